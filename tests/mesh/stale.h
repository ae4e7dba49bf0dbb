/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Nodes and faces that are not of this rank: a stage fills them before it reads
 * them, so that a step does not depend on what they were; faces of the state
 * are valid between steps. */
#ifndef TALUS_TESTS_STALE_H
#define TALUS_TESTS_STALE_H

#include <math.h>

#include "talus/field.h"

/* Leave a value in those of all fields. */
static inline void stale_set(struct fields *fields, const struct mesh *mesh,
                             double value) {
  for (int k = 0; k < fields->n; k++) {
    struct field *field = fields->field[k];
    const bool cell = field->location == FIELD_CELL;
    const int32_t end = cell ? mesh->ncells : mesh->nfaces_all;
    if (field->on_demand || (field->restart && !cell)) continue;
    for (int32_t i = cell ? mesh->nleaves : mesh->nfaces; i < end; i++)
      field->v[i] = value;
  }
}

/* Return the largest difference of leaves between the fields of checkpoints of
 * two runs on the same mesh. Collective. */
static inline double stale_difference(const struct fields *a,
                                      const struct fields *b,
                                      const struct mesh *mesh) {
  double most = 0;
  for (int k = 0; k < a->n; k++) {
    const struct field *field = a->field[k];
    if (!field->restart || field->location != FIELD_CELL) continue;
    for (int32_t i = 0; i < mesh->nleaves; i++) {
      const double difference = fabs(field->v[i] - b->field[k]->v[i]);
      most = difference <= most ? most : difference; /* NaN counts */
    }
  }
  return mesh_max(mesh, most);
}

#endif
