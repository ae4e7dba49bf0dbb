/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The time step of the four-state model [lee_huang_chiew_2015], from t^n to t^n
 * + dt.
 *
 * It begins with the solid fraction nu, the velocity u and the granular
 * temperature T of leaves. _f is at faces, A the mean over the two faces of a
 * leaf across an axis by the mass that they have of the leaf, and F a mean over
 * the two leaves of a face by the same masses (properties.h). M is the mass of
 * a face. In the order of the calls:
 *
 * four_state_time_step   dt, by the flow
 * four_state_properties  p, p_E, mu_K, lambda_K of nu^n and T^n; masses
 * four_state_predict     gamma: that of u^n + dt du/dt, du/dt of the last
 *                        prediction; or with an exact yield as yield.h says
 *     a_f = g - grad p/(rho_d M)
 *     rho_d nu u* - dt div[2 mu D(u*) + (lambda_K - 2/3 mu_K) div u* I]
 *         = rho_d nu (u^n + dt A(a_f))
 *     mu = mu_K + p_E eta_S (1 - exp(-n gamma/2))/gamma
 *     u* <- u* - dt A(a_f)
 * press                  granular_pressure.h, F(u*) of still grains less what
 *                        leaks between leaves and faces (velocities.h)
 *     u_f = F(u*) + dt a_f - 1/2 minmod(F(u*) + dt a_f - F(u^n), dt g)
 *           - dt/(rho_d M) grad(p^{n+1} - p)
 *     nu^{n+1} = nu^n - dt div(nu_f u_f),  p^{n+1} = P(nu^{n+1}, T^n)
 *     u <- u* + dt A(g - grad p^{n+1}/(rho_d M))
 * carry                  u and T with the same fluxes
 *     nu^{n+1} q = nu^n q - dt div(nu_f u_f q_f)
 * four_state_heat        conduction, delta grad nu, production, collisions
 * four_state_calm        leaves without grains take the velocity of those that
 *                        have some around them
 * four_state_adapt       if grains have moved far enough
 * Energy that forces take is booked as they act (work.h).
 *
 * Invariants between steps
 * 1. nu, u, T, du/dt are valid on leaves; every stage fills what it reads.
 * 2. 0 <= nu, 0 <= T <= vacuum.T_max.
 */
#include "talus/four_state/step.h"

#include <math.h>
#include <string.h>

#include "talus/error.h"
#include "talus/four_state/measure.h"
#include "talus/four_state/properties.h"
#include "talus/four_state/state.h"
#include "talus/four_state/temperature.h"
#include "talus/four_state/time_step.h"
#include "talus/four_state/velocities.h"
#include "talus/four_state/work.h"
#include "talus/log.h"
#include "talus/minmax.h"

/* A failed step is repeated at most RETRIES times, each time with dt reduced by
 * RETRY_FACTOR. */
enum { RETRIES = 20, MOST_NEWTON = 30 };
#define RETRY_FACTOR 0.5

/* A leaf may give away this part of its grains in a step. */
#define MOST_GIVEN 0.95
/* R of granular_pressure.h is bounded by this times solver.tolerance_pressure.
 */
#define PRESSURE_FACTOR 1e-4
/* Grains may have this times the kinetic energy that is accounted for, which is
 * a bound: gravity alone makes sqrt(K) grow by sqrt(M/2) g dt at most. */
#define BURST 1.05
/* Part of a rise of pressure by which its slope is taken ahead
 * (docs/notes/four_state.md). */
#define AHEAD 0.1
/* Slope of P over K where there is no pressure. */
#define LEAST_SLOPE 1e-12
/* Leaves with less have no velocity and no T of their own. */
#define LEAST_NU 1e-6
/* Part of the largest speed that a stalled viscous solve may leave. */
#define STALL_FLOOR 1e-10

static double find_pressure(const void *context, int32_t i, double nu,
                            double *slope) {
  const struct four_state *sim = context;
  return four_state_pressure(&sim->closure, max2(nu, 0), sim->T->v[i], slope);
}

