/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/poisson.h"

#include <math.h>
#include <string.h>

#include "levels.h"
#include "talus/error.h"

struct context {
  const struct mesh *mesh;
  struct hierarchy *h;
  const double *alpha_f;
  const struct bc *bc;
};

void poisson_flux(const struct mesh *mesh, const double *alpha_f,
                  const double *p, double *flux) {
  for (int32_t f = 0; f < mesh->nfaces; f++) {
    const int32_t *node = mesh->face_node[f];
    flux[f] = alpha_f[f] * (p[node[1]] - p[node[0]]) / mesh->face_h[f];
  }
  mesh_fill_faces(mesh, 1, &flux);
}

/* q = div(alpha grad p), p filled. */
static void divergence(const struct context *k, const double *p, double *q) {
  const struct mesh *mesh = k->mesh;
  double *flux = k->h->work_faces;
  poisson_flux(mesh, k->alpha_f, p, flux);
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    const int32_t *face = mesh->cell_face[i];
    double sum = 0;
    for (int d = 0; d < DIM; d++) {
      sum += flux[face[2 * d + 1]] - flux[face[2 * d]];
    }
    q[i] = sum / mesh->h[i];
  }
}

static void apply(void *context, const double *z, double *q) {
  const struct context *k = context;
  double *p = k->h->work_cells;
  memcpy(p, z, (size_t)k->mesh->nleaves * sizeof *p);
  mesh_fill(k->mesh, 1, &p, &k->bc, true);
  divergence(k, p, q);
}

static void precondition(void *context, const double *r, double *z) {
  const struct context *k = context;
  cycle_run(k->h, -1, r, z);
}

/* Does any face fix p itself? */
static bool has_level(const struct mesh *mesh, const double *alpha_f,
                      const struct bc *bc) {
  double found = 0;
  for (int32_t f = 0; f < mesh->nfaces; f++) {
    const int patch = mesh->face_patch[f];
    if (patch >= 0 && bc[patch].type != BC_NEUMANN && alpha_f[f] > 0) {
      found = 1;
    }
  }
  return mesh_max(mesh, found) > 0;
}

/* Volume means of v and |v|. */
static void means(const struct mesh *mesh, const double *v, double *mean,
                  double *mean_abs) {
  double sum[3] = {0};
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    sum[0] += mesh->volume[i] * v[i];
    sum[1] += mesh->volume[i] * fabs(v[i]);
    sum[2] += mesh->volume[i];
  }
  MPI_CHECK(
      MPI_Allreduce(MPI_IN_PLACE, sum, 3, MPI_DOUBLE, MPI_SUM, mesh->comm));
  *mean = sum[0] / sum[2];
  *mean_abs = sum[1] / sum[2];
}

static void shift(const struct mesh *mesh, double a, double *v) {
  for (int32_t i = 0; i < mesh->nleaves; i++) v[i] += a;
}

struct solve_stats poisson_solve(const struct mesh *mesh, struct hierarchy *h,
                                 const double *alpha_f, const double *rhs,
                                 const struct bc *bc, double tolerance,
                                 int max_iterations, double *p) {
  CHECK(h->revision == mesh->revision, "hierarchy of an older mesh");
  struct context context = {mesh, h, alpha_f, bc};
  const bool singular = !has_level(mesh, alpha_f, bc);
  double *r = h->residual, mean, mean_abs, level = 0;
  mesh_fill(mesh, 1, &p, &bc, false);
  divergence(&context, p, r);
  for (int32_t i = 0; i < mesh->nleaves; i++) r[i] = rhs[i] - r[i];
  if (singular) {
    means(mesh, p, &level, &mean_abs);
    means(mesh, r, &mean, &mean_abs);
    /* 1e-12: round-off of sums over up to 1e8 cells of both signs */
    if (fabs(mean) > tolerance && fabs(mean) > 1e-12 * mean_abs) {
      return (struct solve_stats){.residual_before = fabs(mean),
                                  .residual_after = fabs(mean),
                                  .status = SOLVE_INCOMPATIBLE};
    }
    shift(mesh, -mean, r);
  }
  coefficients_set(h, 1, alpha_f, 1, NULL, &bc);
  const struct krylov_system system = {.comm = mesh->comm,
                                       .n = mesh->nleaves,
                                       .nparts = 1,
                                       .context = &context,
                                       .precondition = precondition,
                                       .apply = apply,
                                       .weight = h->weight};
  struct solve_stats stats =
      krylov_solve(&system, h->krylov, tolerance, max_iterations, r, p);
  if (singular) {
    means(mesh, p, &mean, &mean_abs);
    shift(mesh, level - mean, p);
  }
  mesh_fill(mesh, 1, &p, &bc, false);
  return stats;
}
