/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Momentum of both phases of the two-fluid model: what transport, a new grid,
 * friction and pressure may do to it. */
#include <check.h>

#include "grid.h"
#include "talus/two_fluid/transport.h"
#include "two_fluid.h"

Suite *two_fluid_momentum_suite(void);

enum { LEVEL = DIM == 2 ? 5 : 4 };
static const double SIZE = 0.16, PI = 3.14159265358979323846;

/* Return LEVEL in one half, the left one if *context says so. */
static double half(void *context, const double x[3]) {
  const bool *left = context;
  return (x[0] < SIZE / 2) == *left ? LEVEL : LEVEL - 1;
}

/* Describe a box with LEVEL in one half and LEVEL - 1 in the other. */
static struct params in_halves(struct two_fluid_keys *keys, bool *left) {
  struct params p = grains_params(keys, SIZE, LEVEL);
  p.level_min = LEVEL - 1;
  p.criterion[p.ncriteria++] = (struct criterion){
      .type = CRITERION_FUNCTION, .level = LEVEL, .function = {half, left}};
  return p;
}

/* Return a wave along all axes. */
static double wave(const double x[3], double shift) {
  double sum = shift;
  for (int d = 0; d < DIM; d++) sum += (d + 1) * x[d];
  return sin(2 * PI / SIZE * sum);
}

/* Make a periodic box of grains without weight, alpha and velocities in waves.
 */
static struct two_fluid *waves(struct params *p) {
  grains_cap(p->own, 10);
  p->gravity[DIM - 1] = 0;
  for (int side = 0; side < 2 * DIM; side++)
    p->boundary[side].type = BOUNDARY_PERIODIC;
  struct two_fluid *sim = grains_new(p);
  const struct mesh *mesh = sim->grid.mesh;
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    sim->alpha->v[i] = 0.3 + 0.1 * wave(mesh->x[i], 0);
    for (int k = 0; k < TWO_FLUID_NPHASES; k++)
      for (int d = 0; d < DIM; d++)
        sim->u[k][d]->v[i] = 0.1 * wave(mesh->x[i], 0.03 * (3 * k + d));
  }
  field_fill(mesh, sim->alpha);
  return sim;
}

/* Return the momentum of a phase along d over its density. */
static double momentum(const struct two_fluid *sim, int phase, int d) {
  const struct mesh *mesh = sim->grid.mesh;
  double sum = 0;
  for (int32_t i = 0; i < mesh->nleaves; i++)
    sum += mesh_volume(mesh, i) * sim->u[phase][d]->v[i] *
           two_fluid_part(phase, sim->alpha->v[i]);
  return mesh_sum(mesh, sum);
}

static void momenta(const struct two_fluid *sim, double *sum) {
  for (int k = 0; k < TWO_FLUID_NPHASES; k++)
    for (int d = 0; d < DIM; d++) sum[k * DIM + d] = momentum(sim, k, d);
}

static double worst_change(const double *before, const double *after) {
  double worst = 0;
  for (int k = 0; k < TWO_FLUID_NPHASES * DIM; k++)
    worst = larger(worst, fabs(after[k] - before[k]));
  return worst / (0.1 * pow(SIZE, DIM));
}

