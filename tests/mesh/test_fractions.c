/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/two_phase/fractions.h"

#include <check.h>

#include "sim.h"

Suite *fractions_suite(void);

/* Return a velocity that has sources on the left and sinks on the right. */
static double spread(int d, const double x[3]) {
  return d == 0 ? x[0] * (1 - x[0]) : 0;
}

/* Return the sum of c div u_f dt of the leaves that the grains fill by more
 * than half, which keep that c during the sweeps. */
static double source(const struct two_phase *sim, double dt) {
  double sum = 0;
  for (int32_t i = 0; i < sim->grid.mesh->nleaves; i++) {
    if (sim->c->v[i] <= 0.5) continue;
    sum +=
        dt * (1 - 2 * sim->grid.mesh->x[i][0]) * mesh_volume(sim->grid.mesh, i);
  }
  return mesh_sum(sim->grid.mesh, sum);
}

/* Divergence of the velocity adds to the volume of grains, which is counted, in
 * all steps. */
START_TEST(volume_that_divergence_adds_is_counted) {
  struct params params = box_params(4);
  params.shape = (struct function){column, NULL};
  struct two_phase *sim = sim_new(&params, MPI_COMM_WORLD);
  const double dt = 0.05, before = integral(sim->grid.mesh, sim->c->v);
  double exact = 0;
  fill_faces(sim->grid.mesh, spread, sim->u_f->v);
  for (int k = 0; k < 2; k++) {
    exact += source(sim, dt);
    fields_save(&sim->grid.fields, sim->grid.mesh);
    fractions_advance(sim, dt, 1);
  }
  const double counted = sim->divergence_volume;
  const double added = integral(sim->grid.mesh, sim->c->v) - before;
  two_phase_destroy(sim);
  ck_assert_double_gt(exact, 1e-3);
  ck_assert_double_eq_tol(counted, exact, 1e-14);
  ck_assert_double_eq_tol(added, exact, 1e-14);
}
END_TEST

Suite *fractions_suite(void) {
  Suite *suite = suite_create("fractions");
  TCase *tc = tcase_create("volume");
  tcase_add_test(tc, volume_that_divergence_adds_is_counted);
  suite_add_tcase(suite, tc);
  return suite;
}
