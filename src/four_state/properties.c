/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/four_state/properties.h"

#include <math.h>
#include <string.h>

#include "talus/four_state/state.h"
#include "talus/minmax.h"
#include "talus/strain.h"

/* A face that leads to no grains weighs this part of one that does, so that
 * parts are defined where there are none around. */
static const double LIGHT = 1e-12;
/* Weights of leaves in tangential differences where grains do not touch and
 * where there are none. */
static const double LOOSE = 1e-3, NO_GRAINS = 1e-6;
/* Part of the diagonal of a leaf's viscous equation below which the cycles
 * leave its weights out: loose grains have little friction. */
static const double SLIGHT = 0.01;
/* Masses below this are none. */
static const double NO_MASS = 1e-30;

static double weight(double here, double there) {
  const double nu = max2(there, 0);
  return min2(here, nu) + LIGHT * max2(here, nu);
}

static void set_upper(struct four_state *sim) {
  const struct mesh *mesh = sim->grid.mesh;
  const double *nu = sim->nu->v;
  for (int d = 0; d < DIM; d++) {
    double *upper = sim->upper[d]->v;
    for (int32_t i = 0; i < mesh->nleaves; i++) {
      const int32_t *node = mesh->stencil[i];
      const double lo = weight(nu[i], nu[node[stencil_face(2 * d)]]);
      const double hi = weight(nu[i], nu[node[stencil_face(2 * d + 1)]]);
      upper[i] = lo + hi > 0 ? hi / (lo + hi) : 0.5;
    }
  }
  field_fill_many(mesh, DIM, sim->upper);
}

/* Give the masses that both leaves lend to a face of axis d. */
static inline void lent(const struct four_state *sim, int d, int32_t f,
                        double mass[2]) {
  const int32_t *node = sim->grid.mesh->face_node[f];
  const double *nu = sim->nu->v, *upper = sim->upper[d]->v;
  mass[0] = max2(nu[node[0]], 0) * upper[node[0]];
  mass[1] = max2(nu[node[1]], 0) * (1 - upper[node[1]]);
}

static void set_mobility(struct four_state *sim) {
  const struct mesh *mesh = sim->grid.mesh;
  const double rho = sim->closure.param[LEE_HUANG_RHO_D];
  const double *nu = sim->nu->v;
  for (int d = 0; d < DIM; d++) {
    for (int32_t f = mesh->face_begin[d]; f < mesh->face_begin[d + 1]; f++) {
      const int32_t *node = mesh->face_node[f];
      double mass[2];
      lent(sim, d, f, mass);
      const double most = max2(nu[node[0]], nu[node[1]]);
      const double M = max2(mass[0] + mass[1], 0.5 * most);
      const bool moves =
          mesh->face_patch[f] < 0 && most >= sim->keys->nu_vacuum;
      sim->mobility_f->v[f] = moves ? 1 / (rho * M) : 0;
    }
  }
  field_fill_faces(mesh, sim->mobility_f);
}

/* Return the acceleration that a pressure gradient gives both leaves of a face
 * which has more mass than they lend: the rest of its force, by mass, as far as
 * it is more than the weight of the face, which it may only carry. */
static double thrust(const struct four_state *sim, int d, int32_t f,
                     double gradient) {
  const int32_t *node = sim->grid.mesh->face_node[f];
  const double rho = sim->closure.param[LEE_HUANG_RHO_D];
  const double mobility = sim->mobility_f->v[f], *nu = sim->nu->v;
  double mass[2];
  if (!(mobility > 0)) return 0;
  lent(sim, d, f, mass);
  const double rest = max2(1 - rho * mobility * (mass[0] + mass[1]), 0);
  const double carried = fabs(sim->params->gravity[d]) / mobility;
  const double force = max2(fabs(gradient) - carried, 0);
  return -copysign(rest * force, gradient) /
         (rho * (nu[node[0]] + nu[node[1]]));
}

/* Fill what was set, and keep interpolated values from falling below 0; p is
 * interpolated by weight, since beside the surface leaves that are nearly empty
 * would get the pressure of those below. */
