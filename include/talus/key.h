/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Keys of a case file: reading, checking, printing and help all work from
 * tables of keys. `case` has the keys that all models share (src/case/keys.c),
 * and each model brings its own. */
#ifndef TALUS_KEY_H
#define TALUS_KEY_H

#include <math.h>
#include <stdbool.h>
#include <stddef.h>

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
  KEY_SECTION,  /* a table of further keys */
  KEY_OF_MODEL  /* not a key: here come those of the model */
};

struct key {
  const char *path;
  enum key_type type;
  double low, high; /* allowed, both included unless ... */
  bool above;       /* ... low itself is not */
  /* Holds when the key is not given: a value, or the path of a key whose
   * value is taken; NULL: it must be given; "": nothing. */
  const char *fallback;
  const char *unit; /* "" for a pure number or none */
  const char *help;
  size_t offset; /* in struct params, or in the struct of the model's own */
  /* KEY_CHOICE: names in the order of the enum, which begins at 0; NULL at the
   * end. KEY_SECTION: names that it may begin with, a choice like that; the
   * last holds for a section without; NULL: it has none. */
  const char *const *choices;
};

/* Ranges and defaults, as tables of keys write them. */
#define KEY_POSITIVE .low = 0, .high = INFINITY, .above = true
#define KEY_NOT_NEGATIVE .low = 0, .high = INFINITY
#define KEY_ANY .low = -INFINITY, .high = INFINITY
#define KEY_NEEDED .fallback = NULL
#define KEY_OPTIONAL .fallback = ""
#define KEY_DEFAULT .fallback =

/* Tells `case` of a model. */
struct model_keys {
  const char *name;  /* of the key `model` */
  const char *title; /* one line */
  const struct key *keys;
  int nkeys;
  const struct key *more; /* numbers of its closures; none if nmore is 0 */
  int nmore;
  /* Bytes of the struct that holds the values of the keys, params.own; 0: they
   * are members of struct params. Only types up to KEY_CHOICE are allowed in a
   * struct of its own. */
  size_t own_size;
  /* Paths of shared keys that mean nothing to the model and are refused; NULL
   * at the end. NULL: it takes all. */
  const char *const *refused;
  bool strips; /* it calls slip_strip_renew, so that sides may be strips */
};

/* Return key k of a model, those of `more` last; NULL past the end. */
static inline const struct key *model_key(const struct model_keys *model,
                                          int k) {
  if (k < model->nkeys) return &model->keys[k];
  return k < model->nkeys + model->nmore ? &model->more[k - model->nkeys]
                                         : NULL;
}

/* Return the keys of model k of src/models.c; NULL past the last. */
const struct model_keys *models_keys(int k);
/* The names of all models; NULL at the end. */
extern const char *const models_names[];

#endif
