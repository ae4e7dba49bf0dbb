/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/granular_pressure.h"

#include <math.h>
#include <string.h>

#include "talus/minmax.h"
#include "talus/poisson.h"
#include "talus/scratch.h"

/* The linear solves gain this factor on R. */
static const double LINEAR_GAIN = 1e-2;
/* R, a solid fraction, is no smaller than this but by luck. */
static const double ROUND_OFF = 1e-15;
/* Part of its grains that a leaf may give away in a step. */
static const double MOST_GIVEN = 0.9;

static const struct bc NEUMANN[MESH_MAX_PATCHES];

void granular_pressure_take(struct granular_pressure *by,
                            struct scratch *scratch, const char *taker) {
  double *cell[DIM + 3], *face[2];
  scratch_take(scratch, FIELD_CELL, taker, DIM + 3, cell);
  scratch_take(scratch, FIELD_FACE, taker, 2, face);
  for (int d = 0; d < DIM; d++) by->slope[d] = cell[d];
  by->change = cell[DIM], by->mass = cell[DIM + 1], by->rhs = cell[DIM + 2];
  by->u_start = face[0], by->alpha = face[1];
}

void granular_slopes(const struct mesh *mesh, int d, const double *v,
                     double *slope) {
  const int lower = stencil_face(2 * d), upper = stencil_face(2 * d + 1);
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    const int32_t *node = mesh->stencil[i];
    slope[i] = minmod(v[i] - v[node[lower]], v[node[upper]] - v[i]);
  }
  mesh_fill_ghosts(mesh, 1, (double *const[]){slope});
}

double granular_donor(const struct mesh *mesh, int32_t f, double dt, double u_f,
                      const double *v, const double *slope) {
  const int side = u_f > 0 ? 0 : 1;
  const int32_t leaf = mesh->face_leaf[f][side];
  const double value = v[mesh->face_node[f][side]];
  if (leaf < 0) return value;
  const double reach = 1 - mesh_face_edges(mesh, f, fabs(u_f) * dt);
  const double half =
      0.5 * mesh_edges(mesh, leaf, mesh->face_h[f]) * max2(reach, 0);
  return value + (side ? -half : half) * slope[leaf];
}

/* Return the solid fraction of the donor at a face. */
static double donor(const struct granular_pressure *by, int d, int32_t f,
                    double dt, double u_f) {
  const double nu =
      granular_donor(by->mesh, f, dt, u_f, by->nu_old, by->slope[d]);
  if (by->surface == NULL) return nu;
  return by->surface->passing(by->surface->context, d, f, dt, u_f, nu);
}

/* Reduce the fluxes out of leaves that would give away more than MOST_GIVEN of
 * their grains, as thin ones may beside fast ones. */
static void limit_fluxes(const struct granular_pressure *by, double dt,
                         double *flux) {
  const struct mesh *mesh = by->mesh;
  double *limit = by->change, most = 0;
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    double out = 0;
    for (int s = 0; s < NFACE; s++) {
      const double v = mesh_side(mesh, flux, i, s);
      out += max2(s & 1 ? v : -v, 0);
    }
    out *= dt / mesh_width(mesh, i);
    const double may = MOST_GIVEN * max2(by->nu_old[i], 0);
    limit[i] = out > may ? may / out : 1;
    most = max2(most, 1 - limit[i]);
  }
  if (!(mesh_max(mesh, most) > 0)) return;
  mesh_fill_ghosts(mesh, 1, &limit);
  for (int32_t f = 0; f < mesh->nfaces; f++) {
    const int32_t leaf = mesh->face_leaf[f][flux[f] > 0 ? 0 : 1];
    if (leaf >= 0) flux[f] *= limit[leaf];
  }
  mesh_fill_faces(mesh, 1, &flux);
}

