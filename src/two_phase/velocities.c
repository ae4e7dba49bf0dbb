/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/two_phase/velocities.h"

#include <math.h>
#include <string.h>

#include "talus/advection.h"
#include "talus/minmax.h"
#include "talus/side_walls.h"
#include "talus/two_phase/pressures.h"
#include "talus/two_phase/state.h"
#include "talus/two_phase/time_step.h"
#include "talus/viscous.h"
#include "talus/yield.h"

/* Take scratch for the acceleration g that the predictor of Crank-Nicolson
 * needs to be of second order in time, and fill it: pressure and gravity, with
 * what viscosity and walls did in the last step; in backward Euler that only to
 * grains that hardly move (still.h). advect_momentum gives it back. */
static void predictor_acceleration(struct two_phase *sim, double *g[DIM]) {
  static const struct bc neumann[MESH_MAX_PATCHES];
  const struct bc *bc[DIM];
  const bool walls = sim->wall[0] != NULL;
  const double *still = sim->params->theta < 1 ? NULL : sim->yield.still->v;
  scratch_take(&sim->scratch, FIELD_CELL, "predictor", DIM, g);
  for (int e = 0; e < DIM; e++) {
    bc[e] = neumann;
    for (int32_t i = 0; i < sim->grid.mesh->nleaves; i++) {
      double lost = sim->viscous_g[e]->v[i];
      if (walls) lost += sim->wall[e]->v[i] / sim->rho->v[i];
      g[e][i] = sim->g[e]->v[i] + (still ? still[i] : 1) * lost;
    }
  }
  mesh_fill(sim->grid.mesh, DIM, g, bc, false);
}

/* Begin the predictor or the advection, whose scratch end_advection gives back.
 */
static struct advection_work begin_advection(struct two_phase *sim) {
  struct advection_work work = {.limiter = sim->params->limiter};
  double *cell[2 * DIM], *face[DIM + 1];
  scratch_take(&sim->scratch, FIELD_CELL, "advection", 2 * DIM, cell);
  scratch_take(&sim->scratch, FIELD_FACE, "advection", DIM + 1, face);
  for (int e = 0; e < DIM; e++) {
    work.slope[e] = cell[e];
    work.transverse[e] = cell[DIM + e];
    work.flux[e] = face[e];
  }
  work.volume = face[DIM];
  return work;
}

static void end_advection(struct two_phase *sim) {
  scratch_give(&sim->scratch, "advection");
}

void velocities_advect(struct two_phase *sim, double dt) {
  const struct mesh *mesh = sim->grid.mesh;
  sim->u_half->v = scratch_take_one(&sim->scratch, FIELD_FACE, "u_half");
  if (sim->params->advection == ADVECTION_OFF) return;
  const bool viscous = sim->params->theta < 1 || sim->exact;
  double *u[DIM], *g[DIM], *out[DIM];
  field_arrays(sim->u_old, u), field_arrays(sim->u, out);
  if (viscous) {
    predictor_acceleration(sim, g);
  } else {
    field_arrays(sim->g, g);
    field_fill_many(mesh, DIM, sim->g);
  }
  struct advection_work work = begin_advection(sim);
  advection_predict(mesh, dt, u, g, sim->grid.closed, &work, sim->u_half->v);
  end_advection(sim);
  sim->predictor = pressures_solenoidal(sim, 0.5 * dt, sim->u_half->v);
  work = begin_advection(sim);
  advection_momentum(mesh, dt, u, g, sim->u_half->v,
                     sim->params->single_phase ? NULL : sim->band->v, &work,
                     out);
  end_advection(sim);
  if (viscous) scratch_give(&sim->scratch, "predictor");
}

static struct viscosity viscosity_of(const struct two_phase *sim) {
  return (struct viscosity){.eta_f = sim->eta_f->v, .skin = sim->skin};
}

/* Set the right hand side of the viscous equation. */
static void viscous_rhs(struct two_phase *sim, double dt,
                        double *const rhs[DIM]) {
  const struct mesh *mesh = sim->grid.mesh;
  const double theta = sim->params->theta;
  if (theta < 1) {
    const struct viscosity viscosity = viscosity_of(sim);
    double *u[DIM];
    field_arrays(sim->u_old, u);
    viscous_force(mesh, &viscosity, u, rhs);
  }
  for (int e = 0; e < DIM; e++) {
    const double *u = sim->u[e]->v, *g = sim->g[e]->v;
    for (int32_t i = 0; i < mesh->nleaves; i++) {
      const double explicit_part = theta < 1 ? (1 - theta) * dt * rhs[e][i] : 0;
      rhs[e][i] = sim->rho->v[i] * (u[i] + dt * g[i]) + explicit_part;
    }
  }
}

/* Find the largest speed of the flow, the boundaries and free fall over dt. */
static double velocity_scale(const struct two_phase *sim, double dt) {
  double most = max2(1e-300, time_step_boundary_speed(sim, false));
  for (int d = 0; d < DIM; d++) {
    most = max2(most, dt * fabs(sim->params->gravity[d]));
  }
  for (int e = 0; e < DIM; e++) {
    for (int32_t i = 0; i < sim->grid.mesh->nleaves; i++) {
      most = max2(most, fabs(sim->u[e]->v[i]));
    }
  }
  return mesh_max(sim->grid.mesh, most);
}

static struct side_walls_state walls_state(const struct two_phase *sim) {
  return (struct side_walls_state){
      .rho = sim->rho->v, .c = sim->c->v, .p = sim->p->v};
}

/* Find the mass with the stiffness of side walls, in scratch that
 * velocities_diffuse gives back, and the force that they have beside it. */
