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
 * step_density
 *     rho = c rho_1 + (1 - c) rho_2,  alpha_f = 1/rho_f
 *     gravity_f = grad of the weight, less that of the surface, over rho_f
 * pressures_renew      where there are grains
 *     g = A(gravity_f - alpha_f grad p)
 * still_find           with "exact", which grains hardly move (still.h)
 * update_viscosity
 *     eta_f = both phases in series, eta_1 of the shear rate of u^n and of p
 * velocities_advect    away from the band
 *     u^{n+1/2} = u^n + dt/2 (g - u^n.grad u^n), upwind, on faces
 *     u_f^{n+1/2} = its normal part less dt/2 alpha_f grad phi, solenoidal
 *     u <- u - dt/h sum_d [u_f^{n+1/2} (u^{n+1/2} - u^n)]_d
 *   with solver.advection = "off" not this, and the second line of
 *   fractions_advance not either
 * and, once or repeatedly with eta_f of the latest u and p (repeat_properties;
 * in the first step of a run from rest at least START_REPETITIONS times),
 * velocities_diffuse   with "exact" as yield.h says, else
 *     rho u* - theta dt div(2 eta D(u*))
 *         = rho (u + dt g) + (1 - theta) dt div(2 eta D(u^n)) + dt f
 *     v = (u* - u)/dt - g - f/rho,   f of side walls (side_walls.h)
 *     u* <- u* - dt g
 * pressures_project
 *     u_f = mean of u* on both sides, by mass, + dt gravity_f, with "exact"
 *           not where grains hardly move (still.h)
 *     div(alpha_f grad p) = div u_f/dt
 *     u_f^{n+1} = u_f - dt alpha_f grad p
 *     g = A(gravity_f - alpha_f grad p)
 *     u^{n+1} = u* + dt g
 *     with "exact" u_f of slow grains is then made anew from u^{n+1} (still.h)
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
#include "talus/clean.h"
#include "talus/error.h"
#include "talus/log.h"
#include "talus/minmax.h"
#include "talus/side_walls.h"
#include "talus/skin.h"
#include "talus/slip_strip.h"
#include "talus/strain.h"
#include "talus/two_phase/fractions.h"
#include "talus/two_phase/percolation.h"
#include "talus/two_phase/pressures.h"
#include "talus/two_phase/properties.h"
#include "talus/two_phase/state.h"
#include "talus/two_phase/still.h"
#include "talus/two_phase/time_step.h"
#include "talus/two_phase/velocities.h"
#include "talus/two_phase/viscous_work.h"
#include "talus/two_phase/yield_faces.h"
#include "talus/vof.h"

/* A divergence below this part of the rate of flow is round-off. */
#define SOLENOIDAL 1e-12

/* A residual that a stalled solve may leave: round-off may be there. */
#define STALL_FLOOR 1e-10

/* A failed step is repeated at most RETRIES times, each time with dt reduced by
 * RETRY_FACTOR; a step too long for the flow it finds, SHORTENINGS times. */
enum { RETRIES = 3, SHORTENINGS = 30 };
#define RETRY_FACTOR 0.25

/* A run from rest begins with the pressure of grains without viscosity: so
 * often its first step is repeated, until p is that of grains that yield. */
enum { START_REPETITIONS = 8 };

/* Describe gravity for properties_gravity, with five arrays of scratch. */
static struct gravity describe_gravity(const struct two_phase *sim,
                                       double *const work[5]) {
  const struct params *params = sim->params;
  struct gravity gravity = {.rho = sim->rho->v,
                            .weight = work[0],
                            .surface = work[1],
                            .count = work[2],
                            .near_surface = work[3],
                            .near_weight = work[4]};
  for (int d = 0; d < DIM; d++) {
    const bool periodic = params->boundary[2 * d].type == BOUNDARY_PERIODIC;
    gravity.bounded[d] = periodic ? 0 : params->gravity[d];
    gravity.periodic[d] = periodic ? params->gravity[d] : 0;
    gravity.origin[d] = params->origin[d];
  }
  return gravity;
}

