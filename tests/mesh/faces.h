/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Places of faces, and face fields from functions of position. */
#ifndef TALUS_TESTS_FACES_H
#define TALUS_TESTS_FACES_H

#include "grid.h"

static const double kPi = 3.14159265358979323846;

/* Return the direction of face f. */
static inline int face_direction(const struct mesh *mesh, int32_t f) {
  int d = 0;
  while (f >= mesh->face_begin[d + 1]) d++;
  return d;
}

static inline void face_centre(const struct mesh *mesh, int32_t f,
                               double x[DIM]) {
  const int32_t i = mesh->face_owner[f];
  const int d = face_direction(mesh, f);
  for (int e = 0; e < DIM; e++) x[e] = mesh->x[i][e];
  x[d] += (mesh->face_node[f][0] == i ? 0.5 : -0.5) * mesh->h[i];
}

/* Return v [nfaces_all], the caller's, from a function of the face centre.
 * Walls are closed (0) if asked for. */
static inline double *face_field(const struct mesh *mesh,
                                 double (*function)(const double *x),
                                 bool closed) {
  double *v = MEM_NEW(double, mesh->nfaces_all);
  for (int32_t f = 0; f < mesh->nfaces; f++) {
    double x[DIM];
    face_centre(mesh, f, x);
    v[f] = closed && mesh->face_patch[f] >= 0 ? 0 : function(x);
  }
  mesh_fill_faces(mesh, 1, &v);
  return v;
}

/* Return the distance from the middle of the unit box. */
static inline double from_middle(const double *x) {
  double r2 = 0;
  for (int d = 0; d < DIM; d++) r2 += (x[d] - 0.5) * (x[d] - 0.5);
  return sqrt(r2);
}

#endif