static const double *foretell_walls(struct two_phase *sim, double dt) {
  const struct mesh *mesh = sim->grid.mesh;
  const struct side_walls_state state = walls_state(sim);
  double *u[DIM], *f[DIM];
  double *mass = scratch_take_one(&sim->scratch, FIELD_CELL, "mass");
  field_arrays(sim->wall, f);
  scratch_take(&sim->scratch, FIELD_CELL, __func__, DIM, u);
  for (int e = 0; e < DIM; e++) {
    for (int32_t i = 0; i < mesh->nleaves; i++) {
      u[e][i] =
          sim->u[e]->v[i] + dt * (sim->g[e]->v[i] + sim->viscous_g[e]->v[i]);
    }
  }
  side_walls_foretell(mesh, &sim->params->side_walls, dt, &state, u, f, mass);
  scratch_give(&sim->scratch, __func__);
  return mass;
}

/* Set the force of the side walls to that of the velocity found. */
static void advance_walls(struct two_phase *sim, double dt, const double *mass,
                          double *const u[DIM]) {
  const struct side_walls_state state = walls_state(sim);
  double *f[DIM];
  field_arrays(sim->wall, f);
  side_walls_advance(sim->grid.mesh, &sim->params->side_walls, dt, &state, mass,
                     u, f);
}

/* Solve the viscous equation with this viscosity. */
static struct solve_stats solve_viscous(struct two_phase *sim, double dt,
                                        const double *mass, const double *eta_f,
                                        double *const rhs[DIM],
                                        const struct bc *const bc[DIM],
                                        double *const u[DIM]) {
  const struct params *params = sim->params;
  struct viscosity viscosity = viscosity_of(sim);
  viscosity.eta_f = eta_f;
  return viscous_solve(sim->grid.mesh, sim->grid.hierarchy, mass, &viscosity,
                       params->theta * dt, rhs, bc,
                       params->tolerance_viscous * sim->scale,
                       params->max_iterations, u);
}

/* Solve with an exact yield (yield.h) in repetition `repetition` of a step. */
static void solve_yield(struct two_phase *sim, double dt, int repetition,
                        const double *mass, double *const rhs[DIM],
                        const struct bc *const bc[DIM], double *const u[DIM]) {
  const struct mesh *mesh = sim->grid.mesh;
  double *full[DIM], *face[2];
  scratch_take(&sim->scratch, FIELD_FACE, __func__, 2, face);
  double *r = face[0], *eta = face[1];
  scratch_take(&sim->scratch, FIELD_CELL, __func__, DIM, full);
  bool fits = false;
  for (int k = 0; !fits; k++) {
    const struct solve_stats before = sim->viscous;
    const bool again = k > 0 || repetition > 0;
    yield_linearise(&sim->yield, again ? 0 : dt, r, eta, full);
    for (int e = 0; e < DIM; e++) {
      for (int32_t i = 0; i < mesh->nleaves; i++) {
        full[e][i] = rhs[e][i] + dt * full[e][i];
      }
    }
    sim->viscous = solve_viscous(sim, dt, mass, eta, full, bc, u);
    if (k > 0) solve_add(&sim->viscous, &before);
    fits = yield_fits(&sim->yield, (long long)sim->model.step, k + 1,
                      yield_advance(&sim->yield, dt, r, eta, u, again));
  }
  scratch_give(&sim->scratch, __func__);
}

void velocities_diffuse(struct two_phase *sim, double dt, int k) {
  const struct mesh *mesh = sim->grid.mesh;
  double *u[DIM], *rhs[DIM];
  const struct bc *bc[DIM];
  field_arrays(sim->u, u);
  const bool walls = sim->wall[0] != NULL;
  const double *rho = sim->rho->v;
  const double *mass = walls ? foretell_walls(sim, dt) : rho;
  scratch_take(&sim->scratch, FIELD_CELL, __func__, DIM, rhs);
  for (int e = 0; e < DIM; e++) bc[e] = sim->u[e]->bc;
  viscous_rhs(sim, dt, rhs);
  for (int e = 0; e < DIM; e++) {
    const double *f = walls ? sim->wall[e]->v : NULL;
    double *viscous_g = sim->viscous_g[e]->v;
    for (int32_t i = 0; i < mesh->nleaves; i++) {
      const double pushed = f ? dt * f[i] / rho[i] : 0;
      rhs[e][i] += rho[i] * pushed;
      const double inviscid = u[e][i] + dt * sim->g[e]->v[i] + pushed;
      u[e][i] = (inviscid + dt * viscous_g[i]) * (rho[i] / mass[i]);
      viscous_g[i] = inviscid; /* until the solve is done */
    }
  }
  sim->scale = velocity_scale(sim, dt);
  if (sim->exact) {
    solve_yield(sim, dt, k, mass, rhs, bc, u);
  } else {
    sim->viscous = solve_viscous(sim, dt, mass, sim->eta_f->v, rhs, bc, u);
  }
  if (walls) advance_walls(sim, dt, mass, u);
  for (int e = 0; e < DIM; e++) {
    double *viscous_g = sim->viscous_g[e]->v;
    for (int32_t i = 0; i < mesh->nleaves; i++) {
      const double held = u[e][i] * (mass[i] / rho[i] - 1); /* by walls */
      viscous_g[i] = (u[e][i] - viscous_g[i] + held) / dt;
      u[e][i] -= dt * sim->g[e]->v[i];
    }
    mesh_touch(mesh, viscous_g), mesh_touch(mesh, u[e]);
  }
  scratch_give(&sim->scratch, __func__);
  if (walls) scratch_give(&sim->scratch, "mass");
}
