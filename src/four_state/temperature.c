/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/four_state/temperature.h"

#include <math.h>
#include <string.h>

#include "talus/four_state/state.h"
#include "talus/minmax.h"
#include "talus/poisson.h"

/* Part of the store of a leaf that may leave through one face by delta. */
static const double MOST_GIVEN = 0.25 / DIM;
/* Production may take this times what friction has taken. */
static const double MOST_POWER = 2;
/* Tolerance of conduction, relative to the largest nu T; leaves below
 * LEAST_STORE of nu count as that. */
static const double TOLERANCE = 1e-7, LEAST_STORE = 1e-6;

double four_state_fluctuating(const struct four_state *sim) {
  const struct mesh *mesh = sim->grid.mesh;
  double sum = 0;
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    sum += sim->nu->v[i] * sim->T->v[i] * mesh_volume(mesh, i);
  }
  return 1.5 * sim->closure.param[LEE_HUANG_RHO_D] * mesh_sum(mesh, sum);
}

/* Set kappa and delta of leaves over 3/2 rho_d, m^2/s and m^4/s^3, filled. */
static void set_numbers(const struct four_state *sim, double *kappa,
                        double *delta) {
  static const struct bc neumann[MESH_MAX_PATCHES];
  const struct bc *bc[] = {neumann, neumann};
  const struct mesh *mesh = sim->grid.mesh;
  const double d = sim->closure.param[LEE_HUANG_D] / 1.5;
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    const double T = sim->T->v[i], s = sqrt(T);
    kappa[i] = delta[i] = 0;
    if (!(T > 0)) continue;
    const struct four_state_numbers k =
        four_state_numbers(&sim->closure, sim->nu->v[i]);
    kappa[i] = d * s * k.kappa;
    delta[i] = d * s * T * k.delta;
  }
  mesh_fill(mesh, 2, (double *const[]){kappa, delta}, bc, false);
}

/* Give how many times its change of T conduction must bring, as collisions take
 * back k dt of it on the way: k dt/(1 - exp(-k dt)), with which T is steady
 * where heat that comes is heat that is lost. */
static double held_back(double k, double dt) {
  const double x = k * dt;
  return x > 1e-8 ? x / -expm1(-x) : 1;
}

/* Set flux [nfaces_all] to what moves nu T up the gradient of nu. */
static void find_rise(const struct four_state *sim, double dt,
                      const double *delta, double *flux) {
  const struct mesh *mesh = sim->grid.mesh;
  const double *nu = sim->nu->v, *T = sim->T->v;
  for (int32_t f = 0; f < mesh->nfaces; f++) {
    const int32_t *node = mesh->face_node[f];
    const double rise = mesh_gradient(mesh, nu, f);
    const int32_t donor = node[rise > 0 ? 0 : 1];
    const double store = max2(nu[donor] * T[donor], 0) / dt;
    const double most = MOST_GIVEN * store * mesh->face_h[f];
    const double q = 0.5 * max2(delta[node[0]] + delta[node[1]], 0) * rise;
    flux[f] = mesh->face_patch[f] >= 0 ? 0 : copysign(min2(fabs(q), most), q);
  }
  mesh_fill_faces(mesh, 1, &flux);
}

static void move_up(struct four_state *sim, double dt, const double *mass,
                    const double *flux) {
  const struct mesh *mesh = sim->grid.mesh;
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    if (!four_state_has_grains(sim, i)) continue;
    sim->T->v[i] -= dt * mesh_divergence(mesh, flux, i) / mass[i];
  }
}

/* Conduct over dt: div(dt kappa grad T) - mass T = -mass T of before. */
static void conduct(struct four_state *sim, double dt, const double *kappa,
                    const double *mass, double *alpha, double *rhs) {
  const struct mesh *mesh = sim->grid.mesh;
  const double *nu = sim->nu->v, none = sim->keys->nu_vacuum;
  double most = 0;
  for (int32_t f = 0; f < mesh->nfaces; f++) {
    const int32_t *node = mesh->face_node[f];
    const bool joined = nu[node[0]] >= none && nu[node[1]] >= none;
    alpha[f] = joined && mesh->face_patch[f] < 0
                   ? 0.5 * dt * (kappa[node[0]] + kappa[node[1]])
                   : 0;
  }
  mesh_fill_faces(mesh, 1, &alpha);
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    rhs[i] = -mass[i] * sim->T->v[i];
    most = max2(most, -rhs[i]);
  }
  most = mesh_max(mesh, most);
  sim->conduction = (struct solve_stats){0};
  if (!(most > 0)) return;
  sim->conduction = poisson_solve(mesh, sim->grid.hierarchy, alpha, mass, NULL,
                                  rhs, sim->T->bc, TOLERANCE * most,
                                  sim->params->max_iterations, sim->T->v);
}

