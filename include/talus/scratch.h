/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Scratch: arrays over cells or faces that the stages of a step borrow.
 *
 * A pool has a fixed number of arrays at either location, fields of a registry
 * (field.h), whose length follows the mesh. A taker, known by name, takes all
 * arrays of a location at once and gives everything back at once; an array has
 * one taker at a time. It is a broken contract (CHECK) to take again before
 * giving back, to take more than is free, and to give back what was not taken.
 * The contents of an array that has been taken are undefined: debug builds fill
 * it with poison (poison.h), and again when it is given back.
 *
 *   double *rhs = scratch_take_one(scratch, FIELD_CELL, __func__);
 *   ...
 *   scratch_give(scratch, __func__);
 */
#ifndef TALUS_SCRATCH_H
#define TALUS_SCRATCH_H

#include "talus/field.h"

enum { SCRATCH_MAX = 12 }; /* arrays at one location */

struct scratch {
  struct mesh *const *mesh;            /* borrowed: that of the fields */
  int n[2];                            /* arrays by location */
  struct field *array[2][SCRATCH_MAX]; /* of the registry */
  const char *taker[2][SCRATCH_MAX];   /* who has the array, NULL: nobody */
};

/* Make a pool of ncells arrays over cells and nfaces over faces of *mesh; the
 * registry owns them. */
void scratch_init(struct scratch *scratch, struct fields *fields,
                  struct mesh *const *mesh, int ncells, int nfaces);

/* Take n arrays at a location, v[k] [ncells] or [nfaces_all], until `taker`, a
 * string that lives as long, gives back all it has. */
void scratch_take(struct scratch *scratch, enum field_location location,
                  const char *taker, int n, double *v[]);
double *scratch_take_one(struct scratch *scratch, enum field_location location,
                         const char *taker);
void scratch_give(struct scratch *scratch, const char *taker);
/* Have the pool own `other`, an array of the same length, in place of one that
 * is taken: two arrays change their roles without a copy. */
void scratch_exchange(struct scratch *scratch, const double *taken,
                      double *other);

/* Name somebody who has not given back; NULL: all arrays are free. */
const char *scratch_taker(const struct scratch *scratch);

#endif
