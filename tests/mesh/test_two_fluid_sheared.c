/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A sheared suspension of the two-fluid model across levels and ranks. */
#include <check.h>

#include "grid.h"
#include "talus/two_fluid/properties.h"
#include "two_fluid.h"

Suite *two_fluid_sheared_suite(void);

enum { LEVEL = 4 };
static const double H = 5e-3, GAMMA = 2, J = 1e-3, ETA = 0.096;

static double line(void *context, const double x[3]) {
  (void)context;
  return GAMMA * (x[DIM - 1] - 0.5 * H);
}

static double left(void *context, const double x[3]) {
  (void)context;
  return x[0] < 0.5 * H ? LEVEL : LEVEL - 1;
}

/* Return a suspension of rauter without p_c between plates that move. */
static struct params plates(struct two_fluid_keys *keys, bool levels) {
  *keys = grains_keys(TWO_FLUID_RAUTER, TWO_FLUID_OWN);
  double *number = keys->closure.param;
  number[TWO_FLUID_RA_INERTIAL] = 0, number[TWO_FLUID_RA_STIFFNESS] = 1e-9;
  number[TWO_FLUID_GRAINS_D] = 1.6e-4, number[TWO_FLUID_FLUID_DENSITY] = 1041;
  number[TWO_FLUID_FLUID_ETA_0] = ETA;
  keys->start = TWO_FLUID_PATCHED, grains_cap(keys, 1e6);
  keys->alpha_start = number[TWO_FLUID_RA_PHI_M] / (1 + sqrt(J));
  struct params p = grains_params(keys, H, LEVEL);
  p.tolerance_pressure = p.tolerance_viscous = 1e-9;
  p.dt_max = 1e-2, p.gravity[DIM - 1] = 0;
  p.velocity[0] = (struct function){line, NULL};
  for (int side = 0; side < 2 * DIM; side++) {
    p.boundary[side].type =
        side < 2 * DIM - 2 ? BOUNDARY_PERIODIC : BOUNDARY_NO_SLIP;
    if (side >= 2 * DIM - 2)
      p.boundary[side].velocity[0] = (side & 1 ? 0.5 : -0.5) * GAMMA * H;
  }
  if (!levels) return p;
  p.level_min = LEVEL - 1;
  p.criterion[p.ncriteria++] = (struct criterion){
      .type = CRITERION_FUNCTION, .level = LEVEL, .function = {left, NULL}};
  return p;
}

/* Friction takes X of both sides of a face, be they leaves, ghosts or helper
 * nodes across a level: plane shear at J stays what it is, with p_s = ETA
 * GAMMA/J. Across levels u is within 2e-4 of that of the plates; with X of the
 * last step in ghosts and helper nodes it was 17 times that of the plates. */
START_TEST(plane_shear_stays) {
  struct two_fluid_keys keys;
  struct params p = plates(&keys, _i);
  struct two_fluid *sim = grains_new(&p);
  const bool done = grains_run(sim, 0.1, 200);
  two_fluid_properties(sim);
  const struct mesh *mesh = sim->grid.mesh;
  double speed = 0, pressure = 0;
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    double x[3] = {0, 0, 0};
    for (int d = 0; d < DIM; d++) x[d] = mesh->x[i][d];
    speed = larger(speed, fabs(sim->u[TWO_FLUID_S][0]->v[i] - line(NULL, x)));
    pressure = larger(pressure, fabs(sim->p_s->v[i] * J / (ETA * GAMMA) - 1));
  }
  speed = mesh_max(mesh, speed), pressure = mesh_max(mesh, pressure);
  two_fluid_destroy(sim);
  ck_assert(done);
  ck_assert_double_le(speed, (_i ? 1e-3 : 1e-6) * GAMMA * H);
  ck_assert_double_le(pressure, _i ? 1e-2 : 1e-6);
}
END_TEST

Suite *two_fluid_sheared_suite(void) {
  Suite *suite = suite_create("two_fluid_sheared");
  TCase *tcase = tcase_create("sheared");
  tcase_add_loop_test(tcase, plane_shear_stays, 0, 2);
  suite_add_tcase(suite, tcase);
  return suite;
}
