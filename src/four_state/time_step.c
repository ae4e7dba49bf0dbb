/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/four_state/time_step.h"

#include <math.h>

#include "talus/four_state/state.h"
#include "talus/minmax.h"

/* dt is at most this times sqrt(h/|g|) of the finest leaves, grows by at most a
 * factor of DT_GROWTH from step to step, and begins with DT_FIRST of that. */
#define DT_ACCELERATION 0.0625
#define DT_GROWTH 1.2
#define DT_FIRST 0.01

/* Return the largest sum over axes of |u|/h of leaves with grains. */
static double flow_rate(const struct four_state *sim) {
  const struct mesh *mesh = sim->grid.mesh;
  double most = 0;
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    double sum = 0;
    if (!four_state_has_grains(sim, i)) continue;
    for (int d = 0; d < DIM; d++) sum += fabs(sim->u[d]->v[i]);
    most = max2(most, mesh_edges(mesh, i, sum));
  }
  return mesh_max(mesh, most);
}

double four_state_time_step(const struct four_state *sim, double dt_max) {
  const struct params *params = sim->params;
  const double h = params->size / exp2(sim->grid.mesh->level_finest);
  const double g = params_gravity(params);
  double dt = min2(dt_max, params->dt_max);
  if (g > 0) dt = min2(dt, DT_ACCELERATION * sqrt(h / g));
  const double rate = flow_rate(sim);
  if (rate > 0) dt = min2(dt, params->cfl / rate);
  dt = sim->model.dt > 0 ? min2(dt, DT_GROWTH * sim->model.dt) : DT_FIRST * dt;
  return dt < dt_max && dt_max < 2 * dt ? 0.5 * dt_max : dt;
}

double four_state_part_given(const struct four_state *sim, double dt, int32_t i,
                             double nu_old) {
  const struct mesh *mesh = sim->grid.mesh;
  const double store = mesh_width(mesh, i) * nu_old; /* dust: none */
  double out = 0;
  if (!(store > 0)) return 1;
  for (int s = 0; s < NFACE; s++) {
    const double v = mesh_side(mesh, sim->flux->v, i, s);
    out += max2(s & 1 ? v : -v, 0);
  }
  return dt * out / store;
}

double four_state_given(const struct four_state *sim, double dt,
                        const double *nu_old) {
  double most = 0;
  for (int32_t i = 0; i < sim->grid.mesh->nleaves; i++) {
    if (nu_old[i] < sim->keys->nu_vacuum) continue;
    most = max2(most, four_state_part_given(sim, dt, i, nu_old[i]));
  }
  return mesh_max(sim->grid.mesh, most);
}
