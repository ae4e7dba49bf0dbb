/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/side_walls.h"
#include "talus/minmax.h"

#include <math.h>

static double speed_of(const double *const u[DIM], int32_t i) {
  double u2 = 0;
  for (int d = 0; d < DIM; d++) u2 += u[d][i] * u[d][i];
  return sqrt(u2);
}

void side_walls_drag(const struct mesh *mesh, const struct side_walls *walls,
                     double dt, double creep,
                     const struct side_walls_state *state, double *drag) {
  const double factor = 2 * walls->mu / walls->width;
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    const double c = min2(max2(state->c[i], 0), 1);
    const double force = factor * c * max2(state->p[i], 0); /* N/m^3 */
    const double slides = speed_of(state->u, i) - dt * force / state->rho[i];
    const double speed = max2(slides, speed_of(state->u_old, i));
    drag[i] = force / max2(speed, creep);
  }
  mesh_touch(mesh, drag);
}

double side_walls_power(const struct mesh *mesh, const double *drag,
                        double *const u[DIM]) {
  double sum = 0;
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    for (int d = 0; d < DIM; d++) {
      sum += drag[i] * u[d][i] * u[d][i] * mesh_volume(mesh, i);
    }
  }
  return mesh_sum(mesh, sum);
}
