/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Droplets, outline, energies: against what is known exactly. */
#include "talus/remap.h"
#include "talus/two_phase/measure.h"
#include "talus/vof.h"

#include <check.h>
#include <math.h>
#include <string.h>

#include "sim.h"
#include "talus/plane.h"
#include "talus/two_phase/fractions.h"

/* Unit box of uniform leaves, or refined in a ball, and a field on it. */
struct world {
  struct forest *forest;
  struct mesh *mesh;
  double *c;
  bool *heap;
};

static struct world world_new(int base, int level) {
  struct world w;
  w.forest = grid_new(MPI_COMM_WORLD, 1, false, base, level);
  w.mesh = mesh_new(w.forest);
  w.c = MEM_NEW(double, w.mesh->ncells);
  w.heap = MEM_NEW(bool, w.mesh->nleaves);
  return w;
}

static void world_destroy(struct world *w) {
  mem_free(w->heap);
  mem_free(w->c);
  mesh_destroy(w->mesh);
  forest_destroy(w->forest);
}

/* Fill the leaves whose centre lies in the box [lo, hi] (all axes but x: from
 * ylo to yhi) with a fraction. */
static void fill_box(struct world *w, double xlo, double xhi, double ylo,
                     double yhi, double c) {
  for (int32_t i = 0; i < w->mesh->nleaves; i++) {
    const double *x = w->mesh->x[i];
    bool inside = x[0] > xlo && x[0] < xhi;
    for (int d = 1; d < DIM; d++) inside = inside && x[d] > ylo && x[d] < yhi;
    if (inside) w->c[i] = c;
  }
}

/* Droplets */

START_TEST(droplets_are_counted_apart_from_the_heap) {
  struct world w = world_new(4, 4); /* 16 cells along an axis */
  struct droplets droplets;
  fill_box(&w, 0, 0.5, 0, 0.5, 1);
  fill_box(&w, 0.75, 0.875, 0.75, 0.875, 1);     /* 2^DIM cells */
  fill_box(&w, 0.5625, 0.625, 0.5, 0.5625, 0.5); /* one cell */
  fill_box(&w, 0.9375, 1, 0, 0.0625, 1e-7);      /* dust: no set */
  droplets_find(w.mesh, w.c, w.heap, &droplets);
  double cell = pow(16, -DIM), in_heap = 0;
  for (int32_t i = 0; i < w.mesh->nleaves; i++)
    if (w.heap[i]) in_heap += w.c[i] * mesh_volume(w.mesh, i);
  in_heap = mesh_sum(w.mesh, in_heap);
  ck_assert_int_eq(droplets.n, 2);
  /* powers of two: exact */
  ck_assert_double_eq(droplets.volume, (NCHILD + 0.5) * cell);
  ck_assert_double_eq(in_heap, pow(0.5, DIM));
  world_destroy(&w);
}
END_TEST

START_TEST(cells_that_share_a_corner_are_apart) {
  struct world w = world_new(3, 3);
  struct droplets droplets;
  fill_box(&w, 0, 0.5, 0, 0.5, 1);
  fill_box(&w, 0.5, 0.75, 0.5, 0.75, 1);
  droplets_find(w.mesh, w.c, w.heap, &droplets);
  ck_assert_int_eq(droplets.n, 1);
  world_destroy(&w);
}
END_TEST

/* A snake that crosses from rank to rank many times, across levels too. */
START_TEST(a_winding_set_is_one_set) {
  struct world w = world_new(4, 6);
  struct droplets droplets;
  const double s = 1.0 / 16;
  for (int k = 0; k < 8; k++) {
    fill_box(&w, 2 * k * s, (2 * k + 1) * s, 0, 1, 1); /* a wall */
    double end = k % 2 ? 1 - s : 0;
    fill_box(&w, (2 * k + 1) * s, (2 * k + 2) * s, end, end + s, 1); /* step */
  }
  fill_box(&w, 15 * s, 1, 0.5, 0.5 + s, 1); /* hangs on nothing but the wall */
  droplets_find(w.mesh, w.c, w.heap, &droplets);
  bool good = droplets.n == 0;
  for (int32_t i = 0; i < w.mesh->nleaves; i++)
    good = good && w.heap[i] == (w.c[i] > 0);
  ck_assert(all_ranks(good));
  world_destroy(&w);
}
END_TEST

