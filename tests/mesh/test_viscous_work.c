/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The work of viscosity on the grains, and of walls that move. */
#include "talus/two_phase/viscous_work.h"

#include <check.h>
#include <math.h>

#include "sim.h"
#include "talus/error.h"

static const double kEta = 0.05;

static double sine(void *context, const double x[3]) {
  (void)context;
  return sin(2 * acos(-1) * x[DIM - 1]);
}

static double height(void *context, const double x[3]) {
  (void)context;
  return x[DIM - 1];
}

static double kinetic(const struct two_phase *sim) {
  double sum = 0;
  for (int d = 0; d < DIM; d++) {
    for (int32_t i = 0; i < sim->grid.mesh->nleaves; i++) {
      const double u = sim->u[d]->v[i];
      sum += 0.5 * u * u * mesh_volume(sim->grid.mesh, i);
    }
  }
  return mesh_sum(sim->grid.mesh, sum);
}

static bool advance(struct two_phase *sim, int nsteps, double dt) {
  bool done = true;
  for (int k = 0; k < nsteps && done; k++) {
    done = step_advance(sim, dt) == EXIT_DONE;
  }
  return done;
}

/* A shear layer that only viscosity slows down loses what is dissipated,
 * however long the step: one of 0.2 takes 28 % of it. With a repetition, the
 * work of the last solve counts alone. */
START_TEST(dissipated_is_the_kinetic_energy_lost) {
  struct params params = periodic_params(4);
  params.grains.rheology = newtonian(kEta);
  params.velocity[0] = (struct function){sine, NULL};
  params.tolerance_viscous = params.tolerance_pressure = 1e-12;
  params.pressure_level_given = true;
  params.picard = _i;
  params.theta = _i == 2 ? 0.5 : 1;
  params.cfl = 1;
  struct two_phase *sim = sim_new(&params, MPI_COMM_WORLD);
  const double before = kinetic(sim);
  const bool done = advance(sim, 3, 0.2);
  const double lost = before - kinetic(sim), heat = sim->energy.dissipated;
  two_phase_destroy(sim);
  ck_assert(done);
  ck_assert_double_gt(lost, 0.5 * before);
  ck_assert_double_eq_tol(heat, lost, 1e-9 * before);
}
END_TEST

static double nowhere(void *context, const double x[3]) {
  (void)context, (void)x;
  return -1;
}

/* Without grains the same is lost by gas, and by gas alone. */
START_TEST(heat_of_gas_is_counted_apart) {
  struct params params = periodic_params(4);
  params.single_phase = false;
  params.shape = (struct function){nowhere, NULL};
  params.gas = (struct phase){1, newtonian(kEta)};
  params.velocity[0] = (struct function){sine, NULL};
  params.tolerance_viscous = params.tolerance_pressure = 1e-12;
  params.pressure_level_given = true;
  struct two_phase *sim = sim_new(&params, MPI_COMM_WORLD);
  const double before = kinetic(sim);
  const bool done = advance(sim, 3, 0.2);
  const double lost = before - kinetic(sim);
  const struct energy energy = sim->energy;
  two_phase_destroy(sim);
  ck_assert(done);
  ck_assert_double_gt(lost, 0.1 * before);
  ck_assert_double_eq_tol(energy.gas_dissipated, lost, 1e-9 * before);
  ck_assert_double_eq(energy.dissipated, 0);
}
END_TEST

/* Between a wall at rest and one that moves with speed 1 in a unit box the
 * steady flow turns eta into heat per time and area. */
START_TEST(moving_walls_heat_the_grains) {
  struct params params = periodic_params(3);
  params.grains.rheology = newtonian(kEta);
  params.tolerance_viscous = params.tolerance_pressure = 1e-12;
  params.pressure_level_given = true;
  params.boundary[2 * DIM - 2].type = BOUNDARY_NO_SLIP;
  params.boundary[2 * DIM - 1].type = BOUNDARY_NO_SLIP;
  params.boundary[2 * DIM - 1].velocity[0] = 1;
  params.velocity[0] = (struct function){height, NULL};
  struct two_phase *sim = sim_new(&params, MPI_COMM_WORLD);
  const bool done = advance(sim, 3, 1);
  const double heat = sim->energy.dissipated, time = sim->model.time;
  two_phase_destroy(sim);
  ck_assert(done);
  ck_assert_double_eq_tol(heat, kEta * time, 1e-6 * kEta * time);
}
END_TEST

Suite *viscous_work_suite(void);
Suite *viscous_work_suite(void) {
  Suite *suite = suite_create("viscous_work");
  TCase *tcase = tcase_create("work");
  tcase_add_loop_test(tcase, dissipated_is_the_kinetic_energy_lost, 0, 3);
  tcase_add_test(tcase, heat_of_gas_is_counted_apart);
  tcase_add_test(tcase, moving_walls_heat_the_grains);
  suite_add_tcase(suite, tcase);
  return suite;
}
