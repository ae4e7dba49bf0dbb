/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/two_phase/measure.h"

#include <math.h>

#include "talus/error.h"
#include "talus/memory.h"
#include "talus/minmax.h"
#include "talus/two_phase/closure_fields.h"
#include "talus/two_phase/fractions.h"
#include "talus/two_phase/state.h"
#include "talus/vof.h"

/* A compensated sum: value + rest is the sum to twice the precision. */
struct sum {
  double value, rest;
};

static inline void sum_add(struct sum *sum, double x) {
  double t = sum->value + x, added = t - sum->value;
  sum->rest += (sum->value - (t - added)) + (x - added);
  sum->value = t;
}

/* Return the sum over all ranks, always in the same order. */
static double sum_total(const struct mesh *mesh, struct sum local) {
  struct sum *all = MEM_NEW(struct sum, (size_t)mesh->nranks);
  MPI_CHECK(
      MPI_Allgather(&local, 2, MPI_DOUBLE, all, 2, MPI_DOUBLE, mesh->comm));
  struct sum total = {0, 0};
  for (int r = 0; r < mesh->nranks; r++) {
    sum_add(&total, all[r].value);
    sum_add(&total, all[r].rest);
  }
  mem_free(all);
  return total.value + total.rest;
}

/* Return the centre along axis d of what lies below the plane in a cell of
 * width 1, seen from the centre of the cell: 1/2 - int m(s) ds / m(1/2), where
 * m(s) is the volume at x_d < s. Simpson's rule, good to 1e-3. */
static double centroid(const struct mesh *mesh, int32_t leaf,
                       const double normal[DIM], double alpha, int d) {
  static const double weight[] = {1, 4, 2, 4, 1};
  double lo[DIM], hi[DIM], integral = 0, volume = 0;
  for (int k = 0; k < DIM; k++) {
    lo[k] = -0.5;
    hi[k] = 0.5;
  }
  for (int k = 1; k <= 4; k++) {
    hi[d] = -0.5 + 0.25 * k;
    volume = 0.25 * k * vof_part(mesh, leaf, normal, alpha, lo, hi);
    integral += weight[k] * volume / 12;
  }
  return volume > 0 ? 0.5 - integral / volume : 0;
}

/* Return g.x at the centre of the grains of a leaf. */
static double leaf_potential(const struct mesh *mesh, const double *c,
                             const double *gravity, int32_t i) {
  double potential = 0, normal[DIM], alpha;
  for (int d = 0; d < DIM; d++) potential += gravity[d] * mesh->x[i][d];
  if (c[i] < DROPLETS_THRESHOLD || c[i] > 1 - DROPLETS_THRESHOLD)
    return potential;
  vof_plane(mesh, c, i, normal, &alpha);
  for (int d = 0; d < DIM; d++)
    if (gravity[d] != 0)
      potential +=
          gravity[d] * mesh->h[i] * centroid(mesh, i, normal, alpha, d);
  return potential;
}

/* Sum up the grains that were in and around leaf i before c was synchronised,
 * and their momentum. u is filled. */
static double grains_around(const struct two_phase *sim, int32_t i,
                            double momentum[DIM]) {
  const int32_t *stencil = sim->grid.mesh->stencil[i];
  double grains = 0;
  for (int e = 0; e < DIM; e++) momentum[e] = 0;
  for (int s = 0; s < NSTENCIL; s++) {
    const double c = max2(sim->c_before[stencil[s]], 0);
    grains += c;
    for (int e = 0; e < DIM; e++) momentum[e] += c * sim->u[e]->v[stencil[s]];
  }
  return grains;
}

/* Return |u|^2 of the grains of leaf i. Those that have entered as c was
 * synchronised bring the velocity of the grains around: the leaf may have held
 * gas alone, which moves otherwise. */
static double speed_squared(const struct two_phase *sim,
                            const double density[2], int32_t i) {
  const double c = sim->c->v[i];
  const double entered = sim->c_before ? max2(c - sim->c_before[i], 0) : 0;
  const double rho = c * density[0] + (1 - c) * density[1];
  double momentum[DIM], sum = 0;
  const double around = entered > 0 ? grains_around(sim, i, momentum) : 0;
  for (int e = 0; e < DIM; e++) {
    double u = sim->u[e]->v[i];
    if (around > 0)
      u += entered * density[0] / rho * (momentum[e] / around - u);
    sum += u * u;
  }
  return sum;
}