START_TEST(an_empty_box_has_neither_heap_nor_droplets) {
  struct world w = world_new(2, 2);
  struct droplets droplets;
  struct outline outline;
  droplets_find(w.mesh, w.c, w.heap, &droplets);
  outline_measure(w.mesh, w.c, w.heap, DIM - 1, &outline);
  ck_assert_int_eq(droplets.n, 0);
  ck_assert_double_eq(droplets.volume, 0);
  ck_assert_double_eq(outline_front(&outline, 0), 0);
  ck_assert_double_eq(outline_height(&outline), 0);
  outline_free(&outline);
  world_destroy(&w);
}
END_TEST

/* Outline */

/* Fill the volume fractions of the heap below h(x) = peak - slope |r|, r = x -
 * x0 (3D: the distance in the plane), by columns of samples. */
static void fill_heap(struct world *w, const double x0[2], double peak,
                      double slope) {
  enum { SAMPLES = 16 };
  for (int32_t i = 0; i < w->mesh->nleaves; i++) {
    const double *x = w->mesh->x[i], h = w->mesh->h[i];
    double bottom = x[DIM - 1] - 0.5 * h, sum = 0;
    for (int a = 0; a < SAMPLES; a++) {
      for (int b = 0; b < (DIM == 3 ? SAMPLES : 1); b++) {
        double r = x[0] + h * ((a + 0.5) / SAMPLES - 0.5) - x0[0];
        if (DIM == 3)
          r = hypot(r, x[1] + h * ((b + 0.5) / SAMPLES - 0.5) - x0[1]);
        double top = peak - slope * fabs(r);
        sum += fmax(0, fmin(1, (top - bottom) / h));
      }
    }
    w->c[i] = sum / (DIM == 3 ? SAMPLES * SAMPLES : SAMPLES);
    w->heap[i] = w->c[i] > 0;
  }
}

/* Return the front of such a heap on leaves of 1/32, and its outline. */
static double front_of(const double x0[2], double peak, double slope,
                       int level) {
  struct world w = world_new(5, level);
  struct outline outline;
  fill_heap(&w, x0, peak, slope);
  outline_measure(w.mesh, w.c, w.heap, DIM - 1, &outline);
  double front = outline_front(&outline, 0);
  outline_free(&outline);
  world_destroy(&w);
  return front;
}

START_TEST(the_front_of_a_wedge_on_the_wall_is_interpolated) {
  const double x0[2] = {0, 0};
  const double delta = 1.0 / 32;
  /* where the height is delta/2; rings and cells of the outermost column, cut
   * by the floor, leave a fraction of a cell */
  double exact = (0.5 - 0.5 * delta) / 0.8;
  double front = front_of(x0, 0.5, 0.8, 5);
  ck_assert_double_le(fabs(front - exact), (DIM == 2 ? 0.1 : 0.5) * delta);
}
END_TEST

/* Columns of width 1 and heights 3, 2, 1, 0: half way from the third to the
 * fourth it is 1/2, at x = 3, and 1.25 at x = 2.25. In 3D
 * all along y, as a slice of a plane heap. */
START_TEST(the_front_of_columns_done_by_hand) {
  enum { NX = 6, NY = DIM == 2 ? 1 : 4 };
  double height[NY * NX];
  struct outline outline = {
      .n = {NX, NY}, .first = {0.5, 0.5}, .spacing = 1, .height = height};
  for (int k = 0; k < NY * NX; k++) height[k] = fmax(3 - k % NX, 0);
  ck_assert_double_eq_tol(outline_front(&outline, 0), 3, 1e-14);
  ck_assert_double_eq_tol(outline_front(&outline, 1.25), 2.25, 1e-14);
  /* a heap lower than that ends at half its height */
  ck_assert_double_eq_tol(outline_front(&outline, 100), 2, 1e-14);
}
END_TEST

