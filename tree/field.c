/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/field.h"

#include <math.h>
#include <string.h>

#include "talus/error.h"
#include "talus/memory.h"

static size_t field_length(const struct field *field, const struct mesh *mesh) {
  return (size_t)(field->location == FIELD_CELL ? mesh->ncells
                                                : mesh->nfaces_all);
}

/* Make an array of zeros on what is computed here; the rest waits for a fill.
 */
static double *new_array(const struct field *field, const struct mesh *mesh) {
  double *v = MEM_NEW(double, field_length(field, mesh));
  if (field->location == FIELD_CELL) {
    mesh_touch(mesh, v);
  } else {
    poison(v + mesh->nfaces, mesh->nfaces_all - mesh->nfaces);
  }
  return v;
}

struct field *fields_add(struct fields *fields, const struct mesh *mesh,
                         const char *name, const char *unit, const char *title,
                         enum field_location location,
                         const struct field_rule *rule) {
  CHECK(fields->n < FIELDS_MAX, "more than %d fields", FIELDS_MAX);
  CHECK(!fields_find(fields, name), "field '%s' twice", name);
  struct field *field = MEM_NEW(struct field, 1);
  field->name = name, field->unit = unit, field->title = title;
  field->location = location, field->rule = rule;
  field->component = -1;
  field->v = new_array(field, mesh);
  fields->field[fields->n++] = field;
  return field;
}

struct field *fields_find(const struct fields *fields, const char *name) {
  for (int k = 0; k < fields->n; k++) {
    if (strcmp(fields->field[k]->name, name) == 0) return fields->field[k];
  }
  return NULL;
}

void fields_release(struct fields *fields, bool all) {
  for (int k = 0; k < fields->n; k++) {
    struct field *field = fields->field[k];
    mem_free(field->saved);
    field->saved = NULL;
    if (!all && field->rule) continue;
    mem_free(field->v);
    field->v = NULL;
  }
}

void fields_reset(struct fields *fields, const struct mesh *mesh) {
  fields_release(fields, true);
  for (int k = 0; k < fields->n; k++) {
    struct field *field = fields->field[k];
    if (field->on_demand) continue;
    field->v = new_array(field, mesh);
  }
}

void fields_destroy(struct fields *fields) {
  fields_release(fields, true);
  for (int k = 0; k < fields->n; k++) mem_free(fields->field[k]);
  fields->n = 0;
}

void fields_touch(struct fields *fields, const struct mesh *mesh) {
  for (int k = 0; k < fields->n; k++) {
    struct field *field = fields->field[k];
    if (field->restart && field->location == FIELD_CELL)
      mesh_touch(mesh, field->v);
  }
}

static size_t saved_length(const struct field *field, const struct mesh *mesh) {
  return (size_t)(field->location == FIELD_CELL ? mesh->nleaves
                                                : mesh->nfaces_all);
}

void fields_save(struct fields *fields, const struct mesh *mesh) {
  for (int k = 0; k < fields->n; k++) {
    struct field *field = fields->field[k];
    if (!field->restart || field->old) continue;
    const size_t n = saved_length(field, mesh);
    if (!field->saved) field->saved = MEM_NEW(double, n);
    memcpy(field->saved, field->v, n * sizeof(double));
  }
}

void field_restore(struct field *field, const struct mesh *mesh) {
  const double *before = field->old ? field->old->v : field->saved;
  CHECK(before, "field '%s' was not saved", field->name);
  if (before == field->v) return;
  memcpy(field->v, before, saved_length(field, mesh) * sizeof(double));
  if (field->location == FIELD_CELL) mesh_touch(mesh, field->v);
}

void fields_restore(struct fields *fields, const struct mesh *mesh) {
  for (int k = 0; k < fields->n; k++) {
    if (fields->field[k]->restart) field_restore(fields->field[k], mesh);
  }
}

/* Are all values finite? Only then is the sum of 0 v zero; in parts, so that
 * the compiler may use vectors. */
static bool is_finite(int32_t n, const double *v) {
  enum { LANES = 8 };
  double zero[LANES] = {0}, sum = 0;
  int32_t i = 0;
  for (; i + LANES <= n; i += LANES) {
    for (int k = 0; k < LANES; k++) zero[k] += 0 * v[i + k];
  }
  for (; i < n; i++) sum += 0 * v[i];
  for (int k = 0; k < LANES; k++) sum += zero[k];
  return sum == 0;
}

const char *fields_not_finite(const struct fields *fields,
                              const struct mesh *mesh) {
  int worst = 0; /* FIELDS_MAX less the place of the first that is not */
  for (int k = 0; k < fields->n && worst == 0; k++) {
    const struct field *field = fields->field[k];
    if (!field->restart) continue;
    const bool cells = field->location == FIELD_CELL;
    if (!is_finite(cells ? mesh->nleaves : mesh->nfaces, field->v))
      worst = FIELDS_MAX - k;
  }
  worst = (int)mesh_max(mesh, worst);
  return worst > 0 ? fields->field[FIELDS_MAX - worst]->name : NULL;
}

void field_fill_many(const struct mesh *mesh, int n,
                     struct field *const field[]) {
  double *v[FIELDS_MAX];
  const struct bc *bc[FIELDS_MAX];
  for (int k = 0; k < n; k++) v[k] = field[k]->v, bc[k] = field[k]->bc;
  mesh_fill(mesh, n, v, bc, false);
}

void field_fill(const struct mesh *mesh, struct field *field) {
  field_fill_many(mesh, 1, &field);
}

void field_fill_faces(const struct mesh *mesh, struct field *field) {
  mesh_fill_faces(mesh, 1, &field->v);
}
