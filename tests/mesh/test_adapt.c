/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/adapt.h"

#include <check.h>

#include "sim.h"
#include "transport.h"

Suite *adapt_suite(void);

enum { COARSE = 2, FINE = DIM == 2 ? 6 : 5, WIDTH = 2 };

/* Small and to one side, to leave room for the coarsest leaves. */
static struct body drop = {{0.3, 0.35, 0.32}, 0.15};

static struct params drop_params(void) {
  struct params params = box_params(FINE);
  params.shape = (struct function){ball, &drop};
  params_follow_surface(&params, COARSE, WIDTH);
  return params;
}

static double distance(const struct mesh *mesh, int32_t i) {
  double x[3] = {0};
  for (int d = 0; d < DIM; d++) x[d] = mesh->x[i][d];
  return ball(&drop, x);
}

START_TEST(the_surface_lies_in_a_band_of_the_finest_level) {
  const struct params params = drop_params();
  struct two_phase *sim = sim_start(&params);
  const struct mesh *mesh = sim->grid.mesh;
  const double h = 1.0 / (1 << FINE);
  bool band = true, wide = true;
  double coarsest = 0;
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    const double c = sim->c->v[i];
    if (c > 1e-6 && c < 1 - 1e-6) band = band && mesh->level[i] == FINE;
    if (fabs(distance(mesh, i)) < WIDTH * h) {
      wide = wide && mesh->level[i] == FINE;
    }
    coarsest = larger(coarsest, mesh->h[i]);
  }
  coarsest = mesh_max(mesh, coarsest);
  band = all_ranks(band), wide = all_ranks(wide);
  const double volume = integral(mesh, sim->c->v), pi = acos(-1);
  two_phase_destroy(sim);
  ck_assert(band);
  ck_assert(wide);
  ck_assert(coarsest == 1.0 / (1 << COARSE)); /* and no more than that */
  const double exact =
      DIM == 2 ? pi * pow(drop.size, 2) : 4 / 3.0 * pi * pow(drop.size, 3);
  ck_assert_double_le(fabs(volume / exact - 1), 1e-5); /* shapes.h */
}
END_TEST

START_TEST(everything_inside_takes_its_level) {
  struct params params = drop_params();
  struct body body = {{0.5, 0.5, 0.5}, 0.38};
  params.shape.context = &body;
  params.criterion[params.ncriteria++] =
      (struct criterion){.type = CRITERION_INSIDE, .level = FINE - 1};
  struct two_phase *sim = sim_start(&params);
  bool good = true;
  double deep = 0;
  for (int32_t i = 0; i < sim->grid.mesh->nleaves; i++) {
    const int level = sim->grid.mesh->level[i];
    double x[3] = {0};
    for (int d = 0; d < DIM; d++) x[d] = sim->grid.mesh->x[i][d];
    if (sim->c->v[i] > 1e-6) good = good && level >= FINE - 1;
    if (ball(&body, x) > 10.0 / (1 << FINE)) { /* out of the band */
      good = good && level == FINE - 1;
      deep++;
    }
  }
  deep = mesh_sum(sim->grid.mesh, deep);
  good = all_ranks(good);
  two_phase_destroy(sim);
  ck_assert(good);
  ck_assert_double_gt(deep, 0);
}
END_TEST

static double left_is_fine(void *context, const double x[3]) {
  (void)context;
  return x[0] < 0.3 ? FINE - 1 : 0;
}

START_TEST(a_function_of_position_sets_the_level) {
  struct params params = box_params(FINE);
  params.level_min = COARSE;
  params.criterion[params.ncriteria++] =
      (struct criterion){.type = CRITERION_FUNCTION,
                         .level = FINE,
                         .function = {left_is_fine, NULL}};
  struct two_phase *sim = sim_start(&params);
  bool good = true;
  for (int32_t i = 0; i < sim->grid.mesh->nleaves; i++) {
    const int level = sim->grid.mesh->level[i];
    if (sim->grid.mesh->x[i][0] < 0.3) good = good && level == FINE - 1;
    if (sim->grid.mesh->x[i][0] > 0.7) good = good && level == COARSE;
  }
  good = all_ranks(good);
  two_phase_destroy(sim);
  ck_assert(good);
}
END_TEST