START_TEST(a_heap_in_the_middle_has_the_front_of_its_longer_side) {
  const double delta = 1.0 / 32;
  if (DIM == 2) { /* the upper end, as both are level */
    const double x0[2] = {0.5, 0};
    double exact = 0.5 + (0.3 - 0.5 * delta) / 0.8;
    ck_assert_double_le(fabs(front_of(x0, 0.3, 0.8, 5) - exact), 0.1 * delta);
  } else { /* the radius */
    const double x0[2] = {0.4, 0.55};
    double exact = (0.3 - 0.5 * delta) / 0.8;
    ck_assert_double_le(fabs(front_of(x0, 0.3, 0.8, 5) - exact), 0.75 * delta);
  }
}
END_TEST

START_TEST(a_heap_on_the_upper_wall_is_walked_downwards) {
  const double x0[2] = {1, 1};
  const double delta = 1.0 / 32;
  double reach = (0.5 - 0.5 * delta) / 0.8;
  double exact = DIM == 2 ? 1 - reach : reach;
  ck_assert_double_le(fabs(front_of(x0, 0.5, 0.8, 5) - exact),
                      (DIM == 2 ? 0.1 : 0.5) * delta);
}
END_TEST

/* Such as 0.3 of a cell, on the whole floor or up to its middle. */
START_TEST(a_layer_thinner_than_a_cell_has_a_front) {
  const double delta = 1.0 / 32, thin[] = {0.9, 0.5, 0.3, 1e-3};
  for (int k = 0; k < 4; k++) {
    struct world w = world_new(5, 5);
    struct outline outline;
    fill_box(&w, 0, _i ? 0.5 : 1, 0, 1, thin[k]);
    for (int32_t i = 0; i < w.mesh->nleaves; i++) {
      if (w.mesh->x[i][DIM - 1] > delta) w.c[i] = 0;
      w.heap[i] = w.c[i] > 0;
    }
    outline_measure(w.mesh, w.c, w.heap, DIM - 1, &outline);
    double front = outline_front(&outline, 0),
           height = outline_height(&outline);
    outline_free(&outline);
    world_destroy(&w);
    ck_assert_double_eq(height, thin[k] * delta);
    /* 2D: the middle between the last full column and the first empty one is
     * the edge; 3D: both leans make a slice of a plane heap where it is one,
     * else the rings reach into the far corner */
    double exact = _i ? 0.5 : DIM == 2 ? 1 : sqrt(2);
    ck_assert_double_le(fabs(front - exact), DIM == 2 ? 1e-12 : delta);
  }
}
END_TEST

START_TEST(columns_add_up_to_the_volume) {
  struct world w = world_new(3, 5);
  const double x0[2] = {0.2, 0.7};
  struct outline outline;
  fill_heap(&w, x0, 0.6, 0.5);
  outline_measure(w.mesh, w.c, w.heap, DIM - 1, &outline);
  double volume = 0, sum = 0;
  for (int32_t i = 0; i < w.mesh->nleaves; i++)
    volume += w.c[i] * mesh_volume(w.mesh, i);
  volume = mesh_sum(w.mesh, volume);
  for (int k = 0; k < outline.n[0] * outline.n[1]; k++)
    sum += outline.height[k] * pow(outline.spacing, DIM - 1);
  ck_assert_int_eq(outline.n[0], 32);
  ck_assert_int_eq(outline.n[1], DIM == 2 ? 1 : 32);
  /* a few thousand terms */
  ck_assert_double_le(fabs(sum / volume - 1), 1e-13);
  outline_free(&outline);
  world_destroy(&w);
}
END_TEST

START_TEST(the_vertical_is_the_axis_of_gravity) {
  static const double down[] = {0, -1, 0}, left[] = {-1, 0, 0};
  static const double tilted[] = {0.5, -1, 0.5}, none[] = {0, 0, 0};
  ck_assert_int_eq(outline_axis(down), 1);
  ck_assert_int_eq(outline_axis(left), 0);
  ck_assert_int_eq(outline_axis(tilted), DIM - 1);
  ck_assert_int_eq(outline_axis(none), DIM - 1);
}
END_TEST

/* A heap whose outline falls within a column of leaves ends as high as the key
 * front_height asks, or half a leaf. */
START_TEST(the_front_is_as_high_as_asked) {
  double front[2];
  for (int k = 0; k < 2; k++) {
    struct diagnostics diagnostics;
    struct params p = box_params(4);
    p.shape = (struct function){column, NULL};
    p.front_height = k ? 0.3 : 0;
    struct two_phase *sim = sim_start(&p);
    diagnostics_measure(sim, &diagnostics);
    front[k] = diagnostics.front;
    ck_assert_double_eq(front[k],
                        outline_front(&diagnostics.outline, p.front_height));
    diagnostics_free(&diagnostics);
    two_phase_destroy(sim);
  }
  ck_assert_double_lt(front[1], front[0]);
}
END_TEST