static void fill_positive(struct four_state *sim) {
  const struct mesh *mesh = sim->grid.mesh;
  const struct bc *bc = sim->p->bc;
  struct field *const field[] = {sim->nu, sim->weight, sim->p_E, sim->mu_K,
                                 sim->lambda_K};
  for (int32_t i = 0; i < mesh->nleaves; i++)
    sim->weight->v[i] = max2(sim->nu->v[i], sim->keys->nu_vacuum);
  field_fill_many(mesh, 5, field);
  for (int k = 0; k < 5; k++) {
    const double least = field[k] == sim->weight ? sim->keys->nu_vacuum : 0;
    for (int32_t i = mesh->begin_virtual; i < mesh->ncells; i++)
      field[k]->v[i] = max2(field[k]->v[i], least);
  }
  mesh_fill_potential(mesh, sim->weight->v, 1, &sim->p->v, &bc, false);
}

/* Find how well the grains of leaves touch, 1 where they carry at least half
 * the weight of a leaf. */
static void find_touches(struct four_state *sim) {
  const struct mesh *mesh = sim->grid.mesh;
  const double weight =
      sim->closure.param[LEE_HUANG_RHO_D] * params_gravity(sim->params);
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    const double half = 0.5 * weight * mesh->h[i] * sim->nu->v[i];
    double *part = &sim->touches->v[i];
    *part = NO_GRAINS;
    if (!four_state_has_grains(sim, i)) continue;
    *part = half > 0 ? min2(max2(sim->p->v[i], 0) / half, 1) : 1;
    *part = max2(*part, LOOSE);
  }
}

/* Find the faces beside leaves in which grains do not touch: what moves there
 * is not continued by the grains of a bed. Where none touch around a leaf there
 * is no bed. */
static void find_skin(struct four_state *sim) {
  static const struct bc neumann[MESH_MAX_PATCHES];
  const struct mesh *mesh = sim->grid.mesh;
  const struct bc *bc = neumann;
  double *m = scratch_take_one(&sim->scratch, FIELD_CELL, __func__);
  for (int32_t i = 0; i < mesh->nleaves; i++) m[i] = sim->touches->v[i] > LOOSE;
  mesh_spread(mesh, m);
  for (int32_t i = 0; i < mesh->nleaves; i++)
    m[i] = m[i] > 0 ? sim->touches->v[i] : 1;
  mesh_fill(mesh, 1, &m, &bc, false);
  for (int32_t i = mesh->begin_virtual; i < mesh->ncells; i++)
    m[i] = min2(max2(m[i], NO_GRAINS), 1);
  sim->skin->n = 0; /* it may be that of an earlier mesh */
  sim->skin->grains_only = true;
  sim->skin->slight = SLIGHT;
  skin_find(mesh, m, 1, sim->skin);
  scratch_give(&sim->scratch, __func__);
}

/* Are p, p_E and the skin those of nu and T? Remember these. */
static bool are_known(struct four_state *sim) {
  const struct mesh *mesh = sim->grid.mesh;
  const size_t size = (size_t)mesh->nleaves * sizeof(double);
  double *nu = sim->known[0]->v, *T = sim->known[1]->v;
  const bool same = sim->known_on == mesh->revision &&
                    memcmp(nu, sim->nu->v, size) == 0 &&
                    memcmp(T, sim->T->v, size) == 0;
  memcpy(nu, sim->nu->v, size);
  memcpy(T, sim->T->v, size);
  sim->known_on = mesh->revision;
  return !(mesh_max(mesh, same ? 0 : 1) > 0);
}

void four_state_contacts(struct four_state *sim) {
  const struct four_state_closure *c = &sim->closure;
  if (are_known(sim)) return;
  for (int32_t i = 0; i < sim->grid.mesh->nleaves; i++) {
    const double nu = sim->nu->v[i], T = sim->T->v[i];
    sim->p->v[i] = sim->p_E->v[i] = 0;
    if (!four_state_has_grains(sim, i)) continue;
    const double p = four_state_pressure(c, nu, T, NULL);
    sim->p->v[i] = p;
    sim->p_E->v[i] = max2(p - four_state_kinetic_pressure(c, nu, T), 0);
  }
  find_touches(sim);
  find_skin(sim);
}

