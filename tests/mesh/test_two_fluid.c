/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The two-fluid model on small grids. */
#include "two_fluid.h"

#include <check.h>
#include <stdio.h>

#include "grid.h"
#include "ranks.h"
#include "stale.h"

Suite *two_fluid_suite(void);

enum { LEVEL = DIM == 2 ? 5 : 3 };

/* Ask for fine leaves in the left half and around the surface, or below and
 * around it. */
static double left(void *context, const double x[3]) {
  (void)context;
  return x[0] < 0.08 || x[DIM - 1] > 0.07 ? LEVEL : LEVEL - 1;
}
static double deep(void *context, const double x[3]) {
  (void)context;
  return x[DIM - 1] < 0.03 || x[DIM - 1] > 0.07 ? LEVEL : LEVEL - 1;
}

static struct params with_levels(struct params p, int which) {
  double (*level[])(void *, const double *) = {NULL, left, deep};
  if (!level[which]) return p;
  p.level_min = LEVEL - 1;
  p.criterion[p.ncriteria++] = (struct criterion){
      .type = CRITERION_FUNCTION, .level = LEVEL, .function = {level[which]}};
  return p;
}

/* A settled bed stays: the flux is that of the last consolidation, from the
 * continuous balance to that of the leaves. Water, and air, where drag is slow;
 * surfaces on faces and between; levels that jump across it and along it. */
START_TEST(a_settled_bed_rests) {
  static const double top[] = {0.1, 0.1017};
  double z[] = {-1, top[_i % 2]};
  struct two_fluid_keys keys =
      grains_keys(TWO_FLUID_KTGF, _i / 2 % 2 ? TWO_FLUID_AIR : TWO_FLUID_WATER);
  struct params p =
      with_levels(grains_params(&keys, 0.16, LEVEL), DIM == 2 ? _i / 4 : 0);
  p.shape = (struct function){bed, z};
  struct two_fluid *sim = grains_new(&p);
  struct two_fluid_measures before, after;
  two_fluid_measure(sim, &before);
  const bool done = grains_run(sim, end_of_run(0.4, 0.1), 300);
  two_fluid_measure(sim, &after);
  const double flux = grains_flux(sim);
  outline_free(&before.outline), outline_free(&after.outline);
  two_fluid_destroy(sim);
  ck_assert(done);
  ck_assert_double_le(flux, _i / 4 == 1 && DIM == 2 ? 1e-4 : 2e-5);
  ck_assert_double_eq_tol(after.volume / before.volume, 1, 1e-13);
}
END_TEST

/* Likewise of critical_state, which a plastic packing holds: settled on one,
 * and with one that makes 0.6 carry the weight. Neither moves it. */
START_TEST(a_plastic_bed_rests) {
  double z[] = {-1, 0.1};
  struct two_fluid_keys keys =
      grains_keys(TWO_FLUID_CRITICAL_STATE, TWO_FLUID_WATER);
  keys.start = _i ? TWO_FLUID_DENSE : TWO_FLUID_SETTLED;
  struct params p = grains_params(&keys, 0.16, LEVEL);
  p.shape = (struct function){bed, z};
  struct two_fluid *sim = grains_new(&p);
  const bool done = grains_run(sim, 0.3, 300);
  const double flux = grains_flux(sim);
  two_fluid_destroy(sim);
  ck_assert(done);
  ck_assert_double_le(flux, 1e-4);
}
END_TEST

/* A bed falls freely through air, by (1 - rho_f/rho_s) g t while drag is small,
 * lands on the floor, and never passes its densest packing. */