/* Sums */

/* Make a state with no more than diagnostics read; the fields are zero. */
static struct two_phase *state_new(struct world *w, struct params *params) {
  static const char *const name[] = {"u_x", "u_y", "u_z"};
  struct two_phase *sim = MEM_NEW(struct two_phase, 1);
  params->grains.density = 2;
  sim->params = params;
  sim->grid.forest = w->forest;
  sim->grid.mesh = w->mesh;
  sim->c = fields_add(&sim->grid.fields, w->mesh, "c", "1", "fraction",
                      FIELD_CELL, &vof_rule);
  for (int d = 0; d < DIM; d++)
    sim->u[d] = fields_add(&sim->grid.fields, w->mesh, name[d], "m/s",
                           "velocity", FIELD_CELL, &remap_linear);
  return sim;
}

static void state_destroy(struct two_phase *sim) {
  fields_destroy(&sim->grid.fields);
  mem_free(sim);
}

/* Fill the fractions below the plane n.x = alpha of the unit box, exact. */
static void fill_plane(struct world *w, const double n[DIM], double alpha,
                       double *c) {
  for (int32_t i = 0; i < w->mesh->nleaves; i++) {
    double local = alpha;
    for (int d = 0; d < DIM; d++) local -= n[d] * w->mesh->x[i][d];
    c[i] = plane_volume(n, local / w->mesh->h[i]);
  }
}

START_TEST(energies_of_a_tilted_half_space_are_exact) {
  struct world w = world_new(4, 5);
  struct params *params = MEM_NEW(struct params, 1);
  struct two_phase *sim = state_new(&w, params);
  struct diagnostics d;
  /* below y = 0.6 + 0.4 (x - 1/2), or the same in z for 3D */
  double n[DIM] = {0};
  n[0] = -0.4;
  n[DIM - 1] = 1;
  fill_plane(&w, n, 0.4, sim->c->v);
  for (int32_t i = 0; i < w.mesh->nleaves; i++) sim->u[0]->v[i] = 3;
  params->gravity[0] = 0.7;
  params->gravity[DIM - 1] = -10;
  diagnostics_measure(sim, &d);
  double volume = 0.6;
  /* moments of the trapezoid */
  double mz = 0.5 * (0.6 * 0.6 + 0.4 * 0.4 / 12);
  double mx = 0.5 * 0.6 + 0.4 / 12;
  double potential = -2 * (0.7 * mx - 10 * mz);
  ck_assert_double_le(fabs(d.volume - volume), 1e-14);
  ck_assert_double_le(fabs(d.kinetic - 0.5 * 2 * 9 * volume), 1e-13);
  ck_assert_double_le(fabs(d.max_speed - 3), 0);
  ck_assert_double_eq(d.shear_rate, 0); /* they move as one */
  /* Simpson's rule is off by 1e-3 h in the cells along the surface; cell
   * centres would give 1e-3 and more */
  ck_assert_double_le(fabs(d.potential / potential - 1), 2e-5);
  diagnostics_free(&d);
  state_destroy(sim);
  mem_free(params);
  world_destroy(&w);
}
END_TEST

/* The sum of numbers of very different size must keep the small ones. */
START_TEST(the_volume_is_good_to_the_last_digits) {
  struct world w = world_new(5, 7);
  struct params *params = MEM_NEW(struct params, 1);
  struct two_phase *sim = state_new(&w, params);
  struct diagnostics d;
  long double local = 0, sum = 0;
  for (int32_t i = 0; i < w.mesh->nleaves; i++) {
    double x = w.mesh->x[i][0] + 1.7 * w.mesh->x[i][1];
    sim->c->v[i] = 0.5 + 0.5 * sin(100 * x);
    local +=
        sim->c->v[i] * mesh_volume(w.mesh, i); /* exact product: powers of 2 */
  }
  MPI_CHECK(
      MPI_Allreduce(&local, &sum, 1, MPI_LONG_DOUBLE, MPI_SUM, MPI_COMM_WORLD));
  diagnostics_measure(sim, &d);
  ck_assert_double_le(fabs((double)(d.volume / sum - 1)), 2.3e-16);
  diagnostics_free(&d);
  state_destroy(sim);
  mem_free(params);
  world_destroy(&w);
}
END_TEST