static double find_fraction(const void *context, int32_t i, double p,
                            double from, double guess) {
  const struct four_state *sim = context;
  return four_state_solid_fraction(&sim->closure, p, sim->T->v[i],
                                   max2(from, 0), guess);
}

struct granular_pressure four_state_material(struct four_state *sim,
                                             const char *taker) {
  struct granular_pressure by = {
      .mesh = sim->grid.mesh,
      .hierarchy = sim->grid.hierarchy,
      .material = {sim, find_pressure, find_fraction},
      .mobility_f = sim->mobility_f->v,
      .nu_old = sim->nu->v,
      .p_old = sim->p->v,
      .rho = sim->weight->v,
      .ahead = AHEAD,
      .least_slope = LEAST_SLOPE * sim->closure.param[LEE_HUANG_K],
      .tolerance = PRESSURE_FACTOR * sim->params->tolerance_pressure,
      .max_newton = MOST_NEWTON,
      .max_iterations = sim->params->max_iterations};
  granular_pressure_take(&by, &sim->scratch, taker);
  return by;
}

/* Find p, u_f and the flux of the end of the step, u without advection, and
 * nu_new [nleaves]. */
static void press(struct four_state *sim, double dt, double *a_f,
                  const double *start_f, double *nu_new) {
  const struct mesh *mesh = sim->grid.mesh;
  double *u[DIM], *a[2 * DIM], *u_f = sim->u_f->v;
  field_arrays(sim->u, u);
  double *p = scratch_take_one(&sim->scratch, FIELD_CELL, __func__);
  field_fill_many(mesh, DIM, sim->u);
  four_state_face_velocity(sim, u, u_f);
  four_state_hold(sim, dt, a_f, u_f);
  four_state_accelerate_faces(sim, dt, a_f, start_f, u_f);
  const struct granular_pressure by = four_state_material(sim, "pressure");
  sim->pressure =
      granular_pressure_solve(&by, dt, u_f, p, nu_new, sim->flux->v);
  scratch_give(&sim->scratch, "pressure");
  granular_carry(mesh, dt, sim->nu->v, sim->flux->v, nu_new);
  scratch_take(&sim->scratch, FIELD_CELL, "accelerations", 2 * DIM, a);
  four_state_face_acceleration(sim, sim->p->v, a_f);
  four_state_acceleration(sim, a_f, a + DIM);
  memcpy(sim->p->v, p, (size_t)mesh->ncells * sizeof *p);
  sim->known_on = 0;
  four_state_face_acceleration(sim, sim->p->v, a_f);
  four_state_acceleration(sim, a_f, a);
  sim->impact += four_state_stored(sim, sim->nu->v) -
                 four_state_stored(sim, nu_new) -
                 four_state_work(sim, dt, a + DIM, a, u);
  for (int e = 0; e < DIM; e++) {
    for (int32_t i = 0; i < mesh->nleaves; i++) u[e][i] += dt * a[e][i];
    mesh_touch(mesh, u[e]);
  }
  sim->impact += 0.5 * dt * four_state_fall(sim, u);
  scratch_give(&sim->scratch, "accelerations");
  scratch_give(&sim->scratch, __func__);
}

/* Set keep [>= nleaves + nghosts] to how much of the slope of q counts in what
 * a leaf gives away: less, the more it gives, so that what stays behind does
 * not outrun its neighbours. */
static void find_keep(const struct four_state *sim, double dt, double *keep) {
  const struct mesh *mesh = sim->grid.mesh;
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    const double part = four_state_part_given(sim, dt, i, sim->nu->v[i]);
    keep[i] = max2(1 - 2 * part, 0);
  }
  mesh_fill_ghosts(mesh, 1, &keep);
}

/* Return q of what passes face f of axis d. */
static double carried(const struct four_state *sim, int32_t f, double dt,
                      const double *q, const double *slope,
                      const double *keep) {
  const struct mesh *mesh = sim->grid.mesh;
  const double u_f = sim->u_f->v[f];
  const int32_t leaf = mesh->face_leaf[f][u_f > 0 ? 0 : 1];
  if (leaf < 0) return 0;
  const double value = granular_donor(mesh, f, dt, u_f, q, slope);
  return q[leaf] + keep[leaf] * (value - q[leaf]);
}

