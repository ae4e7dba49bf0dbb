/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/projection.h"

#include <math.h>

#include "talus/poisson.h"

/* The density of a coarse leaf varies where it does by more than this part. */
#define EVEN 1e-3

struct solve_stats projection_project(const struct projection *projection,
                                      double dt, double *u_f, double *p) {
  const struct mesh *mesh = projection->mesh;
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    projection->rhs[i] = mesh_net(mesh, u_f, i) / (mesh_width(mesh, i) * dt);
  }
  struct solve_stats stats = poisson_solve(
      mesh, projection->hierarchy, projection->alpha_f, NULL, projection->rho,
      projection->rhs, projection->bc, projection->tolerance / (dt * dt),
      projection->max_iterations, p);
  poisson_flux(mesh, projection->alpha_f, p, projection->flux);
  for (int32_t f = 0; f < mesh->nfaces_all; f++) {
    u_f[f] -= dt * projection->flux[f];
  }
  stats.residual_before *= dt * dt;
  stats.residual_after *= dt * dt;
  return stats;
}

/* Return the node whose velocity a face takes on `side`: that of its stencil,
 * or the leaf itself where the density of a coarse leaf varies over its virtual
 * children. */
static int32_t source_of_velocity(const struct mesh *mesh, const double *rho,
                                  int32_t f, int side) {
  const int32_t node = mesh->face_node[f][side];
  const int32_t leaf = mesh->face_leaf[f][side];
  if (node < mesh->begin_virtual || node >= mesh->begin_boundary) return node;
  const int32_t first = node - (node - mesh->begin_virtual) % NCHILD;
  for (int k = 0; k < NCHILD; k++) {
    if (fabs(rho[first + k] - rho[leaf]) > EVEN * rho[leaf]) return leaf;
  }
  return node;
}

void projection_face_velocity(const struct projection *projection, double dt,
                              double *const u[DIM], double *u_f) {
  const struct mesh *mesh = projection->mesh;
  const double *rho = projection->rho;
  for (int d = 0; d < DIM; d++) {
    for (int32_t f = mesh->face_begin[d]; f < mesh->face_begin[d + 1]; f++) {
      const int32_t *leaf = mesh->face_leaf[f];
      const double lower = rho[leaf[0] < 0 ? leaf[1] : leaf[0]];
      const double upper = rho[leaf[1] < 0 ? leaf[0] : leaf[1]];
      u_f[f] = (lower * u[d][source_of_velocity(mesh, rho, f, 0)] +
                upper * u[d][source_of_velocity(mesh, rho, f, 1)]) /
               (lower + upper);
      u_f[f] += dt * projection->gravity_f[f];
    }
  }
  mesh_fill_faces(mesh, 1, &u_f);
}

void projection_acceleration(const struct projection *projection, double *face,
                             double *const g[DIM]) {
  const struct mesh *mesh = projection->mesh;
  for (int32_t f = 0; f < mesh->nfaces_all; f++) {
    face[f] = projection->gravity_f[f] - projection->flux[f];
  }
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    for (int d = 0; d < DIM; d++) {
      g[d][i] = mesh_mean_along(mesh, face, i, d);
    }
  }
  for (int d = 0; d < DIM; d++) mesh_touch(mesh, g[d]);
}
