/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/two_phase/closure_fields.h"

#include <math.h>

#include "talus/field.h"
#include "talus/memory.h"
#include "talus/params.h"
#include "talus/rheology.h"
#include "talus/strain.h"
#include "talus/two_phase/state.h"

static inline bool is_grains(double c) { return c >= 0.5; }

/* Find du_e/dx_t of leaf i for all e; grains look at grains only, on one side
 * if need be. */
static void slopes(const struct mesh *mesh, const double *c,
                   double *const u[DIM], int32_t i, int t, double grad[DIM]) {
  const int32_t *stencil = mesh->stencil[i];
  const int32_t low = stencil[STENCIL_CENTRE - stencil_step(t)];
  const int32_t high = stencil[STENCIL_CENTRE + stencil_step(t)];
  const bool gas = !is_grains(c[i]);
  const bool lower = gas || is_grains(c[low]);
  const bool upper = gas || is_grains(c[high]);
  const int32_t from = lower ? low : i, to = upper ? high : i;
  const double k = mesh_leaf_slope(mesh, i, lower && upper ? 0.5 : 1);
  for (int e = 0; e < DIM; e++) grad[e] = k * (u[e][to] - u[e][from]);
}

static double leaf_shear_squared(const struct mesh *mesh, const double *c,
                                 double *const u[DIM], int32_t i) {
  double grad[DIM][DIM], sum = 0; /* grad[t][e] = du_e/dx_t */
  for (int t = 0; t < DIM; t++) slopes(mesh, c, u, i, t, grad[t]);
  for (int e = 0; e < DIM; e++) {
    sum += 2 * grad[e][e] * grad[e][e];
    for (int t = e + 1; t < DIM; t++) {
      sum += (grad[e][t] + grad[t][e]) * (grad[e][t] + grad[t][e]);
    }
  }
  const double hoop = mesh_hoop(mesh, u[0], i);
  return sum + 2 * hoop * hoop;
}

/* Set the shear rate of all leaves, [nleaves]. */
static void set_shear_rate(const struct two_phase *sim, double *rate) {
  const struct mesh *mesh = sim->grid.mesh;
  double *u[DIM];
  for (int e = 0; e < DIM; e++) u[e] = sim->u[e]->v;
  field_fill_many(mesh, DIM, sim->u);
  field_fill(mesh, sim->c);
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    rate[i] = leaf_shear_squared(mesh, sim->c->v, u, i);
  }
  for (int32_t i = 0; i < mesh->nleaves; i++) rate[i] = sqrt(rate[i]);
}

double closure_fields_shear_rate(const struct two_phase *sim) {
  const struct mesh *mesh = sim->grid.mesh;
  double sum[2] = {0}, *rate = MEM_NEW(double, mesh->nleaves);
  set_shear_rate(sim, rate);
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    const double grains = sim->c->v[i] * mesh_volume(mesh, i);
    sum[0] += grains * rate[i];
    sum[1] += grains;
  }
  mem_free(rate);
  const double total = mesh_sum(mesh, sum[0]), volume = mesh_sum(mesh, sum[1]);
  return volume > 0 ? total / volume : 0;
}

/* Allocate the array of a field on demand, and return it. */
static double *provide(struct field *field, int32_t n) {
  if (!field->v) field->v = MEM_NEW(double, n);
  return field->v;
}

/* Add the mean of the kept stress over the sides of a leaf that have a yield
 * stress to `stress` [nleaves]. */
static void add_kept_stress(const struct two_phase *sim, double *stress) {
  const struct mesh *mesh = sim->grid.mesh;
  const struct yield *yield = &sim->yield;
  double *rows[STRAIN_ROWS], *face[2]; /* |s|, and 1 where it may be */
  for (int k = 0; k < yield->nrows; k++) rows[k] = yield->s[k]->v;
  for (int k = 0; k < 2; k++) face[k] = MEM_NEW(double, mesh->nfaces_all);
  for (int d = 0; d < DIM; d++) {
    for (int32_t f = mesh->face_begin[d]; f < mesh->face_begin[d + 1]; f++) {
      face[0][f] = sqrt(strain_norm_squared(yield->nrows, rows, d, f));
      face[1][f] = yield->tau_y->v[f] > 0;
    }
  }
  mesh_fill_faces(mesh, 2, face);
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    const double part = mesh_mean(mesh, face[1], i);
    if (part > 0) stress[i] += mesh_mean(mesh, face[0], i) / part;
  }
  for (int k = 0; k < 2; k++) mem_free(face[k]);
}

/* Set the stress [nleaves] of the grains. */
static void set_stress(const struct two_phase *sim, const double *shear_rate,
                       double *stress) {
  const struct rheology *grains = &sim->params->grains.rheology;
  const int32_t n = sim->grid.mesh->nleaves;
  double *tau_y = MEM_NEW(double, n), time = sim->model.time;
  const double *p = sim->p->v;
  if (sim->exact)
    rheology_parts(grains, time, n, shear_rate, p, stress, tau_y);
  else
    rheology_eval(grains, time, n, shear_rate, p, stress);
  for (int32_t i = 0; i < n; i++) stress[i] *= shear_rate[i];
  if (sim->exact) add_kept_stress(sim, stress);
  for (int32_t i = 0; i < n; i++) {
    if (!is_grains(sim->c->v[i])) stress[i] = 0;
  }
  mem_free(tau_y);
}

void closure_fields_update(const struct two_phase *sim) {
  const struct rheology *grains = &sim->params->grains.rheology;
  const int32_t n = sim->grid.mesh->nleaves;
  double *shear_rate = provide(sim->shear_rate, n);
  set_shear_rate(sim, shear_rate);
  set_stress(sim, shear_rate, provide(sim->stress, n));
  for (int k = 0; k < sim->nknown; k++) {
    double *known = provide(sim->known[k], n);
    rheology_output(grains, k, n, shear_rate, sim->p->v, known);
    for (int32_t i = 0; i < n; i++) {
      if (!is_grains(sim->c->v[i])) known[i] = 0;
    }
  }
}

void closure_fields_release(const struct two_phase *sim) {
  for (int k = -2; k < sim->nknown; k++) {
    struct field *field = k < -1  ? sim->stress
                          : k < 0 ? sim->shear_rate
                                  : sim->known[k];
    mem_free(field->v);
    field->v = NULL;
  }
}
