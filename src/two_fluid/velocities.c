/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/two_fluid/velocities.h"

#include <math.h>
#include <string.h>

#include "talus/minmax.h"
#include "talus/two_fluid/pressures.h"
#include "talus/two_fluid/properties.h"
#include "talus/two_fluid/state.h"
#include "talus/two_fluid_pair.h"
#include "talus/viscous.h"

/* Friction is found PICARD times, with the shear rates of the last solve, with
 * an exact yield at least so often (yield.h). */
enum { PICARD = 2 };

/* Return m of a phase in leaf i, > 0. */
static double mass_of(const struct two_fluid *sim, int phase, int32_t i) {
  const double part = two_fluid_part(phase, sim->alpha->v[i]);
  return two_fluid_density(sim, phase) * max2(part, TWO_FLUID_NONE);
}

/* Return k = dt K of leaf i. */
static double drag_of(const struct two_fluid *sim, double dt, int32_t i) {
  return dt * sim->drag->v[i] * max2(sim->alpha->v[i], 0);
}

/* Return theta, which of an alpha and K/alpha; of a leaf or of a face. */
static double share(const struct two_fluid *sim, double dt, double alpha,
                    double drag) {
  const double k = dt * drag * max2(alpha, 0);
  const double m = two_fluid_density(sim, TWO_FLUID_F) * (1 - alpha);
  return k > 0 ? k / (max2(m, 0) + k) : 0;
}

/* Find the largest speed of both phases, the walls and free fall over dt. */
static double speed_scale(const struct two_fluid *sim, double dt) {
  double most = 1e-300;
  for (int d = 0; d < DIM; d++) {
    most = max2(most, dt * fabs(sim->params->gravity[d]));
    for (int k = 0; k < TWO_FLUID_NPHASES; k++) {
      const struct field *u = sim->u[k][d];
      for (int b = 0; b < MESH_MAX_PATCHES; b++)
        most = max2(most, fabs(u->bc[b].value));
      for (int32_t i = 0; i < sim->grid.mesh->nleaves; i++)
        most = max2(most, fabs(u->v[i]));
    }
  }
  return mesh_max(sim->grid.mesh, most);
}

/* Return the skin that the velocity of a phase has. */
static const struct skin *skin_of(const struct two_fluid *sim, int phase) {
  return phase == TWO_FLUID_S ? sim->skin : NULL;
}

/* Solve for the velocity of a phase; u: guess, solution. tolerance in m/s. */
static void solve(struct two_fluid *sim, int phase, double dt,
                  const double *eta_f, const double *mass,
                  double *const rhs[DIM], double tolerance) {
  const struct bc *bc[DIM];
  double *u[DIM];
  const struct viscosity viscosity = {.eta_f = eta_f,
                                      .kappa_f = sim->kappa_f[phase]->v,
                                      .skin = skin_of(sim, phase)};
  field_arrays(sim->u[phase], u);
  for (int e = 0; e < DIM; e++) bc[e] = sim->u[phase][e]->bc;
  const struct solve_stats before = sim->viscous[phase];
  sim->viscous[phase] =
      viscous_solve(sim->grid.mesh, sim->grid.hierarchy, mass, &viscosity, dt,
                    rhs, bc, tolerance, sim->params->max_iterations, u);
  solve_add(&sim->viscous[phase], &before);
}

/* Set theta alpha_f eta_f on faces, which the grains feel of the fluid, and
 * `all` to that and their own. */
static void set_shared(struct two_fluid *sim, double dt, double *shared,
                       double *all) {
  const struct mesh *mesh = sim->grid.mesh;
  const double *alpha = sim->alpha->v;
  for (int32_t f = 0; f < mesh->nfaces; f++) {
    const int32_t *node = mesh->face_node[f];
    const double mean = 0.5 * (alpha[node[0]] + alpha[node[1]]);
    shared[f] =
        share(sim, dt, mean, sim->drag_f->v[f]) * sim->eta_f[TWO_FLUID_F]->v[f];
    all[f] = shared[f] + sim->eta_f[TWO_FLUID_S]->v[f];
  }
  mesh_fill_faces(mesh, 2, (double *const[]){shared, all});
}

/* Leave in u_s its value without pressure, weight and drag: u_s* of the header.
 * rhs [DIM] and mass are those of the solve. */
static void keep_solid(struct two_fluid *sim, double dt, const double *shared,
                       const double *mass, double *const rhs[DIM],
                       double *const force[DIM]) {
  const struct mesh *mesh = sim->grid.mesh;
  double *u[DIM];
  field_arrays(sim->u[TWO_FLUID_S], u);
  const struct viscosity fluid = {.eta_f = shared,
                                  .kappa_f = sim->kappa_f[TWO_FLUID_F]->v,
                                  .skin = sim->skin};
  viscous_force(mesh, &fluid, u, force);
  for (int e = 0; e < DIM; e++) {
    const double *before = sim->u[TWO_FLUID_S][e]->saved;
    for (int32_t i = 0; i < mesh->nleaves; i++) {
      const double both = mass[i] * u[e][i] - rhs[e][i];
      force[e][i] =
          before[i] + (both - dt * force[e][i]) / mass_of(sim, TWO_FLUID_S, i);
    }
  }
}

