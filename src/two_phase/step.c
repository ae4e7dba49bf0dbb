/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The time step of the two-phase model, from t^n to t^n + dt.
 *
 * It begins with u^n in cells and u_f^n on faces, and half a step earlier with
 * c, p, g = gravity - grad p/rho, and v, the acceleration by viscosity. [x]_d
 * is x on the upper less x on the lower side of a leaf along axis d, A a mean
 * over its two faces across an axis. In the order of the calls:
 *
 * time_step_choose     dt, by the flow and the bounds of the case
 * fractions_advance    over dt_c, the mean of the last dt and this one, and
 *                      along each axis d in turn
 *     c <- c - dt_c/h [F]_d + cc dt_c/h [u_f^n]_d
 *     rho u <- rho u - dt_c/h [M u^up]_d + rho_cc u^n dt_c/h [u_f^n]_d
 *   F and M: fluxes of grains and of mass, from the planes of the surface; cc
 *   is 1 where c > 1/2 at first; the second line in the band beside the surface
 *   only (vof.h, momentum.h)
 * percolation_advance  the same with w in place of u_f^n, for enclosed gas q
 *     w = grad psi,  div w = q
 * update_density
 *     rho = c rho_1 + (1 - c) rho_2,  alpha_f = 1/rho_f
 *     gravity_f = grad of the weight, less that of the surface, over rho_f
 * update_acceleration  where there are grains
 *     g = A(gravity_f - alpha_f grad p)
 * still_find           with "exact", which grains hardly move (still.h)
 * update_viscosity
 *     eta_f = both phases in series, eta_1 of the shear rate of u^n and of p
 * advect_momentum      away from the band
 *     u^{n+1/2} = u^n + dt/2 (g - u^n.grad u^n), upwind, on faces
 *     u_f^{n+1/2} = its normal part less dt/2 alpha_f grad phi, solenoidal
 *     u <- u - dt/h sum_d [u_f^{n+1/2} (u^{n+1/2} - u^n)]_d
 *   with solver.advection = "off" not this, and the second line of
 *   fractions_advance not either
 * and, once or repeatedly with eta_f of the latest u and p (repeat_properties),
 * diffuse_momentum     with "exact" as yield.h says, else
 *     (rho + dt drag) u* - theta dt div(2 eta D(u*))
 *         = rho (u + dt g) + (1 - theta) dt div(2 eta D(u^n))
 *     v = (u* - u)/dt - g + drag/rho u*
 *     u* <- u* - dt g
 * project
 *     u_f = mean of u* on both sides, by mass, + dt gravity_f, with "exact"
 *           not where grains hardly move (still.h)
 *     div(alpha_f grad p) = div u_f/dt
 *     u_f^{n+1} = u_f - dt alpha_f grad p
 *     g = A(gravity_f - alpha_f grad p)
 *     u^{n+1} = u* + dt g
 *     with "exact" u_f is then made anew from u^{n+1} (carry_with_grains)
 * then
 * viscous_work_add     what viscosity has taken from grains and gas
 * two_phase_adapt      if the surface has moved far enough
 * clean_face_velocity  div u_f^{n+1} = 0 to round-off
 *
 * Invariants between steps
 * 1. c, tracers, u, u_f, p, g are valid on leaves (u_f on all faces); ghosts
 *    and helper nodes of cell fields are not: every stage fills what it reads.
 *    Within a step u_old, which does not change, is filled.
 * 2. u_f is divergence-free to round-off, by cleaning at the end of a step.
 * 3. Where planes_hold, `normal` and `plane` are those of c.
 */
#include "talus/two_phase/step.h"

#include <math.h>
#include <string.h>

#include "talus/adapt.h"
#include "talus/advection.h"
#include "talus/clean.h"
#include "talus/error.h"
#include "talus/log.h"
#include "talus/minmax.h"
#include "talus/poisson.h"
#include "talus/projection.h"
#include "talus/side_walls.h"
#include "talus/skin.h"
#include "talus/slip_strip.h"
#include "talus/strain.h"
#include "talus/two_phase/fractions.h"
#include "talus/two_phase/percolation.h"
#include "talus/two_phase/pressure_level.h"
#include "talus/two_phase/properties.h"
#include "talus/two_phase/state.h"
#include "talus/two_phase/still.h"
#include "talus/two_phase/time_step.h"
#include "talus/two_phase/viscous_work.h"
#include "talus/two_phase/yield_faces.h"
#include "talus/viscous.h"
#include "talus/vof.h"

