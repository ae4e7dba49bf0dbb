/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The table of keys a case file knows: reading, checking, printing and help
 * all work from it. */
#ifndef TALUS_CASE_KEYS_H
#define TALUS_CASE_KEYS_H

#include <stdbool.h>
#include <stddef.h>

#include "talus/params.h"

enum key_type {
  KEY_NUMBER,   /* double */
  KEY_INTEGER,  /* int */
  KEY_COUNT,    /* int64_t */
  KEY_LEVEL,    /* int, bounded by the deepest level of the dimension */
  KEY_VECTOR,   /* double[3], one number per axis */
  KEY_INTEGERS, /* int[3], one per axis */
  KEY_TEXT,     /* char[256] */
  KEY_CHOICE,   /* enum, one of some names */
  KEY_TIMES,    /* list of times */
  KEY_SHAPE,    /* function of position, a level set */
  KEY_VELOCITY, /* one number per axis or a function that returns them */
  KEY_CLOSURE,  /* {"name", key = value, ...} */
  KEY_SIDE,     /* "type", {"type", option = value} or a function */
  KEY_TRACERS,  /* names of the user's choice = level sets */
  KEY_PRESSURE, /* number, or {number, at = "gas" or a point} */
  KEY_PATCHES,  /* names of the user's choice = boundaries */
  KEY_CRITERIA, /* list of "name" or {"name", option = value} */
  KEY_EXPECT,   /* column of series.csv = {least, most} */
  KEY_SECTION   /* a table of further keys */
};

struct key {
  const char *path;
  enum key_type type;
  double low, high; /* allowed, both included unless ... */
  bool above;       /* ... low itself is not */
  /* What holds when the key is not given: a value, or the path of a key whose
   * value is taken; NULL: it must be given; "": nothing. */
  const char *fallback;
  const char *unit; /* "" for a pure number or none */
  const char *help;
  size_t offset; /* in the struct that is filled */
  /* KEY_CHOICE: names in the order of the enum, which begins at 0; NULL at the
   * end. */
  const char *const *choices;
};

/* Key i of the whole case, NULL past the last. Sections come before what is in
 * them, and what others depend on comes first. */
const struct key *keys_get(int i);

/* A boundary type and the options it takes. */
struct boundary_kind {
  const char *name;
  enum boundary_type type;
  const char *options[3]; /* names in boundary_option, NULL at the end */
  const char *needs;      /* the one that must be given, NULL: none */
  const char *help;
};
const struct boundary_kind *keys_boundary_kind(int i);
const struct key *keys_boundary_option(int i); /* offsets in boundary */

/* A criterion of adaptation and its options. */
struct criterion_kind {
  const char *name;
  enum criterion_type type;
  const char *options[3];
  const char *help;
};
const struct criterion_kind *keys_criterion_kind(int i);
const struct key *keys_criterion_option(int i); /* offsets in criterion */

/* Boundaries by side 2d, 2d+1 in this dimension; NULL beyond. */
const char *keys_side_name(int dimension, int side);

/* What a key accepts, in words: "an integer from 1 to 24". */
void keys_allowed(const struct key *key, int dimension, size_t size,
                  char *text);

#endif