static void set_kinetic(struct four_state *sim) {
  const struct four_state_closure *c = &sim->closure;
  const double scale = c->param[LEE_HUANG_RHO_D] * c->param[LEE_HUANG_D];
  for (int32_t i = 0; i < sim->grid.mesh->nleaves; i++) {
    const double s = sqrt(sim->T->v[i]);
    sim->mu_K->v[i] = sim->lambda_K->v[i] = 0;
    if (!(s > 0) || !four_state_has_grains(sim, i)) continue;
    const struct four_state_numbers k = four_state_numbers(c, sim->nu->v[i]);
    sim->mu_K->v[i] = scale * s * k.mu;
    sim->lambda_K->v[i] = scale * s * k.lambda;
  }
}

void four_state_properties(struct four_state *sim) {
  four_state_contacts(sim);
  set_kinetic(sim);
  fill_positive(sim);
  set_upper(sim);
  set_mobility(sim);
}

/* Return the pressure of contact on a wall: that of the leaf, with the weight
 * of the grains between its middle and the wall, and as much of the others' as
 * p does not carry. */
static double wall_pressure(const struct four_state *sim, int d, int32_t f) {
  const struct mesh *mesh = sim->grid.mesh;
  const int32_t i = mesh->face_owner[f];
  const double nu = sim->nu->v[i], upper = sim->upper[d]->v[i];
  const bool low = mesh->face_node[f][1] == i; /* the wall is below */
  const double g = sim->params->gravity[d] * (low ? -1 : 1);
  const double part = low ? 1 - upper : upper;
  const double rho = sim->closure.param[LEE_HUANG_RHO_D];
  const double weight = rho * nu * max2(g, 0) * mesh->h[i];
  return sim->p_E->v[i] + part * weight +
         max2((1 - part) * weight - sim->p->v[i], 0);
}

void four_state_shear(struct four_state *sim, double *const u[]) {
  strain_shear_rate(sim->grid.mesh, sim->skin, u, sim->shear_f->v);
  field_fill_faces(sim->grid.mesh, sim->shear_f);
}

void four_state_viscosity(struct four_state *sim, double *const u[]) {
  const struct mesh *mesh = sim->grid.mesh;
  const double *nu = sim->nu->v, none = sim->keys->nu_vacuum;
  four_state_shear(sim, u);
  for (int d = 0; d < DIM; d++) {
    for (int32_t f = mesh->face_begin[d]; f < mesh->face_begin[d + 1]; f++) {
      const int32_t *node = mesh->face_node[f];
      sim->eta_f->v[f] = sim->kappa_f->v[f] = 0;
      if (sim->exact) sim->yield.tau_y->v[f] = 0;
      if (nu[node[0]] < none || nu[node[1]] < none) continue;
      const double p_E =
          mesh->face_patch[f] >= 0
              ? wall_pressure(sim, d, f)
              : 0.5 * (sim->p_E->v[node[0]] + sim->p_E->v[node[1]]);
      double mu_E = 0;
      if (sim->exact)
        sim->yield.tau_y->v[f] = sim->closure.param[LEE_HUANG_ETA_S] * p_E;
      else
        mu_E = four_state_contact_viscosity(&sim->closure, p_E,
                                            sim->shear_f->v[f]);
      sim->eta_f->v[f] =
          mu_E + 0.5 * (sim->mu_K->v[node[0]] + sim->mu_K->v[node[1]]);
      /* lambda of the stress is kappa - 2/3 eta, and friction has none */
      sim->kappa_f->v[f] = 2. / 3 * mu_E + 0.5 * (sim->lambda_K->v[node[0]] +
                                                  sim->lambda_K->v[node[1]]);
    }
  }
  field_fill_faces(mesh, sim->eta_f);
  field_fill_faces(mesh, sim->kappa_f);
}

