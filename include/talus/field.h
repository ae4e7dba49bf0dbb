/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Fields: named arrays of doubles over the cells or the faces of a mesh.
 *
 * A registry (struct fields) holds all fields of a model. When the mesh changes
 * a field keeps its address and gets another array `v`, of mesh->ncells entries
 * over cells or mesh->nfaces_all over faces (mesh.h). The state of a model is
 * in fields with a rule, by which adaptation carries them to the new leaves;
 * fields without a rule are made anew.
 */
#ifndef TALUS_FIELD_H
#define TALUS_FIELD_H

#include <stdbool.h>

#include "talus/mesh.h"

enum field_location { FIELD_CELL, FIELD_FACE };

struct field;
struct remap;

/* How adaptation carries a field of cells to new leaves (remap.h): `divide`
 * returns the value of a new leaf inside an old one, `merge` that of a new leaf
 * in the place of several old ones; `leaf` is a number of the map. The old
 * values are filled. */
struct field_rule {
  double (*divide)(const struct remap *, const struct field *, int32_t leaf);
  double (*merge)(const struct remap *, const struct field *, int32_t leaf);
};

struct field {
  const char *name; /* this and the next two: static strings */
  const char *unit;
  const char *title;
  enum field_location location;
  const struct field_rule *rule; /* NULL: made anew on a new grid */
  const void *context;           /* of the rule, borrowed */
  double low, high;              /* values allowed in a checkpoint; 0, 0: all */
  bool output;                   /* written to snapshots */
  bool restart;                  /* written to checkpoints */
  int component;           /* axis, of the component of a vector; its name ends
                              in "_x", "_y", "_z"; else -1 */
  double *v;               /* owned */
  double *saved;           /* owned: copy made by fields_save, NULL before */
  const struct field *old; /* a field that will hold the present v by the time
                              of fields_restore, so that fields_save makes no
                              copy; this field itself if v does not change;
                              NULL: fields_save makes a copy */
  bool on_demand; /* v is allocated, on the leaves, while somebody needs the
                     field, else NULL */
  struct bc bc[MESH_MAX_PATCHES];
};

enum { FIELDS_MAX = 128 };
struct fields {
  int n;
  struct field *field[FIELDS_MAX]; /* owned */
};

/* Add a field with an array of zeros for `mesh`, its normal derivative 0 at
 * all boundaries. The registry owns it. */
struct field *fields_add(struct fields *fields, const struct mesh *mesh,
                         const char *name, const char *unit, const char *title,
                         enum field_location location,
                         const struct field_rule *rule);
/* Find a field by its name; NULL: there is none. */
struct field *fields_find(const struct fields *fields, const char *name);
/* Free all arrays, or only those of fields without a rule. */
void fields_release(struct fields *fields, bool all);
/* Replace all arrays by zeros that fit `mesh`. */
void fields_reset(struct fields *fields, const struct mesh *mesh);
void fields_destroy(struct fields *fields);

/* Say that ghosts and helper nodes of all cell fields with restart == true are
 * no longer valid (mesh_touch). */
void fields_touch(struct fields *fields, const struct mesh *mesh);

/* Keep all fields with restart == true (of cell fields the leaf values), and
 * set all or one of them back. The mesh must not change in between. */
void fields_save(struct fields *fields, const struct mesh *mesh);
void fields_restore(struct fields *fields, const struct mesh *mesh);
void field_restore(struct field *field, const struct mesh *mesh);

/* Return the name of the first field with restart == true that is inf or nan on
 * a leaf or face of some rank; NULL: none. Collective. */
const char *fields_not_finite(const struct fields *fields,
                              const struct mesh *mesh);

/* Give the arrays of the components of a vector. */
static inline void field_arrays(struct field *const field[DIM],
                                double *v[DIM]) {
  for (int d = 0; d < DIM; d++) v[d] = field[d]->v;
}

/* Fill cell fields (mesh_fill) with their own boundary conditions. Collective.
 */
void field_fill(const struct mesh *mesh, struct field *field);
void field_fill_many(const struct mesh *mesh, int n,
                     struct field *const field[]);
/* Fill a face field (mesh_fill_faces). Collective. */
void field_fill_faces(const struct mesh *mesh, struct field *field);

#endif
