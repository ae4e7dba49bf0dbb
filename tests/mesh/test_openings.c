/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/openings.h"
#include "talus/two_phase/start.h"

#include <check.h>

#include "sim.h"
#include "talus/side_map.h"

Suite *openings_suite(void);

enum { COARSE = 2, FINE = DIM == 2 ? 7 : 5, TOP = 2 * DIM - 1 };
enum { FIRST = 6, SECOND = 7 }; /* patches */
#define SPEED 0.5

/* FIRST lies in low <= x < high, in 3D in 0.2 <= y < 0.51 of it, and
 * SECOND everywhere else on the top. */
struct opening {
  double low, high;
  struct side_map *map;
};

static int select_patch(void *context, int side, const double x[3]) {
  const struct opening *opening = context;
  if (side != TOP) return side;
  const bool inside = DIM == 2 || (x[1] >= 0.2 && x[1] < 0.51);
  return inside && x[0] >= opening->low && x[0] < opening->high ? FIRST
                                                                : SECOND;
}

static int select_on_top(void *context, const double t[2]) {
  double x[3] = {0};
  x[0] = t[0], x[DIM - 1] = 1;
  if (DIM == 3) x[1] = t[1];
  return select_patch(context, TOP, x);
}

/* Describe a box of gas with an opening of one type in a top of another; it
 * begins at x = left. */
static struct params opening_at(double left, struct opening *opening,
                                enum boundary_type first,
                                enum boundary_type second) {
  struct params p = box_params(FINE);
  p.origin[0] = left;
  p.nboundaries = 8;
  p.boundary[FIRST].type = first;
  p.boundary[SECOND].type = second;
  p.boundary[FIRST].velocity[DIM - 1] = -SPEED;
  p.boundary[FIRST].fraction = 1;
  p.boundary_select = select_patch;
  p.boundary_context = opening;
  const struct side_map_layout layout = {.naxes = DIM - 1,
                                         .size = 1,
                                         .origin = {left, 0},
                                         .trees = {1, 1},
                                         .level = FINE,
                                         .select = select_on_top,
                                         .context = opening};
  p.side_map[TOP] = opening->map = side_map_new(&layout);
  p.opening_level = FINE;
  p.cfl = 0.7;
  return p;
}

static struct params opening_params(struct opening *opening,
                                    enum boundary_type first,
                                    enum boundary_type second) {
  return opening_at(0, opening, first, second);
}

static double nowhere(void *context, const double x[3]) {
  (void)context, (void)x;
  return -1;
}

static void follow(struct params *p) {
  p->shape = (struct function){nowhere, NULL};
  params_follow_surface(p, COARSE, 1);
}

static double area_of(const struct opening *opening) {
  return (opening->high - opening->low) * (DIM == 2 ? 1 : 0.51 - 0.2);
}

/* Return the flux through the top into the box, of c as well if it is given. */
static double inflow_of(struct two_phase *sim, bool grains) {
  const struct mesh *mesh = sim->grid.mesh;
  double sum = 0;
  field_fill(mesh, sim->c);
  field_fill_many(mesh, DIM, sim->u);
  for (int32_t f = mesh->face_begin[DIM - 1]; f < mesh->nfaces; f++) {
    const int32_t *node = mesh->face_node[f];
    const double *u = sim->u[DIM - 1]->v, *c = sim->c->v;
    if (mesh->face_patch[f] < FIRST || !sim->grid.closed[mesh->face_patch[f]]) {
      continue;
    }
    sum -= 0.5 * (u[node[0]] + u[node[1]]) * pow(mesh->face_h[f], DIM - 1) *
           (grains ? 0.5 * (c[node[0]] + c[node[1]]) : 1);
  }
  return mesh_sum(mesh, sum);
}

static const double kEnds[][2] = {
    {0, 0.25}, {0, 0.27}, {0.3, 0.3137}, {0.40123, 0.7}, {0.5, 0.501}};