START_TEST(a_bed_falls_and_lands) {
  double z[] = {0.04, 0.1};
  struct two_fluid_keys keys = grains_keys(TWO_FLUID_KTGF, TWO_FLUID_AIR);
  keys.start = TWO_FLUID_PATCHED, keys.alpha_start = 0.5;
  struct params p = grains_params(&keys, 0.16, LEVEL);
  p.shape = (struct function){bed, z};
  struct two_fluid *sim = grains_new(&p);
  struct two_fluid_measures before, m;
  two_fluid_measure(sim, &before);
  bool done = true;
  double most = 0, gain = 0;
  for (int k = 0; k < 200 && done; k++) {
    done = grains_run(sim, 1, 1);
    two_fluid_measure(sim, &m);
    outline_free(&m.outline);
    most = fmax(most, m.max_alpha);
    gain = fmax(gain, m.kinetic + m.fluid_kinetic + m.potential - sim->initial);
  }
  const double energy = sim->initial;
  outline_free(&before.outline);
  two_fluid_destroy(sim);
  ck_assert(done);
  ck_assert_double_eq_tol(m.volume / before.volume, 1, 1e-12);
  ck_assert_double_lt(most, 0.63);
  ck_assert_double_le(gain, 1e-3 * energy);
  ck_assert_double_le(m.grain_speed, 0.02);
}
END_TEST

/* Both phases keep a uniform velocity, on one level and across levels. */
START_TEST(uniform_motion_stays) {
  struct two_fluid_keys keys = grains_keys(TWO_FLUID_KTGF, TWO_FLUID_WATER);
  grains_cap(&keys, 10);
  keys.start = TWO_FLUID_PATCHED, keys.alpha_start = 0.3;
  struct params p = with_levels(grains_params(&keys, 0.16, LEVEL), _i);
  p.gravity[DIM - 1] = 0;
  p.tolerance_pressure = p.tolerance_viscous = 1e-10;
  for (int side = 0; side < 2 * DIM; side++)
    p.boundary[side].type = BOUNDARY_PERIODIC;
  struct two_fluid *sim = grains_new(&p);
  const struct mesh *mesh = sim->grid.mesh;
  for (int k = 0; k < TWO_FLUID_NPHASES; k++)
    for (int32_t i = 0; i < mesh->nleaves; i++)
      for (int d = 0; d < DIM; d++) sim->u[k][d]->v[i] = 0.1 * (d + 1);
  const bool done = grains_run(sim, 0.05, 5);
  double worst = 0;
  mesh = sim->grid.mesh;
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    for (int k = 0; k < TWO_FLUID_NPHASES; k++)
      for (int d = 0; d < DIM; d++)
        worst = fmax(worst, fabs(sim->u[k][d]->v[i] - 0.1 * (d + 1)));
    worst = fmax(worst, fabs(sim->alpha->v[i] - 0.3));
  }
  worst = mesh_max(mesh, worst);
  two_fluid_destroy(sim);
  ck_assert(done);
  ck_assert_double_le(worst, 1e-8);
}
END_TEST

/* Return how far a point lies above z = 0.05. */
static double above(void *context, const double x[3]) {
  (void)context;
  return x[DIM - 1] - 0.05;
}

static double block(void *context, const double x[3]) {
  (void)context;
  double inside = 0.1 - x[DIM - 1];
  for (int d = 0; d < DIM - 1; d++) inside = fmin(inside, 0.06 - x[d]);
  return inside;
}

/* Grains take their tracer along as a block collapses on a grid that follows
 * it: there is as much of it in the end, but for what thin leaves lose, nearly
 * within 0 and 1, and lower. */
