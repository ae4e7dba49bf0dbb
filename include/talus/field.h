/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Fields: named arrays of doubles over the cells or faces of a mesh.
 *
 * A registry (struct fields) holds the fields of a model; a field keeps its
 * address while the mesh changes, its array `v` does not. Cell arrays have
 * mesh->ncells entries, face arrays mesh->nfaces_all.
 */
#ifndef TALUS_FIELD_H
#define TALUS_FIELD_H

#include <stdbool.h>

#include "talus/mesh.h"

enum field_location { FIELD_CELL, FIELD_FACE };

struct field;
struct remap;

/* How adaptation carries a field of cells to new leaves (remap.h): the value of
 * a new leaf, `leaf` of the map, that lies in an old one, and of one that takes
 * the place of several. The old values are filled. */
struct field_rule {
  double (*divide)(const struct remap *, const struct field *, int32_t leaf);
  double (*merge)(const struct remap *, const struct field *, int32_t leaf);
};

struct field {
  const char *name; /* static strings */
  const char *unit;
  const char *title;
  enum field_location location;
  const struct field_rule *rule; /* NULL: made anew on a new grid */
  const void *context;           /* of the rule, borrowed */
  double low, high;        /* range of a checkpoint's values; 0, 0: none */
  bool output;             /* written to snapshots */
  bool restart;            /* written to checkpoints */
  int component;           /* axis if part of a vector named `name` without the
                              suffix "_x", "_y", "_z"; else -1 */
  double *v;               /* owned */
  double *saved;           /* owned: copy made by fields_save, NULL before */
  const struct field *old; /* has what v was when fields_save was called once
                              fields_restore is, so that no copy is made;
                              itself if v stays as it is; NULL: none has */
  bool on_demand; /* v is NULL but while somebody (who allocates it, on the
                     leaves, and frees it) needs it */
  struct bc bc[MESH_MAX_PATCHES];
};

enum { FIELDS_MAX = 64 };
struct fields {
  int n;
  struct field *field[FIELDS_MAX]; /* owned */
};

/* Add a field, its array allocated for `mesh` and zero; all boundaries
 * zero-Neumann. The registry owns it. */
struct field *fields_add(struct fields *fields, const struct mesh *mesh,
                         const char *name, const char *unit, const char *title,
                         enum field_location location,
                         const struct field_rule *rule);
struct field *fields_find(const struct fields *fields, const char *name);
/* Free every array, or only those that are not carried to new leaves. */
void fields_release(struct fields *fields, bool all);
/* Replace every array by a zero one that fits `mesh`. */
void fields_reset(struct fields *fields, const struct mesh *mesh);
void fields_destroy(struct fields *fields);

/* Keep a copy of all fields with restart == true (cell fields: leaf values),
 * and set them, or one of them, back to it. The mesh must not change in
 * between. */
void fields_save(struct fields *fields, const struct mesh *mesh);
void fields_restore(struct fields *fields, const struct mesh *mesh);
void field_restore(struct field *field, const struct mesh *mesh);

/* The name of the first field with restart == true that is inf or nan on a leaf
 * or face of some rank; NULL: none. Collective. */
const char *fields_not_finite(const struct fields *fields,
                              const struct mesh *mesh);

/* The arrays of a vector's components. */
static inline void field_arrays(struct field *const field[DIM],
                                double *v[DIM]) {
  for (int d = 0; d < DIM; d++) v[d] = field[d]->v;
}

/* mesh_fill for fields with their own boundary conditions. Collective. */
void field_fill(const struct mesh *mesh, struct field *field);
void field_fill_many(const struct mesh *mesh, int n,
                     struct field *const field[]);
/* mesh_fill_faces for a face field. Collective. */
void field_fill_faces(const struct mesh *mesh, struct field *field);

#endif
