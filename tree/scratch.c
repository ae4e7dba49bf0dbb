/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/scratch.h"

#include <string.h>

#include "talus/error.h"
#include "talus/poison.h"

static void add_arrays(struct scratch *scratch, struct fields *fields,
                       enum field_location location, int n,
                       const char *const name[SCRATCH_MAX]) {
  CHECK(n <= SCRATCH_MAX, "%d arrays of scratch, at most %d", n, SCRATCH_MAX);
  for (int k = 0; k < n; k++) {
    scratch->array[location][k] =
        fields_add(fields, *scratch->mesh, name[k], "", "", location, NULL);
  }
  scratch->n[location] = n;
}

void scratch_init(struct scratch *scratch, struct fields *fields,
                  struct mesh *const *mesh, int ncells, int nfaces) {
  static const char *const cell[SCRATCH_MAX] = {
      "cell_0", "cell_1", "cell_2", "cell_3", "cell_4",  "cell_5",
      "cell_6", "cell_7", "cell_8", "cell_9", "cell_10", "cell_11"};
  static const char *const face[SCRATCH_MAX] = {
      "face_0", "face_1", "face_2", "face_3", "face_4",  "face_5",
      "face_6", "face_7", "face_8", "face_9", "face_10", "face_11"};
  memset(scratch, 0, sizeof *scratch);
  scratch->mesh = mesh;
  add_arrays(scratch, fields, FIELD_CELL, ncells, cell);
  add_arrays(scratch, fields, FIELD_FACE, nfaces, face);
}

static void poison_array(const struct scratch *scratch,
                         enum field_location location, int k) {
  const struct mesh *mesh = *scratch->mesh;
  poison(scratch->array[location][k]->v,
         location == FIELD_CELL ? mesh->ncells : mesh->nfaces_all);
}

/* Tell whether `taker` has array k of a location. */
static bool has(const struct scratch *scratch, enum field_location location,
                int k, const char *taker) {
  const char *who = scratch->taker[location][k];
  return who && strcmp(who, taker) == 0;
}

void scratch_take(struct scratch *scratch, enum field_location location,
                  const char *taker, int n, double *v[]) {
  int taken = 0;
  for (int k = 0; k < scratch->n[location]; k++) {
    CHECK(!has(scratch, location, k, taker),
          "%s takes scratch again and has not given it back", taker);
    if (scratch->taker[location][k] || taken == n) continue;
    poison_array(scratch, location, k);
    scratch->taker[location][k] = taker;
    v[taken++] = scratch->array[location][k]->v;
  }
  CHECK(taken == n, "%s wants %d arrays of scratch, %d are free", taker, n,
        taken);
}

double *scratch_take_one(struct scratch *scratch, enum field_location location,
                         const char *taker) {
  double *v;
  scratch_take(scratch, location, taker, 1, &v);
  return v;
}

void scratch_give(struct scratch *scratch, const char *taker) {
  bool given = false;
  for (int location = FIELD_CELL; location <= FIELD_FACE; location++) {
    for (int k = 0; k < scratch->n[location]; k++) {
      if (!has(scratch, location, k, taker)) continue;
      poison_array(scratch, location, k);
      scratch->taker[location][k] = NULL;
      given = true;
    }
  }
  CHECK(given, "%s gives back scratch that it has not taken", taker);
}

void scratch_exchange(struct scratch *scratch, const double *taken,
                      double *other) {
  struct field *found = NULL;
  for (int location = FIELD_CELL; location <= FIELD_FACE; location++) {
    for (int k = 0; k < scratch->n[location]; k++) {
      struct field *array = scratch->array[location][k];
      if (array->v == taken && scratch->taker[location][k]) found = array;
    }
  }
  CHECK(found, "an array that is not taken cannot be exchanged");
  found->v = other;
}

const char *scratch_taker(const struct scratch *scratch) {
  for (int location = FIELD_CELL; location <= FIELD_FACE; location++) {
    for (int k = 0; k < scratch->n[location]; k++) {
      const char *taker = scratch->taker[location][k];
      if (taker) return taker;
    }
  }
  return NULL;
}
