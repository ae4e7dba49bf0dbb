/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The two-fluid model in rings around an axis. */
#include <check.h>

#include "bench.h"
#include "talus/two_fluid/transport.h"
#include "two_fluid.h"

Suite *two_fluid_rings_suite(void);

enum { LEVEL = 5 };

/* Ask for fine leaves near the axis and around the surface of a bed. */
static double near_axis(void *context, const double x[3]) {
  (void)context;
  return x[0] < 0.08 || x[1] > 0.07 ? LEVEL : LEVEL - 1;
}

static struct params rings(struct two_fluid_keys *keys, bool adapted) {
  struct params p = grains_params(keys, 0.16, LEVEL);
  p.coordinates = COORDINATES_AXISYMMETRIC;
  if (!adapted) return p;
  p.level_min = LEVEL - 1;
  p.criterion[p.ncriteria++] = (struct criterion){
      .type = CRITERION_FUNCTION, .level = LEVEL, .function = {near_axis}};
  return p;
}

/* A settled bed stays, as in a plane. */
START_TEST(a_settled_bed_rests) {
  double z[] = {-1, _i == 1 ? 0.1017 : 0.1};
  struct two_fluid_keys keys =
      grains_keys(TWO_FLUID_KTGF, _i == 1 ? TWO_FLUID_AIR : TWO_FLUID_WATER);
  struct params p = rings(&keys, _i == 2);
  p.shape = (struct function){bed, z};
  struct two_fluid *sim = grains_new(&p);
  struct two_fluid_measures before, after;
  two_fluid_measure(sim, &before);
  const bool done = grains_run(sim, 0.3, 300);
  two_fluid_measure(sim, &after);
  const double flux = grains_flux(sim);
  outline_free(&before.outline), outline_free(&after.outline);
  two_fluid_destroy(sim);
  const double exact = acos(-1) * 0.16 * 0.16 * 0.16;
  ck_assert(done);
  ck_assert_double_eq_tol((before.volume + before.fluid_volume) / exact, 1,
                          1e-12);
  ck_assert_double_le(flux, _i == 2 ? 1e-4 : 2e-5);
  ck_assert_double_eq_tol(after.volume / before.volume, 1, 1e-13);
}
END_TEST

static double cylinder(void *context, const double x[3]) {
  (void)context;
  return fmin(0.05 - x[0], 0.06 - x[1]);
}

/* A cylinder collapses on a grid that follows it, and keeps its mass. */
START_TEST(a_cylinder_keeps_its_mass) {
  struct two_fluid_keys keys = grains_keys(TWO_FLUID_KTGF, TWO_FLUID_WATER);
  struct two_fluid_measures before, after;
  struct params p = rings(&keys, false);
  p.level_min = LEVEL - 2;
  p.criterion[p.ncriteria++] = (struct criterion){
      .type = CRITERION_INTERFACE, .level = LEVEL, .width = 2};
  p.shape = (struct function){cylinder, NULL};
  keys.surface = _i ? TWO_FLUID_PLANES : TWO_FLUID_NO_SURFACE;
  struct two_fluid *sim = grains_new(&p);
  two_fluid_measure(sim, &before);
  const bool done = grains_run(sim, 0.15, 1000);
  two_fluid_measure(sim, &after);
  outline_free(&before.outline), outline_free(&after.outline);
  two_fluid_destroy(sim);
  ck_assert(done);
  ck_assert_double_eq_tol(after.volume / before.volume, 1, 1e-13);
  ck_assert_double_eq_tol(after.fluid_volume / before.fluid_volume, 1, 1e-13);
  ck_assert_double_ge(after.front, 0.052);
  ck_assert_double_le(after.height, 0.06);
}
END_TEST

/* Return a wave along the axis that radii shift. */
static double wave(const double x[3], double shift) {
  return sin(2 * acos(-1) / 0.16 * (x[0] + x[1] + shift));
}

/* Drag, friction and pressures leave the momentum of both together along the
 * axis alone, on one level. */
START_TEST(momentum_along_the_axis_stays) {
  struct two_fluid_keys keys =
      grains_keys(TWO_FLUID_KTGF, _i ? TWO_FLUID_AIR : TWO_FLUID_WATER);
  struct two_fluid_measures before, after;
  grains_cap(&keys, 10);
  struct params p = rings(&keys, false);
  p.gravity[1] = 0;
  p.dt_max = 1e-3;
  p.tolerance_pressure = p.tolerance_viscous = 1e-10;
  p.boundary[2].type = p.boundary[3].type = BOUNDARY_PERIODIC;
  struct two_fluid *sim = grains_new(&p);
  for (int32_t i = 0; i < sim->grid.mesh->nleaves; i++) {
    const double *x = sim->grid.mesh->x[i];
    sim->alpha->v[i] = 0.3 + 0.1 * wave(x, 0);
    for (int k = 0; k < TWO_FLUID_NPHASES; k++) {
      sim->u[k][0]->v[i] = x[0] * wave(x, 0.03 * k);
      sim->u[k][1]->v[i] = 0.1 * wave(x, 0.01 + 0.03 * k);
    }
  }
  field_fill(sim->grid.mesh, sim->alpha);
  two_fluid_measure(sim, &before);
  const bool done = grains_run(sim, 1, 2);
  two_fluid_measure(sim, &after);
  outline_free(&before.outline), outline_free(&after.outline);
  two_fluid_destroy(sim);
  const double mass = 2560 * before.volume + before.fluid_volume;
  ck_assert(done);
  ck_assert_double_lt(after.kinetic, 0.999 * before.kinetic);
  ck_assert_double_eq_tol(after.momentum[1], before.momentum[1], 1e-12 * mass);
}
END_TEST

