/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Fields for output: shear rate and what the closure knows of the grains. */
#include "talus/two_phase/closure_fields.h"

#include <check.h>

#include "sim.h"
#include "talus/rheology.h"

Suite *closure_fields_suite(void);

static double height;
static const double RATE = 3, PRESSURE = 40;

static struct rheology lee_huang(void) {
  struct rheology r;
  rheology_init(&r, rheology_find("lee_huang"));
  ck_assert_ptr_null(rheology_prepare(&r));
  return r;
}

/* Set grains in plane shear below gas that shears a hundred times faster, at
 * one pressure. */
static void set_shear(struct two_phase *sim) {
  for (int32_t i = 0; i < sim->grid.mesh->nleaves; i++) {
    const double z = sim->grid.mesh->x[i][DIM - 1];
    sim->u[0]->v[i] = RATE * (z + 99 * fmax(z - height, 0));
    sim->p->v[i] = PRESSURE;
  }
}

/* Is a leaf away from the sides, whose conditions are not those of the shear?
 */
static bool is_inside(const struct two_phase *sim, int32_t i) {
  bool inside = true;
  for (int d = 0; d < DIM; d++) {
    inside = inside &&
             fabs(sim->grid.mesh->x[i][d] - 0.5) < 0.5 - sim->grid.mesh->h[i];
  }
  return inside;
}

/* The surface fills a row of leaves by 0.4, which count as gas. */
START_TEST(grains_have_their_shear_rate_and_state_and_gas_none) {
  struct params params = box_params(4);
  height = 0.5 + 0.4 / 16;
  params.grains.rheology = lee_huang();
  params.shape = (struct function){below, &height};
  if (_i) params_follow_surface(&params, 2, 1);
  struct two_phase *sim = sim_start(&params);
  const int n = sim->nknown;
  double wrong_rate = 0, wrong[8] = {0}, gas = 0, cells = 0;
  double eta, wrong_stress = 0;
  rheology_eval(&params.grains.rheology, 0, 1, &RATE, &PRESSURE, &eta);
  set_shear(sim);
  closure_fields_update(sim);
  for (int32_t i = 0; i < sim->grid.mesh->nleaves; i++) {
    const bool grains = sim->c->v[i] > 0.5;
    for (int k = 0; k < n && !grains; k++) gas += fabs(sim->known[k]->v[i]);
    if (!grains) gas += sim->stress->v[i];
    if (!grains || !is_inside(sim, i)) continue;
    wrong_stress =
        larger(wrong_stress, fabs(sim->stress->v[i] / (eta * RATE) - 1));
    cells++;
    wrong_rate = larger(wrong_rate, fabs(sim->shear_rate->v[i] / RATE - 1));
    for (int k = 0; k < n; k++) {
      double exact;
      rheology_output(&params.grains.rheology, k, 1, &RATE, &PRESSURE, &exact);
      wrong[k] = larger(wrong[k], fabs(sim->known[k]->v[i] - exact));
    }
  }
  closure_fields_release(sim);
  cells = mesh_sum(sim->grid.mesh, cells);
  gas = mesh_sum(sim->grid.mesh, gas);
  wrong_rate = mesh_max(sim->grid.mesh, wrong_rate);
  wrong_stress = mesh_max(sim->grid.mesh, wrong_stress);
  for (int k = 0; k < n; k++) wrong[k] = mesh_max(sim->grid.mesh, wrong[k]);
  two_phase_destroy(sim);
  rheology_release(&params.grains.rheology);
  ck_assert_int_eq(n, 4);
  ck_assert_double_gt(cells, 0);
  ck_assert_double_eq(gas, 0);
  /* sums of a few numbers of the size of the velocity over h */
  ck_assert_double_le(wrong_rate, 1e-11);
  ck_assert_double_le(wrong_stress, 1e-10);
  for (int k = 0; k < n; k++) ck_assert_double_le(wrong[k], 1e-9);
}
END_TEST

/* A Bingham fluid with eta_0 = 0.5 that shears at RATE below its yield stress,
 * of 2, by a kept stress of size 0.7: on faces of the upper half of the box
 * only, so that leaves beside the middle have it on fewer sides. */
