/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Scalars: numbers in a struct that a checkpoint keeps, written down once. */
#ifndef TALUS_SCALARS_H
#define TALUS_SCALARS_H

#include <stddef.h>

enum scalar_type {
  SCALAR_REAL,    /* double */
  SCALAR_INTEGER, /* int64_t */
  SCALAR_INT      /* int, or an enum */
};

struct scalar {
  const char *name;
  enum scalar_type type;
  size_t offset; /* in the struct */
  /* A checkpoint is read if the number lies in [low, high]; where high is
   * INFINITY, what is no number is written as that. */
  double low, high;
};

/* More than a run can count, of steps or rows. */
#define SCALAR_MOST 1e15

/* The scalars of one struct. */
struct scalars {
  int n;
  const struct scalar *list; /* [n] */
  void *of;                  /* the struct, borrowed */
};

#endif
