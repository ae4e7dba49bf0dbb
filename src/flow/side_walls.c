/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/side_walls.h"
#include "talus/minmax.h"

#include <math.h>

/* r dt/rho */
#define STIFFNESS 100.

/* Return F, the most that the walls take. */
static double friction(const struct side_walls *walls,
                       const struct side_walls_state *state, int32_t i) {
  const double c = min2(max2(state->c[i], 0), 1);
  return c * 2 * walls->mu * max2(state->p[i], 0) / walls->width;
}

static double norm(const double f[DIM]) {
  double squares = 0;
  for (int d = 0; d < DIM; d++) squares += f[d] * f[d];
  return sqrt(squares);
}

void side_walls_foretell(const struct mesh *mesh,
                         const struct side_walls *walls, double dt,
                         const struct side_walls_state *state,
                         double *const u[DIM], double *const f[DIM],
                         double *mass) {
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    const double rho = state->rho[i], most = friction(walls, state, i);
    double next[DIM];
    for (int d = 0; d < DIM; d++) {
      next[d] = (f[d][i] - STIFFNESS * rho / dt * u[d][i]) / (1 + STIFFNESS);
    }
    const double needed = norm(next);
    const bool held = most > 0 && needed <= most;
    mass[i] = held ? (1 + STIFFNESS) * rho : rho;
    for (int d = 0; d < DIM && !held; d++) {
      f[d][i] = needed > 0 ? next[d] * (most / needed) : 0;
    }
  }
  mesh_touch(mesh, mass);
  for (int d = 0; d < DIM; d++) mesh_touch(mesh, f[d]);
}

void side_walls_advance(const struct mesh *mesh, const struct side_walls *walls,
                        double dt, const struct side_walls_state *state,
                        const double *mass, double *const u[DIM],
                        double *const f[DIM]) {
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    const double r = (mass[i] - state->rho[i]) / dt;
    double next[DIM];
    for (int d = 0; d < DIM; d++) next[d] = f[d][i] - r * u[d][i];
    const double needed = norm(next), most = friction(walls, state, i);
    const double part = needed > most ? most / needed : 1;
    for (int d = 0; d < DIM; d++) f[d][i] = part * next[d];
  }
  for (int d = 0; d < DIM; d++) mesh_touch(mesh, f[d]);
}

double side_walls_power(const struct mesh *mesh, double *const f[DIM],
                        double *const u[DIM]) {
  double sum = 0;
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    for (int d = 0; d < DIM; d++) {
      sum -= f[d][i] * u[d][i] * mesh_volume(mesh, i);
    }
  }
  return mesh_sum(mesh, sum);
}
