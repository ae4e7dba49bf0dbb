/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/two_phase/percolation.h"

#include <check.h>

#include "sim.h"
#include "talus/error.h"
#include "talus/vof.h"

/* Level sets of grains; the last axis is up. */

/* A block over all of the box that misses the floor by a tenth of a leaf. */
#define LEVEL 4
static const double kGap = 0.1 / (1 << LEVEL);
static double hovering(void *context, const double x[3]) {
  (void)context;
  return fmin(x[DIM - 1] - kGap, 0.5 + kGap - x[DIM - 1]);
}

/* Return the level set of a bed with a bubble of some leaves in it, off the
 * lines of the grid. */
static double bubble(void *context, const double x[3]) {
  (void)context;
  double r2 = 0;
  for (int d = 0; d < DIM; d++) r2 += (x[d] - 0.37) * (x[d] - 0.37);
  return fmin(0.8 - x[DIM - 1], sqrt(r2) - 0.15);
}

/* Return the level set of grains that hang from the lid, a tenth of a leaf
 * below it. */
static double hanging(void *context, const double x[3]) {
  (void)context;
  return fmin(x[DIM - 1] - 0.5, 1 - kGap - x[DIM - 1]);
}

/* Return the level set of a slope that cuts leaves in all ways, without gas
 * below it. */
static double slope(void *context, const double x[3]) {
  (void)context;
  return 0.6 - 0.43 * x[0] - x[DIM - 1];
}

static struct params case_of(double (*shape)(void *, const double[3]),
                             bool permeable, bool open) {
  struct params params = box_params(LEVEL);
  params.permeable = permeable;
  params.shape = (struct function){shape, NULL};
  params_follow_surface(&params, LEVEL - 2, 2);
  params.pressure_level_given = !open;
  if (open) params.boundary[2 * DIM - 1].type = BOUNDARY_OUTFLOW;
  return params;
}

/* Calls without steps between them, and what they do to a state. */
struct effect {
  double gas[2]; /* volume below half of the grains, before and after */
  double drift;  /* of the volume of grains */
  double excess; /* how far c has come out of [0, 1] */
  double moved;  /* largest change of c */
  double passed; /* volume of gas that has left */
  double work;   /* of the grains' weight */
};

static double gas_below(const struct two_phase *sim) {
  double sum = 0;
  for (int32_t i = 0; i < sim->grid.mesh->nleaves; i++) {
    if (sim->grid.mesh->x[i][DIM - 1] > 0.45) continue;
    sum += (1 - sim->c->v[i]) * mesh_volume(sim->grid.mesh, i);
  }
  return mesh_sum(sim->grid.mesh, sum);
}

static struct effect percolate(const struct params *params, int calls,
                               double dt) {
  struct two_phase *sim = sim_new(params, MPI_COMM_WORLD);
  struct effect effect = {.gas = {gas_below(sim)}};
  const double volume = integral(sim->grid.mesh, sim->c->v);
  double *start = MEM_NEW(double, sim->grid.mesh->nleaves);
  memcpy(start, sim->c->v, (size_t)sim->grid.mesh->nleaves * sizeof *start);
  field_fill(sim->grid.mesh, sim->band); /* no momentum rides with c */
  for (int k = 0; k < calls; k++) {
    percolation_advance(sim, dt);
    sim->model.step++;
    effect.excess =
        larger(effect.excess, vof_excess(sim->grid.mesh, sim->c->v));
  }
  for (int32_t i = 0; i < sim->grid.mesh->nleaves; i++) {
    effect.moved = larger(effect.moved, fabs(sim->c->v[i] - start[i]));
  }
  effect.excess = mesh_max(sim->grid.mesh, effect.excess);
  effect.moved = mesh_max(sim->grid.mesh, effect.moved);
  effect.gas[1] = gas_below(sim);
  effect.drift = fabs(integral(sim->grid.mesh, sim->c->v) - volume) / volume;
  effect.passed = sim->percolation.volume;
  effect.work = sim->energy.dissipated;
  mem_free(start);
  two_phase_destroy(sim);
  return effect;
}

START_TEST(a_film_under_grains_closes) {
  const struct params params = case_of(hovering, true, _i);
  const struct effect effect = percolate(&params, 160, 0.01);
  ck_assert_double_eq_tol(effect.gas[0], kGap, 1e-12);
  /* up to the traces that are not worth a sweep */
  ck_assert_double_le(effect.gas[1], 1e-4 * kGap);
  ck_assert_double_eq_tol(effect.passed, kGap, 1e-4 * kGap);
  ck_assert_double_le(effect.drift, 1e-14);
  ck_assert_double_le(effect.excess, VOF_EMPTY);
  /* the whole block, 0.5 high, has sunk by the gap */
  ck_assert_double_eq_tol(effect.work, 0.5 * kGap, 0.01 * 0.5 * kGap);
}
END_TEST

START_TEST(a_bubble_leaves) {
  const struct params params = case_of(bubble, true, _i);
  const struct effect effect = percolate(&params, 200, 0.02);
  ck_assert_double_gt(effect.gas[0], DIM == 2 ? 0.05 : 0.01);
  ck_assert_double_le(effect.gas[1], 1e-4 * effect.gas[0]);
  ck_assert_double_le(effect.drift, 1e-13);
  ck_assert_double_le(effect.excess, VOF_EMPTY);
}
END_TEST

/* A step, and its repetitions, whose solves may do nothing. */
START_TEST(a_step_that_fails_lets_no_gas_pass) {
  struct params params = case_of(bubble, true, true);
  struct two_phase *sim = sim_new(&params, MPI_COMM_WORLD);
  params.max_iterations = 0;
  const int failed = step_advance(sim, 0.01);
  const struct percolation left = sim->percolation;
  params.max_iterations = 200;
  const int good = step_advance(sim, 0.01);
  const double passed = sim->percolation.volume;
  two_phase_destroy(sim);
  ck_assert_int_eq(failed, EXIT_NUMERICAL);
  ck_assert_double_eq(left.volume, 0);
  ck_assert_double_eq(left.flow, 0);
  ck_assert_int_eq(good, EXIT_DONE);
  ck_assert_double_gt(passed, 0);
}
END_TEST

START_TEST(gas_stays_where_grains_are_not_permeable) {
  const struct params params = case_of(bubble, false, _i);
  ck_assert_double_le(percolate(&params, 3, 0.02).moved, 0);
}
END_TEST

/* Their weight pulls them from the lid: a sink would hold them there. */
START_TEST(grains_may_part_from_a_lid) {
  const struct params params = case_of(hanging, true, false);
  ck_assert_double_le(percolate(&params, 9, 0.02).moved, 0);
}
END_TEST

START_TEST(a_free_surface_is_left_alone) {
  const struct params params = case_of(slope, true, _i);
  ck_assert_double_le(percolate(&params, 9, 0.02).moved, 0);
}
END_TEST

Suite *percolation_suite(void);
Suite *percolation_suite(void) {
  Suite *suite = suite_create("percolation");
  TCase *tcase = tcase_create("gas");
  tcase_add_loop_test(tcase, a_film_under_grains_closes, 0, 2);
  tcase_add_loop_test(tcase, a_bubble_leaves, 0, 2);
  tcase_add_test(tcase, a_step_that_fails_lets_no_gas_pass);
  tcase_add_loop_test(tcase, gas_stays_where_grains_are_not_permeable, 0, 2);
  tcase_add_test(tcase, grains_may_part_from_a_lid);
  tcase_add_loop_test(tcase, a_free_surface_is_left_alone, 0, 2);
  suite_add_tcase(suite, tcase);
  return suite;
}