/* Return div u of a leaf within the grains; 0 beside the vacuum. */
static double leaf_divergence(const struct four_state *sim, int32_t i) {
  const struct mesh *mesh = sim->grid.mesh;
  const int32_t *node = mesh->stencil[i];
  double sum = 0;
  for (int d = 0; d < DIM; d++) {
    const int32_t lo = node[stencil_face(2 * d)];
    const int32_t hi = node[stencil_face(2 * d + 1)];
    if (min2(sim->nu->v[lo], sim->nu->v[hi]) < sim->keys->nu_vacuum) return 0;
    sum += 0.5 * (sim->u[d]->v[hi] - sim->u[d]->v[lo]);
  }
  return mesh_leaf_slope(mesh, i, sum) + mesh_hoop(mesh, sim->u[0]->v, i);
}

/* Return D:D of a leaf: the mean over its faces by the mass they have of it. */
static double leaf_strain(const struct four_state *sim, int32_t i) {
  const int32_t *face = sim->grid.mesh->cell_face[i];
  const double *gamma = sim->shear_f->v;
  double sum = 0;
  for (int d = 0; d < DIM; d++) {
    const double upper = sim->upper[d]->v[i];
    const double lo = gamma[face[2 * d]], hi = gamma[face[2 * d + 1]];
    sum += (1 - upper) * lo * lo + upper * hi * hi;
  }
  return 0.5 * sum / DIM;
}

/* Return the most that production may take, W/m^3. */
static double most_power(const struct four_state *sim, double dt, int32_t i,
                         double DD, double div) {
  const double mu = sim->mu_K->v[i], lambda = sim->lambda_K->v[i];
  const double h = sim->grid.mesh->h[i];
  const double rho = sim->closure.param[LEE_HUANG_RHO_D] * sim->nu->v[i];
  const double taken = 2 * mu * DD + (lambda - 2. / 3 * mu) * div * div;
  return max2(MOST_POWER * taken, rho * DD * h * h / dt);
}

/* Produce and dissipate, and set mass to nu times what holds back a change. */
static void react(struct four_state *sim, double dt, double *mass) {
  const struct mesh *mesh = sim->grid.mesh;
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    const double nu = sim->nu->v[i], T = max2(sim->T->v[i], 0);
    const double DD = leaf_strain(sim, i), div = leaf_divergence(sim, i);
    const struct four_state_rates rates = {DD, div,
                                           most_power(sim, dt, i, DD, div)};
    double k = 0;
    sim->T->v[i] =
        four_state_has_grains(sim, i)
            ? four_state_temperature(&sim->closure, nu, T, &rates, dt, &k)
            : 0;
    mass[i] = max2(nu, LEAST_STORE) * held_back(k, dt);
  }
  mesh_touch(mesh, sim->T->v);
}

/* Keep T between 0 and its bound, and at 0 in the vacuum. */
static void bound(struct four_state *sim) {
  const struct mesh *mesh = sim->grid.mesh;
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    double *T = &sim->T->v[i];
    *T =
        four_state_has_grains(sim, i) ? min2(max2(*T, 0), sim->keys->T_max) : 0;
  }
  mesh_touch(mesh, sim->T->v);
}

void four_state_heat(struct four_state *sim, double dt) {
  const struct mesh *mesh = sim->grid.mesh;
  double *cell[4];
  scratch_take(&sim->scratch, FIELD_CELL, __func__, 4, cell);
  double *face = scratch_take_one(&sim->scratch, FIELD_FACE, __func__);
  field_fill_many(mesh, 2, (struct field *const[]){sim->nu, sim->T});
  field_fill_many(mesh, DIM, sim->u);
  const double before = four_state_fluctuating(sim);
  double *kappa = cell[0], *delta = cell[1], *mass = cell[2];
  set_numbers(sim, kappa, delta);
  find_rise(sim, dt, delta, face);
  react(sim, dt, mass);
  move_up(sim, dt, mass, face);
  conduct(sim, dt, kappa, mass, face, cell[3]);
  bound(sim);
  sim->dissipated -= four_state_fluctuating(sim) - before;
  scratch_give(&sim->scratch, __func__);
}