static void measure_sums(const struct two_phase *sim, const double *c,
                         struct diagnostics *diagnostics) {
  const struct mesh *mesh = sim->grid.mesh;
  double density[2];
  struct sum volume = {0, 0}, kinetic = {0, 0}, potential = {0, 0};
  struct sum gas = {0, 0};
  double fastest = 0;
  two_phase_densities(sim, density);
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    double u2 = 0, whole = 0, all = mesh_volume(mesh, i), v = c[i] * all;
    for (int d = 0; d < DIM; d++) {
      u2 += sim->u[d]->v[i] * sim->u[d]->v[i];
      whole += sim->params->gravity[d] * mesh->x[i][d];
    }
    const double grains =
        c[i] == 0 ? 0 : v * leaf_potential(mesh, c, sim->params->gravity, i);
    sum_add(&gas, density[1] * (0.5 * u2 * (all - v) - all * whole + grains));
    if (c[i] == 0) continue;
    sum_add(&volume, v);
    sum_add(&kinetic, 0.5 * density[0] * speed_squared(sim, density, i) * v);
    sum_add(&potential, -density[0] * grains);
    if (c[i] > 0.5) fastest = max2(fastest, u2);
  }
  diagnostics->volume = sum_total(mesh, volume);
  diagnostics->kinetic = sum_total(mesh, kinetic);
  diagnostics->potential = sum_total(mesh, potential);
  diagnostics->gas = sum_total(mesh, gas);
  diagnostics->max_speed = sqrt(mesh_max(mesh, fastest));
}

double diagnostics_flowing(struct two_phase *sim) {
  const struct mesh *mesh = sim->grid.mesh;
  double sum[2] = {0}, *state;
  if (!sim->exact) return 1;
  state = MEM_NEW(double, mesh->nleaves);
  yield_find_state(&sim->yield, sim->c->v, state);
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    const double grains = sim->c->v[i] * mesh_volume(mesh, i);
    sum[0] += grains * state[i];
    sum[1] += grains;
  }
  mem_free(state);
  const double flowing = mesh_sum(mesh, sum[0]);
  const double volume = mesh_sum(mesh, sum[1]);
  return volume > 0 ? flowing / volume : 0;
}

double diagnostics_gas(const struct two_phase *sim) {
  struct diagnostics diagnostics;
  field_fill(sim->grid.mesh, sim->c);
  field_fill_many(sim->grid.mesh, DIM, sim->u);
  measure_sums(sim, sim->c->v, &diagnostics);
  return diagnostics.gas;
}

void diagnostics_energy(const struct two_phase *sim, double *kinetic,
                        double *potential) {
  struct diagnostics diagnostics;
  field_fill(sim->grid.mesh, sim->c);
  field_fill_many(sim->grid.mesh, DIM, sim->u);
  measure_sums(sim, sim->c->v, &diagnostics);
  *kinetic = diagnostics.kinetic;
  *potential = diagnostics.potential;
}

void diagnostics_measure(const struct two_phase *sim,
                         struct diagnostics *diagnostics) {
  const struct mesh *mesh = sim->grid.mesh;
  const double *c = sim->c->v;
  bool *heap = MEM_NEW(bool, (size_t)mesh->nleaves);
  *diagnostics = (struct diagnostics){.heap = heap};
  diagnostics->shear_rate = closure_fields_shear_rate(sim); /* fills c, u */
  measure_sums(sim, c, diagnostics);
  droplets_find(mesh, c, heap, &diagnostics->droplets);
  outline_measure(mesh, c, heap, outline_axis(sim->params->gravity),
                  &diagnostics->outline);
  diagnostics->height = outline_height(&diagnostics->outline);
  diagnostics->front =
      outline_front(&diagnostics->outline, sim->params->front_height);
}

void diagnostics_measure_layers(struct two_phase *sim,
                                struct diagnostics *diagnostics) {
  const struct mesh *mesh = sim->grid.mesh;
  const double *c = sim->c->v;
  double *part = MEM_NEW(double, (size_t)mesh->nleaves);
  for (int k = 0; k < sim->params->ntracers; k++) {
    struct outline outline;
    fractions_read_tracer(sim, k, part);
    for (int32_t i = 0; i < mesh->nleaves; i++) part[i] = min2(part[i], c[i]);
    outline_measure(mesh, part, diagnostics->heap,
                    outline_axis(sim->params->gravity), &outline);
    diagnostics->layer[k] = outline.height;
  }
  mem_free(part);
}

void diagnostics_free(struct diagnostics *diagnostics) {
  outline_free(&diagnostics->outline);
  mem_free(diagnostics->heap);
  for (int k = 0; k < PARAMS_MAX_TRACERS; k++) mem_free(diagnostics->layer[k]);
}