/* A stalled solve passes within STALL_SLACK times its tolerance, or below
 * STALL_FLOOR, where round-off may be. */
#define STALL_SLACK 10
#define STALL_FLOOR 1e-10

/* Leaves with more grains than this take their g from the last pressure; in the
 * others the pressure of grains that have just left would do too much
 * (docs/notes/surface.md). */
#define HOLDS_GRAINS 0.01

/* Density of a gas that weighs nothing, in that of the grains. */
#define WEIGHTLESS 1e-12

/* The velocity that carries c is solved for to this part of the tolerance of
 * pressure: its errors move grains at rest. */
#define CARRIED 0.01
#define LEAST_TOLERANCE 1e-12

/* A divergence below this part of the rate of flow is round-off. */
#define SOLENOIDAL 1e-12

/* Solves of an exact yield are repeated, MOST_SOLVES in all, until their
 * mismatch is below FIT. A heap that has lost 10 % of its stress has 0.035 and
 * would move by 1.4e-5 sqrt(g L). Above BAD the user is told. */
#define FIT 0.0005
#define BAD 0.02
enum { MOST_SOLVES = 32 };

/* A failed step is repeated at most RETRIES times, each time with dt reduced by
 * RETRY_FACTOR; a step too long for the flow it finds, SHORTENINGS times. */
enum { RETRIES = 3, SHORTENINGS = 30 };
#define RETRY_FACTOR 0.25

/* Begin a projection, whose scratch end_projection gives back. */
static struct projection begin_projection(struct two_phase *sim) {
  double *rhs = scratch_take_one(&sim->scratch, FIELD_CELL, "projection");
  double *flux = scratch_take_one(&sim->scratch, FIELD_FACE, "projection");
  return (struct projection){.mesh = sim->grid.mesh,
                             .hierarchy = sim->grid.hierarchy,
                             .rho = sim->rho->v,
                             .alpha_f = sim->alpha_f->v,
                             .gravity_f = sim->gravity_f->v,
                             .bc = sim->p->bc,
                             .tolerance = sim->params->tolerance_pressure,
                             .max_iterations = sim->params->max_iterations,
                             .rhs = rhs,
                             .flux = flux};
}

static void end_projection(struct two_phase *sim) {
  scratch_give(&sim->scratch, "projection");
}

/* Describe gravity for properties_gravity, with five arrays of scratch. */
static struct gravity describe_gravity(const struct two_phase *sim,
                                       double *const work[5]) {
  const struct params *params = sim->params;
  struct gravity gravity = {.rho = sim->rho->v,
                            .weight = work[0],
                            .surface = work[1],
                            .count = work[2],
                            .near_surface = work[3],
                            .near_count = work[4]};
  for (int d = 0; d < DIM; d++) {
    const bool periodic = params->boundary[2 * d].type == BOUNDARY_PERIODIC;
    gravity.bounded[d] = periodic ? 0 : params->gravity[d];
    gravity.periodic[d] = periodic ? params->gravity[d] : 0;
    gravity.origin[d] = params->origin[d];
  }
  return gravity;
}

/* Fill p as the pressure solve does. The density is filled. */
static void fill_pressure(struct two_phase *sim) {
  const struct bc *bc = sim->p->bc;
  mesh_fill_potential(sim->grid.mesh, sim->rho->v, 1, &sim->p->v, &bc, false);
}

static void update_density(struct two_phase *sim) {
  const struct mesh *mesh = sim->grid.mesh;
  double density[2], *normal[DIM], *work[5];
  scratch_take(&sim->scratch, FIELD_CELL, __func__, 5, work);
  const struct gravity gravity = describe_gravity(sim, work);
  two_phase_densities(sim, density);
  field_arrays(sim->normal, normal);
  slip_strip_renew(&sim->grid, sim->c->v);
  field_fill(mesh, sim->c);
  fractions_update_planes(sim);
  if (!sim->params->single_phase) {
    sim->skin->grains_only = sim->exact;
    skin_find(mesh, sim->c->v, sim->exact ? 1 : density[1] / density[0],
              sim->skin);
  }
  properties_density(mesh, density, sim->c->v, sim->grid.closed, sim->rho->v,
                     sim->alpha_f->v);
  field_fill(mesh, sim->rho);
  properties_gravity(mesh, density, &gravity, sim->c->v, normal, sim->plane->v,
                     sim->alpha_f->v, sim->gravity_f->v);
  scratch_give(&sim->scratch, __func__);
}

