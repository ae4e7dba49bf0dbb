/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/four_state/work.h"

#include "talus/four_state/state.h"
#include "talus/minmax.h"

double four_state_work(const struct four_state *sim, double dt,
                       double *const a_0[], double *const a_1[],
                       double *const u[]) {
  const struct mesh *mesh = sim->grid.mesh;
  double sum = 0;
  for (int e = 0; e < DIM; e++) {
    for (int32_t i = 0; i < mesh->nleaves; i++) {
      const double from = a_0 ? a_0[e][i] : 0, to = a_1[e][i];
      const double mean = u[e][i] + 0.5 * dt * (from + to);
      sum += max2(sim->nu->v[i], 0) * mesh_volume(mesh, i) * (to - from) * mean;
    }
  }
  return dt * sim->closure.param[LEE_HUANG_RHO_D] * mesh_sum(mesh, sum);
}

double four_state_fall(const struct four_state *sim, double *const u[]) {
  const struct mesh *mesh = sim->grid.mesh;
  double sum = 0;
  for (int e = 0; e < DIM; e++) {
    const double g = sim->params->gravity[e];
    if (g == 0) continue;
    for (int32_t i = 0; i < mesh->nleaves; i++)
      sum += max2(sim->nu->v[i], 0) * mesh_volume(mesh, i) * g * u[e][i];
  }
  return sim->closure.param[LEE_HUANG_RHO_D] * mesh_sum(mesh, sum);
}

void four_state_book_friction(struct four_state *sim, const double *mass,
                              double *const rhs[], double *const u[]) {
  const struct mesh *mesh = sim->grid.mesh;
  double friction = 0, kick = 0;
  for (int e = 0; e < DIM; e++) {
    for (int32_t i = 0; i < mesh->nleaves; i++) {
      const double change = rhs[e][i] / mass[i] - u[e][i];
      const double impulse = mass[i] * change * mesh_volume(mesh, i);
      friction += impulse * u[e][i];
      kick += 0.5 * impulse * change;
    }
  }
  sim->dissipated += mesh_sum(mesh, friction);
  sim->impact += mesh_sum(mesh, kick);
}

double four_state_stored(const struct four_state *sim, const double *nu) {
  const struct mesh *mesh = sim->grid.mesh;
  double sum = 0;
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    sum +=
        nu[i] * four_state_elastic(&sim->closure, nu[i]) * mesh_volume(mesh, i);
  }
  return mesh_sum(mesh, sum);
}
