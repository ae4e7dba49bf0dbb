/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The surface of a bed inside closures and fluxes (two_fluid/surface.h). */
#include "two_fluid.h"

#include <check.h>

#include "ranks.h"
#include "talus/two_fluid/properties.h"
#include "talus/two_fluid/surface.h"

Suite *two_fluid_surface_suite(void);

/* Give the level set of a heap that slopes down by 20 degrees from a wall. */
static double heap(void *context, const double x[3]) {
  (void)context;
  const double slope = 0.3490658503988659;
  return fmin(0.1 - x[DIM - 1],
              (0.1 - x[DIM - 1]) * cos(slope) - x[0] * sin(slope));
}

static struct params heap_params(struct two_fluid_keys *keys,
                                 enum two_fluid_surface surface, double angle) {
  *keys = grains_keys(TWO_FLUID_KTGF, TWO_FLUID_WATER);
  keys->surface = surface, keys->regularisation = TWO_FLUID_CLIP;
  keys->closure.param[TWO_FLUID_KT_ANGLE] = angle;
  struct params p = grains_params(keys, 0.4, 5);
  p.shape = (struct function){heap, NULL};
  return p;
}

/* Run a heap and measure its beginning and its end. Returns whether it got
 * there. */
static bool run_heap(const struct params *p, double end,
                     struct two_fluid_measures *before,
                     struct two_fluid_measures *after) {
  struct two_fluid *sim = grains_new(p);
  two_fluid_properties(sim);
  two_fluid_measure(sim, before);
  const bool done = grains_run(sim, end, 300);
  two_fluid_measure(sim, after);
  outline_free(&before->outline), outline_free(&after->outline);
  two_fluid_destroy(sim);
  return done;
}

/* A heap of 20 degrees whose grains repose at 31 stands, and slides if they
 * repose at 17, or if closures read the solid fraction of leaves. */
START_TEST(a_heap_stands) {
  static const enum two_fluid_surface surface[] = {
      TWO_FLUID_PLANES, TWO_FLUID_PLANES, TWO_FLUID_NO_SURFACE};
  struct two_fluid_keys keys;
  const struct params p =
      heap_params(&keys, surface[_i], _i == 1 ? 17.5 : 36.9);
  struct two_fluid_measures before, after;
  const bool done = run_heap(&p, 0.5, &before, &after);
  ck_assert(done);
  ck_assert_double_eq_tol(after.volume / before.volume, 1, 1e-13);
  if (_i == 0)
    ck_assert_double_le(after.max_speed, 0.01);
  else
    ck_assert_double_ge(after.max_speed, 0.02);
}
END_TEST

/* With an exact yield the same heap holds, with its pressure, and so do the
 * grains on leaves that are not full. */
START_TEST(a_heap_that_yields_exactly_holds) {
  struct two_fluid_keys keys;
  const struct params p = heap_params(&keys, TWO_FLUID_PLANES, 36.9);
  keys.regularisation = TWO_FLUID_EXACT;
  struct two_fluid_measures before, after;
  const bool done = run_heap(&p, end_of_run(0.5, 0.2), &before, &after);
  ck_assert(done);
  ck_assert_double_ge(after.max_solid_pressure,
                      0.99 * before.max_solid_pressure);
  ck_assert_double_le(after.kinetic, 2e-8);
  ck_assert_double_le(after.max_speed, 1e-4);
}
END_TEST

/* Grains that settle all alike have no surface in their midst, though some
 * leaves have more than the next by round-off. */
START_TEST(a_suspension_stays_as_it_is) {
  const double alpha = 0.5; /* of the loosest bed */
  double worst = 0;
  struct two_fluid_keys keys = grains_keys(TWO_FLUID_KTGF, TWO_FLUID_WATER);
  keys.start = TWO_FLUID_PATCHED, keys.alpha_start = alpha;
  struct params p = grains_params(&keys, 0.01, 1);
  p.trees[DIM - 1] = 20;
  struct two_fluid *sim = grains_new(&p);
  const bool done = grains_run(sim, 0.1, 100);
  const struct mesh *mesh = sim->grid.mesh;
  for (int32_t i = 0; i < mesh->nleaves; i++)
    if (fabs(mesh->x[i][DIM - 1] - 0.1) < 0.02)
      worst = fmax(worst, fabs(sim->alpha->v[i] / alpha - 1));
  worst = mesh_max(mesh, worst);
  two_fluid_destroy(sim);
  ck_assert(done);
  ck_assert_double_le(worst, 1e-5);
}
END_TEST