void step_density(struct two_phase *sim) {
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

/* Set eta_f from a velocity, which is filled, and p. */
static void update_viscosity(struct two_phase *sim,
                             struct field *const velocity[DIM]) {
  const struct mesh *mesh = sim->grid.mesh;
  const struct params *params = sim->params;
  double *u[DIM], *normal[DIM], *work[3];
  field_arrays(velocity, u), field_arrays(sim->normal, normal);
  scratch_take(&sim->scratch, FIELD_FACE, __func__, 3, work);
  pressures_fill(sim);
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

/* Keep the advected velocity (k = 0), or set u back to it before repetition k
 * of these and renew the viscosity from the latest u and p. */
static void repeat_properties(struct two_phase *sim, int k, int repetitions,
                              double *advected[DIM]) {
  const size_t bytes = (size_t)sim->grid.mesh->nleaves * sizeof(double);
  if (repetitions == 0) return;
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
  if (k == repetitions) scratch_give(&sim->scratch, "advected");
}

/* Return how often viscosity and projection of this step are repeated.
 * Collective. */
static int count_repetitions(const struct two_phase *sim) {
  const int picard = sim->params->picard;
  if (sim->model.step > 0 || picard > START_REPETITIONS) return picard;
  double speed = time_step_boundary_speed(sim, false);
  for (int d = 0; d < DIM; d++) {
    for (int32_t i = 0; i < sim->grid.mesh->nleaves; i++) {
      speed = max2(speed, fabs(sim->u_old[d]->v[i]));
    }
  }
  return mesh_max(sim->grid.mesh, speed) > 0 ? picard : START_REPETITIONS;
}

static void add_wall_work(struct two_phase *sim, double dt) {
  double *u[DIM], *f[DIM];
  if (!sim->wall[0]) return;
  field_arrays(sim->u, u), field_arrays(sim->wall, f);
  sim->energy.dissipated += dt * side_walls_power(sim->grid.mesh, f, u);
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
  const double tolerances[] = {params->tolerance_pressure,
                               params->tolerance_pressure,
                               pressures_carrying_tolerance(params),
                               params->tolerance_viscous * sim->scale};
  for (int k = 0; k < 4; k++) {
    const double tolerance = tolerances[k];
    if (solve_passes(solve[k], tolerance, STALL_FLOOR)) continue;
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
  step_density(sim);
  pressures_renew(sim);
  if (sim->exact) still_find(sim, dt);
  lap(sim, STAGE_DENSITY);
  update_viscosity(sim, sim->u_old), lap(sim, STAGE_RHEOLOGY);
  velocities_advect(sim, dt), lap(sim, STAGE_ADVECTION);
  double *advected[DIM];
  const int repetitions = count_repetitions(sim);
  for (int k = 0; k <= repetitions; k++) {
    const struct solve_stats viscous = sim->viscous, pressure = sim->pressure;
    repeat_properties(sim, k, repetitions, advected), lap(sim, STAGE_RHEOLOGY);
    velocities_diffuse(sim, dt, k), lap(sim, STAGE_VISCOUS);
    pressures_project(sim, dt, k), lap(sim, STAGE_PROJECTION);
    if (k > 0) solve_add(&sim->viscous, &viscous);
    if (k > 0) solve_add(&sim->pressure, &pressure);
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

void step_start(struct two_phase *sim) {
  sim->planes_hold = false;
  step_density(sim);
  const double divergence = clean_divergence(sim->grid.mesh, sim->u_f->v);
  if (divergence > SOLENOIDAL * time_step_rate(sim)) {
    pressures_solenoidal(sim, 1 / divergence, sim->u_f->v);
  }
  sim->pressure = pressures_start(sim);
  field_fill_many(sim->grid.mesh, DIM, sim->u);
  update_viscosity(sim, sim->u);
  set_cell_viscosity(sim);
}
