/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sudden starts: the length of a step, and c in step with it. */
#include "talus/two_phase/time_step.h"

#include <check.h>
#include <string.h>

#include "sim.h"
#include "talus/error.h"
#include "talus/memory.h"
#include "talus/two_phase/conditions.h"
#include "talus/two_phase/fractions.h"
#include "talus/vof.h"
#include "transport.h"

Suite *time_step_suite(void);

/* No bound of the last step tells what gas that falls from rest will do in a
 * step of any length: that step itself does. */
static double nowhere(void *context, const double x[3]) {
  (void)context, (void)x;
  return -1;
}

START_TEST(two_equal_steps_meet_a_time) {
  struct params params = box_params(4);
  double rate;
  struct two_phase *sim = sim_start(&params);
  const double dt = time_step_choose(sim, 1e6, &rate);
  ck_assert_double_eq(time_step_choose(sim, 0.5 * dt, &rate), 0.5 * dt);
  ck_assert_double_eq(time_step_choose(sim, 1.5 * dt, &rate), 0.75 * dt);
  ck_assert_double_eq(time_step_choose(sim, 2.5 * dt, &rate), dt);
  two_phase_destroy(sim);
}
END_TEST

START_TEST(a_fall_from_rest_keeps_to_the_bound) {
  struct params params = box_params(DIM == 2 ? 5 : 4);
  double most = 0;
  bool done = true;
  params.shape = (struct function){nowhere, NULL};
  params.gravity[DIM - 1] = 0;
  params.gravity[0] = 1;
  params.dt_max = 1e6;
  params.pressure_level_given = true;
  for (int side = 0; side < 2; side++) {
    params.boundary[side].type = BOUNDARY_PERIODIC;
  }
  struct two_phase *sim = sim_start(&params);
  for (int k = 0; k < 6 && done; k++) {
    done = step_advance(sim, 1e6) == EXIT_DONE;
    most = larger(most, sim->model.dt * time_step_rate(sim));
  }
  const double time = sim->model.time, speed = largest(sim, sim->u);
  two_phase_destroy(sim);
  ck_assert(done);
  ck_assert_double_le(most, 1.8 * params.cfl * (1 + 1e-9));
  ck_assert_double_ge(most, params.cfl); /* and are as long as they may be */
  ck_assert_double_eq_tol(speed, time, 1e-6 * time);
}
END_TEST

/* After a step that its caller has made short. */
START_TEST(dt_grows_by_a_fifth_a_step) {
  struct params params = box_params(3);
  static double level = 0.5;
  const double first = 1e-4;
  double most = 0;
  bool done = true;
  params.shape = (struct function){below, &level};
  struct two_phase *sim = sim_new(&params, MPI_COMM_WORLD);
  for (int k = 0; k < 4; k++) {
    done = step_advance(sim, k == 0 ? first : 1) == EXIT_DONE && done;
    most = larger(most, fabs(sim->model.dt / (first * pow(1.2, k)) - 1));
  }
  two_phase_destroy(sim);
  ck_assert(done);
  ck_assert_double_le(most, 1e-14);
}
END_TEST

/* The flow of Taylor and Green, which squeezes a slanted bar of grains. */
static int axis[] = {0, 1};
static double squeeze(void *context, const double x[3]) {
  const double wave = 6.283185307179586;
  return *(const int *)context == 0 ? sin(wave * x[0]) * cos(wave * x[1])
                                    : -cos(wave * x[0]) * sin(wave * x[1]);
}
static double bar(void *context, const double x[3]) {
  (void)context;
  return 0.3 - fabs(x[0] - 0.47) - 1.3 * fabs(x[1] - 0.47);
}

/* Over a time in which the flow crosses three cells: bit 0, to be looked at; 1,
 * planes of c are there, or not. */