enum { NENDS = sizeof kEnds / sizeof *kEnds };

/* Any width, finer than a face as well, on a uniform coarse grid and on one
 * that is fine at the opening. */
START_TEST(what_flows_in_is_speed_times_area) {
  struct opening opening = {kEnds[_i][0], kEnds[_i][1], NULL};
  struct params params =
      opening_params(&opening, BOUNDARY_INFLOW, BOUNDARY_OUTFLOW);
  double flux[2];
  follow(&params);
  for (int k = 0; k < 2; k++) {
    struct forest_layout layout;
    grid_layout(&params, &layout);
    struct two_phase *sim = two_phase_new_on(
        &params, forest_new(MPI_COMM_WORLD, &layout, COARSE + 1));
    for (int n = 0; k == 1 && n < 20 && two_phase_adapt(sim);) n++;
    flux[k] = inflow_of(sim, true);
    two_phase_destroy(sim);
  }
  side_map_destroy(opening.map);
  for (int k = 0; k < 2; k++) {
    ck_assert_double_eq_tol(flux[k] / (SPEED * area_of(&opening)), 1, 2e-4);
  }
}
END_TEST

/* Return the inflow through a ring in the top, on a uniform coarse grid. */
static double ring_inflow(const struct params *params) {
  struct forest_layout layout;
  grid_layout(params, &layout);
  struct two_phase *sim =
      two_phase_new_on(params, forest_new(MPI_COMM_WORLD, &layout, COARSE + 1));
  const struct mesh *mesh = sim->grid.mesh;
  const double *u = sim->u[1]->v;
  double sum = 0;
  field_fill_many(mesh, DIM, sim->u);
  for (int32_t f = mesh->face_begin[1]; f < mesh->nfaces; f++) {
    const int32_t *node = mesh->face_node[f];
    const int patch = mesh->face_patch[f];
    if (patch < FIRST || !sim->grid.closed[patch]) continue;
    sum -= 0.5 * (u[node[0]] + u[node[1]]) * mesh_face_area(mesh, f);
  }
  sum = mesh_sum(mesh, sum);
  two_phase_destroy(sim);
  return sum;
}

/* A face that two patches share is divided by the areas of their rings, be one
 * of them in its middle. */
START_TEST(a_ring_takes_in_what_its_area_does) {
  const double low = kEnds[_i][0], high = kEnds[_i][1];
  struct opening opening = {low, high, NULL};
  if (DIM == 3) return;
  struct params params =
      opening_params(&opening, BOUNDARY_INFLOW, BOUNDARY_OUTFLOW);
  params.coordinates = COORDINATES_AXISYMMETRIC;
  follow(&params);
  const double flux = ring_inflow(&params);
  side_map_destroy(opening.map);
  const double want = SPEED * acos(-1) * (high * high - low * low);
  /* 1/4096 of a face of 1/8, in whose middle the last is */
  ck_assert_double_eq_tol(flux / want, 1, high - low < 0.01 ? 0.03 : 2e-4);
}
END_TEST

/* Steps of a whole run; what is in its way leaves through another side. */
START_TEST(volume_is_that_of_the_jet) {
  struct opening opening = {0, 0.27, NULL};
  struct params params =
      opening_params(&opening, BOUNDARY_INFLOW, BOUNDARY_SLIP);
  params.boundary[1].type = BOUNDARY_OUTFLOW;
  follow(&params);
  params.level_max = params.criterion[0].level = params.opening_level =
      FINE - 2;
  params.tolerance_pressure = params.tolerance_viscous = 1e-4;
  struct two_phase *sim = sim_start(&params);
  bool good = true;
  for (int k = 0; k < 8; k++) {
    good = good && step_advance(sim, 1) == EXIT_DONE;
  }
  const double volume = integral(sim->grid.mesh, sim->c->v);
  const double time = sim->model.time - 0.5 * sim->model.dt;
  two_phase_destroy(sim);
  side_map_destroy(opening.map);
  ck_assert(good);
  ck_assert_double_gt(volume, 0);
  ck_assert_double_eq_tol(volume / (SPEED * area_of(&opening) * time), 1, 2e-4);
}
END_TEST

