/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Two fluids on a slope: a column of leaves of a layer under a viscous liquid,
 * as in [pailha_2008], 0.16 mm in 0.096 Pa s. Gravity is inclined. */
#include "two_fluid.h"

#include <check.h>

#include "ranks.h"
#include "talus/memory.h"
#include "talus/two_fluid/properties.h"

Suite *two_fluid_slope_suite(void);

static const double H = 4.9e-3, RADIAN = 0.017453292519943295;

static struct params slope(struct two_fluid_keys *keys, double degrees,
                           double phi) {
  enum { N = 24 };
  *keys = grains_keys(TWO_FLUID_CRITICAL_STATE, TWO_FLUID_OWN);
  keys->closure.param[TWO_FLUID_FLUID_DENSITY] = 1041;
  keys->closure.param[TWO_FLUID_FLUID_ETA_0] = 0.096;
  keys->closure.param[TWO_FLUID_GRAINS_D] = 1.6e-4;
  keys->start = TWO_FLUID_DENSE, keys->alpha_start = phi;
  struct params p = grains_params(keys, 2 * H / N, 1);
  p.grains.density = 2500;
  p.trees[DIM - 1] = 3 * N / 4;
  for (int side = 0; side < 2 * (DIM - 1); side++)
    p.boundary[side].type = BOUNDARY_PERIODIC;
  p.gravity[0] = 9.81 * sin(degrees * RADIAN);
  p.gravity[DIM - 1] = -9.81 * cos(degrees * RADIAN);
  return p;
}

/* Return the largest velocity down the slope in the middle of the layer, and
 * set how far it differs there from the mean of the leaves above and below. */
static double velocity(const struct two_fluid *sim, double *rough) {
  const struct mesh *mesh = sim->grid.mesh;
  const double *u = sim->u[TWO_FLUID_S][0]->v;
  double most = 0, fastest = 0;
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    const int32_t *node = mesh->stencil[i];
    if (fabs(mesh->x[i][DIM - 1] - 0.5 * H) > 0.25 * H) continue;
    most = fmax(most, fabs(u[i] - 0.5 * (u[node[stencil_face(2 * DIM - 2)]] +
                                         u[node[stencil_face(2 * DIM - 1)]])));
    fastest = fmax(fastest, fabs(u[i]));
  }
  *rough = mesh_max(mesh, most);
  return mesh_max(mesh, fastest);
}

/* Return how far the stress of the grains in the middle of the layer is from
 * their weight down the slope, Pa, over that of the layer. */
static double stress_error(struct two_fluid *sim) {
  const struct mesh *mesh = sim->grid.mesh;
  double *stress = MEM_NEW(double, mesh->nleaves), worst = 0;
  const double weight = 0.562 * (2500 - 1041) * sim->params->gravity[0];
  two_fluid_properties(sim);
  two_fluid_find_stress(sim, stress);
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    const double depth = H - mesh->x[i][DIM - 1];
    if (fabs(depth - 0.5 * H) > 0.25 * H) continue;
    worst = fmax(worst, fabs(stress[i] - weight * depth) / (weight * H));
  }
  mem_free(stress);
  return mesh_max(mesh, worst);
}

/* Below the slope of repose, 23 degrees, a layer creeps only, or rests where it
 * yields exactly; above, loose grains flow at once, and smoothly: 0.6 mm/s at
 * the surface in the experiment. Their stress holds their weight. */
START_TEST(a_layer_slides_beyond_repose) {
  const bool exact = _i >= 2, slides = _i % 2;
  double z[] = {-1, H}, rough;
  struct two_fluid_keys keys;
  struct params p = slope(&keys, slides ? 25 : 20, 0.562);
  keys.regularisation = exact ? TWO_FLUID_EXACT : TWO_FLUID_CLIP;
  p.shape = (struct function){bed, z};
  struct two_fluid *sim = grains_new(&p);
  bool done = true;
  double u = 0, most = 0;
  const double end = end_of_run(0.5, 0.1);
  while (done && sim->model.time < end * (1 - 1e-12)) {
    done = grains_run(sim, end, 1);
    u = velocity(sim, &rough);
    most = fmax(most, u);
  }
  const double wrong = stress_error(sim);
  two_fluid_destroy(sim);
  ck_assert(done);
  if (exact && !slides) ck_assert_double_le(most, 1e-6);
  /* held grains have normal stresses besides, in 3D up to 0.16 of the weight */
  if (slides || (exact && DIM == 2)) ck_assert_double_le(wrong, 0.05);
  ck_assert_double_le(u, slides ? 1e-3 : 5e-5);
  ck_assert_double_ge(u, slides ? 1e-4 : 0);
  ck_assert_double_le(rough, 1e-5);
}
END_TEST

/* Dense grains stay: they would have to expand, and have less than twice the
 * pressure that holds them. With an exact yield what moves is how fast they do,
 * as suction lets liquid in. */
START_TEST(a_dense_layer_stays) {
  double z[] = {-1, H}, rough, most = 0;
  struct two_fluid_keys keys;
  struct params p = slope(&keys, 25, 0.592);
  keys.regularisation = _i ? TWO_FLUID_EXACT : TWO_FLUID_CLIP;
  p.shape = (struct function){bed, z};
  struct two_fluid *sim = grains_new(&p);
  const bool done = grains_run(sim, 0.5, 2000);
  const double u = velocity(sim, &rough);
  for (int32_t i = 0; i < sim->grid.mesh->nleaves; i++)
    most = fmax(most, sim->p_s->v[i]);
  most = mesh_max(sim->grid.mesh, most);
  two_fluid_destroy(sim);
  ck_assert(done);
  ck_assert_double_le(u, _i ? 5e-6 : 3e-5);
  ck_assert_double_le(most, 50); /* Pa; weight 37, to hold 40 */
}
END_TEST

Suite *two_fluid_slope_suite(void) {
  Suite *suite = suite_create("two_fluid_slope");
  TCase *flow = tcase_create("flow"), *alone = tcase_create("long flow");
  tcase_set_tags(alone, "one_rank");
  tcase_add_loop_test(flow, a_layer_slides_beyond_repose, 2, 3);
  tcase_add_loop_test(alone, a_layer_slides_beyond_repose, 0, 2);
  if (DIM == 2) tcase_add_loop_test(alone, a_layer_slides_beyond_repose, 3, 4);
  tcase_add_loop_test(alone, a_dense_layer_stays, 0, DIM == 2 ? 2 : 1);
  suite_add_tcase(suite, flow);
  suite_add_tcase(suite, alone);
  return suite;
}