/* Set g [nleaves] from the flux of a projection. */
static void set_acceleration(struct two_phase *sim,
                             const struct projection *projection,
                             double *const g[DIM]) {
  double *face = scratch_take_one(&sim->scratch, FIELD_FACE, __func__);
  projection_acceleration(projection, face, g);
  scratch_give(&sim->scratch, __func__);
}

/* Find g of the last pressure with the present density, gravity and boundaries.
 */
static void find_acceleration(struct two_phase *sim, double *const g[DIM]) {
  const struct projection projection = begin_projection(sim);
  fill_pressure(sim);
  poisson_flux(sim->grid.mesh, projection.alpha_f, sim->p->v, projection.flux);
  set_acceleration(sim, &projection, g);
  end_projection(sim);
}

/* Renew g in leaves that hold grains, so that the viscous solve sees nearly the
 * g that the projection will find. Gas keeps its g: where grains have just
 * left, their pressure would accelerate gas far too much. */
static void update_acceleration(struct two_phase *sim) {
  double *g[DIM];
  if (sim->params->single_phase) return;
  scratch_take(&sim->scratch, FIELD_CELL, __func__, DIM, g);
  find_acceleration(sim, g);
  for (int e = 0; e < DIM; e++) {
    for (int32_t i = 0; i < sim->grid.mesh->nleaves; i++) {
      if (sim->c->v[i] > HOLDS_GRAINS) sim->g[e]->v[i] = g[e][i];
    }
    mesh_touch(sim->grid.mesh, sim->g[e]->v);
  }
  scratch_give(&sim->scratch, __func__);
}

/* Set eta_f from a velocity, which is filled, and p. */
static void update_viscosity(struct two_phase *sim,
                             struct field *const velocity[DIM]) {
  const struct mesh *mesh = sim->grid.mesh;
  const struct params *params = sim->params;
  double *u[DIM], *normal[DIM], *work[3];
  field_arrays(velocity, u), field_arrays(sim->normal, normal);
  scratch_take(&sim->scratch, FIELD_FACE, __func__, 3, work);
  fill_pressure(sim);
  if (sim->exact) {
    scratch_give(&sim->scratch, __func__);
    yield_faces_update(sim, u);
    return;
  }
  strain_shear_rate(mesh, sim->skin, u, work[0]);
  properties_viscosity(mesh, sim->model.time, &params->grains,
                       params->single_phase ? NULL : &params->gas,
                       params->gravity, sim->c->v, normal, sim->plane->v,
                       sim->p->v, sim->grid.closed, work[0], &work[1],
                       sim->eta_f->v);
  scratch_give(&sim->scratch, __func__);
}

/* Make u_f solenoidal to the tolerance by a projection over dt with a pressure
 * that starts from 0. */
static struct solve_stats make_solenoidal_by(struct two_phase *sim,
                                             const struct projection *by,
                                             double dt, double *u_f) {
  struct projection projection = *by;
  double *phi = scratch_take_one(&sim->scratch, FIELD_CELL, __func__);
  struct bc bc[MESH_MAX_PATCHES];
  memcpy(bc, sim->p->bc, sizeof bc);
  for (int k = 0; k < MESH_MAX_PATCHES; k++) bc[k].value = 0;
  projection.bc = bc;
  memset(phi, 0, (size_t)sim->grid.mesh->ncells * sizeof(double));
  struct solve_stats stats = projection_project(&projection, dt, u_f, phi);
  scratch_give(&sim->scratch, __func__);
  return stats;
}

/* Make u_f solenoidal, then to round-off by cleaning. */
static struct solve_stats make_solenoidal(struct two_phase *sim, double dt,
                                          double *u_f) {
  const struct projection projection = begin_projection(sim);
  const struct solve_stats stats =
      make_solenoidal_by(sim, &projection, dt, u_f);
  end_projection(sim);
  clean_face_velocity(sim->grid.clean, sim->grid.mesh, sim->grid.open, u_f);
  return stats;
}

/* Take scratch for the acceleration g that the predictor of Crank-Nicolson
 * needs to be of second order in time, and fill it: pressure and gravity, with
 * what viscosity and walls did in the last step; in backward Euler that only to
 * grains that hardly move (still.h). advect_momentum gives it back. */