/* Fill accelerations a and thrusts of faces. A side of a coarse leaf gets the
 * mean by mass of its finer faces: one that leads to hardly any grains is
 * accelerated by pressure as they are, which is no acceleration of the leaf. */
static void fill_by_mass(struct four_state *sim, double *a, double *thrusts) {
  const struct mesh *mesh = sim->grid.mesh;
  double *face[3];
  scratch_take(&sim->scratch, FIELD_FACE, __func__, 3, face);
  for (int32_t f = 0; f < mesh->nfaces; f++) {
    const double mobility = sim->mobility_f->v[f];
    const double m = mobility > 0 ? 1 / mobility : NO_MASS;
    face[0][f] = m, face[1][f] = m * a[f], face[2][f] = m * thrusts[f];
  }
  mesh_fill_faces(mesh, 5,
                  (double *const[]){a, thrusts, face[0], face[1], face[2]});
  for (int32_t f = mesh->begin_face_average; f < mesh->nfaces_all; f++) {
    a[f] = face[1][f] / face[0][f];
    thrusts[f] = face[2][f] / face[0][f];
  }
  scratch_give(&sim->scratch, __func__);
}

void four_state_face_acceleration(struct four_state *sim, const double *p,
                                  double *a_f) {
  const struct mesh *mesh = sim->grid.mesh;
  for (int d = 0; d < DIM; d++) {
    const double g = sim->params->gravity[d];
    for (int32_t f = mesh->face_begin[d]; f < mesh->face_begin[d + 1]; f++) {
      const double gradient = mesh_gradient(mesh, p, f);
      const bool wall = mesh->face_patch[f] >= 0;
      a_f[f] = wall ? 0 : g - sim->mobility_f->v[f] * gradient;
      sim->thrust_f->v[f] = wall ? 0 : thrust(sim, d, f, gradient);
    }
  }
  fill_by_mass(sim, a_f, sim->thrust_f->v);
}

void four_state_acceleration(const struct four_state *sim, const double *a_f,
                             double *const a[]) {
  const struct mesh *mesh = sim->grid.mesh;
  for (int d = 0; d < DIM; d++) {
    const double *upper = sim->upper[d]->v;
    for (int32_t i = 0; i < mesh->nleaves; i++) {
      const int32_t *face = mesh->cell_face[i];
      const int32_t lo = face[2 * d], hi = face[2 * d + 1];
      a[d][i] = (1 - upper[i]) * a_f[lo] + upper[i] * a_f[hi] +
                sim->thrust_f->v[lo] + sim->thrust_f->v[hi];
    }
  }
}

void four_state_face_velocity(const struct four_state *sim, double *const u[],
                              double *u_f) {
  const struct mesh *mesh = sim->grid.mesh;
  for (int d = 0; d < DIM; d++) {
    for (int32_t f = mesh->face_begin[d]; f < mesh->face_begin[d + 1]; f++) {
      const int32_t *node = mesh->face_node[f];
      double mass[2];
      lent(sim, d, f, mass);
      const double M = mass[0] + mass[1];
      const double u0 = u[d][node[0]], u1 = u[d][node[1]];
      u_f[f] =
          M > NO_MASS ? (mass[0] * u0 + mass[1] * u1) / M : 0.5 * (u0 + u1);
      if (mesh->face_patch[f] >= 0) u_f[f] = 0;
    }
  }
}

void four_state_accelerate_faces(const struct four_state *sim, double dt,
                                 const double *a_f, const double *start_f,
                                 double *u_f) {
  const struct mesh *mesh = sim->grid.mesh;
  for (int d = 0; d < DIM; d++) {
    const double fall = dt * sim->params->gravity[d];
    for (int32_t f = mesh->face_begin[d]; f < mesh->face_begin[d + 1]; f++) {
      if (mesh->face_patch[f] >= 0) continue;
      u_f[f] += dt * a_f[f];
      u_f[f] -= 0.5 * minmod(u_f[f] - start_f[f], fall);
    }
  }
}
