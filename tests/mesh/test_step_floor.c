/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/two_phase/step_floor.h"

#include <check.h>

#include "sim.h"
#include "talus/error.h"

Suite *step_floor_suite(void);

static double speed;

static double wind(void *context, const double x[3]) {
  (void)context;
  (void)x;
  return speed;
}

/* A layer of grains, everything at this speed, before and after a step. */
struct trial {
  double floor, dt;
  bool too_short, grows, lands, stands;
};

static struct trial try_speed(double u) {
  double height = 0.55;
  struct params params = box_params(3);
  params.shape = (struct function){below, &height};
  params.velocity[0] = (struct function){wind, NULL};
  params.boundary[0].type = params.boundary[1].type = BOUNDARY_PERIODIC;
  speed = u;
  struct two_phase *sim = sim_new(&params, MPI_COMM_WORLD);
  struct trial trial = {.floor = step_floor(sim)};
  step_advance(sim, 1);
  trial.dt = sim->model.dt;
  struct step_taken taken = {0, 0, 1};
  trial.too_short = step_is_too_short(sim, trial.floor, &taken);
  taken.last_dt = sim->model.dt / 1.2;
  trial.grows = step_is_too_short(sim, trial.floor, &taken);
  taken = (struct step_taken){0, 0, sim->model.dt};
  trial.lands = step_is_too_short(sim, trial.floor, &taken);
  taken = (struct step_taken){sim->model.time, 0, sim->model.dt};
  trial.stands = step_is_too_short(sim, trial.floor, &taken);
  two_phase_destroy(sim);
  return trial;
}

START_TEST(a_run_that_cannot_end_is_given_up) {
  const struct trial trial = try_speed(1e25);
  ck_assert_double_lt(trial.dt, 1e-20);
  ck_assert(trial.too_short);
  ck_assert(!trial.grows); /* recovers from a short step */
  ck_assert(!trial.lands); /* was to be short */
  ck_assert(trial.stands); /* never allowed */
}
END_TEST

START_TEST(a_fast_run_may_go_on) {
  /* 1e-9 L/u_0 < 1e-9 stop */
  const struct trial trial = try_speed(1e4);
  ck_assert_double_eq_tol(trial.floor, 1e-13, 1e-20);
  ck_assert(!trial.too_short);
}
END_TEST

START_TEST(the_floor_is_that_of_the_fastest_time) {
  const struct trial trial = try_speed(0.1);
  ck_assert_double_eq_tol(trial.floor, 1e-9, 1e-15);
  ck_assert(!trial.too_short);
}
END_TEST

static double twice(void *context, const double x[3]) {
  (void)x;
  return 2 * *(const double *)context;
}
static double same(void *context, const double x[3]) {
  (void)x;
  return *(const double *)context;
}

/* L = 2: 2/4 with the speed along y, sqrt(2/32) with gravity, or 0.1 to stop,
 * whichever is least. */

START_TEST(each_time_of_the_case_may_bind) {
  const double stop = _i == 2 ? 0.1 : 10, exact[] = {0.5, 0.25, 0.1};
  double along[] = {3, 2};
  struct params params = box_params(2);
  params.size = 2;
  params.stop = stop;
  params.gravity[DIM - 1] = _i >= 1 ? -32 : 0;
  params.velocity[0] = (struct function){same, &along[0]};
  params.velocity[1] = (struct function){twice, &along[1]};
  struct two_phase *sim = sim_new(&params, MPI_COMM_WORLD);
  const double floor = step_floor(sim);
  two_phase_destroy(sim);
  ck_assert_double_eq_tol(floor, 1e-9 * exact[_i], 1e-24);
}
END_TEST

Suite *step_floor_suite(void) {
  Suite *suite = suite_create("step_floor");
  TCase *tcase = tcase_create("floor");
  tcase_add_test(tcase, a_run_that_cannot_end_is_given_up);
  tcase_add_test(tcase, a_fast_run_may_go_on);
  tcase_add_test(tcase, the_floor_is_that_of_the_fastest_time);
  tcase_add_loop_test(tcase, each_time_of_the_case_may_bind, 0, 3);
  suite_add_tcase(suite, tcase);
  return suite;
}
