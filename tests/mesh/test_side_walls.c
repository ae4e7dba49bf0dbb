/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Friction of side walls: a plug in a narrow channel.
 *
 * Grains too stiff to shear fill a channel of height H = 1 on a floor without
 * friction, inclined by alpha. Their pressure has the mean g cos(alpha) H/2,
 * so walls a distance W apart take
 *   F = 2 mu (g cos(alpha) H/2)/W
 * per mass: sliding, the plug gains g sin(alpha) - F, and if that is negative
 * it stops after u_0/(F - g sin(alpha)) and stays. */
#include "talus/side_walls.h"

#include <check.h>

#include "ranks.h"
#include "sim.h"
#include "transport.h"

Suite *side_walls_suite(void);

enum { LEVEL = 3, CUT = DIM == 2 ? 0 : 2 };
static const double WIDTH = 1. / (1 << CUT); /* across the flow */
static const double DT = 2.5e-3;
static const double SLOPE = 0.3, START = 0.5;

static double start(void *context, const double x[3]) {
  (void)context, (void)x;
  return START;
}

/* Describe a plug; F is `friction` times g sin(alpha). */
static struct params plug_params(double friction, bool moves) {
  struct params p = box_params(LEVEL);
  params_make_narrow(&p, CUT);
  p.single_phase = true;
  p.grains.rheology = newtonian(1e4);
  p.gravity[0] = sin(SLOPE), p.gravity[DIM - 1] = -cos(SLOPE);
  p.boundary[0].type = p.boundary[1].type = BOUNDARY_PERIODIC;
  p.pressure_level_given = true;
  p.pressure_level = 0.5 * cos(SLOPE);
  p.side_walls.width = 0.1;
  p.side_walls.mu = friction * tan(SLOPE) * p.side_walls.width;
  p.tolerance_pressure = p.tolerance_viscous = 1e-10;
  if (moves) p.velocity[0] = (struct function){start, NULL};
  return p;
}

/* Return the mean of u_x, and how far the leaves are from it. */
static double plug_speed(const struct two_phase *sim, double *spread) {
  const double mean = integral(sim->grid.mesh, sim->u[0]->v) / WIDTH;
  double most = 0;
  for (int32_t i = 0; i < sim->grid.mesh->nleaves; i++) {
    most = larger(most, fabs(sim->u[0]->v[i] - mean));
  }
  *spread = mesh_max(sim->grid.mesh, most);
  return mean;
}

static bool run_to(struct two_phase *sim, double stop, double dt) {
  bool good = true;
  while (good && sim->model.time < stop * (1 - 1e-12)) {
    good = step_advance(sim, fmin(dt, stop - sim->model.time)) == EXIT_DONE;
  }
  return good;
}

/* Twice as much friction as weight, and half as much. */
START_TEST(a_plug_is_slowed_at_the_right_rate) {
  const double friction = _i ? 0.5 : 2, weight = sin(SLOPE);
  const double stop = end_of_run(1, 0.25);
  struct params params = plug_params(friction, true);
  struct two_phase *sim = sim_start(&params);
  double spread;
  const bool done = run_to(sim, stop, DT);
  const double speed = plug_speed(sim, &spread);
  two_phase_destroy(sim);
  ck_assert(done);
  /* of 0.2 and 0.65; friction lags by dt, and dt/2 changes this by half */
  ck_assert_double_eq_tol(speed, START + (1 - friction) * weight * stop,
                          1.5e-3);
  ck_assert_double_le(spread, 1e-3);
}
END_TEST

/* It stops on time, stays, and with it goes its energy. */
START_TEST(a_plug_stops_and_stays) {
  const double weight = sin(SLOPE), stop = START / weight;
  struct params params = plug_params(2, true);
  struct two_phase *sim = sim_start(&params);
  double spread, late, rest;
  bool done = run_to(sim, 0.95 * stop, DT);
  const double before = plug_speed(sim, &spread);
  done = done && run_to(sim, stop + 0.05, DT);
  late = plug_speed(sim, &spread);
  done = done && run_to(sim, stop + 2, DT);
  rest = plug_speed(sim, &spread);
  const double lost = sim->energy.dissipated / WIDTH;
  two_phase_destroy(sim);
  ck_assert(done);
  ck_assert_double_gt(before, 0.01);
  ck_assert_double_le(fabs(late), 5e-3);
  ck_assert_double_le(fabs(rest), 1e-5);
  /* F times the way, which is u_0^2 / (2 (F - weight)) */
  ck_assert_double_eq_tol(lost, 2 * weight * START * START / (2 * weight),
                          0.02 * START * START);
}
END_TEST

