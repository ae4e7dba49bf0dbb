/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/two_phase/rest.h"

#include <check.h>

#include "sim.h"

Suite *rest_suite(void);

/* Give one leaf, of the last rank, fraction c and speed u. */
static void set_one(struct two_phase *sim, double c, double u) {
  const struct mesh *mesh = sim->grid.mesh;
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    const bool here = mesh->rank == mesh->nranks - 1 && i == 0;
    sim->c->v[i] = here ? c : 1;
    for (int d = 0; d < DIM; d++) sim->u[d]->v[i] = here && d == 1 ? u : 0;
  }
}

START_TEST(the_fastest_grains_are_looked_at) {
  const struct params params = box_params(2);
  struct two_phase *sim = sim_new(&params, MPI_COMM_WORLD);
  set_one(sim, 0.6, -3);
  const double grains = rest_fastest(sim);
  set_one(sim, 0.4, -3);
  const double gas = rest_fastest(sim);
  two_phase_destroy(sim);
  ck_assert_double_eq(grains, 3);
  ck_assert_double_eq(gas, 0);
}
END_TEST

START_TEST(rest_is_slowness_for_a_time_without_break) {
  struct params params = box_params(2);
  params.rest_speed = 0.1;
  params.rest_time = 1;
  struct two_phase *sim = sim_new(&params, MPI_COMM_WORLD);
  bool reached[6];
  const double speed[6] = {0.01, 0.2, 0.01, 0.01, 0.05, 0.01};
  sim->model.dt = 0.3;
  for (int k = 0; k < 6; k++) {
    set_one(sim, 1, speed[k]);
    reached[k] = rest_is_reached(sim);
  }
  params.rest_time = 0; /* not asked for */
  const bool unasked = rest_is_reached(sim);
  two_phase_destroy(sim);
  for (int k = 0; k < 5; k++) ck_assert(!reached[k]);
  ck_assert(reached[5]);
  ck_assert(!unasked);
}
END_TEST

/* Grains of volume 1 under g = 1 are still while the root of their mean square
 * speed is below 1e-3, and at rest when they have been so for 1. */
START_TEST(arrest_is_the_last_time_grains_moved) {
  const double speed[] = {0.1, 2e-3, 9e-4, 9e-4, 1e-5, 1e-5, 1e-2};
  const double moved[] = {0.4, 0.8, 0.8, 0.8, 0.8, 0.8, 2.8};
  enum { N = sizeof speed / sizeof *speed };
  double time[N];
  int rests[N];
  struct params params = box_params(2);
  rheology_set(&params.grains.rheology, "cohesion", 1);
  rheology_set_regularisation(&params.grains.rheology, _i ? "clip" : "exact");
  struct two_phase *sim = sim_new(&params, MPI_COMM_WORLD);
  for (int k = 0; k < N; k++) {
    sim->model.time += 0.4;
    set_one(sim, 1, speed[k] * (1 << DIM)); /* one of 4^DIM leaves */
    rest_note(sim);
    time[k] = sim->arrest.moved, rests[k] = sim->arrest.rests;
  }
  two_phase_destroy(sim);
  for (int k = 0; k < N; k++) {
    ck_assert_double_eq_tol(time[k], _i ? 0 : moved[k], 1e-12);
    ck_assert_int_eq(rests[k], !_i && (k == 4 || k == 5));
  }
}
END_TEST

/* No grains do not rest, nor do grains that float. */
START_TEST(arrest_needs_grains_and_gravity) {
  struct params params = box_params(2);
  rheology_set(&params.grains.rheology, "cohesion", 1);
  rheology_set_regularisation(&params.grains.rheology, "exact");
  params.gravity[DIM - 1] = -_i;
  struct two_phase *sim = sim_new(&params, MPI_COMM_WORLD);
  for (int32_t i = 0; i < sim->grid.mesh->nleaves; i++) sim->c->v[i] = !_i;
  sim->model.time = 9;
  rest_note(sim);
  const int rests = sim->arrest.rests;
  two_phase_destroy(sim);
  ck_assert_int_eq(rests, 0);
}
END_TEST

Suite *rest_suite(void) {
  Suite *suite = suite_create("rest");
  TCase *tcase = tcase_create("speed");
  tcase_add_test(tcase, the_fastest_grains_are_looked_at);
  tcase_add_test(tcase, rest_is_slowness_for_a_time_without_break);
  tcase_add_loop_test(tcase, arrest_is_the_last_time_grains_moved, 0, 2);
  tcase_add_loop_test(tcase, arrest_needs_grains_and_gravity, 0, 2);
  suite_add_tcase(suite, tcase);
  return suite;
}