/* Return a jump of velocity, which only the estimate can see. */
static double jump_velocity(void *context, const double x[3]) {
  (void)context;
  return tanh((x[0] - 0.5) * 40);
}

START_TEST(the_estimate_finds_a_jump_of_velocity) {
  struct params params = periodic_params(FINE);
  params.level_min = COARSE + 1;
  params.velocity[1] = (struct function){jump_velocity, NULL};
  params.boundary[0].type = params.boundary[1].type = BOUNDARY_SLIP;
  params.criterion[params.ncriteria++] = (struct criterion){
      .type = CRITERION_ESTIMATE, .level = FINE, .threshold = 0.02};
  struct two_phase *sim = sim_start(&params);
  bool good = sim->grid.mesh->level_finest == FINE;
  for (int32_t i = 0; i < sim->grid.mesh->nleaves; i++) {
    const double away = fabs(sim->grid.mesh->x[i][0] - 0.5);
    if (away < 0.02) good = good && sim->grid.mesh->level[i] == FINE;
    if (away > 0.3) good = good && sim->grid.mesh->level[i] == COARSE + 1;
  }
  good = all_ranks(good);
  two_phase_destroy(sim);
  ck_assert(good);
}
END_TEST

/* v = cos 2 pi x differs from the mean of its neighbours by (1 - cos 2 pi h)
 * |v|: above the threshold leaves are divided, below a quarter of it merged,
 * between the two they stay. Loop 1: leaves are of the finest level. */
START_TEST(leaves_are_kept_down_to_a_quarter_of_the_threshold) {
  const double pi = acos(-1), limit = 0.81;
  struct params params = periodic_params(FINE - 1);
  struct two_phase *sim = sim_new(&params, MPI_COMM_WORLD);
  const struct mesh *mesh = sim->grid.mesh;
  double wrong = 0, found[3] = {0};
  params.criterion[params.ncriteria++] =
      (struct criterion){.type = CRITERION_ESTIMATE,
                         .level = _i ? FINE - 1 : FINE,
                         .threshold = limit * (1 - cos(2 * pi * mesh->h[0]))};
  const struct followed followed = two_phase_followed(sim);
  int8_t *flag = MEM_NEW(int8_t, mesh->nleaves);
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    sim->u[1]->v[i] = cos(2 * pi * mesh->x[i][0]);
  }
  field_fill(mesh, sim->c);
  adapt_flags(&sim->grid, &followed, flag);
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    const double v = fabs(sim->u[1]->v[i]) / limit;
    const int wanted = v < 0.25 ? -1 : v > 1 && !_i;
    wrong += flag[i] != wanted;
    found[wanted + 1]++;
  }
  wrong = mesh_sum(mesh, wrong);
  for (int k = 0; k < 3; k++) found[k] = mesh_sum(mesh, found[k]);
  mem_free(flag);
  two_phase_destroy(sim);
  ck_assert_double_eq(wrong, 0);
  ck_assert(found[0] > 0 && found[1] > 0 && (_i || found[2] > 0));
}
END_TEST

/* The jump crosses grains and gas. A leaf that was divided, and merged into no
 * other since, lies within 4 leaves of the phase: 1 beside it, 2 of hysteresis,
 * 1 for the rest of a family. Rounds and a second adaptation change nothing. */