/* Layers */

static double everywhere(void *context, const double x[3]) {
  (void)context, (void)x;
  return 1;
}

/* Return x < 0.2 if *context, else x > 0.2. */
static double half(void *context, const double x[3]) {
  return *(const double *)context > 0 ? 0.2 - x[0] : x[0] - 0.2;
}

/* Describe tracers of a collapsing column: all of the box, the grains, their
 * left and their right half. */
static struct params layered_params(void) {
  static double left[2] = {1, 0};
  struct params params = box_params(DIM == 2 ? 5 : 4);
  params.shape = (struct function){column, NULL};
  params.ntracers = 4;
  params.tracer[0] = (struct tracer){"all", {everywhere, NULL}};
  params.tracer[1] = (struct tracer){"grains", {column, NULL}};
  params.tracer[2] = (struct tracer){"left", {half, &left[0]}};
  params.tracer[3] = (struct tracer){"right", {half, &left[1]}};
  return params;
}

/* A tracer of all the box has the height of the heap, the tracer that began as
 * the grains too, as it moves with the same fluxes: to round-off, if both are
 * taken at the same time. Two halves add up but for the cells between them,
 * whose tracers are cut by different planes: to a tenth of the volume in one
 * row of cells. */
START_TEST(layers_add_up_to_the_heap) {
  const struct params params = layered_params();
  struct two_phase *sim = sim_start(&params);
  struct diagnostics d;
  double apart[2] = {0}, gap = 0, volume = 0, moved = 0;
  for (int k = 0; k < 24; k++) step_advance(sim, 1);
  double *before = MEM_NEW(double, (size_t)sim->grid.mesh->nleaves);
  const size_t bytes = (size_t)sim->grid.mesh->nleaves * sizeof(double);
  memcpy(before, sim->tracer[2]->v, bytes);
  fractions_synchronise(sim);
  diagnostics_measure(sim, &d);
  diagnostics_measure_layers(sim, &d);
  fractions_desynchronise(sim);
  for (int i = 0; i < d.outline.n[0] * d.outline.n[1]; i++) {
    const double height = d.outline.height[i];
    for (int k = 0; k < 2; k++)
      apart[k] = larger(apart[k], fabs(d.layer[k][i] - height));
    gap += fabs(d.layer[2][i] + d.layer[3][i] - height);
    volume += height;
  }
  for (int32_t i = 0; i < sim->grid.mesh->nleaves; i++)
    moved = larger(moved, fabs(sim->tracer[2]->v[i] - before[i]));
  moved = mesh_max(sim->grid.mesh, moved);
  const double front = d.front, row = d.outline.spacing / 0.4;
  diagnostics_free(&d);
  mem_free(before);
  two_phase_destroy(sim);
  ck_assert_double_gt(front, 0.42); /* it has begun to fall */
  ck_assert_double_le(apart[0], 1e-14);
  ck_assert_double_le(apart[1], 1e-12);
  ck_assert_double_le(gap / volume, 0.1 * row);
  ck_assert_double_eq(moved, 0);
}
END_TEST

static double upper_half(void *context, const double x[3]) {
  (void)context;
  return x[DIM - 1] - 0.5;
}

/* Grains that sink into a row of gas which moves ten times as fast keep the
 * speed that they had, but for what the mass of the gas does: 3e-3 of it, in
 * 1/16 of the grains. */
