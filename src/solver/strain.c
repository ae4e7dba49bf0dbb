/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/strain.h"

#include <math.h>

/* Set grad[e][t] to du_e/dx_t at face f of axis d from the stencil of its
 * owner. */
static inline void face_gradient(const struct mesh *mesh, int d, int32_t f,
                                 double *const u[DIM], double grad[DIM][DIM]) {
  const int32_t *node = mesh->face_node[f];
  const int32_t *stencil = mesh->stencil[mesh->face_owner[f]];
  const int other =
      stencil_face(2 * d + (node[0] == mesh->face_owner[f] ? 1 : 0));
  const double k = mesh_slope(mesh, f, 1);
  for (int e = 0; e < DIM; e++) {
    for (int t = 0; t < DIM; t++) {
      const int step = stencil_step(t);
      grad[e][t] = t == d ? k * (u[e][node[1]] - u[e][node[0]])
                          : 0.25 * k *
                                (u[e][stencil[STENCIL_CENTRE + step]] -
                                 u[e][stencil[STENCIL_CENTRE - step]] +
                                 u[e][stencil[other + step]] -
                                 u[e][stencil[other - step]]);
    }
  }
}

/* Return 2 D:D */
static inline double shear_squared(double grad[DIM][DIM]) {
  double sum = 0;
  for (int e = 0; e < DIM; e++) {
    sum += 2 * grad[e][e] * grad[e][e];
    for (int t = e + 1; t < DIM; t++) {
      const double shear = grad[e][t] + grad[t][e];
      sum += shear * shear;
    }
  }
  return sum;
}

/* Set 2 D:D at the faces beside the surface. */
static void skin_shear_squared(const struct mesh *mesh, const struct skin *skin,
                               double *const u[DIM], double *squared_f) {
  for (int32_t k = 0; k < skin->n; k++) {
    const struct skin_face *face = &skin->face[k];
    const int32_t f = face->face;
    double grad[DIM][DIM];
    face_gradient(mesh, face->axis, f, u, grad);
    for (int t = 0; t < DIM; t++) {
      for (int e = 0; e < DIM && t != face->axis; e++) {
        const double du = skin_difference(mesh, face, t, u[e]);
        grad[e][t] = mesh_slope(mesh, f, face->part[t] * du);
      }
    }
    squared_f[f] = shear_squared(grad);
  }
}

/* Add what the hoop has of 2 D:D. */
static void add_hoop_squared(const struct mesh *mesh, double *const u[DIM],
                             double *squared_f) {
  for (int d = 0; d < DIM; d++) {
    for (int32_t f = mesh->face_begin[d]; f < mesh->face_begin[d + 1]; f++) {
      const double hoop = mesh_face_hoop(mesh, u[0], f, d);
      squared_f[f] += 2 * hoop * hoop;
    }
  }
}

void strain_shear_rate(const struct mesh *mesh, const struct skin *skin,
                       double *const u[DIM], double *shear_f) {
  struct mesh_piece piece = mesh_no_piece(mesh);
  while (mesh_next_piece(mesh, &piece)) {
#pragma GCC unroll 3 /* so that d is known in the loop over faces */
    for (int d = 0; d < DIM; d++) {
      for (int32_t f = piece.begin[d]; f < piece.end[d]; f++) {
        double grad[DIM][DIM];
        face_gradient(mesh, d, f, u, grad);
        shear_f[f] = shear_squared(grad);
      }
    }
  }
  if (skin) skin_shear_squared(mesh, skin, u, shear_f);
  if (mesh_is_axisymmetric(mesh)) add_hoop_squared(mesh, u, shear_f);
  /* apart, several at a time: roots are slow */
  for (int32_t f = 0; f < mesh->nfaces; f++) shear_f[f] = sqrt(shear_f[f]);
}

void strain_sliding_rate(const struct mesh *mesh, double *const u[DIM],
                         double *slide_f) {
  for (int d = 0; d < DIM; d++) {
    for (int32_t f = mesh->face_begin[d]; f < mesh->face_begin[d + 1]; f++) {
      double grad[DIM][DIM], div = 0;
      face_gradient(mesh, d, f, u, grad);
      for (int e = 0; e < DIM; e++) div += grad[e][e];
      const double hoop =
          mesh_is_axisymmetric(mesh) ? mesh_face_hoop(mesh, u[0], f, d) : 0;
      div += hoop;
      const double squared =
          shear_squared(grad) + 2 * hoop * hoop - 2 * div * div;
      slide_f[f] = squared > 0 ? sqrt(squared) : 0;
    }
  }
}

