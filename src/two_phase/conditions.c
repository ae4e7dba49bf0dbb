/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/two_phase/conditions.h"

#include <math.h>

#include "talus/changed_energy.h"
#include "talus/log.h"
#include "talus/projection.h"
#include "talus/two_phase/fractions.h"
#include "talus/two_phase/measure.h"
#include "talus/two_phase/pressures.h"
#include "talus/two_phase/state.h"
#include "talus/two_phase/step.h"
#include "talus/two_phase/time_step.h"

/* Sums that differ by less than this part are the same: the order of their
 * terms depends on the number of ranks. */
#define SAME 1e-10

static void measure_energy(struct two_phase *sim,
                           struct conditions *conditions) {
  double kinetic, potential;
  fractions_synchronise(sim);
  diagnostics_energy(sim, &kinetic, &potential);
  conditions->gas = diagnostics_gas(sim);
  fractions_desynchronise(sim);
  conditions->energy = kinetic + potential;
}

static double measure_force(struct two_phase *sim) {
  const struct mesh *mesh = sim->grid.mesh;
  double *g[DIM], sum = 0;
  step_density(sim);
  scratch_take(&sim->scratch, FIELD_CELL, __func__, DIM, g);
  pressures_acceleration(sim, g);
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    double g2 = 0;
    for (int d = 0; d < DIM; d++) g2 += g[d][i] * g[d][i];
    sum += sqrt(g2) * mesh_volume(mesh, i);
  }
  scratch_give(&sim->scratch, __func__);
  return mesh_sum(mesh, sum);
}

/* Find the velocity of the faces on closed patches, u_f [nfaces_all], and its
 * sum. The density is that of c. */
static double boundary_velocity(struct two_phase *sim, double *u_f) {
  const struct mesh *mesh = sim->grid.mesh;
  const struct projection projection = {
      .mesh = mesh, .rho = sim->rho->v, .gravity_f = sim->gravity_f->v};
  double *u[DIM], sum = 0;
  field_arrays(sim->u, u);
  field_fill_many(mesh, DIM, sim->u);
  projection_face_velocity(&projection, 0, u, u_f);
  for (int32_t f = 0; f < mesh->nfaces; f++) {
    const int patch = mesh->face_patch[f];
    if (patch < 0 || !sim->grid.closed[patch]) continue;
    sum += fabs(u_f[f]) * mesh_face_area(mesh, f);
  }
  return mesh_sum(mesh, sum);
}

void conditions_measure(struct two_phase *sim, struct conditions *conditions) {
  measure_energy(sim, conditions);
  conditions->force = measure_force(sim);
  double *u_f = scratch_take_one(&sim->scratch, FIELD_FACE, __func__);
  conditions->inflow = boundary_velocity(sim, u_f);
  scratch_give(&sim->scratch, __func__);
}

/* Bring c, and the momentum that rides with it, to `time`. */
static void end_lag(struct two_phase *sim) {
  fields_save(&sim->grid.fields, sim->grid.mesh);
  fractions_advance(sim, 0.5 * sim->model.dt, time_step_rate(sim));
  sim->model.dt = 0;
}

static void start_anew(struct two_phase *sim) {
  const struct mesh *mesh = sim->grid.mesh;
  end_lag(sim);
  double *given = scratch_take_one(&sim->scratch, FIELD_FACE, __func__);
  boundary_velocity(sim, given);
  for (int32_t f = 0; f < mesh->nfaces; f++) {
    const int patch = mesh->face_patch[f];
    if (patch >= 0 && sim->grid.closed[patch]) sim->u_f->v[f] = given[f];
  }
  scratch_give(&sim->scratch, __func__);
  field_fill_faces(mesh, sim->u_f);
  step_start(sim);
}

void conditions_renew(struct two_phase *sim) {
  const struct conditions *before = &sim->conditions;
  struct conditions now;
  double gravity = 0, volume = 0;
  conditions_measure(sim, &now);
  for (int32_t i = 0; i < sim->grid.mesh->nleaves; i++) {
    volume += mesh_volume(sim->grid.mesh, i);
  }
  for (int d = 0; d < DIM; d++) {
    gravity = fmax(gravity, fabs(sim->params->gravity[d]));
  }
  const double weight = gravity * mesh_sum(sim->grid.mesh, volume);
  sim->energy.changed += changed_energy(before->energy, now.energy);
  if (fabs(now.gas - before->gas) > SAME * fabs(before->gas)) {
    sim->energy.gas += now.gas - before->gas;
  }
  if (fabs(now.force - before->force) > SAME * (before->force + weight) ||
      fabs(now.inflow - before->inflow) > SAME * before->inflow) {
    log_info("restart with other forces or inflow: the flow starts anew");
    start_anew(sim);
  }
}
