/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/vof.h"

#include <math.h>

#include "talus/error.h"
#include "talus/forest.h"
#include "talus/minmax.h"
#include "talus/plane.h"
#include "talus/remap.h"
#include "talus/ring.h"

/* Turn volume fractions of rings, [NSTENCIL], into those of the cells that they
 * have in the plane of r and z, for a surface with the normal n. */
static void flatten(const struct mesh *mesh, int32_t leaf, const double n[DIM],
                    const double ring[], double flat[]) {
  for (int s = 0; s < NSTENCIL; s++) {
    const double r = mesh->x[leaf][0] + (s % 3 - 1) * mesh->h[leaf];
    const double alpha = ring_alpha(n, ring[s], 0.5 * mesh->h[leaf] / r);
    flat[s] = vof_is_cut(ring[s]) ? plane_volume(n, alpha) : ring[s];
  }
}

/* Find the normal in a ring: the fractions of its cells are known once it is.
 */
static void ring_normal(const struct mesh *mesh, int32_t leaf,
                        const double ring[NSTENCIL], const bool known[NSTENCIL],
                        double n[DIM]) {
  enum { REPETITIONS = 2 };
  double flat[NSTENCIL];
  for (int k = 0; k < REPETITIONS; k++) {
    flatten(mesh, leaf, n, ring, flat);
    plane_normal(flat, known, n);
  }
}

void vof_plane(const struct mesh *mesh, const double *c, int32_t leaf,
               double n[DIM], double *alpha) {
  double stencil[NSTENCIL];
  bool known[NSTENCIL];
  for (int s = 0; s < NSTENCIL; s++) {
    const int32_t node = mesh->stencil[leaf][s];
    stencil[s] = min2(max2(c[node], 0), 1);
    known[s] = node < mesh->begin_virtual;
  }
  plane_normal(stencil, known, n);
  if (mesh_is_axisymmetric(mesh)) {
    ring_normal(mesh, leaf, stencil, known, n);
    *alpha = ring_alpha(n, stencil[STENCIL_CENTRE], mesh->slant[leaf]);
  } else {
    *alpha = plane_alpha(n, stencil[STENCIL_CENTRE]);
  }
}

double vof_part(const struct mesh *mesh, int32_t leaf, const double n[DIM],
                double alpha, const double lo[DIM], const double hi[DIM]) {
  return ring_box_volume(n, alpha, lo, hi, mesh_slant(mesh, leaf));
}

void vof_reconstruct(const struct mesh *mesh, const double *c,
                     double *const normal[DIM], double *alpha) {
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    if (!vof_is_cut(c[i])) continue;
    double n[DIM];
    vof_plane(mesh, c, i, n, &alpha[i]);
    for (int d = 0; d < DIM; d++) normal[d][i] = n[d];
  }
  double *v[DIM + 1] = {alpha};
  for (int d = 0; d < DIM; d++) v[d + 1] = normal[d];
  for (int k = 0; k < DIM + 1; k++) mesh_touch(mesh, v[k]);
  mesh_fill_ghosts(mesh, DIM + 1, v);
}

double vof_swept(const struct mesh *mesh, int d, int32_t face, int upwind,
                 double swept, double *const normal[DIM], const double *alpha) {
  const int32_t leaf = mesh->face_leaf[face][upwind];
  const int32_t node = mesh->face_node[face][upwind];
  double n[DIM], lo[DIM], hi[DIM];
  const bool coarse = node >= mesh->begin_virtual;
  for (int e = 0; e < DIM; e++) {
    n[e] = normal[e][leaf];
    lo[e] = -0.5, hi[e] = 0.5;
    if (coarse) {
      const int upper = (node - mesh->begin_virtual) % NCHILD >> e & 1;
      lo[e] = upper ? 0 : -0.5;
      hi[e] = lo[e] + 0.5;
    }
  }
  if (coarse) swept *= 0.5;
  if (upwind == 0) {
    lo[d] = hi[d] - swept;
  } else {
    hi[d] = lo[d] + swept;
  }
  return vof_part(mesh, leaf, n, alpha[leaf], lo, hi);
}

void vof_flux(const struct mesh *mesh, int d, double dt, const double *u_f,
              const bool *open, const double *c, double *const normal[DIM],
              const double *alpha, double *flux) {
  for (int32_t f = mesh->face_begin[d]; f < mesh->face_begin[d + 1]; f++) {
    const double u = u_f[f];
    const int upwind = u > 0 ? 0 : 1;
    const int32_t leaf = mesh->face_leaf[f][upwind];
    double fraction;
    if (leaf < 0) { /* carried in through a boundary */
      const int32_t *node = mesh->face_node[f];
      fraction = min2(max2(0.5 * (c[node[0]] + c[node[1]]), 0), 1);
      if (open && open[mesh->face_patch[f]]) fraction = 0;
    } else if (!vof_is_cut(c[leaf]) || u == 0) {
      fraction = c[leaf];
    } else {
      fraction = vof_swept(mesh, d, f, upwind,
                           mesh_swept(mesh, f, d, upwind, fabs(u) * dt), normal,
                           alpha);
    }
    flux[f] = u * fraction;
  }
  mesh_fill_faces(mesh, 1, &flux);
}

void vof_freeze(const struct mesh *mesh, const double *c, double *cc) {
  for (int32_t i = 0; i < mesh->nleaves; i++) cc[i] = c[i] > 0.5;
}

void vof_update(const struct mesh *mesh, int d, double dt, const double *u_f,
                const double *flux, const double *cc, double *c) {
  const struct mesh view = *mesh; /* which no c[i] can change */
  for (int32_t i = 0; i < view.nleaves; i++) {
    c[i] -= dt / mesh_width(&view, i) *
            (mesh_net_along(&view, flux, i, d) -
             cc[i] * mesh_net_along(&view, u_f, i, d));
  }
  mesh_touch(mesh, c);
}

double vof_excess(const struct mesh *mesh, const double *c) {
  double excess = 0;
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    excess = max2(excess, max2(c[i] - 1, -c[i]));
  }
  return excess;
}

/* Give the part of a new leaf that the plane of the old leaf around it cuts. */
static double divide(const struct remap *remap, const struct field *field,
                     int32_t leaf) {
  double n[DIM], alpha, lo[DIM], hi[DIM];
  const int32_t i = remap_box(remap, leaf, lo, hi);
  if (!vof_is_cut(field->v[i])) return field->v[i];
  vof_plane(remap->mesh, field->v, i, n, &alpha);
  return vof_part(remap->mesh, i, n, alpha, lo, hi);
}

const struct field_rule vof_rule = {divide, remap_content};
