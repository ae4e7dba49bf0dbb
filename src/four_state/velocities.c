/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/four_state/velocities.h"

#include <math.h>
#include <string.h>

#include "talus/four_state/properties.h"
#include "talus/four_state/state.h"
#include "talus/four_state/work.h"
#include "talus/minmax.h"
#include "talus/viscous.h"

/* Solid fractions below this count as this in the viscous equation. */
#define LEAST_NU 1e-6
/* Still grains are slower than this part of what gravity gives in a step. */
#define SLOW 0.1

/* Find the largest speed of the grains, the walls and free fall over dt. */
static double speed_scale(const struct four_state *sim, double dt) {
  double most = 1e-300;
  for (int d = 0; d < DIM; d++) {
    most = max2(most, dt * fabs(sim->params->gravity[d]));
    for (int k = 0; k < MESH_MAX_PATCHES; k++) {
      most = max2(most, fabs(sim->u[d]->bc[k].value));
    }
    for (int32_t i = 0; i < sim->grid.mesh->nleaves; i++) {
      if (four_state_has_grains(sim, i))
        most = max2(most, fabs(sim->u[d]->v[i]));
    }
  }
  return mesh_max(sim->grid.mesh, most);
}

void four_state_calm(struct four_state *sim) {
  const struct mesh *mesh = sim->grid.mesh;
  const double *nu = sim->nu->v;
  for (int e = 0; e < DIM; e++) {
    double *u = sim->u[e]->v;
    field_fill(mesh, sim->u[e]);
    for (int32_t i = 0; i < mesh->nleaves; i++) {
      double mass = 0, sum = 0;
      if (four_state_has_grains(sim, i)) continue;
      for (int s = 0; s < NSTENCIL; s++) {
        const int32_t node = mesh->stencil[i][s];
        if (nu[node] < sim->keys->nu_vacuum) continue;
        mass += nu[node];
        sum += nu[node] * u[node];
      }
      u[i] = mass > 0 ? sum / mass : 0;
    }
    mesh_touch(mesh, u);
    field_fill(mesh, sim->u[e]);
  }
}

/* A viscous equation of a step. */
struct equation {
  double dt;
  const double *mass; /* [nleaves] */
  double **rhs;       /* [DIM][nleaves] */
};

/* Solve it with a viscosity eta_f. Iterations are added up; u: guess, solution.
 */
static void diffuse(struct four_state *sim, const struct equation *by,
                    double *const rhs[DIM], const double *eta_f) {
  const struct bc *bc[DIM];
  double *u[DIM];
  const struct viscosity viscosity = {
      .eta_f = eta_f, .kappa_f = sim->kappa_f->v, .skin = sim->skin};
  field_arrays(sim->u, u);
  for (int e = 0; e < DIM; e++) bc[e] = sim->u[e]->bc;
  const int before = sim->viscous.iterations;
  sim->viscous = viscous_solve(sim->grid.mesh, sim->grid.hierarchy, by->mass,
                               &viscosity, by->dt, rhs, bc,
                               sim->params->tolerance_viscous * sim->scale,
                               sim->params->max_iterations, u);
  sim->viscous.iterations += before;
}

/* Give leaves without grains the velocity of those around them, and a right
 * hand side that leaves it there. */
static void calm(struct four_state *sim, const struct equation *by) {
  four_state_calm(sim);
  for (int32_t i = 0; i < sim->grid.mesh->nleaves; i++) {
    if (four_state_has_grains(sim, i)) continue;
    for (int e = 0; e < DIM; e++) by->rhs[e][i] = by->mass[i] * sim->u[e]->v[i];
  }
}

static void solve_exponential(struct four_state *sim,
                              const struct equation *by) {
  double *u[DIM];
  field_arrays(sim->u, u);
  diffuse(sim, by, by->rhs, sim->eta_f->v);
  four_state_book_friction(sim, by->mass, by->rhs, u);
  calm(sim, by);
}

/* Do it with an exact yield (yield.h). */
static void solve_yield(struct four_state *sim, const struct equation *by) {
  const struct mesh *mesh = sim->grid.mesh;
  const double rho = sim->closure.param[LEE_HUANG_RHO_D];
  double *full[DIM], *face[2], *u[DIM];
  field_arrays(sim->u, u);
  scratch_take(&sim->scratch, FIELD_CELL, __func__, DIM, full);
  scratch_take(&sim->scratch, FIELD_FACE, __func__, 2, face);
  double *r = face[0], *eta = face[1];
  bool fits = false;
  for (int k = 0; !fits; k++) {
    if (k > 0) four_state_shear(sim, u);
    yield_set_rate(&sim->yield, sim->params, rho, sim->scale);
    yield_linearise(&sim->yield, k > 0 ? 0 : by->dt, r, eta, full);
    for (int e = 0; e < DIM; e++) {
      for (int32_t i = 0; i < mesh->nleaves; i++)
        full[e][i] = by->rhs[e][i] + by->dt * full[e][i];
    }
    diffuse(sim, by, full, eta);
    calm(sim, by);
    fits = yield_fits(&sim->yield, (long long)sim->model.step, k + 1,
                      yield_advance(&sim->yield, by->dt, r, eta, u, k > 0));
  }
  four_state_book_friction(sim, by->mass, by->rhs, u);
  scratch_give(&sim->scratch, __func__);
}

