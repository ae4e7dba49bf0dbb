/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/closure_fields.h"

#include <math.h>

#include "talus/field.h"
#include "talus/params.h"
#include "talus/rheology.h"
#include "talus/simulation.h"

static inline bool is_grains(double c) { return c >= 0.5; }

/* du_e/dx_t of leaf i; grains look at grains only, on one side if need be. */
static double slope(const struct mesh *mesh, const double *c, const double *u,
                    int32_t i, int t) {
  const int32_t *stencil = mesh->stencil[i];
  const int32_t low = stencil[STENCIL_CENTRE - stencil_step(t)];
  const int32_t high = stencil[STENCIL_CENTRE + stencil_step(t)];
  const bool gas = !is_grains(c[i]);
  const bool lower = gas || is_grains(c[low]);
  const bool upper = gas || is_grains(c[high]);
  const double difference = (upper ? u[high] : u[i]) - (lower ? u[low] : u[i]);
  return lower || upper ? difference / (mesh->h[i] * (lower + upper)) : 0;
}

static double leaf_shear_rate(const struct mesh *mesh, const double *c,
                              struct field *const u[DIM], int32_t i) {
  double grad[DIM][DIM], sum = 0;
  for (int e = 0; e < DIM; e++) {
    for (int t = 0; t < DIM; t++) grad[e][t] = slope(mesh, c, u[e]->v, i, t);
  }
  for (int e = 0; e < DIM; e++) {
    sum += 2 * grad[e][e] * grad[e][e];
    for (int t = e + 1; t < DIM; t++) {
      sum += (grad[e][t] + grad[t][e]) * (grad[e][t] + grad[t][e]);
    }
  }
  return sqrt(sum);
}

double closure_fields_shear_rate(const struct simulation *sim) {
  const struct mesh *mesh = sim->mesh;
  double sum[2] = {0};
  field_fill_many(mesh, DIM, sim->u);
  field_fill(mesh, sim->c);
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    const double grains = sim->c->v[i] * mesh->volume[i];
    sim->shear_rate->v[i] = leaf_shear_rate(mesh, sim->c->v, sim->u, i);
    sum[0] += grains * sim->shear_rate->v[i];
    sum[1] += grains;
  }
  const double total = mesh_sum(mesh, sum[0]), volume = mesh_sum(mesh, sum[1]);
  return volume > 0 ? total / volume : 0;
}

void closure_fields_update(const struct simulation *sim) {
  const struct rheology *grains = &sim->params->grains.rheology;
  const int32_t n = sim->mesh->nleaves;
  closure_fields_shear_rate(sim);
  for (int k = 0; k < sim->nknown; k++) {
    double *known = sim->known[k]->v;
    rheology_output(grains, k, n, sim->shear_rate->v, sim->p->v, known);
    for (int32_t i = 0; i < n; i++) {
      if (!is_grains(sim->c->v[i])) known[i] = 0;
    }
  }
}