/* Neighbours get what a phase carries out of a leaf, across levels too. */
START_TEST(transport_keeps_momentum) {
  bool left = _i;
  struct two_fluid_keys keys = grains_keys(TWO_FLUID_KTGF, TWO_FLUID_AIR);
  struct params p = in_halves(&keys, &left);
  struct two_fluid *sim = waves(&p);
  const struct mesh *mesh = sim->grid.mesh;
  const double dt = 2e-3;
  double before[TWO_FLUID_NPHASES * DIM], after[TWO_FLUID_NPHASES * DIM];
  for (int d = 0; d < DIM; d++) {
    for (int32_t f = mesh->face_begin[d]; f < mesh->face_begin[d + 1]; f++) {
      const int32_t *node = mesh->face_node[f];
      const double *alpha = sim->alpha->v;
      sim->j->v[f] = 0.2;
      const double mean = 0.5 * (alpha[node[0]] + alpha[node[1]]);
      sim->w_f[TWO_FLUID_S]->v[f] = mean - 0.1;
      sim->flux->v[f] = mean * (mean - 0.1);
      sim->w_f[TWO_FLUID_F]->v[f] = 0.2;
    }
  }
  for (int k = 0; k < TWO_FLUID_NPHASES; k++)
    field_fill_faces(mesh, sim->w_f[k]);
  field_fill_faces(mesh, sim->flux);
  field_fill_faces(mesh, sim->j);
  for (int32_t i = 0; i < mesh->nleaves; i++)
    sim->alpha_new->v[i] =
        sim->alpha->v[i] - dt * mesh_divergence(mesh, sim->flux->v, i);
  momenta(sim, before);
  fields_save(&sim->grid.fields, sim->grid.mesh);
  two_fluid_transport(sim, dt);
  momenta(sim, after);
  double moved = 0;
  for (int32_t i = 0; i < mesh->nleaves; i++)
    moved = larger(
        moved, fabs(sim->u[TWO_FLUID_S][0]->v[i] - 0.1 * wave(mesh->x[i], 0)));
  moved = mesh_max(mesh, moved);
  two_fluid_destroy(sim);
  ck_assert_double_ge(moved, 1e-3);
  ck_assert_double_le(worst_change(before, after), 1e-14);
}
END_TEST

/* A coarser or finer grid takes the momentum of each phase over. */
START_TEST(a_new_grid_keeps_momentum) {
  bool left = true;
  struct two_fluid_keys keys = grains_keys(TWO_FLUID_KTGF, TWO_FLUID_AIR);
  struct params p = in_halves(&keys, &left);
  struct two_fluid *sim = waves(&p);
  double before[TWO_FLUID_NPHASES * DIM], after[TWO_FLUID_NPHASES * DIM];
  momenta(sim, before);
  const int32_t leaves = sim->grid.mesh->nleaves;
  p.ncriteria = 0;
  p.level_max = _i ? LEVEL : LEVEL - 1;
  while (two_fluid_adapt(sim)) continue;
  const bool changed = sim->grid.mesh->nleaves != leaves;
  momenta(sim, after);
  two_fluid_destroy(sim);
  ck_assert(changed);
  ck_assert_double_le(worst_change(before, after), 1e-14);
}
END_TEST

/* Both velocities at a face make up the flux that has no divergence. */
START_TEST(phases_add_up_to_their_flux) {
  double z[] = {0.03, 0.1};
  struct two_fluid_keys keys =
      grains_keys(TWO_FLUID_KTGF, _i ? TWO_FLUID_AIR : TWO_FLUID_WATER);
  struct params p = grains_params(&keys, SIZE, LEVEL);
  keys.start = TWO_FLUID_PATCHED, keys.alpha_start = 0.4;
  p.shape = (struct function){bed, z};
  struct two_fluid *sim = grains_new(&p);
  const struct mesh *mesh = sim->grid.mesh;
  double *alpha = MEM_NEW(double, mesh->ncells);
  bool done = grains_run(sim, 1, 3);
  field_fill(mesh, sim->alpha);
  memcpy(alpha, sim->alpha->v, (size_t)mesh->ncells * sizeof *alpha);
  done = done && grains_run(sim, 1, 1);
  double worst = 0, speed = 0;
  for (int32_t f = 0; f < mesh->nfaces; f++) {
    const int32_t *node = mesh->face_node[f];
    const double phi = 0.5 * (alpha[node[0]] + alpha[node[1]]);
    double u[TWO_FLUID_NPHASES];
    if (two_fluid_is_side(sim, f)) continue;
    for (int k = 0; k < TWO_FLUID_NPHASES; k++)
      u[k] = sim->w_f[k]->v[f] + sim->v_f[k]->v[f];
    speed = larger(speed, fabs(u[TWO_FLUID_S]));
    worst = larger(worst, fabs(phi * u[TWO_FLUID_S] +
                               (1 - phi) * u[TWO_FLUID_F] - sim->j->v[f]));
  }
  speed = mesh_max(mesh, speed), worst = mesh_max(mesh, worst);
  mem_free(alpha);
  two_fluid_destroy(sim);
  ck_assert(done);
  ck_assert_double_ge(speed, 1e-3);
  ck_assert_double_le(worst, 1e-10 * speed);
}
END_TEST