/* Grains beside gas that flow in at different speeds: on their common face the
 * fluxes of both add up, and that of grains alone is right too. */
START_TEST(two_inflows_share_a_face) {
  struct opening opening = {0, 0.27, NULL};
  struct params params =
      opening_params(&opening, BOUNDARY_INFLOW, BOUNDARY_INFLOW);
  params.boundary[SECOND].velocity[DIM - 1] = -3 * SPEED;
  params.boundary[SECOND].fraction = 0;
  struct forest_layout layout;
  grid_layout(&params, &layout);
  struct two_phase *sim =
      two_phase_new_on(&params, forest_new(MPI_COMM_WORLD, &layout, COARSE));
  const double all = inflow_of(sim, false), grains = inflow_of(sim, true);
  two_phase_destroy(sim);
  side_map_destroy(opening.map);
  const double area = area_of(&opening);
  ck_assert_double_eq_tol(grains / (SPEED * area), 1, 2e-4);
  ck_assert_double_eq_tol(all / (SPEED * (area + 3 * (1 - area))), 1, 2e-4);
}
END_TEST

/* An outlet of a few of the finest faces in a wall is there on the grid that
 * a start makes of coarse leaves, and stays. */
START_TEST(narrow_outlet_is_on_the_finest_level) {
  const double h = 1.0 / (1 << FINE);
  struct opening opening = {0.5, 0.5 + 3 * h, NULL};
  struct params params =
      opening_params(&opening, BOUNDARY_OUTFLOW, BOUNDARY_SLIP);
  follow(&params);
  struct forest_layout layout;
  grid_layout(&params, &layout);
  struct two_phase *sim =
      two_phase_new_on(&params, forest_new(MPI_COMM_WORLD, &layout, COARSE));
  const bool before = sim->grid.pressure_set;
  two_phase_refine_openings(sim);
  const struct mesh *mesh = sim->grid.mesh;
  double area = 0, coarsest = 0;
  for (int32_t f = 0; f < mesh->nfaces; f++) {
    const int patch = mesh->face_patch[f];
    if (patch < 0 || !sim->grid.open[patch]) continue;
    area += pow(mesh->face_h[f], DIM - 1);
    coarsest = larger(coarsest, mesh->face_h[f]);
  }
  area = mesh_sum(mesh, area), coarsest = mesh_max(mesh, coarsest);
  const bool after = sim->grid.pressure_set,
             fine = openings_are_fine(&sim->grid);
  const bool changed = two_phase_adapt(sim);
  const double cells = (double)forest_nleaves_global(sim->grid.forest);
  two_phase_destroy(sim);
  side_map_destroy(opening.map);
  ck_assert(!before);
  ck_assert(after);
  ck_assert(fine);
  ck_assert(!changed);
  ck_assert(coarsest == h);
  const double width = DIM == 2 ? 1 : round((0.51 - 0.2) / h) * h;
  ck_assert_double_eq_tol(area, 3 * h * width, 1e-12);
  ck_assert_double_le(cells, DIM == 2 ? 500 : 8000); /* of 16,384, 32,768 */
}
END_TEST