START_TEST(c_is_in_0_1_however_long_it_has_lagged) {
  struct params params = periodic_params(4);
  params.single_phase = false;
  params.pressure_level_given = true;
  params.shape = (struct function){bar, NULL};
  for (int d = 0; d < 2; d++) {
    params.velocity[d] = (struct function){squeeze, &axis[d]};
  }
  struct two_phase *sim = sim_new(&params, MPI_COMM_WORLD);
  const struct mesh *mesh = sim->grid.mesh;
  const double before = integral(mesh, sim->c->v);
  const double rate = time_step_rate(sim);
  double *c = MEM_NEW(double, mesh->nleaves);
  memcpy(c, sim->c->v, (size_t)mesh->nleaves * sizeof *c);
  field_fill(mesh, sim->c);
  sim->planes_hold = false;
  if (_i & 2) fractions_update_planes(sim);
  if (_i & 1) {
    sim->model.dt = 6 / rate;
    fractions_synchronise(sim);
  } else {
    fields_save(&sim->grid.fields, mesh);
    fractions_advance(sim, 3 / rate, rate);
  }
  const double after = integral(mesh, sim->c->v);
  const double excess = mesh_max(mesh, vof_excess(mesh, sim->c->v));
  double moved = 0, left = 0;
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    moved = larger(moved, fabs(sim->c->v[i] - c[i]));
  }
  if (_i & 1) fractions_desynchronise(sim);
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    left = larger(left, fabs(sim->c->v[i] - c[i]));
  }
  moved = mesh_max(mesh, moved), left = mesh_max(mesh, left);
  mem_free(c);
  two_phase_destroy(sim);
  ck_assert_double_eq_tol(after, before, 1e-13);
  ck_assert_double_le(excess, VOF_EMPTY);
  ck_assert_double_gt(moved, 0.9);
  if (_i & 1) ck_assert_double_eq(left, 0);
}
END_TEST

/* A bed at rest, stopped after a long step. */
static double height = 0.53;
static struct two_phase *bed_at_rest(struct params *params) {
  *params = box_params(DIM == 2 ? 5 : 4);
  params->shape = (struct function){below, &height};
  params->tolerance_pressure = params->tolerance_viscous = 1e-12;
  params->boundary[2 * DIM - 1].type = BOUNDARY_OUTFLOW;
  struct two_phase *sim = sim_start(params);
  ck_assert_int_eq(step_advance(sim, 0.4), EXIT_DONE);
  conditions_measure(sim, &sim->conditions);
  return sim;
}

/* With ten times the gravity it stays at rest, and the energy that this brings
 * is booked. */
START_TEST(another_gravity_is_a_new_start) {
  struct params params;
  struct two_phase *sim = bed_at_rest(&params);
  const struct conditions before = sim->conditions;
  const double gas = sim->energy.gas;
  params.gravity[DIM - 1] *= 10;
  conditions_renew(sim);
  const double changed = sim->energy.changed, dt = sim->model.dt;
  const double of_gas = sim->energy.gas - gas;
  bool done = true;
  for (int k = 0; k < 5; k++)
    done = done && step_advance(sim, 0.4) == EXIT_DONE;
  const double speed = largest(sim, sim->u);
  two_phase_destroy(sim);
  ck_assert(done);
  ck_assert_double_eq_tol(changed, 9 * before.energy, 1e-12 * before.energy);
  ck_assert_double_eq_tol(of_gas, 9 * before.gas, 1e-12 * fabs(before.gas));
  ck_assert_double_eq(dt, 0);
  ck_assert_double_le(speed, 1e-10);
}
END_TEST

/* Flow comes in with speed 0.7 through a side of area 1. */
START_TEST(inflow_is_speed_times_area) {
  struct params params = box_params(3);
  params.gravity[DIM - 1] = 0;
  params.boundary[0] =
      (struct boundary){.type = BOUNDARY_INFLOW, .velocity = {0.7, 0, 0}};
  params.boundary[1].type = BOUNDARY_OUTFLOW;
  struct two_phase *sim = sim_new(&params, MPI_COMM_WORLD);
  conditions_measure(sim, &sim->conditions);
  const double inflow = sim->conditions.inflow;
  two_phase_destroy(sim);
  ck_assert_double_eq_tol(inflow, 0.7, 1e-14);
}
END_TEST