/* Let leaves without grains keep the velocity that they have, that of the
 * grains around them: in free fall they would have a part in div u of the faces
 * of the leaves beside them. */
static void keep_empty(const struct two_fluid *sim, const double *mass,
                       double *const rhs[DIM]) {
  for (int32_t i = 0; i < sim->grid.mesh->nleaves; i++) {
    if (two_fluid_has_grains(sim, i)) continue;
    for (int e = 0; e < DIM; e++)
      rhs[e][i] = mass[i] * sim->u[TWO_FLUID_S][e]->v[i];
  }
}

/* Solve for the grains with their friction. Leaves in `shared` what set_shared
 * does. */
static void solve_capped(struct two_fluid *sim, double dt, const double *mass,
                         double *const rhs[DIM], double *shared) {
  double *all = scratch_take_one(&sim->scratch, FIELD_FACE, __func__);
  for (int k = 0; k < PICARD; k++) {
    if (k > 0) {
      two_fluid_calm(sim);
      two_fluid_viscosities(sim);
    }
    set_shared(sim, dt, shared, all);
    keep_empty(sim, mass, rhs);
    solve(sim, TWO_FLUID_S, dt, all, mass, rhs,
          sim->params->tolerance_viscous * sim->scale);
  }
  scratch_give(&sim->scratch, __func__);
}

/* Set `full` to the right hand side with the force of the stress, which it has,
 * and `all` to shared and the viscosity of the grains. */
static void add_stress(const struct two_fluid *sim, double dt,
                       double *const rhs[DIM], const double *shared,
                       double *all, double *const full[DIM]) {
  const struct mesh *mesh = sim->grid.mesh;
  for (int e = 0; e < DIM; e++) {
    for (int32_t i = 0; i < mesh->nleaves; i++)
      full[e][i] = rhs[e][i] + dt * full[e][i];
  }
  for (int32_t f = 0; f < mesh->nfaces_all; f++) all[f] += shared[f];
}

/* Do it with an exact yield (yield.h); full [DIM][nleaves] is overwritten. */
static void solve_yield(struct two_fluid *sim, double dt, const double *mass,
                        double *const rhs[DIM], double *shared,
                        double *const full[DIM]) {
  const struct mesh *mesh = sim->grid.mesh;
  double *face[3], *u[DIM];
  field_arrays(sim->u[TWO_FLUID_S], u);
  scratch_take(&sim->scratch, FIELD_FACE, __func__, 3, face);
  double *r = face[0], *eta = face[1], *all = face[2];
  const double buoyant =
      two_fluid_density(sim, TWO_FLUID_S) - two_fluid_density(sim, TWO_FLUID_F);
  bool fits = false;
  for (int k = 0; k < PICARD || !fits; k++) {
    if (k > 0) two_fluid_viscosities(sim);
    yield_set_rate(&sim->yield, sim->params, buoyant, sim->scale);
    yield_linearise(&sim->yield, k > 0 ? 0 : dt, r, eta, full);
    set_shared(sim, dt, shared, all);
    keep_empty(sim, mass, rhs);
    memcpy(all, eta, (size_t)mesh->nfaces_all * sizeof *all);
    add_stress(sim, dt, rhs, shared, all, full);
    solve(sim, TWO_FLUID_S, dt, all, mass, full,
          sim->params->tolerance_viscous * sim->scale);
    two_fluid_calm(sim);
    fits = yield_fits(&sim->yield, (long long)sim->model.step, k + 1,
                      yield_advance(&sim->yield, dt, r, eta, u, k > 0));
  }
  scratch_give(&sim->scratch, __func__);
}

/* Solve for the grains and leave u_s* in `star`, where their forces are. */
static void solve_solid(struct two_fluid *sim, double dt, double *const b[DIM],
                        double *const star[DIM]) {
  const struct mesh *mesh = sim->grid.mesh;
  double *cell[DIM + 1];
  double *shared = scratch_take_one(&sim->scratch, FIELD_FACE, __func__);
  scratch_take(&sim->scratch, FIELD_CELL, __func__, DIM + 1, cell);
  double **rhs = cell, *mass = cell[DIM];
  two_fluid_viscosities(sim);
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    const double theta = share(sim, dt, sim->alpha->v[i], sim->drag->v[i]);
    mass[i] =
        mass_of(sim, TWO_FLUID_S, i) + theta * mass_of(sim, TWO_FLUID_F, i);
  }
  for (int e = 0; e < DIM; e++) {
    double *u_s = sim->u[TWO_FLUID_S][e]->v;
    const double *u_f = sim->u[TWO_FLUID_F][e]->v;
    for (int32_t i = 0; i < mesh->nleaves; i++) {
      const double m_s = mass_of(sim, TWO_FLUID_S, i);
      if (two_fluid_has_grains(sim, i)) u_s[i] += dt * star[e][i];
      rhs[e][i] = m_s * u_s[i] + (mass[i] - m_s) * (u_f[i] + dt * b[e][i]);
    }
    mesh_touch(mesh, u_s);
  }
  if (sim->exact)
    solve_yield(sim, dt, mass, rhs, shared, star);
  else
    solve_capped(sim, dt, mass, rhs, shared);
  two_fluid_calm(sim);
  two_fluid_shear_leaves(sim);
  keep_solid(sim, dt, shared, mass, rhs, star);
  scratch_give(&sim->scratch, __func__);
}

