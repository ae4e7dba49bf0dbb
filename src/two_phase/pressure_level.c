/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/two_phase/pressure_level.h"

#include <math.h>

#include "talus/error.h"
#include "talus/two_phase/properties.h"
#include "talus/two_phase/state.h"

/* Less gas than this part of the box is none. */
#define NO_GAS 1e-9

/* Mean of p, and the volume it is taken over. */
struct mean {
  double value, volume;
};

static struct mean mean_of(const struct mesh *mesh, double sum, double volume) {
  const double all = mesh_sum(mesh, volume);
  return (struct mean){mesh_sum(mesh, sum) / (all > 0 ? all : 1), all};
}

static double mean_over_box(const struct two_phase *sim) {
  const struct mesh *mesh = sim->grid.mesh;
  double sum = 0, volume = 0;
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    sum += sim->p->v[i] * mesh_volume(mesh, i);
    volume += mesh_volume(mesh, i);
  }
  return mean_of(mesh, sum, volume).value;
}

/* Return the weight of a column of gas from the highest corner of the box down
 * to x. */
static double weight_above(const struct params *params, const double x[DIM]) {
  double weight = 0;
  for (int d = 0; d < DIM; d++) {
    const double g = params->gravity[d], low = params->origin[d];
    const double high = low + params->size * params->trees[d];
    if (params->boundary[2 * d].type == BOUNDARY_PERIODIC) continue;
    weight += params->gas.density * g * (x[d] - (g > 0 ? low : high));
  }
  return weight;
}

static double mean_over_gas(const struct two_phase *sim) {
  const struct mesh *mesh = sim->grid.mesh;
  double sum = 0, volume = 0, all_sum = 0, all_volume = 0, box = 0;
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    const double gas = (1 - sim->c->v[i]) * mesh_volume(mesh, i);
    const double p = sim->p->v[i] - weight_above(sim->params, mesh->x[i]);
    const bool pure = sim->c->v[i] < PARAMS_GAS;
    sum += pure ? gas * p : 0;
    volume += pure ? gas : 0;
    all_sum += gas * p;
    all_volume += gas;
    box += mesh_volume(mesh, i);
  }
  const struct mean pure = mean_of(mesh, sum, volume);
  const struct mean all = mean_of(mesh, all_sum, all_volume);
  if (pure.volume > 0) return pure.value;
  if (all.volume > NO_GAS * mesh_sum(mesh, box)) return all.value;
  WARN_ONCE(
      "the grains fill the box, so boundary.pressure_level, meant for the gas, "
      "becomes the mean pressure of the box, with the weight of the grains in "
      "it: give the pressure at a point, pressure_level = {%g, at = {...}}",
      sim->params->pressure_level);
  return mean_over_box(sim);
}

/* Return p at x, extrapolated from leaf i and the differences to its neighbours
 * inside the box; exact if p is linear. p filled. */
static double extrapolate(const struct two_phase *sim, int32_t i,
                          const double x[DIM]) {
  const struct mesh *mesh = sim->grid.mesh;
  const double *p = sim->p->v;
  double value = p[i];
  for (int d = 0; d < DIM; d++) {
    double slope = 0;
    int n = 0;
    for (int side = 0; side < 2; side++) {
      const int32_t next = mesh->stencil[i][stencil_face(2 * d + side)];
      if (next >= mesh->begin_boundary) continue; /* a mirror, not a value */
      slope += side ? p[next] - p[i] : p[i] - p[next];
      n++;
    }
    slope = n > 0 ? slope / n * (x[d] - mesh->x[i][d]) : 0;
    value += mesh_leaf_slope(mesh, i, slope);
  }
  return value;
}

/* Return the mean of what the leaves that touch the point say. */
static double value_at_point(struct two_phase *sim) {
  const struct mesh *mesh = sim->grid.mesh;
  const double *x = sim->params->pressure_point;
  double sum = 0, count = 0;
  field_fill(mesh, sim->p);
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    double away = 0; /* in edges */
    for (int d = 0; d < DIM; d++) {
      away = fmax(away, mesh_edges(mesh, i, fabs(x[d] - mesh->x[i][d])));
    }
    if (away > 0.5 * (1 + 1e-9)) continue;
    sum += extrapolate(sim, i, x);
    count++;
  }
  const struct mean mean = mean_of(mesh, sum, count);
  CHECK(mean.volume > 0, "no leaf holds the point of the pressure level");
  return mean.value;
}

void pressure_level_set(struct two_phase *sim) {
  const struct params *params = sim->params;
  double now = 0;
  if (sim->grid.pressure_set) return;
  switch (params->pressure_at) {
    case PRESSURE_AT_BOX:
      now = mean_over_box(sim);
      break;
    case PRESSURE_AT_GAS:
      now = mean_over_gas(sim);
      break;
    case PRESSURE_AT_POINT:
      now = value_at_point(sim);
      break;
  }
  const double shift = params->pressure_level - now;
  for (int32_t i = 0; i < sim->grid.mesh->nleaves; i++) sim->p->v[i] += shift;
  mesh_touch(sim->grid.mesh, sim->p->v);
}