void four_state_predict(struct four_state *sim, double dt, double *a_f,
                        double *start_f) {
  const struct mesh *mesh = sim->grid.mesh;
  const double rho = sim->closure.param[LEE_HUANG_RHO_D];
  double *u[DIM], *cell[2 * DIM + 1];
  field_arrays(sim->u, u);
  scratch_take(&sim->scratch, FIELD_CELL, __func__, 2 * DIM + 1, cell);
  double **a = cell, **rhs = cell + DIM, *mass = cell[2 * DIM];
  const struct equation by = {.dt = dt, .mass = mass, .rhs = rhs};
  four_state_face_acceleration(sim, sim->p->v, a_f);
  four_state_acceleration(sim, a_f, a);
  field_fill_many(mesh, DIM, sim->u);
  four_state_face_velocity(sim, u, start_f);
  sim->impact +=
      0.5 * dt * four_state_fall(sim, u) - four_state_work(sim, dt, NULL, a, u);
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    mass[i] = rho * max2(sim->nu->v[i], LEAST_NU);
    for (int e = 0; e < DIM; e++) {
      rhs[e][i] = mass[i] * (u[e][i] + dt * a[e][i]);
      u[e][i] += dt * sim->trend[e]->v[i];
    }
  }
  for (int e = 0; e < DIM; e++) mesh_touch(mesh, u[e]);
  field_fill_many(mesh, DIM, sim->u);
  four_state_viscosity(sim, u);
  sim->scale = speed_scale(sim, dt);
  sim->viscous = (struct solve_stats){0};
  if (sim->exact)
    solve_yield(sim, &by);
  else
    solve_exponential(sim, &by);
  four_state_shear(sim, u);
  for (int e = 0; e < DIM; e++) {
    const double *before = sim->u[e]->saved;
    double *trend = sim->trend[e]->v;
    for (int32_t i = 0; i < mesh->nleaves; i++) {
      trend[i] = (u[e][i] - before[i]) / dt;
      u[e][i] -= dt * a[e][i];
    }
    mesh_touch(mesh, u[e]);
    mesh_touch(mesh, trend);
  }
  scratch_give(&sim->scratch, __func__);
}

/* Set the field still to how still grains that touch are, 1: at rest, 0 where
 * they move by SLOW of what gravity gives in dt. */
static void find_still(struct four_state *sim, double dt) {
  const struct mesh *mesh = sim->grid.mesh;
  const double slow = max2(SLOW * dt * params_gravity(sim->params), 1e-300);
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    double u2 = 0;
    for (int e = 0; e < DIM; e++)
      u2 += sim->u[e]->saved[i] * sim->u[e]->saved[i];
    sim->still->v[i] = sim->touches->v[i] * max2(0, 1 - sqrt(u2) / slow);
  }
  mesh_fill_ghosts(mesh, 1, &sim->still->v);
}

void four_state_hold(struct four_state *sim, double dt, const double *a_f,
                     double *u_f) {
  static const struct bc neumann[MESH_MAX_PATCHES];
  const struct mesh *mesh = sim->grid.mesh;
  const double *still = sim->still->v;
  const struct bc *bc[DIM];
  double *a[DIM];
  for (int e = 0; e < DIM; e++) bc[e] = neumann;
  scratch_take(&sim->scratch, FIELD_CELL, __func__, DIM, a);
  double *mean = scratch_take_one(&sim->scratch, FIELD_FACE, __func__);
  find_still(sim, dt);
  four_state_acceleration(sim, a_f, a);
  mesh_fill(mesh, DIM, a, bc, false);
  four_state_face_velocity(sim, a, mean);
  for (int32_t f = 0; f < mesh->nfaces; f++) {
    const int32_t *leaf = mesh->face_leaf[f];
    if (mesh->face_patch[f] >= 0 || leaf[0] < 0 || leaf[1] < 0) continue;
    const double part = min2(still[leaf[0]], still[leaf[1]]);
    u_f[f] += part * dt * (mean[f] - a_f[f]);
  }
  scratch_give(&sim->scratch, __func__);
}
