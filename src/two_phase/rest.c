/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/two_phase/rest.h"

#include <math.h>

#include "talus/minmax.h"
#include "talus/params.h"
#include "talus/two_phase/state.h"

double rest_fastest(const struct two_phase *sim) {
  double fastest = 0;
  for (int32_t i = 0; i < sim->grid.mesh->nleaves; i++) {
    double u2 = 0;
    if (!(sim->c->v[i] > 0.5)) continue;
    for (int d = 0; d < DIM; d++) u2 += sim->u[d]->v[i] * sim->u[d]->v[i];
    fastest = max2(fastest, u2);
  }
  return sqrt(mesh_max(sim->grid.mesh, fastest));
}

bool rest_is_reached(struct two_phase *sim) {
  const struct params *params = sim->params;
  if (!(params->rest_time > 0)) return false;
  if (!(rest_fastest(sim) < params->rest_speed)) {
    sim->slow_time = 0;
    return false;
  }
  sim->slow_time += sim->model.dt;
  return sim->slow_time >= params->rest_time;
}