START_TEST(a_criterion_is_confined_to_a_phase) {
  const enum criterion_phase only = _i ? CRITERION_GAS : CRITERION_GRAINS;
  const double side = only == CRITERION_GRAINS ? 1 : -1;
  const double h = 1.0 / (1 << FINE);
  struct params params = box_params(FINE);
  struct body body = {{0.5, 0.5, 0.5}, 0.25};
  params.shape = (struct function){ball, &body};
  params.level_min = COARSE;
  params.velocity[DIM - 1] = (struct function){jump_velocity, NULL};
  params.criterion[params.ncriteria++] =
      (struct criterion){.type = CRITERION_ESTIMATE,
                         .only = only,
                         .level = FINE,
                         .threshold = 0.02};
  struct two_phase *sim = sim_new(&params, MPI_COMM_WORLD);
  const struct mesh *mesh = sim->grid.mesh;
  double inside = 0, outside = 0, coarse = 0;
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    const double c = sim->c->v[i], away = fabs(mesh->x[i][0] - 0.5);
    double x[3] = {0};
    for (int d = 0; d < DIM; d++) x[d] = mesh->x[i][d];
    if ((only == CRITERION_GRAINS ? c : 1 - c) > 1e-6 && away < 0.02) {
      inside++, coarse += mesh->level[i] < FINE;
    }
    if (mesh->level[i] == FINE && side * ball(&body, x) < -4 * sqrt(DIM) * h) {
      outside++;
    }
  }
  inside = mesh_sum(mesh, inside), coarse = mesh_sum(mesh, coarse);
  outside = mesh_sum(mesh, outside);
  const bool changed = two_phase_adapt(sim);
  two_phase_destroy(sim);
  ck_assert_double_gt(inside, 0);
  ck_assert_double_eq(coarse, 0);
  ck_assert_double_eq(outside, 0);
  ck_assert(!changed);
}
END_TEST

/* Caps just below the sizes that the grid goes through when there is none.
 * What balance adds is not foreseen: a tenth at most. */
static double near_a_point(void *context, const double x[3]) {
  const double h = 1.0 / (1 << COARSE);
  double away = 0;
  (void)context;
  for (int d = 0; d < DIM; d++) away = larger(away, fabs(x[d] - 0.45));
  return away < 0.5 * h ? FINE : 0;
}

START_TEST(the_cap_is_respected) {
  enum { MOST = 12 };
  struct params params = drop_params();
  params.criterion[params.ncriteria++] = (struct criterion){
      .type = CRITERION_FUNCTION, .level = FINE, .function = {near_a_point}};
  if (_i) { /* without the surface: a few leaves that ask for many more */
    params.criterion[0] = params.criterion[1];
    params.ncriteria = 1;
  }
  int64_t size[MOST];
  double over = 0;
  int n = 0;
  struct forest_layout layout;
  grid_layout(&params, &layout);
  for (int part = -1; part < n; part++) {
    if (part >= 0) params.max_cells = size[part] - 1;
    struct two_phase *sim =
        two_phase_new_on(&params, forest_new(MPI_COMM_WORLD, &layout, COARSE));
    for (int k = 0; k < MOST; k++) {
      sim_fill(sim);
      if (!two_phase_adapt(sim)) break;
      const int64_t leaves = forest_nleaves_global(sim->grid.forest);
      if (part < 0) size[n++] = leaves;
      over = larger(over, (double)leaves / (double)params.max_cells);
    }
    two_phase_destroy(sim);
  }
  ck_assert_int_gt(n, FINE - COARSE - 1);
  ck_assert_double_le(over, 1.1);
}
END_TEST

START_TEST(a_second_adaptation_changes_nothing) {
  struct params params = drop_params();
  if (_i) {
    params.criterion[params.ncriteria++] =
        (struct criterion){.type = CRITERION_INSIDE, .level = FINE - 1};
  }
  struct two_phase *sim = sim_start(&params);
  const bool changed = two_phase_adapt(sim);
  two_phase_destroy(sim);
  ck_assert(!changed);
}
END_TEST

static double drift(int d, const double x[3]) {
  (void)x;
  return d == 0 ? 1 : 0.5;
}

