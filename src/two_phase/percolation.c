/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/two_phase/percolation.h"

#include <math.h>
#include <string.h>

#include "talus/clean.h"
#include "talus/droplets.h"
#include "talus/error.h"
#include "talus/memory.h"
#include "talus/minmax.h"
#include "talus/poisson.h"
#include "talus/two_phase/fractions.h"
#include "talus/two_phase/state.h"
#include "talus/vof.h"

/* Part of its gas that a leaf may give in one step. */
#define PART 0.5
/* Leaves that give less than this part of their volume wait for the next
 * search; less than the second is never worth the sweeps. */
#define LEAST 1e-3
#define TRACE 1e-6
/* psi is good enough within this part of the largest q: clean_to_source does
 * the rest. */
#define TOLERANCE 0.05
/* Sets with less than this part of the gas are no free gas of a closed box. */
#define SMALL_SET 0.1

/* Return g.x at a leaf; gravity along a periodic axis has no potential. */
static double gravity_potential(const struct two_phase *sim, int32_t i) {
  const struct params *params = sim->params;
  double sum = 0;
  for (int d = 0; d < DIM; d++) {
    if (params->boundary[2 * d].type == BOUNDARY_PERIODIC) continue;
    sum += params->gravity[d] * sim->grid.mesh->x[i][d];
  }
  return sum;
}

/* Return the pressure less the weight of the gas. */
static double reduced_pressure(const struct two_phase *sim, int32_t i) {
  return sim->p->v[i] - sim->params->gas.density * gravity_potential(sim, i);
}

static bool is_at_opening(const struct two_phase *sim, int32_t i) {
  const struct mesh *mesh = sim->grid.mesh;
  for (int f = 0; f < NFACE; f++) {
    const int32_t face = mesh->cell_face[i][f];
    const int patch = face < mesh->nfaces ? mesh->face_patch[face] : -1;
    if (patch >= 0 && sim->grid.open[patch]) return true;
  }
  return false;
}

/* Numbers of a set of gas. */
enum { SET_OPEN, SET_VOLUME, SET_PRESSURE, SET_SIZE };

static void measure_sets(const struct two_phase *sim, const int32_t *set, int n,
                         double (*sum)[SET_SIZE]) {
  const struct mesh *mesh = sim->grid.mesh;
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    if (set[i] < 0) continue;
    const double volume = mesh_volume(mesh, i);
    sum[set[i]][SET_OPEN] += is_at_opening(sim, i);
    sum[set[i]][SET_VOLUME] += volume;
    sum[set[i]][SET_PRESSURE] += volume * reduced_pressure(sim, i);
  }
  MPI_CHECK(MPI_Allreduce(MPI_IN_PLACE, sum, n * SET_SIZE, MPI_DOUBLE, MPI_SUM,
                          mesh->comm));
}

/* Choose which of n sets are free gas. */
static void choose_free(int n, double (*sum)[SET_SIZE], bool *is_free) {
  double gas = 0, open = 0;
  int lowest = -1;
  for (int k = 0; k < n; k++) {
    gas += sum[k][SET_VOLUME];
    open += sum[k][SET_OPEN];
  }
  for (int k = 0; k < n; k++) {
    is_free[k] = sum[k][SET_OPEN] > 0;
    if (!(sum[k][SET_VOLUME] > SMALL_SET * gas)) continue;
    if (lowest < 0 || sum[k][SET_PRESSURE] * sum[lowest][SET_VOLUME] <
                          sum[lowest][SET_PRESSURE] * sum[k][SET_VOLUME]) {
      lowest = k;
    }
  }
  if (open == 0 && lowest >= 0) is_free[lowest] = true;
}

/* Set solid [ncells], filled, to c, and to 1 in leaves of gas that is not
 * free; remember whether there are any. */