START_TEST(grains_carry_tracers) {
  struct two_fluid_keys keys = grains_keys(TWO_FLUID_KTGF, TWO_FLUID_WATER);
  struct params p = grains_params(&keys, 0.16, LEVEL);
  p.level_min = LEVEL - 1;
  p.criterion[p.ncriteria++] = (struct criterion){
      .type = CRITERION_INTERFACE, .level = LEVEL, .width = 2};
  p.shape = (struct function){block, NULL};
  p.ntracers = 1;
  snprintf(p.tracer[0].name, sizeof p.tracer[0].name, "upper");
  p.tracer[0].shape = (struct function){above, NULL};
  struct two_fluid *sim = grains_new(&p);
  double mass[2], height[2], low = 0, high = 1;
  bool done = true;
  for (int k = 0; k < 2; k++) {
    const struct mesh *mesh = sim->grid.mesh;
    mass[k] = height[k] = 0;
    for (int32_t i = 0; i < mesh->nleaves; i++) {
      const double part = sim->tracer[0]->v[i];
      const double m = part * sim->alpha->v[i] * mesh_volume(mesh, i);
      mass[k] += m, height[k] += m * mesh->x[i][DIM - 1];
      low = fmin(low, part), high = fmax(high, part);
    }
    mass[k] = mesh_sum(mesh, mass[k]);
    height[k] = mesh_sum(mesh, height[k]) / mass[k];
    if (k == 0) done = grains_run(sim, end_of_run(0.1, 0.09), 100);
  }
  two_fluid_destroy(sim);
  ck_assert(done);
  ck_assert_double_eq_tol(mass[1] / mass[0], 1, 1e-5);
  ck_assert_double_lt(height[1], 0.99 * height[0]);
  ck_assert_double_eq_tol(height[0], 0.075, 2e-3);
  ck_assert_double_ge(low, -0.02);
  ck_assert_double_le(high, 1.02);
}
END_TEST

/* A block in the corner of a box knows no difference between the horizontal
 * axes: moments of the solid fraction and of both velocities turned round. */
START_TEST(horizontal_axes_are_alike) {
  struct two_fluid_keys keys = grains_keys(
      TWO_FLUID_CRITICAL_STATE, _i ? TWO_FLUID_AIR : TWO_FLUID_WATER);
  struct params p = grains_params(&keys, 0.16, LEVEL);
  p.level_min = LEVEL - 1;
  p.criterion[p.ncriteria++] = (struct criterion){
      .type = CRITERION_INTERFACE, .level = LEVEL, .width = 1};
  p.shape = (struct function){block, NULL};
  p.tolerance_pressure = p.tolerance_viscous = 1e-8;
  struct two_fluid *sim = grains_new(&p);
  const bool done = grains_run(sim, end_of_run(0.1, 0.04), 100);
  const struct mesh *mesh = sim->grid.mesh;
  double moment[3][2] = {{0}}, speed = 0;
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    for (int d = 0; d < 2; d++) {
      const double x = mesh->x[i][d], y = mesh->x[i][1 - d];
      const double weight = mesh_volume(mesh, i) * x * x * y;
      moment[0][d] += weight * sim->alpha->v[i];
      for (int k = 0; k < TWO_FLUID_NPHASES; k++)
        moment[1 + k][d] += weight * sim->u[k][d]->v[i] * sim->alpha->v[i];
      speed = fmax(speed, sim->u[TWO_FLUID_S][d]->v[i]);
    }
  }
  for (int k = 0; k < 3; k++)
    for (int d = 0; d < 2; d++) moment[k][d] = mesh_sum(mesh, moment[k][d]);
  speed = mesh_max(mesh, speed);
  two_fluid_destroy(sim);
  ck_assert(done);
  ck_assert_double_ge(speed, 0.01);
  for (int k = 0; k < 3; k++)
    ck_assert_double_eq_tol(moment[k][0] / moment[k][1], 1, 1e-6);
}
END_TEST

/* Sides of leaves are walls at the sides of the box only, not where levels
 * jump. */
START_TEST(walls_are_the_sides_of_the_box) {
  double z[] = {-1, 0.1}, wrong = 0;
  struct two_fluid_keys keys = grains_keys(TWO_FLUID_KTGF, TWO_FLUID_WATER);
  struct params p = with_levels(grains_params(&keys, 0.16, LEVEL), 1);
  p.shape = (struct function){bed, z};
  struct two_fluid *sim = grains_new(&p);
  const struct mesh *mesh = sim->grid.mesh;
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    for (int s = 0; s < NFACE; s++) {
      const bool edge =
          mesh->stencil[i][stencil_face(s)] >= mesh->begin_boundary;
      wrong += two_fluid_is_side(sim, mesh->cell_face[i][s]) != edge;
    }
  }
  wrong = mesh_sum(mesh, wrong);
  two_fluid_destroy(sim);
  ck_assert_double_eq(wrong, 0);
}
END_TEST