START_TEST(an_exact_yield_adds_its_kept_stress) {
  struct params params = box_params(3);
  rheology_init(&params.grains.rheology, rheology_find("bingham"));
  rheology_set(&params.grains.rheology, "tau_y", 2);
  rheology_set(&params.grains.rheology, "eta_0", 0.5);
  rheology_set_regularisation(&params.grains.rheology, "exact");
  struct two_phase *sim = sim_new(&params, MPI_COMM_WORLD);
  const struct mesh *mesh = sim->grid.mesh;
  double wrong = 0;
  height = 1;
  for (int32_t i = 0; i < mesh->nleaves; i++) sim->c->v[i] = 1;
  set_shear(sim);
  for (int d = 0; d < DIM; d++) {
    for (int32_t f = mesh->face_begin[d]; f < mesh->face_begin[d + 1]; f++) {
      const int32_t leaf = mesh->face_owner[f];
      const bool there = mesh->x[leaf][DIM - 1] > 0.5;
      sim->yield.tau_y->v[f] = there ? 2 : 0;
      sim->yield.s[d == 0]->v[f] = there ? 0.7 : 0;
    }
  }
  closure_fields_update(sim);
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    const double s = mesh->x[i][DIM - 1] > 0.5 ? 0.7 : 0;
    const bool middle = fabs(mesh->x[i][DIM - 1] - 0.5) < mesh->h[i];
    if (!is_inside(sim, i) || (middle && s == 0)) continue;
    wrong = larger(wrong, fabs(sim->stress->v[i] - 0.5 * RATE - s));
  }
  wrong = mesh_max(mesh, wrong);
  closure_fields_release(sim);
  two_phase_destroy(sim);
  ck_assert_double_le(wrong, 1e-12);
}
END_TEST

/* Stretched along x and pressed along y at RATE: sqrt(2 D:D) is twice that. */
START_TEST(stretching_at_a_rate_shears_at_twice_of_it) {
  struct params params = box_params(3);
  struct two_phase *sim = sim_new(&params, MPI_COMM_WORLD);
  double most = 0, cells = 0;
  for (int32_t i = 0; i < sim->grid.mesh->nleaves; i++) {
    sim->u[0]->v[i] = RATE * sim->grid.mesh->x[i][0];
    sim->u[1]->v[i] = -RATE * sim->grid.mesh->x[i][1];
  }
  closure_fields_update(sim);
  for (int32_t i = 0; i < sim->grid.mesh->nleaves; i++) {
    if (!is_inside(sim, i)) continue;
    most = larger(most, fabs(sim->shear_rate->v[i] - 2 * RATE));
    cells++;
  }
  most = mesh_max(sim->grid.mesh, most);
  cells = mesh_sum(sim->grid.mesh, cells);
  closure_fields_release(sim);
  two_phase_destroy(sim);
  ck_assert_double_gt(cells, 0);
  ck_assert_double_le(most, 1e-12);
}
END_TEST

/* The mean leaves out the gas. */
START_TEST(the_mean_shear_rate_is_that_of_the_grains) {
  struct params params = box_params(5);
  height = 0.5;
  params.shape = (struct function){below, &height};
  params.boundary[0].type = params.boundary[1].type = BOUNDARY_PERIODIC;
  params.boundary[2 * DIM - 2].type = BOUNDARY_NO_SLIP;
  struct two_phase *sim = sim_start(&params);
  set_shear(sim);
  const double mean = closure_fields_shear_rate(sim);
  two_phase_destroy(sim);
  /* the floor's condition is exact for a linear velocity */
  ck_assert_double_eq_tol(mean, RATE, 1e-10);
}
END_TEST

Suite *closure_fields_suite(void) {
  Suite *suite = suite_create("closure_fields");
  TCase *tcase = tcase_create("all"), *alone = tcase_create("one level");
  tcase_set_tags(alone, "one_rank");
  tcase_add_loop_test(
      alone, grains_have_their_shear_rate_and_state_and_gas_none, 0, 1);
  tcase_add_loop_test(
      tcase, grains_have_their_shear_rate_and_state_and_gas_none, 1, 2);
  tcase_add_test(tcase, an_exact_yield_adds_its_kept_stress);
  tcase_add_test(tcase, stretching_at_a_rate_shears_at_twice_of_it);
  tcase_add_test(tcase, the_mean_shear_rate_is_that_of_the_grains);
  suite_add_tcase(suite, tcase);
  suite_add_tcase(suite, alone);
  return suite;
}