static void fill_pockets(struct two_phase *sim, double *solid) {
  const struct mesh *mesh = sim->grid.mesh;
  const struct bc *bc[] = {sim->c->bc};
  double *pure = scratch_take_one(&sim->scratch, FIELD_CELL, __func__);
  int32_t *set = MEM_NEW(int32_t, (size_t)mesh->nleaves);
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    pure[i] = sim->c->v[i] < PERCOLATION_PURE;
  }
  const int n = droplets_number(mesh, pure, 0.5, set);
  scratch_give(&sim->scratch, __func__);
  double(*sum)[SET_SIZE] = mem_alloc((size_t)n + 1, sizeof *sum);
  bool *is_free = MEM_NEW(bool, (size_t)n + 1);
  measure_sets(sim, set, n, sum);
  choose_free(n, sum, is_free);
  sim->percolation.pockets = 0;
  for (int k = 0; k < n; k++) {
    if (sum[k][SET_VOLUME] > 0 && !is_free[k]) sim->percolation.pockets++;
  }
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    solid[i] = set[i] >= 0 && !is_free[set[i]] ? 1 : sim->c->v[i];
  }
  mesh_fill(mesh, 1, &solid, bc, false);
  mem_free(is_free);
  mem_free(sum);
  mem_free(set);
}

/* Set reach [ncells], filled, to 1 in leaves with gas that meets the free gas:
 * in their stencil, or next to a leaf with little grains that has it there, as
 * at the bottom of a valley. Returns whether other leaves hold gas. */
static bool find_reach(const struct two_phase *sim, const double *solid,
                       double *reach) {
  static const struct bc neumann[MESH_MAX_PATCHES];
  const struct bc *bc[] = {neumann};
  const struct mesh *mesh = sim->grid.mesh;
  double others = 0;
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    double least = solid[i];
    reach[i] = 0;
    if (!(solid[i] < 1 - VOF_EMPTY) && !(sim->c->v[i] < 1 - VOF_EMPTY)) {
      continue;
    }
    for (int s = 0; s < NSTENCIL && !(least < PERCOLATION_PURE); s++) {
      least = min2(least, solid[mesh->stencil[i][s]]);
    }
    reach[i] = least < PERCOLATION_PURE || is_at_opening(sim, i);
    others += !(reach[i] > 0);
  }
  if (mesh_max(mesh, others) == 0) return false;
  mesh_fill(mesh, 1, &reach, bc, true);
  return true;
}

static bool is_enclosed(const struct two_phase *sim, const double *solid,
                        const double *reach, int32_t i) {
  const int32_t *stencil = sim->grid.mesh->stencil[i];
  double most = 0;
  if (!(sim->c->v[i] < 1 - VOF_EMPTY) || reach[i] > 0) return false;
  for (int f = 0; f < NFACE; f++) {
    const int32_t node = stencil[stencil_face(f)];
    if (reach[node] > 0 && solid[node] < 0.5) return false;
  }
  for (int s = 0; s < NSTENCIL; s++) {
    most = max2(most, sim->c->v[stencil[s]]);
  }
  return most > 0.5;
}

/* Return the largest speed of the grains around leaf i; u filled. */
static double speed_around(const struct two_phase *sim, int32_t i) {
  double most = 0;
  for (int s = 0; s < NSTENCIL; s++) {
    const int32_t node = sim->grid.mesh->stencil[i][s];
    double u2 = 0;
    if (!(sim->c->v[node] > 0.5)) continue;
    for (int e = 0; e < DIM; e++) u2 += sim->u[e]->v[node] * sim->u[e]->v[node];
    most = max2(most, u2);
  }
  return sqrt(most);
}

/* Gas that may take more: its volume, and the mean of its reduced pressure. */
struct free_gas {
  double volume, pressure;
};

static struct free_gas find_free_gas(const struct two_phase *sim,
                                     const double *solid) {
  const struct mesh *mesh = sim->grid.mesh;
  double sum[2] = {0};
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    if (!(solid[i] < 0.5)) continue;
    const double volume = (1 - sim->c->v[i]) * mesh_volume(mesh, i);
    sum[0] += volume;
    sum[1] += volume * reduced_pressure(sim, i);
  }
  MPI_CHECK(
      MPI_Allreduce(MPI_IN_PLACE, sum, 2, MPI_DOUBLE, MPI_SUM, mesh->comm));
  return (struct free_gas){sum[0], sum[0] > 0 ? sum[1] / sum[0] : 0};
}