/* A bed that ends within a leaf fills the part c of it, has the pressure of
 * half its own weight there, and lets grains out through its sides by c, not
 * through its top. */
START_TEST(a_leaf_is_filled_in_part) {
  double z[] = {-1, 0.1 + 0.3 * 0.005};
  struct two_fluid_keys keys = grains_keys(TWO_FLUID_KTGF, TWO_FLUID_WATER);
  struct params p = grains_params(&keys, 0.01, 1);
  p.trees[DIM - 1] = 16;
  p.shape = (struct function){bed, z};
  struct two_fluid *sim = grains_new(&p);
  two_fluid_properties(sim);
  const struct mesh *mesh = sim->grid.mesh;
  int found = 0;
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    const double alpha = sim->alpha->v[i], h = mesh->h[i];
    if (fabs(mesh->x[i][DIM - 1] - 0.1025) > 1e-6) continue;
    const int32_t top = mesh->cell_face[i][2 * DIM - 1];
    const int32_t side = mesh->cell_face[i][1];
    ck_assert_double_eq_tol(sim->c->v[i], 0.3, 0.03);
    ck_assert_double_eq_tol(sim->p_s->v[i], 0.5 * alpha * h * 1562 * 9.81,
                            1e-3 * sim->p_s->v[i]);
    ck_assert(two_fluid_passing(sim, DIM - 1, top, 1e-3, 1e-3, 1) == 0);
    if (mesh->face_leaf[side][0] >= 0)
      ck_assert_double_eq_tol(two_fluid_passing(sim, 0, side, 1e-3, 1e-3, 1),
                              alpha, 1e-6);
    ck_assert_double_eq_tol(two_fluid_wetted(sim, i, 0), sim->c->v[i], 1e-5);
    found++;
  }
  const bool done = grains_run(sim, 0.3, 300);
  const double flux = grains_flux(sim);
  const int leaves = (int)mesh_sum(sim->grid.mesh, found);
  two_fluid_destroy(sim);
  ck_assert_int_eq(leaves, DIM == 2 ? 2 : 4);
  ck_assert(done);
  ck_assert_double_le(flux, DIM == 2 ? 1e-5 : 1e-4);
}
END_TEST

/* A bed that shears hardens in a leaf of the surface as it does in a full one:
 * the pressure that shear has made already does not count as what it adds. */
START_TEST(a_cut_leaf_hardens_as_a_full_one) {
  double z[] = {-1, 0.1 + 0.3 * 0.005}, most[2] = {0, 0};
  struct two_fluid_keys keys =
      grains_keys(TWO_FLUID_CRITICAL_STATE, TWO_FLUID_WATER);
  keys.start = TWO_FLUID_DENSE, keys.alpha_start = 0.6;
  struct params p = grains_params(&keys, 0.01, 1);
  p.trees[DIM - 1] = 16;
  p.shape = (struct function){bed, z};
  struct two_fluid *sim = grains_new(&p);
  const struct mesh *mesh = sim->grid.mesh;
  for (int32_t i = 0; i < mesh->nleaves; i++) sim->X->v[i] = 0.1;
  mesh_touch(mesh, sim->X->v);
  two_fluid_properties(sim);
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    const int cut = mesh->x[i][DIM - 1] > 0.1;
    most[cut] = fmax(most[cut], sim->hardening->v[i]);
  }
  for (int k = 0; k < 2; k++) most[k] = mesh_max(mesh, most[k]);
  two_fluid_destroy(sim);
  ck_assert_double_ge(most[1], 1);
  ck_assert_double_le(most[1], most[0]);
}
END_TEST

Suite *two_fluid_surface_suite(void) {
  Suite *suite = suite_create("two_fluid_surface");
  TCase *leaf = tcase_create("leaf"), *flow = tcase_create("flow");
  tcase_add_test(leaf, a_leaf_is_filled_in_part);
  tcase_add_test(leaf, a_suspension_stays_as_it_is);
  tcase_add_test(leaf, a_cut_leaf_hardens_as_a_full_one);
  if (DIM == 2) tcase_add_loop_test(flow, a_heap_stands, 0, 3);
  if (DIM == 2) tcase_add_test(flow, a_heap_that_yields_exactly_holds);
  suite_add_tcase(suite, leaf);
  suite_add_tcase(suite, flow);
  return suite;
}