/* Set u_f and the flux for a pressure, filled here. */
static void move(const struct granular_pressure *by, double dt, double *p,
                 double *u_f, double *flux) {
  const struct mesh *mesh = by->mesh;
  const struct bc *bc = NEUMANN;
  mesh_fill_potential(mesh, by->rho, 1, &p, &bc, false);
  for (int d = 0; d < DIM; d++) {
    for (int32_t f = mesh->face_begin[d]; f < mesh->face_begin[d + 1]; f++) {
      const int32_t *node = mesh->face_node[f];
      const double change =
          (p[node[1]] - by->p_old[node[1]]) - (p[node[0]] - by->p_old[node[0]]);
      u_f[f] =
          by->u_start[f] - dt * by->mobility_f[f] * mesh_slope(mesh, f, change);
      flux[f] = u_f[f] * donor(by, d, f, dt, u_f[f]);
    }
  }
  mesh_fill_faces(mesh, 2, (double *const[]){u_f, flux});
  limit_fluxes(by, dt, flux);
}

/* Set the residual; returns its largest. */
static double residual(const struct granular_pressure *by, double dt,
                       const double *nu, const double *flux) {
  const struct mesh *mesh = by->mesh;
  double most = 0;
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    by->rhs[i] = nu[i] - by->nu_old[i] + dt * mesh_divergence(mesh, flux, i);
    most = max2(most, fabs(by->rhs[i]));
    if (isnan(by->rhs[i])) most = INFINITY;
  }
  return mesh_max(mesh, most);
}

/* Set alpha by what a change of u_f adds to the flux: nu_f, and what the donor
 * changes by. */
static void set_alpha(const struct granular_pressure *by, double dt,
                      const double *u_f, const double *flux) {
  static const double STEP = 1e-3; /* of u_f */
  const struct mesh *mesh = by->mesh;
  for (int d = 0; d < DIM; d++) {
    for (int32_t f = mesh->face_begin[d]; f < mesh->face_begin[d + 1]; f++) {
      const double u = u_f[f], here = donor(by, d, f, dt, u);
      const double change = donor(by, d, f, dt, (1 + STEP) * u) - here;
      const double nu = (u != 0 ? flux[f] / u : here) + change / STEP;
      by->alpha[f] = dt * dt * max2(nu, 0) * by->mobility_f[f];
    }
  }
  mesh_fill_faces(mesh, 1, (double *const[]){by->alpha});
}

/* Return by how much p of leaf i must rise to hold its R back without a change
 * of nu or of its neighbours, Pa. */
static double rise_alone(const struct granular_pressure *by, int32_t i) {
  double sum = 0;
  for (int s = 0; s < NFACE; s++) sum += mesh_side(by->mesh, by->alpha, i, s);
  const double h = by->mesh->h[i];
  return sum > 0 ? -by->rhs[i] * h * h / sum : 0;
}

/* Return P' of a leaf whose own is `slope`: where grains are compressed that
 * hardly touch, that of a pressure ahead, as far as nu - R reaches. */
static double slope_of(const struct granular_pressure *by, int32_t i, double nu,
                       double p, double slope) {
  const struct granular_material *m = &by->material;
  const double linear = nu - by->rhs[i];
  double there;
  slope = max2(slope, by->least_slope);
  if (!(by->ahead > 0 && linear > nu)) return slope;
  const double next = p + by->ahead * rise_alone(by, i);
  if (!(next - p > slope * (linear - nu))) return slope;
  if (m->pressure(m->context, i, linear, &there) > next) {
    const double at = m->solid_fraction(m->context, i, next, nu, linear);
    m->pressure(m->context, i, at, &there);
  }
  return max2(slope, there);
}

/* Add the change q of p to a leaf, whose mass is 1/P', and leave P' of its new
 * nu in mass. */