/* Carry q with the grains; q is filled here. */
static void carry_one(struct four_state *sim, double dt, struct field *q,
                      const double *nu_new, double *const cell[2],
                      double *flux) {
  const struct mesh *mesh = sim->grid.mesh;
  const double *nu = sim->nu->v;
  field_fill(mesh, q);
  for (int d = 0; d < DIM; d++) {
    granular_slopes(mesh, d, q->v, cell[0]);
    for (int32_t f = mesh->face_begin[d]; f < mesh->face_begin[d + 1]; f++) {
      flux[f] = sim->flux->v[f] * carried(sim, f, dt, q->v, cell[0], cell[1]);
    }
  }
  mesh_fill_faces(mesh, 1, &flux);
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    const double store = nu[i] * q->v[i] - dt * mesh_divergence(mesh, flux, i);
    q->v[i] = nu_new[i] > LEAST_NU ? store / nu_new[i] : 0;
  }
  mesh_touch(mesh, q->v);
}

static void carry(struct four_state *sim, double dt, const double *nu_new) {
  const struct mesh *mesh = sim->grid.mesh;
  double *cell[2];
  scratch_take(&sim->scratch, FIELD_CELL, __func__, 2, cell);
  double *flux = scratch_take_one(&sim->scratch, FIELD_FACE, __func__);
  find_keep(sim, dt, cell[1]);
  for (int e = 0; e < DIM; e++) {
    carry_one(sim, dt, sim->u[e], nu_new, cell, flux);
  }
  carry_one(sim, dt, sim->T, nu_new, cell, flux);
  scratch_give(&sim->scratch, __func__);
  memcpy(sim->nu->v, nu_new, (size_t)mesh->nleaves * sizeof *nu_new);
  mesh_touch(mesh, sim->nu->v);
}

static void lap(struct four_state *sim, enum four_state_stage stage) {
  stopwatch_lap(&sim->model.stopwatch, stage);
}

/* Advance the state by dt; returns the largest part of its grains that a leaf
 * has given away. */
static double advance_state(struct four_state *sim, double dt) {
  double *face[2];
  scratch_take(&sim->scratch, FIELD_FACE, __func__, 2, face);
  double *nu_new = scratch_take_one(&sim->scratch, FIELD_CELL, __func__);
  four_state_properties(sim), lap(sim, FOUR_STATE_CLOSURES);
  four_state_predict(sim, dt, face[0], face[1]), lap(sim, FOUR_STATE_VISCOUS);
  press(sim, dt, face[0], face[1], nu_new);
  lap(sim, FOUR_STATE_PRESSURE);
  const double given = four_state_given(sim, dt, sim->nu->v);
  carry(sim, dt, nu_new), lap(sim, FOUR_STATE_TRANSPORT);
  scratch_give(&sim->scratch, __func__);
  four_state_heat(sim, dt), lap(sim, FOUR_STATE_TEMPERATURE);
  field_fill(sim->grid.mesh, sim->nu);
  four_state_calm(sim), lap(sim, FOUR_STATE_OTHER);
  return given;
}

/* Do walls or a given flow drive the grains? */
static bool is_driven(const struct four_state *sim) {
  bool driven = false;
  for (int k = 0; k < MESH_MAX_PATCHES; k++) {
    for (int d = 0; d < DIM; d++) driven |= sim->u[d]->bc[k].value != 0;
  }
  return driven;
}

/* Return how much kinetic energy there is for each J that gravity over dt and
 * what grains had stored may have made. Above 1 they burst: p_D has a pole at
 * nu_0, and grains packed beyond get a pressure from the first fluctuation that
 * no energy stands behind. */