/* 10 % more friction than weight holds it from the second step on, though the
 * leaves near the top, where there is no pressure, are held by those below,
 * from which they creep away at g cos(alpha)/eta; 10 % less friction lets it go
 * at once. With implicit steps and with Crank-Nicolson. */
START_TEST(a_plug_at_rest_yields_at_its_friction) {
  const bool yields = _i & 1;
  const double friction = yields ? 0.9 : 1.1;
  struct params params = plug_params(friction, false);
  params.theta = _i & 2 ? 0.5 : 1;
  struct two_phase *sim = sim_start(&params);
  double spread, most = 0;
  bool done = run_to(sim, DT, DT);
  while (done && sim->model.time < end_of_run(1, 0.25)) {
    done = step_advance(sim, DT) == EXIT_DONE;
    most = larger(most, fabs(plug_speed(sim, &spread)));
  }
  const double speed = plug_speed(sim, &spread);
  const double free = (1 - friction) * sin(SLOPE);
  two_phase_destroy(sim);
  ck_assert(done);
  if (yields) {
    ck_assert_double_eq_tol(speed, free, 0.1 * free);
  } else {
    ck_assert_double_le(most, 5e-6);
  }
}
END_TEST

/* Return the level set of a heap with a slope of 1/2, where mu_s = 0.38. */
static double steep(void *context, const double x[3]) {
  (void)context;
  return 0.3 - 0.5 * x[0] - x[1];
}

/* Grains rest between walls, which take up to 3 p, once a little of its skin
 * has slid; with walls that only slow it down it crept at 5e-7. */
START_TEST(a_steep_heap_rests_between_walls) {
  struct params p = box_params(5);
  p.size = 2;
  p.shape = (struct function){steep, NULL};
  rheology_init(&p.grains.rheology, rheology_find("mu_i"));
  rheology_set_regularisation(&p.grains.rheology, "exact");
  rheology_set(&p.grains.rheology, "mu_s", 0.38);
  rheology_set(&p.grains.rheology, "d", 0.04);
  rheology_set(&p.grains.rheology, "rho", 1);
  p.side_walls.mu = 0.3, p.side_walls.width = 0.2;
  p.boundary[1].type = p.boundary[2].type = BOUNDARY_NO_SLIP;
  p.boundary[3].type = BOUNDARY_OUTFLOW;
  p.tolerance_pressure = p.tolerance_viscous = 1e-10;
  struct two_phase *sim = sim_start(&p);
  const bool done = run_to(sim, 4, 1. / 32);
  double speed = 0;
  for (int32_t i = 0; i < sim->grid.mesh->nleaves; i++) {
    if (sim->c->v[i] < 0.01) continue;
    for (int d = 0; d < DIM; d++) speed = larger(speed, fabs(sim->u[d]->v[i]));
  }
  speed = mesh_max(sim->grid.mesh, speed);
  two_phase_destroy(sim);
  ck_assert(done);
  ck_assert_msg(speed < 1e-9, "%g", speed);
}
END_TEST

Suite *side_walls_suite(void) {
  Suite *suite = suite_create("side_walls");
  TCase *tcase = tcase_create("plug"), *alone = tcase_create("long rest");
  tcase_set_tags(alone, "one_rank");
  tcase_add_loop_test(tcase, a_plug_is_slowed_at_the_right_rate, 0, 2);
  tcase_add_test(alone, a_plug_stops_and_stays);
  tcase_add_loop_test(tcase, a_plug_at_rest_yields_at_its_friction, 0, 1);
  tcase_add_loop_test(alone, a_plug_at_rest_yields_at_its_friction, 1, 4);
  if (DIM == 2) tcase_add_test(alone, a_steep_heap_rests_between_walls);
  suite_add_tcase(suite, tcase);
  suite_add_tcase(suite, alone);
  return suite;
}