START_TEST(grains_that_enter_gas_keep_their_speed) {
  struct params params = box_params(3);
  params.shape = (struct function){upper_half, NULL};
  struct two_phase *sim = sim_start(&params);
  const struct mesh *mesh = sim->grid.mesh;
  struct diagnostics d;
  double *u_f = sim->u_f->v;
  for (int32_t f = mesh->face_begin[DIM - 1]; f < mesh->nfaces; f++) {
    u_f[f] = mesh->face_patch[f] < 0 ? -1 : 0;
  }
  mesh_fill_faces(mesh, 1, &u_f);
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    sim->u[0]->v[i] = sim->c->v[i] > 0 ? 0 : 10;
    sim->u[DIM - 1]->v[i] = sim->c->v[i] > 0 ? -1 : 0;
  }
  for (int e = 0; e < DIM; e++) mesh_touch(mesh, sim->u[e]->v);
  sim->model.dt = 1.0 / 16;
  fractions_synchronise(sim);
  diagnostics_measure(sim, &d);
  fractions_desynchronise(sim);
  const double kinetic = d.kinetic, volume = d.volume;
  diagnostics_free(&d);
  two_phase_destroy(sim);
  ck_assert_double_le(fabs(kinetic / (0.5 * volume) - 1), 5e-4);
}
END_TEST

Suite *diagnostics_suite(void);
/* Grains above the middle of a box are at their yield stress. */
START_TEST(flowing_is_the_part_at_its_yield_stress) {
  struct params params = box_params(3);
  rheology_set(&params.grains.rheology, "cohesion", 1);
  rheology_set_regularisation(&params.grains.rheology, _i ? "clip" : "exact");
  struct two_phase *sim = sim_new(&params, MPI_COMM_WORLD);
  const struct mesh *mesh = sim->grid.mesh;
  for (int32_t i = 0; i < mesh->nleaves; i++) sim->c->v[i] = 1;
  for (int d = 0; d < DIM && !_i; d++) {
    for (int32_t f = mesh->face_begin[d]; f < mesh->face_begin[d + 1]; f++) {
      const double half = mesh->face_node[f][0] == mesh->face_owner[f] ? 1 : -1;
      const int32_t i = mesh->face_owner[f];
      const double z =
          mesh->x[i][DIM - 1] + (d == DIM - 1 ? 0.5 * half * mesh->h[i] : 0);
      sim->yield.tau_y->v[f] = 2;
      sim->yield.s[d == 0]->v[f] = z > 0.5 + 1e-9 ? 2 : 1.99;
    }
  }
  const double flowing = diagnostics_flowing(sim);
  two_phase_destroy(sim);
  /* half of the leaves, less one side of the lowest of them */
  const double exact = 0.5 - 0.125 / (2 * DIM);
  ck_assert_double_eq_tol(flowing, _i ? 1 : exact, 1e-12);
}
END_TEST

Suite *diagnostics_suite(void) {
  Suite *suite = suite_create("diagnostics");
  TCase *tcase = tcase_create("droplets");
  tcase_add_test(tcase, droplets_are_counted_apart_from_the_heap);
  tcase_add_test(tcase, cells_that_share_a_corner_are_apart);
  tcase_add_test(tcase, a_winding_set_is_one_set);
  tcase_add_test(tcase, an_empty_box_has_neither_heap_nor_droplets);
  tcase_add_loop_test(tcase, flowing_is_the_part_at_its_yield_stress, 0, 2);
  suite_add_tcase(suite, tcase);
  tcase = tcase_create("outline");
  tcase_add_test(tcase, the_front_of_a_wedge_on_the_wall_is_interpolated);
  tcase_add_test(tcase, the_front_of_columns_done_by_hand);
  tcase_add_test(tcase, a_heap_in_the_middle_has_the_front_of_its_longer_side);
  tcase_add_test(tcase, a_heap_on_the_upper_wall_is_walked_downwards);
  tcase_add_loop_test(tcase, a_layer_thinner_than_a_cell_has_a_front, 0, 2);
  tcase_add_test(tcase, columns_add_up_to_the_volume);
  tcase_add_test(tcase, the_front_is_as_high_as_asked);
  tcase_add_test(tcase, the_vertical_is_the_axis_of_gravity);
  suite_add_tcase(suite, tcase);
  tcase = tcase_create("sums");
  tcase_add_test(tcase, energies_of_a_tilted_half_space_are_exact);
  tcase_add_test(tcase, the_volume_is_good_to_the_last_digits);
  suite_add_tcase(suite, tcase);
  tcase = tcase_create("layers");
  tcase_add_test(tcase, grains_that_enter_gas_keep_their_speed);
  tcase_add_test(tcase, layers_add_up_to_the_heap);
  tcase_set_timeout(tcase, 60);
  suite_add_tcase(suite, tcase);
  return suite;
}