/* Set q [nleaves] to the sinks of enclosed leaves, else 0; returns the largest
 * part of its volume that a leaf gives. */
static double set_sinks(const struct two_phase *sim, double dt,
                        const double *solid, const double *reach,
                        double pressure, double *q) {
  const struct mesh *mesh = sim->grid.mesh;
  double most = 0, gravity = 0;
  for (int d = 0; d < DIM; d++) {
    gravity = max2(gravity, fabs(sim->params->gravity[d]));
  }
  field_fill_many(mesh, DIM, sim->u);
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    q[i] = 0;
    if (!is_enclosed(sim, solid, reach, i)) continue;
    if (!(reduced_pressure(sim, i) > pressure)) continue;
    const double fall = speed_around(sim, i) + sqrt(gravity * mesh->h[i]);
    const double part =
        min2(PART * (1 - sim->c->v[i]), mesh_edges(mesh, i, dt * fall));
    q[i] = -part / dt;
    most = max2(most, part);
  }
  return mesh_max(mesh, most);
}

/* Give what the sinks take to the free gas. */
static void balance_sinks(const struct mesh *mesh, const double *c,
                          const double *solid, double *q) {
  double sum[2] = {0}; /* taken, free gas */
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    const double volume = mesh_volume(mesh, i);
    if (q[i] < 0) {
      sum[0] -= q[i] * volume;
    } else if (solid[i] < 0.5) {
      sum[1] += (1 - c[i]) * volume;
    }
  }
  MPI_CHECK(
      MPI_Allreduce(MPI_IN_PLACE, sum, 2, MPI_DOUBLE, MPI_SUM, mesh->comm));
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    if (q[i] < 0 || !(solid[i] < 0.5)) continue;
    q[i] = sum[1] > 0 ? (1 - c[i]) * sum[0] / sum[1] : 0;
  }
}

/* Set w to grad psi with div w about q. */
static void solve_velocity(struct two_phase *sim, double most, double *w) {
  const struct mesh *mesh = sim->grid.mesh;
  double *psi = scratch_take_one(&sim->scratch, FIELD_CELL, __func__);
  double *alpha = scratch_take_one(&sim->scratch, FIELD_FACE, __func__);
  struct bc bc[MESH_MAX_PATCHES];
  memcpy(bc, sim->p->bc, sizeof bc);
  for (int k = 0; k < MESH_MAX_PATCHES; k++) bc[k].value = 0;
  for (int32_t f = 0; f < mesh->nfaces; f++) {
    const int patch = mesh->face_patch[f];
    alpha[f] = !(patch >= 0 && sim->grid.closed[patch]);
  }
  mesh_fill_faces(mesh, 1, &alpha);
  memset(psi, 0, (size_t)mesh->ncells * sizeof *psi);
  poisson_solve(mesh, sim->grid.hierarchy, alpha, NULL, NULL, sim->source->v,
                bc, TOLERANCE * most, sim->params->max_iterations, psi);
  poisson_flux(mesh, alpha, psi, w);
  scratch_give(&sim->scratch, __func__);
}

/* Bind what a leaf gives by the gas that w leaves in it. */
static void limit_sinks(const struct two_phase *sim, double dt, double *q) {
  const struct mesh *mesh = sim->grid.mesh;
  const double *w = sim->carrier->v;
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    double out = 0;
    if (!(q[i] < 0)) continue;
    for (int f = 0; f < NFACE; f++) {
      out += max2(0, (f & 1 ? 1 : -1) * mesh_side(mesh, w, i, f));
    }
    const double gas = (1 - sim->c->v[i]) / dt - out / mesh_width(mesh, i);
    q[i] = -min2(-q[i], max2(gas, 0));
  }
}

/* Add the volume and the speed of what passes, and how far it moves the
 * surface. */