static void change_leaf(const struct granular_pressure *by, int32_t i, double q,
                        double *nu, double *p) {
  const struct granular_material *m = &by->material;
  const double linear = *nu + by->mass[i] * q;
  double there = m->pressure(m->context, i, linear, &by->mass[i]);
  /* where P' was raised to least_slope, `linear` may still be below P^-1 */
  if (q > 0 && there > *p + q) {
    *nu = m->solid_fraction(m->context, i, *p + q, *nu, linear);
    there = m->pressure(m->context, i, *nu, &by->mass[i]);
  } else {
    *nu = linear;
  }
  *p = there;
}

/* Take a Newton step from nu, p with P' in mass. */
static struct solve_stats newton(const struct granular_pressure *by,
                                 double size, double *nu, double *p) {
  const struct mesh *mesh = by->mesh;
  double *q = by->change;
  for (int32_t i = 0; i < mesh->nleaves; i++)
    by->mass[i] = 1 / slope_of(by, i, nu[i], p[i], by->mass[i]);
  memset(q, 0, (size_t)mesh->ncells * sizeof *q);
  const double tolerance =
      max2(LINEAR_GAIN * size, 0.1 * max2(by->tolerance, ROUND_OFF));
  const struct solve_stats stats =
      poisson_solve(mesh, by->hierarchy, by->alpha, by->mass, by->rho, by->rhs,
                    NEUMANN, tolerance, by->max_iterations, q);
  for (int32_t i = 0; i < mesh->nleaves; i++)
    change_leaf(by, i, q[i], &nu[i], &p[i]);
  mesh_touch(mesh, p);
  return stats;
}

/* Begin with nu and p of the last step unless there is a guess, and P' in mass.
 * Where p^n is less than P(nu^n), because shear has changed P since, begin as
 * loose as p^n lets grains be: a change of p is harder to find than one of nu.
 */
static void begin(const struct granular_pressure *by, const double *u_f,
                  double *nu, double *p) {
  const struct mesh *mesh = by->mesh;
  const struct granular_material *m = &by->material;
  memcpy(by->u_start, u_f, (size_t)mesh->nfaces_all * sizeof *u_f);
  if (!by->guessed) {
    memcpy(nu, by->nu_old, (size_t)mesh->nleaves * sizeof *nu);
    memcpy(p, by->p_old, (size_t)mesh->nleaves * sizeof *p);
  }
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    const double P = m->pressure(m->context, i, nu[i], &by->mass[i]);
    if (by->guessed) continue;
    if (p[i] > 0 && P > p[i])
      nu[i] = m->solid_fraction(m->context, i, p[i], 0, nu[i]);
    p[i] = m->pressure(m->context, i, nu[i], &by->mass[i]);
  }
  mesh_touch(mesh, p);
  for (int d = 0; d < DIM; d++)
    granular_slopes(mesh, d, by->nu_old, by->slope[d]);
}

struct granular_stats granular_pressure_solve(
    const struct granular_pressure *by, double dt, double *u_f, double *p,
    double *nu, double *flux) {
  struct granular_stats stats = {.status = SOLVE_STALLED};
  begin(by, u_f, nu, p);
  for (;; stats.newton++) {
    move(by, dt, p, u_f, flux);
    stats.residual = residual(by, dt, nu, flux);
    if (stats.residual <= max2(by->tolerance, ROUND_OFF))
      stats.status = SOLVE_CONVERGED;
    if (stats.status == SOLVE_CONVERGED || stats.newton == by->max_newton ||
        !isfinite(stats.residual))
      break;
    set_alpha(by, dt, u_f, flux);
    const struct solve_stats linear = newton(by, stats.residual, nu, p);
    stats.iterations += linear.iterations;
    if (linear.iterations > stats.most_iterations)
      stats.most_iterations = linear.iterations;
  }
  return stats;
}

void granular_carry(const struct mesh *mesh, double dt, const double *nu_old,
                    const double *flux, double *nu) {
  for (int32_t i = 0; i < mesh->nleaves; i++)
    nu[i] = nu_old[i] - dt * mesh_divergence(mesh, flux, i);
}