/* Return u/s of the flow u = s (r, -2 z). */
static double linear(int e, const double x[3]) {
  return e == 0 ? x[0] : -2 * x[1];
}

/* Set the fluxes of that flow, with its shear s in 1/s, through the faces. */
static void set_linear(struct two_fluid *sim, double s) {
  const struct mesh *mesh = sim->grid.mesh;
  for (int d = 0; d < DIM; d++) {
    for (int32_t i = 0; i < mesh->nleaves; i++)
      sim->u[TWO_FLUID_F][d]->v[i] = s * linear(d, mesh->x[i]);
    mesh_touch(mesh, sim->u[TWO_FLUID_F][d]->v);
    for (int32_t f = mesh->face_begin[d]; f < mesh->face_begin[d + 1]; f++) {
      double x[3];
      face_centre(mesh, d, f, x);
      const double u = s * linear(d, x);
      sim->j->v[f] = sim->w_f[TWO_FLUID_F]->v[f] = u;
      sim->flux->v[f] = 0.3 * u;
      sim->v_f[TWO_FLUID_F]->v[f] = sim->v_f[TWO_FLUID_S]->v[f] = 0;
      sim->w_f[TWO_FLUID_S]->v[f] = u;
    }
  }
  field_fill_faces(mesh, sim->j);
  field_fill_faces(mesh, sim->flux);
}

/* A linear flow carries itself by u.grad u = s^2 (r, 4 z), with an error of
 * h^2/(4 r), as a leaf has its mean at its centre. */
START_TEST(a_linear_flow_carries_itself) {
  const double s = 3, dt = 1e-5;
  struct two_fluid_keys keys = grains_keys(TWO_FLUID_KTGF, TWO_FLUID_WATER);
  keys.start = TWO_FLUID_PATCHED, keys.alpha_start = 0.3;
  struct params p = rings(&keys, _i);
  struct two_fluid *sim = grains_new(&p);
  const struct mesh *mesh = sim->grid.mesh;
  set_linear(sim, s);
  double worst = 0, divergence = 0;
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    sim->alpha_new->v[i] = 0.3;
    divergence = fmax(divergence, fabs(mesh_divergence(mesh, sim->j->v, i)));
  }
  fields_save(&sim->grid.fields, sim->grid.mesh);
  two_fluid_transport(sim, dt);
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    const double *x = mesh->x[i];
    if (x[0] < 0.01 || x[0] > (_i ? 0.07 : 0.14)) continue;
    if (x[1] < 0.01 || x[1] > (_i ? 0.06 : 0.14)) continue;
    for (int e = 0; e < DIM; e++) {
      const double before = s * linear(e, x);
      const double rate = (e == 0 ? x[0] : 4 * x[1]) * s * s;
      const double now = sim->u[TWO_FLUID_F][e]->v[i];
      worst = fmax(worst, fabs((now - before) / dt + rate) / (s * s * 0.1));
    }
  }
  worst = mesh_max(mesh, worst), divergence = mesh_max(mesh, divergence);
  two_fluid_destroy(sim);
  ck_assert_double_le(divergence, 1e-10);
  ck_assert_double_le(worst, 0.01);
}
END_TEST

Suite *two_fluid_rings_suite(void) {
  Suite *suite = suite_create("two_fluid_rings");
  TCase *tcase = tcase_create("rings"), *alone = tcase_create("long rest");
  tcase_set_tags(alone, "one_rank");
  if (DIM == 2) {
    tcase_add_loop_test(tcase, a_settled_bed_rests, 2, 3);
    tcase_add_loop_test(alone, a_settled_bed_rests, 0, 2);
    tcase_add_loop_test(tcase, a_cylinder_keeps_its_mass, 1, 2);
    tcase_add_loop_test(alone, a_cylinder_keeps_its_mass, 0, 1);
    tcase_add_loop_test(tcase, momentum_along_the_axis_stays, 0, 2);
    tcase_add_loop_test(tcase, a_linear_flow_carries_itself, 0, 2);
  }
  suite_add_tcase(suite, tcase);
  suite_add_tcase(suite, alone);
  return suite;
}