static double burst(const struct four_state *sim, double dt,
                    const struct four_state_store *before) {
  if (is_driven(sim)) return 0;
  const double fall =
      sqrt(0.5 * before->mass) * params_gravity(sim->params) * dt;
  const double speed = sqrt(before->kinetic) + fall;
  const double most = BURST * (speed * speed + before->other) + 1e-300;
  return four_state_store(sim).kinetic / most;
}

/* Say what is wrong with the step that was taken; returns whether it is. */
static bool has_failed(const struct four_state *sim, double given,
                       double burst) {
  const long long step = (long long)sim->model.step;
  const char *wild = fields_not_finite(&sim->grid.fields, sim->grid.mesh);
  const double tolerance = sim->params->tolerance_viscous * sim->scale;
  if (wild != NULL) {
    log_info("step %lld: %s is not finite", step, wild);
  } else if (sim->pressure.status != SOLVE_CONVERGED) {
    log_info(
        "step %lld: pressure and mass do not fit by %.3g after %d Newton "
        "iterations",
        step, sim->pressure.residual, sim->pressure.newton);
  } else if (!solve_passes(&sim->viscous, tolerance,
                           STALL_FLOOR * sim->scale)) {
    log_info(
        "step %lld: viscous solve stalled after %d iterations, residual "
        "%g, tolerance %g",
        step, sim->viscous.iterations, sim->viscous.residual_after, tolerance);
  } else if (given > MOST_GIVEN) {
    log_info("step %lld: a leaf gives away %.3g of its grains", step, given);
  } else if (!(burst <= 1)) {
    log_info(
        "step %lld: grains burst, with %.3g times the energy that gravity and "
        "elasticity may have given them: those above grains.nu_0 have a "
        "pressure without bounds, so start from balance with a larger grains.K "
        "or a smaller grains.chi, or from a smaller grains.nu_start",
        step, burst);
  } else {
    return false;
  }
  return true;
}

/* Take a step of at most dt_max; returns its dt, or 0 with the state of before.
 */
static double find_step(struct four_state *sim, double dt_max) {
  const double dissipated = sim->dissipated, impact = sim->impact;
  const struct four_state_store before = four_state_store(sim);
  fields_save(&sim->grid.fields, sim->grid.mesh);
  for (int attempt = 0; attempt <= RETRIES; attempt++) {
    const double dt = four_state_time_step(sim, dt_max);
    const double given = advance_state(sim, dt);
    if (!has_failed(sim, given, burst(sim, dt, &before))) return dt;
    fields_restore(&sim->grid.fields, sim->grid.mesh);
    sim->dissipated = dissipated, sim->impact = impact;
    dt_max = RETRY_FACTOR * dt;
    log_info("step %lld: dt %.3g is repeated with at most %.3g",
             (long long)sim->model.step, dt, dt_max);
  }
  return 0;
}

/* Add how many cells grains may have moved. */
static void add_travel(struct four_state *sim, double dt) {
  const struct mesh *mesh = sim->grid.mesh;
  double most = 0;
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    if (!four_state_has_grains(sim, i)) continue;
    for (int d = 0; d < DIM; d++) {
      most = max2(most, mesh_edges(mesh, i, fabs(sim->u[d]->v[i]) * dt));
    }
  }
  sim->travel += mesh_max(mesh, most);
}

int four_state_step(struct four_state *sim, double dt_max) {
  stopwatch_start(&sim->model.stopwatch);
  fields_touch(&sim->grid.fields, sim->grid.mesh);
  const double dt = find_step(sim, dt_max);
  const char *taker = scratch_taker(&sim->scratch);
  CHECK(!taker, "%s has not given its scratch back", taker);
  if (dt == 0) return EXIT_NUMERICAL;
  sim->model.time += dt;
  sim->model.dt = dt;
  sim->model.step++;
  add_travel(sim, dt), lap(sim, FOUR_STATE_OTHER);
  if (adapt_is_due(&sim->grid, sim->model.step, sim->travel))
    four_state_adapt(sim);
  lap(sim, FOUR_STATE_ADAPTATION);
  return EXIT_DONE;
}