static void set_rows(double grad[DIM][DIM], int d, int32_t f,
                     double *const rows[STRAIN_ROWS]) {
  for (int e = 0; e < DIM; e++) {
    rows[e][f] = 0.5 * (grad[e][d] + grad[d][e]);
  }
  if (DIM == 2) return;
  const int t = (d + 1) % DIM, w = (d + 2) % DIM;
  rows[STRAIN_ROWS - 2][f] = 0.5 * (grad[t][t] - grad[w][w]);
  rows[STRAIN_ROWS - 1][f] = 0.5 * (grad[t][w] + grad[w][t]);
}

/* Set the derivatives along the axes of a face beside the surface. */
static void skin_gradient(const struct mesh *mesh, const struct skin_face *face,
                          double *const u[DIM], double grad[DIM][DIM]) {
  face_gradient(mesh, face->axis, face->face, u, grad);
  for (int t = 0; t < DIM; t++) {
    for (int e = 0; e < DIM && t != face->axis; e++) {
      const double du = skin_difference(mesh, face, t, u[e]);
      grad[e][t] = mesh_slope(mesh, face->face, du);
    }
  }
}

void strain_find(const struct mesh *mesh, const struct skin *skin,
                 double *const u[DIM], double *const rows[STRAIN_ROWS]) {
  double grad[DIM][DIM];
  struct mesh_piece piece = mesh_no_piece(mesh);
  while (mesh_next_piece(mesh, &piece)) {
#pragma GCC unroll 3 /* so that d is known in the loop over faces */
    for (int d = 0; d < DIM; d++) {
      for (int32_t f = piece.begin[d]; f < piece.end[d]; f++) {
        face_gradient(mesh, d, f, u, grad);
        set_rows(grad, d, f, rows);
        if (mesh_is_axisymmetric(mesh)) {
          rows[STRAIN_HOOP][f] = mesh_face_hoop(mesh, u[0], f, d);
        }
      }
    }
  }
  for (int32_t k = 0; skin && k < skin->n; k++) {
    const struct skin_face *face = &skin->face[k];
    skin_gradient(mesh, face, u, grad);
    set_rows(grad, face->axis, face->face, rows);
    for (int e = 0; e < DIM; e++) { /* as the stress of viscous.h */
      if (e != face->axis) rows[e][face->face] *= face->part[e];
    }
  }
  mesh_fill_faces(mesh, strain_rows(mesh), rows);
}

/* Set what D at the faces beside the surface has of derivatives along them. */
static void set_skin_rows(const struct mesh *mesh, const struct skin *skin,
                          double *const u[DIM],
                          double *const rows[STRAIN_ROWS]) {
  for (int32_t k = 0; k < skin->n; k++) {
    const struct skin_face *face = &skin->face[k];
    const int32_t f = face->face;
    const int d = face->axis;
    double grad[DIM][DIM];
    face_gradient(mesh, d, f, u, grad);
    for (int e = 0; e < DIM; e++) {
      if (e == d) continue;
      const double along =
          mesh_slope(mesh, f, skin_difference(mesh, face, e, u[d]));
      rows[e][f] = 0.5 * face->part[e] * (grad[e][d] + along);
    }
  }
}

void strain_find_deviator(const struct mesh *mesh, const struct skin *skin,
                          double *const u[DIM],
                          double *const rows[STRAIN_ROWS]) {
  for (int d = 0; d < DIM; d++) {
    for (int32_t f = mesh->face_begin[d]; f < mesh->face_begin[d + 1]; f++) {
      double grad[DIM][DIM];
      face_gradient(mesh, d, f, u, grad);
      set_rows(grad, d, f, rows);
      const double hoop =
          mesh_is_axisymmetric(mesh) ? mesh_face_hoop(mesh, u[0], f, d) : 0;
      double trace = hoop;
      for (int e = 0; e < DIM; e++) trace += grad[e][e];
      rows[d][f] -= trace / 3;
      if (DIM == 2) rows[STRAIN_HOOP][f] = hoop - trace / 3;
    }
  }
  if (skin) set_skin_rows(mesh, skin, u, rows);
  mesh_fill_faces(mesh, STRAIN_ROWS, rows);
}

void strain_divergence(const struct mesh *mesh, double *const s[],
                       double *const force[DIM]) {
  for (int e = 0; e < DIM; e++) {
    for (int32_t i = 0; i < mesh->nleaves; i++) {
      force[e][i] = mesh_divergence(mesh, s[e], i);
    }
  }
  for (int32_t i = 0; i < mesh->nleaves && mesh_is_axisymmetric(mesh); i++) {
    force[0][i] += mesh_hoop_force(mesh, s[STRAIN_HOOP], i);
  }
}
