/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The time step of the two-fluid model, from t^n to t^n + dt.
 *
 * It begins with the solid fraction alpha, the velocities u_s, u_f of grains
 * and fluid, the pressure p of the fluid less rho_f g.x, the plastic packing
 * phi_p and the shear X that makes pressure, all in leaves. _f is at faces, a =
 * 1 - alpha, k = dt K, F a mean over the two leaves of a face by mass, A the
 * mean over the two faces of a leaf across an axis. In the order of the calls:
 *
 * two_fluid_time_step    dt, by what carries
 * two_fluid_properties   planes of the surface, K, Theta, p_s = P(alpha^n)
 *     with gamma of u^n
 * two_fluid_foresee      transport.h
 *     u_f <- u_f - dt div(F u_f)/a,  F = j - alpha u_s of the last step
 * two_fluid_velocities   velocities.h
 *     b = A(forces of p, p_s and weight)
 *     (m_s + theta m_f) u_s - dt div(tau_s + theta tau_f) = ...
 *         twice, with eta_s of gamma of u^n and then of u_s, or until the
 *         stress of an exact yield fits
 *     (m_f + k) u_f - dt div tau_f = ...
 *     u <- u^n + dt div tau/m
 * two_fluid_pressures    pressures.h, until j stays
 *     w = F(u), less what still grains of an exact yield leak
 *     u_s_f = [rho_s w_s - rho_f w_f + N j + dt (rho_s - rho_f) g
 *              - dt grad p_s^{n+1}/alpha]/M
 *     alpha^{n+1} = alpha^n - dt div(alpha u_s_f),  p_s^{n+1} = P(alpha^{n+1})
 *     div(lambda grad p) = div j / dt,  j = alpha u_s_f + a u_f_f
 *     u <- u + A(u_f - w)
 * two_fluid_transport    u_f without what was foreseen
 *     u, phi_p, X and tracers with the same fluxes
 *     alpha^{n+1} q = alpha^n q - dt div(alpha u_s_f q_f)
 * shear_grains
 *     phi_p <- phi_p exp(- delta gamma dt),   X towards its value at gamma
 * two_fluid_adapt        if grains have moved far enough
 *
 * Invariants between steps
 * 1. alpha, u, p, phi_p, X are valid on leaves, flux and j on all faces; every
 *    stage fills what it reads.
 * 2. 0 <= alpha < two_fluid_densest.
 * 3. div j = 0 to solver.tolerance_pressure.
 */
#include "talus/two_fluid/step.h"

#include <math.h>

#include "talus/error.h"
#include "talus/log.h"
#include "talus/minmax.h"
#include "talus/two_fluid/pressures.h"
#include "talus/two_fluid/properties.h"
#include "talus/two_fluid/state.h"
#include "talus/two_fluid/surface.h"
#include "talus/two_fluid/time_step.h"
#include "talus/two_fluid/transport.h"
#include "talus/two_fluid/velocities.h"
#include "talus/two_fluid_grains.h"

/* A failed step is repeated at most RETRIES times, each time with dt reduced by
 * RETRY_FACTOR. */
enum { RETRIES = 8 };
#define RETRY_FACTOR 0.5

/* A leaf may give away this part of its grains in a step, and what it holds may
 * be replaced MOST_RATE times. */
#define MOST_GIVEN 0.95
#define MOST_RATE 1.5
/* A residual that a stalled solve may leave, m/s. */
#define STALL_FLOOR 1e-12
/* Both phases may have this times the kinetic energy that is accounted for:
 * what grains are pressed by may do work over this strain. */
#define BURST 1.05
#define STRAIN 0.01

/* Let the plastic packing and the shear that makes pressure follow the shear
 * rate. */
static void shear_grains(struct two_fluid *sim, double dt) {
  const struct mesh *mesh = sim->grid.mesh;
  const struct two_fluid_closure *c = &sim->closure;
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    const double alpha = sim->alpha->v[i], gamma = sim->shear->v[i];
    const double eta = sim->eta->v[i];
    if (!two_fluid_has_grains(sim, i)) {
      sim->X->v[i] = 0;
      continue;
    }
    sim->phi_p->v[i] = two_fluid_next_packing(sim, i, alpha, dt);
    sim->X->v[i] =
        two_fluid_relaxed_shear(c, sim->X->v[i], gamma, eta, alpha, dt);
  }
  mesh_touch(mesh, sim->phi_p->v);
  mesh_touch(mesh, sim->X->v);
}

/* Set the mean of p over the fluid that holds no grains to 0, in a box without
 * an opening; over all of it where there is none. */
static void level_pressure(struct two_fluid *sim) {
  const struct mesh *mesh = sim->grid.mesh;
  double sum[2] = {0, 0}, volume[2] = {0, 0};
  if (sim->grid.pressure_set) return;
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    const int k = two_fluid_has_grains(sim, i);
    sum[k] += mesh_volume(mesh, i) * sim->p->v[i];
    volume[k] += mesh_volume(mesh, i);
  }
  for (int k = 0; k < 2; k++) {
    sum[k] = mesh_sum(mesh, sum[k]), volume[k] = mesh_sum(mesh, volume[k]);
  }
  const int k = volume[0] > 0 ? 0 : 1;
  for (int32_t i = 0; i < mesh->nleaves; i++)
    sim->p->v[i] -= sum[k] / volume[k];
  mesh_touch(mesh, sim->p->v);
}

/* Advance the state by dt; returns the largest part of its grains that a leaf
 * has given away. */