static void predictor_acceleration(struct two_phase *sim, double *g[DIM]) {
  static const struct bc neumann[MESH_MAX_PATCHES];
  const struct bc *bc[DIM];
  const double *drag = sim->drag ? sim->drag->v : NULL;
  const double *still = sim->params->theta < 1 ? NULL : sim->yield.still->v;
  scratch_take(&sim->scratch, FIELD_CELL, "predictor", DIM, g);
  for (int e = 0; e < DIM; e++) {
    bc[e] = neumann;
    for (int32_t i = 0; i < sim->grid.mesh->nleaves; i++) {
      const double u = sim->u_old[e]->v[i];
      double lost = sim->viscous_g[e]->v[i];
      if (drag) lost -= drag[i] * u / sim->rho->v[i];
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

/* Carry momentum away from the band with a solenoidal u_f at half steps; u_half
 * has its room in any case. */
static void advect_momentum(struct two_phase *sim, double dt) {
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
  sim->predictor = make_solenoidal(sim, 0.5 * dt, sim->u_half->v);
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

/* Find rho + dt drag of the side walls, in scratch that diffuse_momentum gives
 * back. */
static const double *mass_with_walls(struct two_phase *sim, double dt) {
  const struct mesh *mesh = sim->grid.mesh;
  const struct params *params = sim->params;
  double gravity = 0, *u[DIM];
  double *mass = scratch_take_one(&sim->scratch, FIELD_CELL, "mass");
  struct side_walls_state state = {
      .rho = sim->rho->v, .c = sim->c->v, .p = sim->p->v};
  scratch_take(&sim->scratch, FIELD_CELL, __func__, DIM, u);
  for (int e = 0; e < DIM; e++) {
    for (int32_t i = 0; i < mesh->nleaves; i++) {
      u[e][i] =
          sim->u[e]->v[i] + dt * (sim->g[e]->v[i] + sim->viscous_g[e]->v[i]);
    }
    gravity = max2(gravity, fabs(params->gravity[e]));
    state.u[e] = u[e], state.u_old[e] = sim->u_old[e]->v;
  }
  const double creep =
      max2(SIDE_WALLS_CREEP * sqrt(gravity * params->size), 1e-300);
  side_walls_drag(mesh, &params->side_walls, dt, creep, &state, sim->drag->v);
  scratch_give(&sim->scratch, __func__);
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    mass[i] = sim->rho->v[i] + dt * sim->drag->v[i];
  }
  return mass;
}

/* Add the iterations of an earlier solve of the step, and keep the worse result
 * of the two: a repetition that converges must not hide one that did not. */
static void add_solve(struct solve_stats *last,
                      const struct solve_stats *before) {
  const int iterations = last->iterations + before->iterations;
  const bool failed = last->status != SOLVE_CONVERGED;
  if (before->status != SOLVE_CONVERGED
          ? !failed || !(before->residual_after <= last->residual_after)
          : !failed && before->residual_after > last->residual_after) {
    *last = *before;
  }
  last->iterations = iterations;
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

/* Solve with an exact yield (yield.h) in repetition `repetition` of a step:
 * once, or up to MOST_SOLVES times until the stress fits the load. */
static void solve_yield(struct two_phase *sim, double dt, int repetition,
                        const double *mass, double *const rhs[DIM],
                        const struct bc *const bc[DIM], double *const u[DIM]) {
  const struct mesh *mesh = sim->grid.mesh;
  double *full[DIM], *face[2], mismatch = HUGE_VAL;
  scratch_take(&sim->scratch, FIELD_FACE, __func__, 2, face);
  double *r = face[0], *eta = face[1];
  scratch_take(&sim->scratch, FIELD_CELL, __func__, DIM, full);
  int k = 0;
  for (; k < MOST_SOLVES && mismatch > FIT; k++) {
    const struct solve_stats before = sim->viscous;
    const bool again = k > 0 || repetition > 0;
    yield_linearise(&sim->yield, again ? 0 : dt, r, eta, full);
    for (int e = 0; e < DIM; e++) {
      for (int32_t i = 0; i < mesh->nleaves; i++) {
        full[e][i] = rhs[e][i] + dt * full[e][i];
      }
    }
    sim->viscous = solve_viscous(sim, dt, mass, eta, full, bc, u);
    mismatch = yield_advance(&sim->yield, dt, r, eta, u, again);
    if (k > 0) add_solve(&sim->viscous, &before);
  }
  scratch_give(&sim->scratch, __func__);
  if (k == MOST_SOLVES && mismatch > FIT) {
    yield_say_misfit(&sim->yield, (long long)sim->model.step, k, mismatch, FIT,
                     BAD);
  }
}

/* Solve the viscous equation for u* and v, in repetition k. The guess is u + dt
 * (g + v) with v of the last step, less the friction of the walls. */
static void diffuse_momentum(struct two_phase *sim, double dt, int k) {
  const struct mesh *mesh = sim->grid.mesh;
  double *u[DIM], *rhs[DIM];
  const struct bc *bc[DIM];
  field_arrays(sim->u, u);
  const double *rho = sim->rho->v;
  const double *mass = sim->drag ? mass_with_walls(sim, dt) : rho;
  scratch_take(&sim->scratch, FIELD_CELL, __func__, DIM, rhs);
  for (int e = 0; e < DIM; e++) bc[e] = sim->u[e]->bc;
  viscous_rhs(sim, dt, rhs);
  for (int e = 0; e < DIM; e++) {
    double *viscous_g = sim->viscous_g[e]->v;
    for (int32_t i = 0; i < mesh->nleaves; i++) {
      const double inviscid = u[e][i] + dt * sim->g[e]->v[i];
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
  for (int e = 0; e < DIM; e++) {
    double *viscous_g = sim->viscous_g[e]->v;
    for (int32_t i = 0; i < mesh->nleaves; i++) {
      const double lost = u[e][i] * (mass[i] / rho[i] - 1); /* to the walls */
      viscous_g[i] = (u[e][i] - viscous_g[i] + lost) / dt;
      u[e][i] -= dt * sim->g[e]->v[i];
    }
    mesh_touch(mesh, viscous_g), mesh_touch(mesh, u[e]);
  }
  scratch_give(&sim->scratch, __func__);
  if (sim->drag) scratch_give(&sim->scratch, "mass");
}

/* Keep the advected velocity (k = 0), or set u back to it before repetition k
 * and renew the viscosity from the latest u and p. */
static void repeat_properties(struct two_phase *sim, int k,
                              double *advected[DIM]) {
  const size_t bytes = (size_t)sim->grid.mesh->nleaves * sizeof(double);
  if (sim->params->picard == 0) return;
  if (k > 0) {
    field_fill_many(sim->grid.mesh, DIM, sim->u);
    update_viscosity(sim, sim->u);
  } else {
    scratch_take(&sim->scratch, FIELD_CELL, "advected", DIM, advected);
  }
  for (int e = 0; e < DIM; e++) {
    double *u = sim->u[e]->v;
    memcpy(k > 0 ? u : advected[e], k > 0 ? advected[e] : u, bytes);
    mesh_touch(sim->grid.mesh, k > 0 ? u : advected[e]);
  }
  if (k == sim->params->picard) scratch_give(&sim->scratch, "advected");
}

/* Measure how far repetition k has moved u_f from `last`, which
 * turn_face_velocity has kept. */
static void measure_repetition(struct two_phase *sim, int k,
                               const double *last) {
  const struct mesh *mesh = sim->grid.mesh;
  double change = 0;
  if (k == 0) return;
  for (int32_t f = 0; f < mesh->nfaces; f++) {
    change = max2(change, fabs(sim->u_f->v[f] - last[f]));
  }
  scratch_give(&sim->scratch, "last");
  sim->repeat_change = mesh_max(mesh, change);
  log_info("step %lld, repetition %d: velocity changes by %.3g of %.3g",
           (long long)sim->model.step, k, sim->repeat_change, sim->scale);
}

static void add_wall_work(struct two_phase *sim, double dt) {
  double *u[DIM];
  if (!sim->drag) return;
  field_arrays(sim->u, u);
  sim->energy.dissipated +=
      dt * side_walls_power(sim->grid.mesh, sim->drag->v, u);
}

/* Make room for the new u_f. The first solve writes into the array of u_half
 * and leaves u_f of the last step there, in case this step fails (u_f->old). A
 * repetition writes over the new u_f; returns a copy of u_f from before, else
 * NULL. */
static const double *turn_face_velocity(struct two_phase *sim, int k) {
  double *last = sim->u_f->v;
  if (k > 0) {
    double *copy = scratch_take_one(&sim->scratch, FIELD_FACE, "last");
    return memcpy(copy, last,
                  (size_t)sim->grid.mesh->nfaces_all * sizeof(double));
  }
  scratch_exchange(&sim->scratch, sim->u_half->v, last);
  sim->u_f->v = sim->u_half->v;
  sim->u_half->v = last;
  return NULL;
}

static double carrying_tolerance(const struct params *params) {
  const double tolerance = params->tolerance_pressure;
  return min2(tolerance, max2(CARRIED * tolerance, LEAST_TOLERANCE));
}

/* Make of a projection one with a gas that weighs nothing, so that its currents
 * are felt by itself alone, in scratch that end_light gives back. Traces of
 * grains weigh nothing either: round-off of c must not outweigh the gas. */
static struct projection begin_light(struct two_phase *sim,
                                     const struct projection *projection) {
  static const struct bc neumann[MESH_MAX_PATCHES];
  const struct mesh *mesh = sim->grid.mesh;
  const double density[2] = {1, WEIGHTLESS};
  const struct bc *bc[] = {neumann};
  struct projection light = *projection;
  double *rho = scratch_take_one(&sim->scratch, FIELD_CELL, "light");
  double *alpha_f = scratch_take_one(&sim->scratch, FIELD_FACE, "light");
  double *c = scratch_take_one(&sim->scratch, FIELD_CELL, __func__);
  field_fill(mesh, sim->c);
  for (int32_t i = 0; i < mesh->ncells; i++) {
    c[i] = sim->c->v[i] < PARAMS_GAS ? 0 : sim->c->v[i];
  }
  properties_density(mesh, density, c, sim->grid.closed, rho, alpha_f);
  scratch_give(&sim->scratch, __func__);
  mesh_fill(mesh, 1, &rho, bc, false);
  light.rho = rho;
  light.alpha_f = alpha_f;
  light.tolerance = carrying_tolerance(sim->params);
  return light;
}

static void end_light(struct two_phase *sim) {
  scratch_give(&sim->scratch, "light");
}

/* Make u_f the solenoidal part of the mean of u^{n+1} on both sides of a face,
 * which vanishes where grains rest (yield.h). */
static void carry_with_grains(struct two_phase *sim,
                              const struct projection *light, double dt) {
  double *u[DIM];
  field_arrays(sim->u, u);
  field_fill_many(sim->grid.mesh, DIM, sim->u);
  projection_face_velocity(light, 0, u, sim->u_f->v);
  sim->carrying = make_solenoidal_by(sim, light, dt, sim->u_f->v);
}

static void add_acceleration(struct two_phase *sim, double dt) {
  const struct mesh *mesh = sim->grid.mesh;
  for (int e = 0; e < DIM; e++) {
    double *u = sim->u[e]->v;
    for (int32_t i = 0; i < mesh->nleaves; i++) u[i] += dt * sim->g[e]->v[i];
    mesh_touch(mesh, u);
  }
}

/* Find p, and from it u_f and g. */
static void find_pressure(struct two_phase *sim, struct projection *projection,
                          double dt) {
  double *g[DIM];
  field_arrays(sim->g, g);
  sim->pressure = projection_project(projection, dt, sim->u_f->v, sim->p->v);
  pressure_level_set(sim);
  set_acceleration(sim, projection, g);
}

/* With an exact yield, find p, u and u_f, which is the mean of u* - dt g, + dt
 * gravity. */
static void project_exactly(struct two_phase *sim,
                            struct projection *projection, double dt) {
  const struct projection light = begin_light(sim, projection);
  double *last_g[DIM];
  fill_pressure(sim);
  still_face_velocity(sim, projection, light.rho, dt, sim->u_f->v);
  still_remember(sim, last_g);
  find_pressure(sim, projection, dt);
  add_acceleration(sim, dt);
  still_keep(sim, dt, last_g);
  carry_with_grains(sim, &light, dt);
  end_light(sim);
}

/* Find p, u_f and u at the end of the step; k counts repetitions. */
static void project(struct two_phase *sim, double dt, int k) {
  const double *last = turn_face_velocity(sim, k);
  struct projection projection = begin_projection(sim);
  double *u[DIM];
  field_arrays(sim->u, u);
  field_fill_many(sim->grid.mesh, DIM, sim->u);
  projection_face_velocity(&projection, dt, u, sim->u_f->v);
  if (sim->exact) {
    project_exactly(sim, &projection, dt);
  } else {
    find_pressure(sim, &projection, dt);
    add_acceleration(sim, dt);
  }
  end_projection(sim);
  measure_repetition(sim, k, last);
}

/* Does the grid follow more than the surface? */
static bool follows_velocity(const struct params *params) {
  bool found = params->single_phase;
  for (int k = 0; k < params->ncriteria; k++) {
    found = found || params->criterion[k].type == CRITERION_ESTIMATE;
  }
  return found;
}

static void set_cell_viscosity(struct two_phase *sim) {
  const struct mesh *mesh = sim->grid.mesh;
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    sim->eta->v[i] = mesh_mean(mesh, sim->eta_f->v, i);
  }
  mesh_touch(mesh, sim->eta->v);
}

/* Add how many cells the surface, or the flow, may have moved. */
static void add_travel(struct two_phase *sim, double dt) {
  const struct mesh *mesh = sim->grid.mesh;
  const bool everywhere = follows_velocity(sim->params);
  double travel = 0;
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    if (!everywhere && !vof_is_cut(sim->c->v[i])) continue;
    for (int f = 0; f < NFACE; f++) {
      const double u = fabs(sim->u_f->v[mesh->cell_face[i][f]]);
      travel = max2(travel, mesh_edges(mesh, i, u * dt));
    }
  }
  sim->travel += mesh_max(mesh, travel);
}

/* Is a solve good enough? One that stalls at round-off or close to its
 * tolerance is, one that stalls far from it is not. */
static bool is_solved(const struct solve_stats *stats, double tolerance) {
  return stats->status == SOLVE_CONVERGED ||
         (stats->status == SOLVE_STALLED &&
          stats->residual_after <= max2(STALL_SLACK * tolerance, STALL_FLOOR));
}

static bool has_failed(const struct two_phase *sim) {
  const struct params *params = sim->params;
  const struct solve_stats *solve[] = {&sim->pressure, &sim->predictor,
                                       &sim->carrying, &sim->viscous};
  static const char *const name[] = {"pressure", "predictor", "carrying",
                                     "viscous"};
  const char *wild = fields_not_finite(&sim->grid.fields, sim->grid.mesh);
  bool failed = wild != NULL;
  if (failed) {
    log_info("step %lld: %s is not finite", (long long)sim->model.step, wild);
  }
  const double tolerances[] = {
      params->tolerance_pressure, params->tolerance_pressure,
      carrying_tolerance(params), params->tolerance_viscous * sim->scale};
  for (int k = 0; k < 4; k++) {
    const double tolerance = tolerances[k];
    if (is_solved(solve[k], tolerance)) continue;
    if (solve[k]->status == SOLVE_INCOMPATIBLE) {
      log_info("step %lld: %s solve: what flows in does not flow out",
               (long long)sim->model.step, name[k]);
    }
    log_info(
        "step %lld: %s solve stalled after %d iterations, residual %g of "
        "%g, tolerance %g",
        (long long)sim->model.step, name[k], solve[k]->iterations,
        solve[k]->residual_after, solve[k]->residual_before, tolerance);
    failed = true;
  }
  return failed;
}

/* Count the time since the last call for this stage. */
static void lap(struct two_phase *sim, enum step_stage stage) {
  stopwatch_lap(&sim->model.stopwatch, stage);
}

/* Advance the state from `time` to `time` + dt; rate: of time_step_choose. */
static void advance_state(struct two_phase *sim, double dt, double rate) {
  const double dt_c = 0.5 * (sim->model.dt + dt);
  fractions_advance(sim, dt_c, rate);
  percolation_advance(sim, dt_c), lap(sim, STAGE_FRACTION);
  update_density(sim);
  update_acceleration(sim);
  if (sim->exact) still_find(sim, dt);
  lap(sim, STAGE_DENSITY);
  update_viscosity(sim, sim->u_old), lap(sim, STAGE_RHEOLOGY);
  advect_momentum(sim, dt), lap(sim, STAGE_ADVECTION);
  double *advected[DIM];
  for (int k = 0; k <= sim->params->picard; k++) {
    const struct solve_stats viscous = sim->viscous, pressure = sim->pressure;
    repeat_properties(sim, k, advected), lap(sim, STAGE_RHEOLOGY);
    diffuse_momentum(sim, dt, k), lap(sim, STAGE_VISCOUS);
    project(sim, dt, k), lap(sim, STAGE_PROJECTION);
    if (k > 0) add_solve(&sim->viscous, &viscous);
    if (k > 0) add_solve(&sim->pressure, &pressure);
  }
  viscous_work_add(sim, dt);
  add_wall_work(sim, dt);
}

/* Set the state back to that before the step; `before` has the scalars. */
static void set_back(struct two_phase *sim, const struct two_phase *before) {
  fields_restore(&sim->grid.fields, sim->grid.mesh);
  slip_strip_renew(&sim->grid, sim->c->v);
  sim->planes_hold = false;
  sim->energy = before->energy;
  sim->divergence_volume = before->divergence_volume;
  sim->percolation = before->percolation;
}

/* Give back the face velocity of before a step, which is done or set back. */
static void drop_half(struct two_phase *sim) {
  scratch_give(&sim->scratch, "u_half");
  sim->u_half->v = NULL;
}

/* Take a step of at most dt_max, as short as need be; returns its dt, or 0 with
 * the state before the step. */
static double find_step(struct two_phase *sim, double dt_max) {
  const struct two_phase before = *sim;
  int failures = 0;
  fields_save(&sim->grid.fields, sim->grid.mesh);
  for (int attempt = 0; attempt <= SHORTENINGS; attempt++) {
    double rate;
    const double dt = time_step_choose(sim, dt_max, &rate);
    lap(sim, STAGE_OTHER);
    advance_state(sim, dt, rate);
    const bool failed = has_failed(sim);
    dt_max = failed ? RETRY_FACTOR * dt : time_step_allowed(sim, dt);
    const bool good = dt_max >= dt;
    if (!good) set_back(sim, &before);
    drop_half(sim);
    if (good) return dt;
    failures += failed;
    if (failures > RETRIES) break;
    log_info("step %lld: dt %.3g is repeated with %.3g",
             (long long)sim->model.step, dt, dt_max);
  }
  return 0;
}

int step_advance(struct two_phase *sim, double dt_max) {
  stopwatch_start(&sim->model.stopwatch);
  fields_touch(&sim->grid.fields, sim->grid.mesh); /* invariant 1 */
  const double dt = find_step(sim, dt_max);
  const char *taker = scratch_taker(&sim->scratch);
  CHECK(!taker, "%s has not given its scratch back", taker);
  if (dt == 0) return EXIT_NUMERICAL;
  sim->model.time += dt;
  sim->model.dt = dt;
  sim->model.step++;
  add_travel(sim, dt);
  set_cell_viscosity(sim), lap(sim, STAGE_OTHER);
  if (adapt_is_due(&sim->grid, sim->model.step, sim->travel))
    two_phase_adapt(sim);
  lap(sim, STAGE_ADAPTATION);
  clean_face_velocity(sim->grid.clean, sim->grid.mesh, sim->grid.open,
                      sim->u_f->v);
  lap(sim, STAGE_FRACTION);
  return EXIT_DONE;
}

/* Find pressure and acceleration of the grains at rest, without viscosity. */
static struct solve_stats static_pressure(struct two_phase *sim) {
  struct projection projection = begin_projection(sim);
  double *rest[DIM], *g[DIM], size = 0;
  double *u_f = scratch_take_one(&sim->scratch, FIELD_FACE, __func__);
  scratch_take(&sim->scratch, FIELD_CELL, __func__, DIM, rest);
  field_arrays(sim->g, g);
  for (int d = 0; d < DIM; d++) {
    memset(rest[d], 0, (size_t)sim->grid.mesh->ncells * sizeof(double));
    size = max2(size, fabs(sim->params->gravity[d]));
  }
  /* 1e-13 of the divergence gravity makes at a density jump, but not below
   * the round-off of p / (rho h^2) */
  const double cells = exp2(sim->params->level_max);
  projection.tolerance =
      size * cells / sim->params->size * max2(1e-13, 1e-16 * cells);
  projection_face_velocity(&projection, 1, rest, u_f);
  struct solve_stats stats = projection_project(&projection, 1, u_f, sim->p->v);
  scratch_give(&sim->scratch, __func__);
  pressure_level_set(sim);
  set_acceleration(sim, &projection, g);
  end_projection(sim);
  return stats;
}

void step_density(struct two_phase *sim) { update_density(sim); }

void step_acceleration(struct two_phase *sim, double *const g[DIM]) {
  find_acceleration(sim, g);
}

void step_start(struct two_phase *sim) {
  sim->planes_hold = false;
  update_density(sim);
  const double divergence = clean_divergence(sim->grid.mesh, sim->u_f->v);
  if (divergence > SOLENOIDAL * time_step_rate(sim)) {
    make_solenoidal(sim, 1 / divergence, sim->u_f->v);
  }
  sim->pressure = static_pressure(sim);
  field_fill_many(sim->grid.mesh, DIM, sim->u);
  update_viscosity(sim, sim->u);
  set_cell_viscosity(sim);
}
