/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/two_phase/rest.h"

#include <math.h>

#include "talus/log.h"
#include "talus/minmax.h"
#include "talus/params.h"
#include "talus/two_phase/state.h"

/* Grains slower than this part of sqrt(g l) are still. */
static const double STILL = 1e-3;

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

/* Find the size l of the heap and the root of the mean square speed of its
 * grains. Leaves that are mostly gas have the speed of that. */
static void find_motion(const struct two_phase *sim, double *size,
                        double *speed) {
  const struct mesh *mesh = sim->grid.mesh;
  const int dimension = mesh_is_axisymmetric(mesh) ? 3 : DIM;
  double sum[2] = {0};
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    const double grains = sim->c->v[i] * mesh_volume(mesh, i);
    double u2 = 0;
    for (int d = 0; d < DIM; d++) u2 += sim->u[d]->v[i] * sim->u[d]->v[i];
    sum[0] += grains;
    if (sim->c->v[i] > 0.5) sum[1] += grains * u2;
  }
  const double volume = mesh_sum(mesh, sum[0]);
  *size = pow(volume, 1. / dimension);
  *speed = sqrt(mesh_sum(mesh, sum[1]) / max2(volume, 1e-300));
}

static void set_rest(struct two_phase *sim, bool rests) {
  if (rests && !sim->arrest.rests) {
    log_info("step %lld: the grains have come to rest at t = %.6g",
             (long long)sim->model.step, sim->arrest.moved);
  }
  if (!rests && sim->arrest.rests) {
    log_info("step %lld: grains that were at rest move again at t = %.6g",
             (long long)sim->model.step, sim->model.time);
  }
  sim->arrest.rests = rests;
}

void rest_note(struct two_phase *sim) {
  double size, speed;
  if (!sim->exact) return;
  const double g = params_gravity(sim->params), time = sim->model.time;
  find_motion(sim, &size, &speed);
  if (!(speed < STILL * sqrt(g * size))) sim->arrest.moved = time;
  set_rest(sim,
           g > 0 && size > 0 && time - sim->arrest.moved >= sqrt(size / g));
}