/* A tilt lets it go: dt is that of a start. */
START_TEST(a_tilt_is_a_sudden_start) {
  struct params params;
  struct two_phase *sim = bed_at_rest(&params);
  params.gravity[0] = 1;
  conditions_renew(sim);
  const bool done = step_advance(sim, 0.4) == EXIT_DONE;
  const double dt = sim->model.dt, h = sim->grid.mesh->h[0];
  two_phase_destroy(sim);
  ck_assert(done);
  ck_assert_double_le(dt, 0.1 * sqrt(h));
}
END_TEST

/* From rest a tenth of what a fall across the leaf takes, then until the speed
 * has grown by a quarter; grains that are faster, and gas, are let be. Of the
 * fall friction takes a fifth, all (of which 0.4 count), less than nothing. */
START_TEST(grains_that_set_off_may_gain_a_quarter_of_their_speed) {
  enum { SPEEDS = 4, FRICTIONS = 4 };
  static const double part[SPEEDS] = {0, 0.05, 0.9, 1.01},
                      want[SPEEDS] = {0.1, 0.1, 0.225, 1e9},
                      taken[FRICTIONS] = {0, 0.2, 1, -1},
                      left[FRICTIONS] = {1, 0.8, 0.6, 1};
  struct params params;
  struct two_phase *sim = bed_at_rest(&params);
  const double h = sim->grid.mesh->h[0], g = 3;
  double most = 0;
  for (int d = 0; d < DIM; d++) {
    sim->u[d]->v[0] = sim->g[d]->v[0] = sim->viscous_g[d]->v[0] = 0;
  }
  sim->c->v[0] = 1;
  sim->g[0]->v[0] = -g;
  for (int j = 0; j < FRICTIONS; j++) {
    const double a = left[j] * g;
    sim->viscous_g[0]->v[0] = taken[j] * g;
    for (int k = 0; k < SPEEDS; k++) {
      sim->u[1]->v[0] = part[k] * sqrt(a * h);
      const double dt = fmin(time_step_of_start(sim, 0) / sqrt(h / a), 1e9);
      most = larger(most, fabs(dt / want[k] - 1));
    }
  }
  sim->c->v[0] = 0.4, sim->u[1]->v[0] = 0;
  const double gas = time_step_of_start(sim, 0);
  two_phase_destroy(sim);
  ck_assert_double_le(most, 1e-12);
  ck_assert(gas == HUGE_VAL);
}
END_TEST

START_TEST(the_same_conditions_change_nothing) {
  struct params params;
  struct two_phase *sim = bed_at_rest(&params);
  const double dt = sim->model.dt;
  const size_t bytes = (size_t)sim->grid.mesh->nleaves * sizeof(double);
  double *p = MEM_NEW(double, sim->grid.mesh->nleaves);
  memcpy(p, sim->p->v, bytes);
  conditions_renew(sim);
  const bool same = sim->model.dt == dt && sim->energy.changed == 0 &&
                    memcmp(p, sim->p->v, bytes) == 0;
  mem_free(p);
  two_phase_destroy(sim);
  ck_assert(same);
}
END_TEST

Suite *time_step_suite(void) {
  Suite *suite = suite_create("time_step");
  TCase *tc = tcase_create("time_step");
  tcase_add_test(tc, two_equal_steps_meet_a_time);
  tcase_add_test(tc, a_fall_from_rest_keeps_to_the_bound);
  tcase_add_test(tc, dt_grows_by_a_fifth_a_step);
  tcase_add_loop_test(tc, c_is_in_0_1_however_long_it_has_lagged, 0, 4);
  tcase_add_test(tc, another_gravity_is_a_new_start);
  tcase_add_test(tc, inflow_is_speed_times_area);
  tcase_add_test(tc, a_tilt_is_a_sudden_start);
  tcase_add_test(tc, grains_that_set_off_may_gain_a_quarter_of_their_speed);
  tcase_add_test(tc, the_same_conditions_change_nothing);
  suite_add_tcase(suite, tc);
  return suite;
}