/* Leave in u_f its value without pressure and drag: u_f* of the header.
 * shared, own [DIM][nleaves] are overwritten. */
static void keep_fluid(struct two_fluid *sim, double dt,
                       double *const shared[DIM], double *const own[DIM]) {
  const struct mesh *mesh = sim->grid.mesh;
  double *eta[2], *u[TWO_FLUID_NPHASES][DIM];
  scratch_take(&sim->scratch, FIELD_FACE, __func__, 2, eta);
  set_shared(sim, dt, eta[0], eta[1]);
  for (int32_t f = 0; f < mesh->nfaces_all; f++)
    eta[1][f] = sim->eta_f[TWO_FLUID_F]->v[f] - eta[0][f];
  for (int k = 0; k < TWO_FLUID_NPHASES; k++) {
    const struct viscosity part = {.eta_f = eta[k],
                                   .kappa_f = sim->kappa_f[TWO_FLUID_F]->v,
                                   .skin = skin_of(sim, k)};
    field_arrays(sim->u[k], u[k]);
    viscous_force(mesh, &part, u[k], k == TWO_FLUID_S ? shared : own);
  }
  scratch_give(&sim->scratch, __func__);
  for (int e = 0; e < DIM; e++) {
    const double *before = sim->u[TWO_FLUID_F][e]->saved;
    const double *gain = sim->gain[e]->v;
    for (int32_t i = 0; i < mesh->nleaves; i++)
      u[TWO_FLUID_F][e][i] =
          before[i] + gain[i] +
          dt * (shared[e][i] + own[e][i]) / mass_of(sim, TWO_FLUID_F, i);
    mesh_touch(mesh, u[TWO_FLUID_F][e]);
  }
}

/* Solve for the fluid and leave u_f* in its velocity. b is overwritten. */
static void solve_fluid(struct two_fluid *sim, double dt,
                        double *const b[DIM]) {
  const struct mesh *mesh = sim->grid.mesh;
  double *cell[DIM + 1], least = 1;
  scratch_take(&sim->scratch, FIELD_CELL, __func__, DIM + 1, cell);
  double **rhs = cell, *mass = cell[DIM];
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    const double m = mass_of(sim, TWO_FLUID_F, i), k = drag_of(sim, dt, i);
    mass[i] = m + k;
    least = min2(least, m / mass[i]);
    for (int e = 0; e < DIM; e++) {
      rhs[e][i] = m * (sim->u[TWO_FLUID_F][e]->v[i] + dt * b[e][i]) +
                  k * sim->u[TWO_FLUID_S][e]->v[i];
    }
  }
  least = -mesh_max(mesh, -least); /* what drag makes of an error in u_f */
  solve(sim, TWO_FLUID_F, dt, sim->eta_f[TWO_FLUID_F]->v, mass, rhs,
        least * sim->params->tolerance_viscous * sim->scale);
  keep_fluid(sim, dt, rhs, b);
  scratch_give(&sim->scratch, __func__);
}

/* Take u_s* [DIM][nleaves] for the velocity of the grains. */
static void take_solid(struct two_fluid *sim, double *const star[DIM]) {
  const struct mesh *mesh = sim->grid.mesh;
  for (int e = 0; e < DIM; e++) {
    memcpy(sim->u[TWO_FLUID_S][e]->v, star[e],
           (size_t)mesh->nleaves * sizeof(double));
    mesh_touch(mesh, sim->u[TWO_FLUID_S][e]->v);
  }
}

void two_fluid_velocities(struct two_fluid *sim, double dt) {
  double *b[DIM], *star[DIM];
  scratch_take(&sim->scratch, FIELD_CELL, "forces", DIM, b);
  scratch_take(&sim->scratch, FIELD_CELL, "velocity", DIM, star);
  two_fluid_fill_pressure(sim, dt);
  for (int e = 0; e < DIM; e++)
    two_fluid_leaf_forces(sim, e, (double *const[]){star[e], b[e]});
  sim->scale = speed_scale(sim, dt);
  for (int k = 0; k < TWO_FLUID_NPHASES; k++)
    sim->viscous[k] = (struct solve_stats){0};
  solve_solid(sim, dt, b, star);
  solve_fluid(sim, dt, b);
  take_solid(sim, star);
  scratch_give(&sim->scratch, "forces");
  scratch_give(&sim->scratch, "velocity");
  two_fluid_calm(sim);
  field_fill_many(sim->grid.mesh, DIM, sim->u[TWO_FLUID_F]);
}