/* Drag and pressures leave the momentum of both together alone: on one level,
 * and where the left or the right half is finer. */
START_TEST(a_step_keeps_momentum) {
  bool left = _i / 2 == 1;
  struct two_fluid_keys keys =
      grains_keys(TWO_FLUID_KTGF, _i % 2 ? TWO_FLUID_AIR : TWO_FLUID_WATER);
  struct params p =
      _i < 2 ? grains_params(&keys, SIZE, LEVEL) : in_halves(&keys, &left);
  p.dt_max = 1e-3;
  p.tolerance_pressure = p.tolerance_viscous = 1e-10;
  struct two_fluid *sim = waves(&p);
  double before[TWO_FLUID_NPHASES * DIM], after[TWO_FLUID_NPHASES * DIM];
  momenta(sim, before);
  const bool done = grains_run(sim, 1, 2);
  momenta(sim, after);
  const double rho_s = two_fluid_density(sim, TWO_FLUID_S);
  const double rho_f = two_fluid_density(sim, TWO_FLUID_F);
  double worst = 0, most = 0;
  for (int d = 0; d < DIM; d++) {
    const double solid = rho_s * (after[d] - before[d]);
    const double fluid = rho_f * (after[DIM + d] - before[DIM + d]);
    worst = larger(worst, fabs(solid + fluid));
    most = larger(most, fabs(solid));
  }
  const double scale = rho_s * 0.1 * pow(SIZE, DIM);
  two_fluid_destroy(sim);
  ck_assert(done);
  ck_assert_double_ge(most, 1e-5 * scale);
  ck_assert_double_le(worst, 1e-12 * scale);
}
END_TEST

/* Grains that shear stop together with what is between them, of which either
 * feels the stress of the other: packed ones of 0.1 mm in water, and loose ones
 * in a thick fluid. */
START_TEST(friction_stops_both) {
  struct two_fluid_keys keys = grains_keys(TWO_FLUID_KTGF, TWO_FLUID_WATER);
  double *own = keys.closure.param;
  keys.start = TWO_FLUID_PATCHED, keys.alpha_start = _i ? 0.2 : 0.6;
  grains_cap(&keys, _i ? 1 : 1e7);
  if (!_i) own[TWO_FLUID_GRAINS_D] = 1e-4;
  if (_i) own[TWO_FLUID_FLUID_ETA_0] = own[TWO_FLUID_FLUID_ETA_INF] = 1e4;
  struct params p = grains_params(&keys, SIZE, LEVEL);
  p.gravity[DIM - 1] = 0;
  p.dt_max = 1e-2;
  for (int side = 0; side < 2 * DIM; side++)
    p.boundary[side].type = BOUNDARY_PERIODIC;
  struct two_fluid *sim = grains_new(&p);
  const struct mesh *mesh = sim->grid.mesh;
  for (int k = 0; k < TWO_FLUID_NPHASES; k++)
    for (int32_t i = 0; i < mesh->nleaves; i++)
      sim->u[k][0]->v[i] =
          0.01 + 1e-4 * sin(2 * PI / SIZE * mesh->x[i][DIM - 1]);
  const bool done = grains_run(sim, 1, 1);
  double shear = 0;
  for (int k = 0; k < TWO_FLUID_NPHASES; k++)
    for (int32_t i = 0; i < mesh->nleaves; i++)
      shear = larger(shear, fabs(sim->u[k][0]->v[i] - 0.01));
  shear = mesh_max(mesh, shear);
  two_fluid_destroy(sim);
  ck_assert(done);
  ck_assert_double_le(shear, _i ? 2e-6 : 1e-6);
}
END_TEST

Suite *two_fluid_momentum_suite(void) {
  Suite *suite = suite_create("two_fluid_momentum");
  TCase *momentum = tcase_create("momentum");
  tcase_add_loop_test(momentum, transport_keeps_momentum, 0, 2);
  tcase_add_loop_test(momentum, a_new_grid_keeps_momentum, 0, 2);
  tcase_add_loop_test(momentum, phases_add_up_to_their_flux, 0, 2);
  tcase_add_loop_test(momentum, a_step_keeps_momentum, 0, 6);
  tcase_add_loop_test(momentum, friction_stops_both, 0, 2);
  suite_add_tcase(suite, momentum);
  return suite;
}