static double advance_state(struct two_fluid *sim, double dt) {
  sim->dt = dt;
  two_fluid_properties(sim), two_fluid_lap(sim, TWO_FLUID_CLOSURES);
  two_fluid_foresee(sim, dt);
  two_fluid_velocities(sim, dt), two_fluid_lap(sim, TWO_FLUID_VISCOUS);
  two_fluid_pressures(sim, dt), two_fluid_lap(sim, TWO_FLUID_PROJECTION);
  const double given = two_fluid_given(sim, dt);
  two_fluid_transport(sim, dt);
  shear_grains(sim, dt);
  two_fluid_settle_beds(sim, dt);
  level_pressure(sim), two_fluid_lap(sim, TWO_FLUID_TRANSPORT);
  return given;
}

/* Holds what a step begins with, J/m (3D: J). */
struct energy {
  double mass;    /* of both, kg/m */
  double kinetic; /* of both */
  double stored;  /* that p_s may do in work, at most */
};

static struct energy energy_of(const struct two_fluid *sim) {
  const struct mesh *mesh = sim->grid.mesh;
  struct energy sum = {0, 0, 0};
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    for (int k = 0; k < TWO_FLUID_NPHASES; k++) {
      const double m = two_fluid_density(sim, k) * mesh_volume(mesh, i) *
                       two_fluid_part(k, sim->alpha->v[i]);
      for (int d = 0; d < DIM; d++)
        sum.kinetic += 0.5 * m * sim->u[k][d]->v[i] * sim->u[k][d]->v[i];
      sum.mass += m;
    }
    sum.stored += STRAIN * sim->p_s->v[i] * mesh_volume(mesh, i);
  }
  return (struct energy){mesh_sum(mesh, sum.mass), mesh_sum(mesh, sum.kinetic),
                         mesh_sum(mesh, sum.stored)};
}

/* Return how much kinetic energy there is for each J that gravity over dt and
 * p_s may have made of what there was before. */
static double burst(const struct two_fluid *sim, double dt,
                    const struct energy *before) {
  if (two_fluid_is_driven(sim)) return 0;
  const double fall =
      sqrt(0.5 * before->mass) * params_gravity(sim->params) * dt;
  const double speed = sqrt(before->kinetic) + fall;
  const double most = BURST * (speed * speed + before->stored) + 1e-300;
  return energy_of(sim).kinetic / most;
}

/* Say what is wrong with the step that was taken; returns whether it is. */
static bool has_failed(const struct two_fluid *sim, double dt, double given,
                       double gained) {
  const long long step = (long long)sim->model.step;
  const char *wild = fields_not_finite(&sim->grid.fields, sim->grid.mesh);
  const double tolerance = sim->params->tolerance_viscous * sim->scale;
  const double rate = two_fluid_rate(sim) * dt;
  const struct solve_stats *projection = &sim->projection;
  if (wild != NULL) {
    log_info("step %lld: %s is not finite", step, wild);
    return true;
  }
  if (sim->pressure.status != SOLVE_CONVERGED) {
    log_info(
        "step %lld: pressure and mass of the grains do not fit by %.3g after "
        "%d Newton iterations",
        step, sim->pressure.residual, sim->pressure.newton);
    return true;
  }
  if (!solve_passes(projection, sim->params->tolerance_pressure, STALL_FLOOR)) {
    log_info("step %lld: projection stalled after %d iterations, residual %g",
             step, projection->iterations, projection->residual_after);
    return true;
  }
  for (int k = 0; k < TWO_FLUID_NPHASES; k++) {
    if (solve_passes(&sim->viscous[k], tolerance, STALL_FLOOR)) continue;
    log_info(
        "step %lld: viscous solve of the %s stalled after %d iterations, "
        "residual %g, tolerance %g",
        step, k == TWO_FLUID_S ? "grains" : "fluid", sim->viscous[k].iterations,
        sim->viscous[k].residual_after, tolerance);
    return true;
  }
  if (given > MOST_GIVEN || rate > MOST_RATE) {
    log_info(
        "step %lld: a leaf gives away %.3g of its grains, and is crossed %.3g "
        "times",
        step, given, rate);
    return true;
  }
  if (!(gained <= 1)) {
    log_info(
        "step %lld: grains burst, with %.3g times the energy that gravity and "
        "their pressure may have given them",
        step, gained);
    return true;
  }
  return false;
}

/* Take a step of at most dt_max; returns its dt, or 0 with the state of before.
 */
static double find_step(struct two_fluid *sim, double dt_max) {
  const struct energy before = energy_of(sim);
  fields_save(&sim->grid.fields, sim->grid.mesh);
  for (int attempt = 0; attempt <= RETRIES; attempt++) {
    const double dt = two_fluid_time_step(sim, dt_max);
    const double given = advance_state(sim, dt);
    if (!has_failed(sim, dt, given, burst(sim, dt, &before))) return dt;
    fields_restore(&sim->grid.fields, sim->grid.mesh);
    dt_max = RETRY_FACTOR * dt;
    log_info("step %lld: dt %.3g is repeated with at most %.3g",
             (long long)sim->model.step, dt, dt_max);
  }
  return 0;
}

int two_fluid_step(struct two_fluid *sim, double dt_max) {
  stopwatch_start(&sim->model.stopwatch);
  fields_touch(&sim->grid.fields, sim->grid.mesh);
  const double dt = find_step(sim, dt_max);
  const char *taker = scratch_taker(&sim->scratch);
  CHECK(!taker, "%s has not given its scratch back", taker);
  if (dt == 0) return EXIT_NUMERICAL;
  sim->model.time += dt;
  sim->model.dt = dt;
  sim->model.step++;
  sim->travel += 2 * two_fluid_rate(sim) * dt;
  two_fluid_lap(sim, TWO_FLUID_OTHER);
  if (adapt_is_due(&sim->grid, sim->model.step, sim->travel))
    two_fluid_adapt(sim);
  two_fluid_lap(sim, TWO_FLUID_ADAPTATION);
  return EXIT_DONE;
}