/* The open air beside a jet is fine at its end alone. */
START_TEST(large_opening_is_fine_at_its_ends) {
  struct opening opening = {0, 0.125, NULL};
  struct params params =
      opening_params(&opening, BOUNDARY_INFLOW, BOUNDARY_OUTFLOW);
  follow(&params);
  struct two_phase *sim = sim_start(&params);
  const struct mesh *mesh = sim->grid.mesh;
  double coarsest[2] = {0};
  for (int32_t f = 0; f < mesh->nfaces; f++) {
    const int patch = mesh->face_patch[f];
    if (patch < FIRST) continue;
    double *most = &coarsest[sim->grid.open[patch]];
    *most = larger(*most, mesh->face_h[f]);
  }
  for (int k = 0; k < 2; k++) coarsest[k] = mesh_max(mesh, coarsest[k]);
  two_phase_destroy(sim);
  side_map_destroy(opening.map);
  ck_assert(coarsest[0] == 1.0 / (1 << FINE));
  ck_assert_double_ge(coarsest[1], 4.0 / (1 << FINE));
}
END_TEST

/* A small outlet is fine in its middle too, far from both ends. */
START_TEST(small_outlet_is_fine_all_over) {
  struct opening opening = {0.25, 0.7, NULL};
  struct params params =
      opening_params(&opening, BOUNDARY_OUTFLOW, BOUNDARY_SLIP);
  follow(&params);
  struct two_phase *sim = sim_start(&params);
  const struct mesh *mesh = sim->grid.mesh;
  double coarsest = 0;
  for (int32_t f = 0; f < mesh->nfaces; f++) {
    const int patch = mesh->face_patch[f];
    if (patch < FIRST || !sim->grid.open[patch]) continue;
    coarsest = larger(coarsest, mesh->face_h[f]);
  }
  coarsest = mesh_max(mesh, coarsest);
  two_phase_destroy(sim);
  side_map_destroy(opening.map);
  ck_assert(coarsest == 1.0 / (1 << FINE));
}
END_TEST

/* A box and its opening, moved along x by what is no number of leaves. */
START_TEST(levels_at_openings_move_with_the_box) {
  const double left = 0.3;
  struct opening opening[] = {{0.25, 0.7, NULL}, {0.55, 1, NULL}};
  const struct params params[] = {
      opening_at(0, &opening[0], BOUNDARY_OUTFLOW, BOUNDARY_SLIP),
      opening_at(left, &opening[1], BOUNDARY_OUTFLOW, BOUNDARY_SLIP)};
  int wrong = 0, fine = 0;
  for (int level = COARSE; level <= FINE; level++) {
    const double h = 1.0 / (1 << level);
    for (int i = 0; i < 1 << level; i++) {
      double at[2][3] = {{0}}; /* below the top, in 3D in the opening */
      for (int k = 0; k < 2; k++) {
        at[k][1] = (floor(0.4 / h) + 0.5) * h;
        at[k][0] = k * left + (i + 0.5) * h;
        at[k][DIM - 1] = 1 - 0.5 * h;
      }
      const int wanted = openings_level_at(&params[0], at[0], level);
      wrong += openings_level_at(&params[1], at[1], level) != wanted;
      fine += wanted == FINE;
    }
  }
  for (int k = 0; k < 2; k++) side_map_destroy(opening[k].map);
  ck_assert_int_gt(fine, 0);
  ck_assert_int_eq(wrong, 0);
}
END_TEST

Suite *openings_suite(void) {
  Suite *suite = suite_create("openings");
  TCase *tc = tcase_create("openings");
  tcase_add_loop_test(tc, what_flows_in_is_speed_times_area, 0, NENDS);
  tcase_add_loop_test(tc, a_ring_takes_in_what_its_area_does, 0, NENDS);
  tcase_add_test(tc, volume_is_that_of_the_jet);
  tcase_add_test(tc, two_inflows_share_a_face);
  tcase_add_test(tc, narrow_outlet_is_on_the_finest_level);
  tcase_add_test(tc, large_opening_is_fine_at_its_ends);
  tcase_add_test(tc, small_outlet_is_fine_all_over);
  tcase_add_test(tc, levels_at_openings_move_with_the_box);
  tcase_set_timeout(tc, 60);
  suite_add_tcase(suite, tc);
  return suite;
}
