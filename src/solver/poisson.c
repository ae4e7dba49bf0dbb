/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/poisson.h"

#include <math.h>
#include <string.h>

#include "levels.h"
#include "talus/error.h"

struct context {
  const struct mesh *mesh;
  struct hierarchy *h;
  const double *alpha_f, *mass, *rho, *rhs;
  const struct bc *bc;
  double excess; /* taken from rhs */
};

void poisson_flux(const struct mesh *mesh, const double *alpha_f,
                  const double *p, double *restrict flux) {
  for (int32_t f = 0; f < mesh->nfaces; f++) {
    const int32_t *node = mesh->face_node[f];
    flux[f] = mesh_slope(mesh, f, alpha_f[f] * (p[node[1]] - p[node[0]]));
  }
  mesh_fill_faces(mesh, 1, (double *const[]){flux});
}

static inline __attribute__((always_inline)) void divergence(
    const struct mesh *mesh, bool rings, const double *flux, double *q) {
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    q[i] = mesh_net_of(mesh, rings, flux, i) / mesh_width(mesh, i);
  }
}

/* Set q = div(alpha grad p) - mass p, p filled; q may be p. */
static void operate(const struct context *k, const double *p, double *q) {
  const struct mesh *mesh = k->mesh;
  double *flux = k->h->work_faces;
  poisson_flux(mesh, k->alpha_f, p, flux);
  for (int32_t i = 0; i < mesh->nleaves && k->mass; i++) {
    q[i] = mesh_divergence(mesh, flux, i) - k->mass[i] * p[i];
  }
  if (k->mass) return;
  if (mesh_is_axisymmetric(mesh)) {
    divergence(mesh, true, flux, q);
  } else {
    divergence(mesh, false, flux, q);
  }
}

static void apply(void *context, const double *z, double *q[]) {
  const struct context *k = context;
  double *p = k->h->work_cells;
  memcpy(p, z, (size_t)k->mesh->nleaves * sizeof *z);
  mesh_fill_potential(k->mesh, k->rho, 1, &p, &k->bc, true);
  operate(k, p, p);
  q[0] = p;
}

static void residual(const struct context *k, double *const p[], double *r) {
  mesh_fill_potential(k->mesh, k->rho, 1, p, &k->bc, false);
  operate(k, p[0], r);
  for (int32_t i = 0; i < k->mesh->nleaves; i++) {
    r[i] = k->rhs[i] - k->excess - r[i];
  }
}

static void precondition(void *context, const double *r, double size,
                         double *z) {
  const struct context *k = context;
  rough_watch(k->h, size);
  cycle_run(k->h, -1, r, z);
}

/* Does any face or any mass fix p itself? */
static bool has_level(const struct mesh *mesh, const double *alpha_f,
                      const double *mass, const struct bc *bc) {
  double found = 0;
  for (int32_t i = 0; mass && i < mesh->nleaves && found == 0; i++) {
    if (mass[i] > 0) found = 1;
  }
  for (int32_t f = 0; f < mesh->nfaces && found == 0; f++) {
    const int patch = mesh->face_patch[f];
    if (patch >= 0 && bc[patch].type != BC_NEUMANN && alpha_f[f] > 0) {
      found = 1;
    }
  }
  return mesh_max(mesh, found) > 0;
}

/* Find the means over the volume of p, of the residual r, and of the terms it
 * is made of, each in absolute value. */
static void means(const struct context *k, const double *p, const double *r,
                  double mean[3]) {
  const struct mesh *mesh = k->mesh;
  const double *flux = k->h->work_faces; /* of p */
  double sum[4] = {0};
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    sum[0] += mesh_volume(mesh, i) * p[i];
    sum[1] += mesh_volume(mesh, i) * r[i];
    sum[2] += mesh_volume(mesh, i) *
              (fabs(k->rhs[i]) + 2 * mesh_turnover(mesh, flux, i));
    sum[3] += mesh_volume(mesh, i);
  }
  MPI_CHECK(
      MPI_Allreduce(MPI_IN_PLACE, sum, 4, MPI_DOUBLE, MPI_SUM, mesh->comm));
  for (int j = 0; j < 3; j++) mean[j] = sum[j] / sum[3];
}

static void shift(const struct mesh *mesh, double a, double *v) {
  for (int32_t i = 0; i < mesh->nleaves; i++) v[i] += a;
}

static void prepare(void *context) {
  const struct context *k = context;
  bulk_set(k->h, NULL, NULL, 0);
  coefficients_set(k->h, 1, k->alpha_f, 1, k->mass, &k->bc);
}

/* Solve with p determined up to a constant. */
static struct solve_stats solve_singular(const struct krylov_system *system,
                                         double tolerance, int max_iterations,
                                         double *p) {
  struct context *k = system->context;
  double *r = k->h->residual, before[3], after[3];
  means(k, p, r, before);
  const double excess = fabs(before[1]);
  /* 1e-12: round-off of sums over many cells of both signs */
  if (excess > tolerance && excess > 1e-12 * before[2]) {
    return (struct solve_stats){.residual_before = excess,
                                .residual_after = excess,
                                .status = SOLVE_INCOMPATIBLE};
  }
  k->excess = before[1];
  shift(k->mesh, -k->excess, r);
  struct solve_stats stats =
      krylov_solve(system, k->h->krylov, tolerance, max_iterations, r, &p);
  means(k, p, r, after);
  shift(k->mesh, before[0] - after[0], p);
  return stats;
}

struct solve_stats poisson_solve(const struct mesh *mesh, struct hierarchy *h,
                                 const double *alpha_f, const double *mass,
                                 const double *rho, const double *rhs,
                                 const struct bc *bc, double tolerance,
                                 int max_iterations, double *p) {
  CHECK(h->revision == mesh->revision, "hierarchy of an older mesh");
  struct context context = {mesh, h, alpha_f, mass, rho, rhs, bc, 0};
  const struct krylov_system system = {.comm = mesh->comm,
                                       .n = mesh->nleaves,
                                       .nparts = 1,
                                       .context = &context,
                                       .prepare = prepare,
                                       .precondition = precondition,
                                       .apply = apply,
                                       .weight = h->weight};
  double *r = h->residual;
  residual(&context, &p, r);
  struct solve_stats stats =
      has_level(mesh, alpha_f, mass, bc)
          ? krylov_solve(&system, h->krylov, tolerance, max_iterations, r, &p)
          : solve_singular(&system, tolerance, max_iterations, p);
  mesh_fill_potential(mesh, rho, 1, &p, &bc, false);
  return stats;
}
