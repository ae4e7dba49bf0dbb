/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/two_phase/viscous_work.h"

#include "talus/two_phase/state.h"

static bool boundaries_move(const struct two_phase *sim) {
  bool move = false;
  for (int patch = 0; patch < MESH_MAX_PATCHES; patch++) {
    for (int e = 0; e < DIM; e++) {
      move = move || sim->u[e]->bc[patch].value != 0;
    }
  }
  return move;
}

/* Sum the power of closed boundaries on grains (power[0]) and gas of this rank,
 * from the viscous stress there. u is filled. */
static void boundary_power(const struct two_phase *sim, const double density[2],
                           double power[2]) {
  const struct mesh *mesh = sim->grid.mesh;
  for (int d = 0; d < DIM; d++) {
    for (int32_t f = mesh->face_begin[d]; f < mesh->face_begin[d + 1]; f++) {
      const int patch = mesh->face_patch[f];
      if (patch < 0 || !sim->grid.closed[patch]) continue;
      const int32_t *node = mesh->face_node[f], i = mesh->face_owner[f];
      const double out = node[0] == i ? 1 : -1, c = sim->c->v[i];
      const double area = mesh_face_area(mesh, f);
      double sum = 0;
      for (int e = 0; e < DIM; e++) {
        const double *u = sim->u[e]->v, wall = sim->u[e]->bc[patch].value;
        const double eta = (e == d ? 2 : 1) * sim->eta_f->v[f];
        const double stress =
            mesh_slope(mesh, f, eta * (u[node[1]] - u[node[0]])) +
            (sim->exact ? sim->yield.s[e]->v[f] : 0);
        sum += out * area * wall * stress;
      }
      power[0] += c * density[0] / sim->rho->v[i] * sum;
      power[1] += (1 - c) * density[1] / sim->rho->v[i] * sum;
    }
  }
}

/* Sum the power of viscosity on grains and gas of this rank. */
static void viscous_power(const struct two_phase *sim, double dt,
                          const double density[2], double power[2]) {
  const struct mesh *mesh = sim->grid.mesh;
  for (int e = 0; e < DIM; e++) {
    const double *g = sim->g[e]->v, *v = sim->viscous_g[e]->v;
    const double *f = sim->wall[e] ? sim->wall[e]->v : NULL;
    for (int32_t i = 0; i < mesh->nleaves; i++) {
      const double u = sim->u[e]->v[i], c = sim->c->v[i];
      const double walls = f ? f[i] / sim->rho->v[i] : 0;
      const double mean = u - 0.5 * dt * (g[i] + v[i] + walls);
      const double each = v[i] * mean * mesh_volume(mesh, i);
      power[0] += c * density[0] * each;
      power[1] += (1 - c) * density[1] * each;
    }
  }
}

void viscous_work_add(struct two_phase *sim, double dt) {
  double density[2], lost[2] = {0}, brought[2] = {0};
  two_phase_densities(sim, density);
  viscous_power(sim, dt, density, lost);
  if (boundaries_move(sim)) {
    field_fill_many(sim->grid.mesh, DIM, sim->u);
    boundary_power(sim, density, brought);
  }
  sim->energy.dissipated += dt * mesh_sum(sim->grid.mesh, brought[0] - lost[0]);
  sim->energy.gas_dissipated +=
      dt * mesh_sum(sim->grid.mesh, brought[1] - lost[1]);
}
