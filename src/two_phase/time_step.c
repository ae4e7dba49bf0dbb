/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/two_phase/time_step.h"

#include <math.h>

#include "talus/minmax.h"
#include "talus/two_phase/state.h"

/* From one step to the next dt grows by at most this factor. */
#define DT_GROWTH 1.2
/* dt is at most this times sqrt(h/a) of grains at rest that set off with a. */
#define DT_ACCELERATION 0.1
/* Or their speed grows by at most this part of it. */
#define DT_UNDER_WAY 0.25
/* Friction takes at most the rest of |g| from a. */
#define DT_LEFT 0.6
/* After a step that was too long the next is at least this part of the bound.
 */
#define DT_SHRINK 0.2
/* A step too long for the flow it finds is repeated with DT_REPEAT times the dt
 * that the acceleration allows, and at least DT_LEAST times its dt. */
#define DT_REPEAT 0.7
#define DT_LEAST 0.01

double time_step_boundary_speed(const struct two_phase *sim, bool per_leaf) {
  const struct mesh *mesh = sim->grid.mesh;
  double speed[MESH_MAX_PATCHES] = {0}, fastest = 0, most = 0;
  for (int patch = 0; patch < MESH_MAX_PATCHES; patch++) {
    for (int e = 0; e < DIM; e++) {
      const struct bc *bc = &sim->u[e]->bc[patch];
      if (bc->type != BC_DIRICHLET) continue;
      speed[patch] = max2(speed[patch], fabs(bc->value));
    }
    fastest = max2(fastest, speed[patch]);
  }
  for (int32_t f = 0; f < mesh->nfaces && fastest > 0; f++) {
    const int patch = mesh->face_patch[f];
    if (patch < 0) continue;
    most = max2(
        most, per_leaf ? mesh_face_edges(mesh, f, speed[patch]) : speed[patch]);
  }
  return most;
}

double time_step_rate(const struct two_phase *sim) {
  const struct mesh *mesh = sim->grid.mesh;
  const struct mesh view = *mesh; /* known to be the same all over the loop */
  const double *u_f = sim->u_f->v;
  double rate = 0;
  for (int32_t i = 0; i < view.nleaves; i++) {
    rate = max2(rate, mesh_turnover(&view, u_f, i));
  }
  return mesh_max(mesh, rate);
}

/* Divide cfl by a rate; HUGE_VAL if nothing moves. */
static double cfl_bound(const struct two_phase *sim, double rate) {
  return rate > 0 ? sim->params->cfl / rate : HUGE_VAL;
}

double time_step_of_start(const struct two_phase *sim, int32_t i) {
  double g2 = 0, left2 = 0, u2 = 0;
  if (!(sim->c->v[i] > 0.5)) return HUGE_VAL;
  for (int d = 0; d < DIM; d++) {
    const double g = sim->g[d]->v[i], left = g + sim->viscous_g[d]->v[i];
    g2 += g * g;
    left2 += left * left;
    u2 += sim->u[d]->v[i] * sim->u[d]->v[i];
  }
  const double a = sqrt(max2(min2(left2, g2), DT_LEFT * DT_LEFT * g2));
  const double fall2 = a * sim->grid.mesh->h[i];
  if (!(u2 < fall2)) return HUGE_VAL;
  return max2(DT_ACCELERATION * sqrt(fall2), DT_UNDER_WAY * sqrt(u2)) / a;
}

static double acceleration_bound(const struct two_phase *sim) {
  const struct mesh *mesh = sim->grid.mesh;
  double least = HUGE_VAL;
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    least = min2(least, time_step_of_start(sim, i));
  }
  return -mesh_max(mesh, -least);
}

/* Bound dt by sqrt(h/|g|) of the finest leaves, where there is a surface. */
static double wave_bound(const struct params *params) {
  const double g = params_gravity(params);
  if (params->single_phase || g == 0) return HUGE_VAL;
  return sqrt(params->size / exp2(params->level_max) / g);
}

double time_step_choose(const struct two_phase *sim, double dt_max,
                        double *rate) {
  const double boundary =
      mesh_max(sim->grid.mesh, time_step_boundary_speed(sim, true));
  double dt = min2(dt_max, sim->params->dt_max);
  dt = min2(dt, wave_bound(sim->params));
  *rate = time_step_rate(sim);
  dt = min2(dt, cfl_bound(sim, max2(boundary, *rate)));
  dt = min2(dt, acceleration_bound(sim));
  if (sim->model.dt > 0) {
    const double bound = cfl_bound(sim, *rate);
    dt = min2(dt, DT_GROWTH * sim->model.dt);
    dt = min2(dt, max2(2 * bound - sim->model.dt, DT_SHRINK * bound));
  }
  return dt < dt_max && dt_max < 2 * dt ? 0.5 * dt_max : dt;
}

double time_step_allowed(const struct two_phase *sim, double dt) {
  const double most = (2 - DT_SHRINK) * cfl_bound(sim, time_step_rate(sim));
  /* from rest the rate grows as dt */
  return dt <= most ? dt : dt * max2(DT_REPEAT * sqrt(most / dt), DT_LEAST);
}
