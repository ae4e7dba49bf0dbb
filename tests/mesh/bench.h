/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A grid with fields and a closed or periodic box around it, for tests of
 * single stages of the scheme; and ways to fill and to compare fields. */
#ifndef TALUS_TESTS_BENCH_H
#define TALUS_TESTS_BENCH_H

#include <stdlib.h>
#include <string.h>

#include "grid.h"
#include "talus/clean.h"
#include "talus/field.h"
#include "talus/shapes.h"

struct bench {
  struct forest *forest;
  struct mesh *mesh;
  struct clean *clean;
  struct fields fields;
  bool closed[MESH_MAX_PATCHES], open[MESH_MAX_PATCHES];
};

/* Make a bench on a forest, which it takes over. All sides closed. */
static inline struct bench *bench_on(struct forest *forest) {
  struct bench *b = MEM_NEW(struct bench, 1);
  b->forest = forest;
  b->mesh = mesh_new(forest);
  b->clean = clean_new(b->mesh);
  for (int k = 0; k < MESH_MAX_PATCHES; k++) b->closed[k] = true;
  return b;
}

static inline struct bench *bench_new(int trees, bool periodic, int base,
                                      int level) {
  return bench_on(grid_new(MPI_COMM_WORLD, trees, periodic, base, level));
}

static inline void bench_destroy(struct bench *b) {
  fields_destroy(&b->fields);
  clean_destroy(b->clean);
  mesh_destroy(b->mesh);
  forest_destroy(b->forest);
  mem_free(b);
}

static inline struct field *bench_cell(struct bench *b, const char *name) {
  return fields_add(&b->fields, b->mesh, name, "", "", FIELD_CELL, NULL);
}

static inline struct field *bench_face(struct bench *b, const char *name) {
  return fields_add(&b->fields, b->mesh, name, "", "", FIELD_FACE, NULL);
}

/* Add one field per axis; `names` has at least DIM entries. */
static inline void bench_vector(struct bench *b, const char *const names[],
                                struct field *out[DIM]) {
  for (int d = 0; d < DIM; d++) out[d] = bench_cell(b, names[d]);
}

/* Fill the volume fractions of a level set, its surface found to 1/8 of a leaf.
 */
static inline void fill_shape(const struct mesh *mesh, shape_level_set f,
                              void *context, double *v) {
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    v[i] = shape_fraction(f, context, mesh->x[i], mesh->h[i], 3);
  }
}

static inline void face_centre(const struct mesh *mesh, int d, int32_t f,
                               double x[3]) {
  const int32_t i = mesh->face_owner[f];
  x[2] = 0;
  for (int e = 0; e < DIM; e++) x[e] = mesh->x[i][e];
  x[d] += 0.5 * mesh->h[i] * (mesh->face_leaf[f][0] == i ? 1 : -1);
}

/* Return component d of a velocity field at x. */
typedef double (*velocity_function)(int d, const double x[3]);

/* Fill normal velocities at face centres, not solenoidal to round-off. */
static inline void fill_faces(const struct mesh *mesh, velocity_function u,
                              double *u_f) {
  for (int d = 0; d < DIM; d++) {
    for (int32_t f = mesh->face_begin[d]; f < mesh->face_begin[d + 1]; f++) {
      double x[3];
      face_centre(mesh, d, f, x);
      u_f[f] = u(d, x);
    }
  }
  mesh_fill_faces(mesh, 1, &u_f);
}

static inline void fill_cells(const struct mesh *mesh, velocity_function u,
                              struct field *const field[DIM]) {
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    double x[3] = {0};
    for (int d = 0; d < DIM; d++) x[d] = mesh->x[i][d];
    for (int d = 0; d < DIM; d++) field[d]->v[i] = u(d, x);
  }
}

/* Give boundary nodes of a filled field the value of a function beyond the wall
 * instead of what a boundary condition says. */
typedef double (*scalar_function)(const void *context, const double x[3]);
static inline void set_boundary_nodes(const struct mesh *mesh,
                                      scalar_function value,
                                      const void *context, double *v) {
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    for (int s = 0; s < NSTENCIL; s++) {
      if (mesh->stencil[i][s] < mesh->begin_boundary) continue;
      const int o[] = {s % 3 - 1, s / 3 % 3 - 1, s / 9 - 1};
      double x[3] = {0};
      for (int d = 0; d < DIM; d++) x[d] = mesh->x[i][d] + o[d] * mesh->h[i];
      v[mesh->stencil[i][s]] = value(context, x);
    }
  }
}

/* Return a solenoidal velocity without normal component on the unit box,
 * largest value 1: a vortex in two dimensions, three crossed ones in three. */
static inline double vortex(int d, const double x[3]) {
  const double pi = acos(-1);
  double s[3], c[3];
  for (int e = 0; e < 3; e++) {
    s[e] = sin(pi * x[e]);
    c[e] = sin(2 * pi * x[e]);
  }
  if (DIM == 2) return (d ? 1 : -1) * s[d] * s[d] * c[1 - d];
  const double k[] = {1, -0.5, -0.5};
  return k[d] * s[d] * s[d] * c[(d + 1) % 3] * c[(d + 2) % 3];
}

/* Return the bound of the scheme: 1/2 sum |u_f| A dt / V <= cfl in all leaves.
 */
static inline double courant_dt(const struct mesh *mesh, const double *u_f,
                                double cfl) {
  double rate = 0;
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    double sum = 0;
    for (int f = 0; f < NFACE; f++) sum += fabs(u_f[mesh->cell_face[i][f]]);
    rate = larger(rate, 0.5 * sum / mesh->h[i]);
  }
  return cfl / mesh_max(mesh, rate);
}

/* Return the integral over the box of weight(i) v; the sum itself adds no
 * round-off. */
static inline double integral(const struct mesh *mesh, const double *v) {
  long double sum = 0;
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    sum += (long double)v[i] * mesh_volume(mesh, i);
  }
  return mesh_sum(mesh, (double)sum);
}

/* Return an array with every leaf of the unit box at the place of its centre in
 * a lattice of 2 2^level points along each axis, known to all ranks; 0
 * elsewhere. The caller frees it. Collective. */
static inline double *paint(const struct mesh *mesh, const double *v,
                            int level) {
  const int32_t n = 2 << level;
  int32_t size = 1;
  for (int d = 0; d < DIM; d++) size *= n;
  double *out = MEM_NEW(double, size);
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    int32_t at = 0;
    for (int d = DIM - 1; d >= 0; d--) {
      at = at * n + (int32_t)(mesh->x[i][d] * n + 0.5);
    }
    out[at] = v[i];
  }
  MPI_CHECK(
      MPI_Allreduce(MPI_IN_PLACE, out, size, MPI_DOUBLE, MPI_SUM, mesh->comm));
  return out;
}

#endif