/* Move the grains by `leaves` of the finest along a diagonal. */
static void move(struct two_phase *sim, double leaves) {
  const struct mesh *mesh = sim->grid.mesh;
  double *normal[DIM], *face[2], *flux, *u_f;
  double *cc = scratch_take_one(&sim->scratch, FIELD_CELL, __func__);
  scratch_take(&sim->scratch, FIELD_FACE, __func__, 2, face);
  flux = face[0], u_f = face[1];
  field_arrays(sim->normal, normal);
  fill_faces(mesh, drift, sim->u_f->v);
  const double dt = 0.25 * (leaves > 0 ? 1 : -1) / (1 << FINE);
  for (double done = 0; done < fabs(leaves) - 1e-9; done += 0.25) {
    vof_freeze(mesh, sim->c->v, cc);
    for (int d = 0; d < DIM; d++) {
      const double sign = dt > 0 ? 1 : -1;
      for (int32_t f = 0; f < mesh->nfaces_all; f++) {
        u_f[f] = sign * sim->u_f->v[f];
      }
      field_fill(mesh, sim->c);
      vof_reconstruct(mesh, sim->c->v, normal, sim->plane->v);
      vof_flux(mesh, d, fabs(dt), u_f, NULL, sim->c->v, normal, sim->plane->v,
               flux);
      vof_update(mesh, d, fabs(dt), u_f, flux, cc, sim->c->v);
    }
  }
  scratch_give(&sim->scratch, __func__);
}

/* After the surface has moved the band follows within a few rounds, and what
 * is no longer near it is merged again. */
START_TEST(the_band_follows_the_surface) {
  const struct params params = drop_params();
  struct two_phase *sim = sim_start(&params);
  const double volume = integral(sim->grid.mesh, sim->c->v);
  const double before = (double)forest_nleaves_global(sim->grid.forest);
  int rounds = 0;
  for (int k = 0; k < 8; k++) {
    move(sim, 1);
    int n = 0;
    while (n < 20 && two_phase_adapt(sim)) n++;
    if (n > rounds) rounds = n;
  }
  bool band = true;
  for (int32_t i = 0; i < sim->grid.mesh->nleaves; i++) {
    const double c = sim->c->v[i];
    if (c > 1e-6 && c < 1 - 1e-6) {
      band = band && sim->grid.mesh->level[i] == FINE;
    }
  }
  band = all_ranks(band);
  const double after = (double)forest_nleaves_global(sim->grid.forest);
  const double drifted = integral(sim->grid.mesh, sim->c->v);
  two_phase_destroy(sim);
  ck_assert(band);
  ck_assert_int_le(rounds, FINE - COARSE + 1); /* a level at a time */
  /* about as many as before: the wake is merged, but for the hysteresis */
  ck_assert_double_le(fabs(after / before - 1), 0.15);
  ck_assert_double_le(fabs(drifted / volume - 1), 1e-13);
}
END_TEST

/* Hysteresis: a surface that goes to and fro by half a leaf asks for some
 * leaves at first, then for nothing more. */
START_TEST(a_trembling_surface_leaves_the_grid_alone) {
  const struct params params = drop_params();
  struct two_phase *sim = sim_start(&params);
  bool changed = false;
  for (int k = 1; k <= 6; k++) {
    struct body body = drop;
    for (int d = 0; d < DIM; d++) body.centre[d] += 0.5 * (k & 1) / (1 << FINE);
    for (int n = 0; n < 20; n++) {
      fill_shape(sim->grid.mesh, ball, &body, sim->c->v);
      if (!two_phase_adapt(sim)) break;
      changed = changed || k > 2;
    }
  }
  two_phase_destroy(sim);
  ck_assert(!changed);
}
END_TEST

Suite *adapt_suite(void) {
  Suite *suite = suite_create("adapt");
  TCase *tc = tcase_create("adapt");
  tcase_add_test(tc, the_surface_lies_in_a_band_of_the_finest_level);
  tcase_add_test(tc, everything_inside_takes_its_level);
  tcase_add_test(tc, a_function_of_position_sets_the_level);
  tcase_add_test(tc, the_estimate_finds_a_jump_of_velocity);
  tcase_add_loop_test(tc, leaves_are_kept_down_to_a_quarter_of_the_threshold, 0,
                      2);
  tcase_add_loop_test(tc, a_criterion_is_confined_to_a_phase, 0, 2);
  tcase_add_loop_test(tc, the_cap_is_respected, 0, 2);
  tcase_add_loop_test(tc, a_second_adaptation_changes_nothing, 0, 2);
  tcase_add_test(tc, the_band_follows_the_surface);
  tcase_add_test(tc, a_trembling_surface_leaves_the_grid_alone);
  tcase_set_timeout(tc, 60);
  suite_add_tcase(suite, tc);
  return suite;
}