/* Return how far a point lies below a slope of 45 degrees. */
static double cliff(void *context, const double x[3]) {
  (void)context;
  return 0.2 - x[0] - x[DIM - 1];
}

/* Grains end as high as the key front_height asks, or half a grain. */
START_TEST(the_front_is_as_high_as_asked) {
  double front[2];
  struct two_fluid_keys keys =
      grains_keys(TWO_FLUID_CRITICAL_STATE, TWO_FLUID_WATER);
  for (int k = 0; k < 2; k++) {
    struct two_fluid_measures m;
    struct params p = grains_params(&keys, 0.16, LEVEL);
    p.shape = (struct function){cliff, NULL};
    p.front_height = k ? 0.05 : 0;
    struct two_fluid *sim = grains_new(&p);
    two_fluid_measure(sim, &m);
    front[k] = m.grain_front;
    outline_free(&m.outline);
    two_fluid_destroy(sim);
  }
  ck_assert_double_lt(front[1], front[0]);
}
END_TEST

/* A step of a cliff that slides, across levels and in most of the box, so that
 * ranks meet in it, fills the nodes that it reads: whatever they were, it ends
 * the same. */
START_TEST(a_step_reads_no_stale_nodes) {
  struct two_fluid_keys keys = grains_keys(
      _i ? TWO_FLUID_CRITICAL_STATE : TWO_FLUID_KTGF, TWO_FLUID_WATER);
  struct params p = with_levels(grains_params(&keys, 0.16, LEVEL), 1);
  p.shape = (struct function){cliff, NULL};
  struct two_fluid *sim[2];
  bool done = true;
  for (int k = 0; k < 2; k++) {
    sim[k] = grains_new(&p);
    done = done && grains_run(sim[k], 1, 1);
    stale_set(&sim[k]->grid.fields, sim[k]->grid.mesh, k);
    done = done && grains_run(sim[k], 1, 1);
  }
  const double difference = stale_difference(
      &sim[0]->grid.fields, &sim[1]->grid.fields, sim[0]->grid.mesh);
  for (int k = 0; k < 2; k++) two_fluid_destroy(sim[k]);
  ck_assert(done);
  ck_assert_double_eq(difference, 0);
}
END_TEST

Suite *two_fluid_suite(void) {
  Suite *suite = suite_create("two_fluid");
  TCase *rest = tcase_create("rest"), *flow = tcase_create("flow");
  TCase *alone = tcase_create("long rest and flow");
  tcase_set_tags(alone, "one_rank");
  const int last = DIM == 2 ? 11 : 3; /* the last jumps along the bed, in air */
  tcase_add_loop_test(rest, a_settled_bed_rests, last, last + 1);
  tcase_add_loop_test(alone, a_settled_bed_rests, 0, last);
  if (DIM == 2) tcase_add_loop_test(alone, a_plastic_bed_rests, 0, 2);
  tcase_add_test(alone, a_bed_falls_and_lands);
  tcase_add_test(flow, grains_carry_tracers);
  tcase_add_test(flow, walls_are_the_sides_of_the_box);
  tcase_add_test(flow, the_front_is_as_high_as_asked);
  tcase_add_loop_test(flow, a_step_reads_no_stale_nodes, 0, DIM == 2 ? 2 : 1);
  if (DIM == 3) tcase_add_loop_test(alone, horizontal_axes_are_alike, 0, 1);
  if (DIM == 3) tcase_add_loop_test(flow, horizontal_axes_are_alike, 1, 2);
  tcase_add_loop_test(flow, uniform_motion_stays, 0, DIM == 2 ? 2 : 1);
  suite_add_tcase(suite, rest);
  suite_add_tcase(suite, flow);
  suite_add_tcase(suite, alone);
  return suite;
}
