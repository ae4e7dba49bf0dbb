/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/two_fluid/time_step.h"

#include <math.h>

#include "talus/minmax.h"
#include "talus/two_fluid/state.h"

/* dt is at most WAVE times sqrt(h/g') of the finest leaves, g' the weight of
 * grains in the fluid over their mass, begins with a quarter of that, and grows
 * by at most DT_GROWTH. */
#define WAVE 0.4
#define WAVE_DENSE 0.1
#define DT_FIRST 0.25
#define DT_GROWTH 1.2
/* Grains that are more than PACKED change alpha by at most this part of it. */
#define DT_CHANGE 0.2
#define PACKED 0.4

/* Return how often grains replace those of leaf i, 1/s. alpha is filled. They
 * pass a face with at least the speed of the flux over the larger alpha of both
 * sides: what the surface leaves of a bed in a leaf may be next to nothing, and
 * falls no faster than the rest. */
static double grain_rate(const struct two_fluid *sim, int32_t i) {
  const struct mesh *mesh = sim->grid.mesh;
  const double *alpha = sim->alpha->v;
  double sum = 0;
  if (!(alpha[i] > TWO_FLUID_NONE)) return 0;
  for (int s = 0; s < NFACE; s++) {
    const int32_t there = mesh->stencil[i][stencil_face(s)];
    sum += fabs(mesh_side(mesh, sim->flux->v, i, s)) /
           max2(alpha[i], alpha[there]);
  }
  return 0.5 * sum / mesh_width(mesh, i);
}

/* Return that of the fluid, whose flux is j less that of the grains. */
static double fluid_rate(const struct two_fluid *sim, int32_t i) {
  const struct mesh *mesh = sim->grid.mesh;
  double sum = 0;
  for (int s = 0; s < NFACE; s++)
    sum += fabs(mesh_side(mesh, sim->j->v, i, s) -
                mesh_side(mesh, sim->flux->v, i, s));
  return 0.5 * sum / (mesh_width(mesh, i) * (1 - sim->alpha->v[i]));
}

double two_fluid_rate(const struct two_fluid *sim) {
  double most = 0;
  field_fill(sim->grid.mesh, sim->alpha);
  for (int32_t i = 0; i < sim->grid.mesh->nleaves; i++)
    most = max2(most, max2(grain_rate(sim, i), fluid_rate(sim, i)));
  return mesh_max(sim->grid.mesh, most);
}

/* Return the largest |div(alpha u_s)|/alpha where grains are packed. */
static double change_rate(const struct two_fluid *sim) {
  const struct mesh *mesh = sim->grid.mesh;
  double most = 0;
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    const double alpha = sim->alpha->v[i];
    if (alpha < PACKED) continue;
    most = max2(most, fabs(mesh_divergence(mesh, sim->flux->v, i)) / alpha);
  }
  return mesh_max(mesh, most);
}

/* Are there grains that hold each other and expand where they are sheared? What
 * they gain of speed in a step shears them by dt^2 g'/h, and a strain of 0.01
 * takes the pressure of a dense bed to a multiple. */
static bool has_dense(const struct two_fluid *sim) {
  const struct two_fluid_closure *c = &sim->closure;
  double dense = 0;
  if (c->set != TWO_FLUID_CRITICAL_STATE) return false;
  for (int32_t i = 0; i < sim->grid.mesh->nleaves; i++) {
    const double alpha = sim->alpha->v[i];
    if (alpha > c->param[TWO_FLUID_CS_PHI_C] && alpha > sim->phi_p->v[i])
      dense = 1;
  }
  return mesh_max(sim->grid.mesh, dense) > 0;
}

/* Return the dt in which waves of grains under fluid cross a leaf of the
 * finest: grains move, with what they weigh, before their weight is felt. */
static double wave_bound(const struct two_fluid *sim) {
  const struct params *params = sim->params;
  const double h = params->size / exp2(sim->grid.mesh->level_finest);
  const double buoyancy =
      two_fluid_density(sim, TWO_FLUID_F) / two_fluid_density(sim, TWO_FLUID_S);
  const double g = (1 - buoyancy) * params_gravity(params);
  const double part = has_dense(sim) ? WAVE_DENSE : WAVE;
  return g > 0 ? part * sqrt(h / g) : HUGE_VAL;
}

double two_fluid_time_step(const struct two_fluid *sim, double dt_max) {
  const struct params *params = sim->params;
  double dt = min2(dt_max, params->dt_max);
  const double rate = two_fluid_rate(sim), change = change_rate(sim);
  if (rate > 0) dt = min2(dt, params->cfl / rate);
  if (change > 0) dt = min2(dt, DT_CHANGE / change);
  const double wave = wave_bound(sim);
  dt = min2(dt, wave);
  dt =
      min2(dt, sim->model.dt > 0 ? DT_GROWTH * sim->model.dt : DT_FIRST * wave);
  return dt < dt_max && dt_max < 2 * dt ? 0.5 * dt_max : dt;
}
