/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/projection.h"

#include <check.h>

#include "sim.h"
#include "talus/hierarchy.h"
#include "talus/two_phase/properties.h"
#include "transport.h"

Suite *projection_suite(void);

static struct body off_centre = {{0.45, 0.55, 0.5}, 0.3};

/* A random velocity among a ball of grains: bit 0: level jumps, 1: a side is
 * open, 2: density ratio 1000 instead of 1. */
START_TEST(the_result_is_solenoidal_to_the_tolerance) {
  struct bench *b = bench_new(1, false, _i & 1 ? 2 : 4, DIM == 2 ? 5 : 4);
  const struct mesh *mesh = b->mesh;
  const double density[] = {1, _i & 4 ? 1e-3 : 1}, dt = 0.01, tolerance = 1e-8;
  struct field *c = bench_cell(b, "c"), *p = bench_cell(b, "p");
  struct field *alpha_f = bench_face(b, "alpha");
  double *u_f = bench_face(b, "u_f")->v;
  b->closed[NFACE - 1] = !(_i & 2);
  if (_i & 2) p->bc[NFACE - 1] = (struct bc){BC_DIRICHLET, 0, 0};
  fill_shape(mesh, ball, &off_centre, c->v);
  field_fill(mesh, c);
  struct field *rho = bench_cell(b, "rho");
  properties_density(mesh, density, c->v, b->closed, rho->v, alpha_f->v);
  field_fill(mesh, rho);
  srand(17 + (unsigned)mesh->rank);
  for (int32_t f = 0; f < mesh->nfaces; f++) {
    const int patch = mesh->face_patch[f];
    u_f[f] = patch >= 0 && b->closed[patch] ? 0 : rand() / (double)RAND_MAX;
  }
  mesh_fill_faces(mesh, 1, &u_f);
  struct hierarchy *hierarchy = hierarchy_new(mesh);
  const struct projection projection = {.mesh = mesh,
                                        .hierarchy = hierarchy,
                                        .rho = rho->v,
                                        .alpha_f = alpha_f->v,
                                        .bc = p->bc,
                                        .tolerance = tolerance,
                                        .max_iterations = 100,
                                        .rhs = bench_cell(b, "rhs")->v,
                                        .flux = bench_face(b, "flux")->v};
  const double before = clean_divergence(mesh, u_f) * dt;
  const struct solve_stats stats =
      projection_project(&projection, dt, u_f, p->v);
  const double after = clean_divergence(mesh, u_f) * dt;
  double most = 0;
  for (int32_t f = 0; f < mesh->nfaces; f++) {
    const int patch = mesh->face_patch[f];
    if (patch >= 0 && b->closed[patch]) most = larger(most, fabs(u_f[f]));
  }
  most = mesh_max(mesh, most);
  hierarchy_destroy(hierarchy);
  bench_destroy(b);
  ck_assert_int_eq(stats.status, SOLVE_CONVERGED);
  ck_assert_double_le(stats.residual_after, tolerance);
  ck_assert_double_le(fabs(stats.residual_before - before), 1e-12 * before);
  /* the residual is updated, not computed anew: round-off of div u dt */
  ck_assert_double_le(after, tolerance + 1e-14 * before);
  ck_assert(most == 0); /* closed sides stay closed */
}
END_TEST

/* Grains to the height 0.53, which cuts leaves, at rest: bit 0: the surface
 * on a fine band with coarser leaves above and below, 1: open at the top. */
struct bed {
  struct params params;
  struct two_phase *sim;
};

static double surface = 0.53;

static struct bed bed_new(int kind) {
  struct bed bed = {.params = box_params(DIM == 2 ? 5 : 4)};
  bed.params.shape = (struct function){below, &surface};
  if (kind & 1) params_follow_surface(&bed.params, 2, 1);
  if (kind & 2) bed.params.boundary[2 * DIM - 1].type = BOUNDARY_OUTFLOW;
  return bed;
}

START_TEST(a_flat_bed_feels_no_acceleration) {
  struct bed bed = bed_new(_i);
  struct two_phase *sim = sim_start(&bed.params);
  const double most = largest(sim, sim->g);
  const bool jumps =
      forest_nleaves_global(sim->grid.forest) < 1 << DIM * bed.params.level_max;
  two_phase_destroy(sim);
  ck_assert(jumps == (_i & 1));
  /* of g = 1: the residual of 1e-13 / h, added up over the box. The solve may
   * stall above its target, at the round-off of p / (rho_2 h^2). */
  ck_assert_double_le(most, 1e-10);
}
END_TEST

/* Under an open top the pressure of a leaf is the weight of what lies above
 * its centre, exactly: fractions on faces are means of two leaves, so their
 * sum from the top down is that of the leaves. */
START_TEST(pressure_is_the_weight_above) {
  struct bed bed = bed_new(2 | _i);
  struct two_phase *sim = sim_start(&bed.params);
  const double grains = 1, gas = 1e-3;
  double most = 0;
  for (int32_t i = 0; i < sim->grid.mesh->nleaves; i++) {
    const double z = sim->grid.mesh->x[i][DIM - 1], h = sim->grid.mesh->h[i];
    if (fabs(z - surface) < h) continue; /* centres next to the surface */
    const double exact = gas * (1 - z) + (grains - gas) * fmax(surface - z, 0);
    most = larger(most, fabs(sim->p->v[i] - exact));
  }
  most = mesh_max(sim->grid.mesh, most);
  two_phase_destroy(sim);
  ck_assert_double_le(most, 1e-11);
}
END_TEST

/* A steep surface, too, is in balance on the faces: div g = 0 there. */
START_TEST(static_acceleration_is_solenoidal) {
  struct params params = box_params(DIM == 2 ? 5 : 4);
  params.shape = (struct function){column, NULL};
  params_follow_surface(&params, 2, 2);
  struct two_phase *sim = sim_start(&params);
  const double left = sim->pressure.residual_after;
  const double h = 1.0 / (1 << params.level_max);
  two_phase_destroy(sim);
  /* the target, or the round-off of p / (rho_2 h^2) */
  ck_assert_double_le(left, fmax(1e-13 / h, 1e-16 * 1e3 / (h * h)));
}
END_TEST

Suite *projection_suite(void) {
  Suite *suite = suite_create("projection");
  TCase *tc = tcase_create("projection");
  tcase_add_loop_test(tc, the_result_is_solenoidal_to_the_tolerance, 0, 8);
  tcase_add_loop_test(tc, a_flat_bed_feels_no_acceleration, 0, 4);
  tcase_add_loop_test(tc, pressure_is_the_weight_above, 0, 2);
  tcase_add_test(tc, static_acceleration_is_solenoidal);
  tcase_set_timeout(tc, 60);
  suite_add_tcase(suite, tc);
  return suite;
}