static void add_passage(struct two_phase *sim, double dt) {
  const struct mesh *mesh = sim->grid.mesh;
  const double *q = sim->source->v, *w = sim->carrier->v;
  double sum[2] = {0}, travel = 0;
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    const double given = -min2(q[i], 0) * dt * mesh_volume(mesh, i);
    sum[0] += given;
    sum[1] -= given * min2(q[i], 0) * mesh_width(mesh, i);
    for (int f = 0; f < NFACE && vof_is_cut(sim->c->v[i]); f++) {
      const double speed = fabs(w[mesh->cell_face[i][f]]);
      travel = max2(travel, mesh_edges(mesh, i, speed * dt));
    }
  }
  MPI_CHECK(
      MPI_Allreduce(MPI_IN_PLACE, sum, 2, MPI_DOUBLE, MPI_SUM, mesh->comm));
  sim->percolation.volume += sum[0];
  sim->percolation.flow += sum[1];
  sim->travel += mesh_max(mesh, travel);
}

/* Return the potential energy of the grains of this rank, by the centres of
 * leaves. */
static double potential(const struct two_phase *sim) {
  double sum = 0;
  for (int32_t i = 0; i < sim->grid.mesh->nleaves; i++) {
    sum -= sim->c->v[i] * mesh_volume(sim->grid.mesh, i) *
           gravity_potential(sim, i);
  }
  return sim->params->grains.density * sum;
}

/* Find the source of gas and the velocity that carries it; returns whether
 * there is enough. */
static bool find_carrier(struct two_phase *sim, double dt, double *solid,
                         double *reach) {
  const struct mesh *mesh = sim->grid.mesh;
  const bool search =
      sim->model.step % PERCOLATION_EVERY == 0 || sim->percolation.pockets > 0;
  const bool thorough = sim->model.step % PERCOLATION_EVERY == 0;
  double *q = sim->source->v, *w = sim->carrier->v;
  field_fill(mesh, sim->c);
  if (search) {
    fill_pockets(sim, solid);
  } else {
    solid = sim->c->v;
  }
  if (!find_reach(sim, solid, reach)) return false;
  const struct free_gas gas = find_free_gas(sim, solid);
  if (gas.volume == 0 && !sim->grid.pressure_set) return false;
  const double most = set_sinks(sim, dt, solid, reach, gas.pressure, q);
  if (most < (thorough ? TRACE : LEAST)) return false;
  balance_sinks(mesh, sim->c->v, solid, q);
  solve_velocity(sim, most / dt, w);
  clean_to_source(sim->grid.clean, mesh, sim->grid.open, q, w);
  enum { ROUNDS = 3 };
  for (int k = 0; k < ROUNDS; k++) {
    limit_sinks(sim, dt, q);
    balance_sinks(mesh, sim->c->v, solid, q);
    clean_to_source(sim->grid.clean, mesh, sim->grid.open, q, w);
  }
  return true;
}

void percolation_advance(struct two_phase *sim, double dt) {
  double *work[2];
  if (!sim->source || dt == 0) return;
  scratch_take(&sim->scratch, FIELD_CELL, __func__, 2, work);
  const bool flows = find_carrier(sim, dt, work[0], work[1]);
  scratch_give(&sim->scratch, __func__);
  if (!flows) return;
  add_passage(sim, dt);
  const double energy = potential(sim);
  fractions_carry(sim, dt, sim->carrier->v, sim->source->v);
  sim->energy.dissipated += mesh_sum(sim->grid.mesh, energy - potential(sim));
}

double percolation_permeability(const struct two_phase *sim) {
  const double shear_rate = 1, pressure = 0;
  const double g = params_gravity(sim->params);
  double eta;
  if (!(sim->percolation.volume > 0)) return 0;
  if (g == 0) return 0;
  rheology_eval(&sim->params->gas.rheology, sim->model.time, 1, &shear_rate,
                &pressure, &eta);
  return eta * sim->percolation.flow / sim->percolation.volume /
         (sim->params->grains.density * g);
}
