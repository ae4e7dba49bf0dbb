/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The table of keys a case file knows: reading, checking, printing and help
 * all work from it. */
#ifndef TALUS_CASE_KEYS_H
#define TALUS_CASE_KEYS_H

#include <stdbool.h>
#include <stddef.h>

#include "talus/key.h"
#include "talus/params.h"

/* Return key i of a case of this model, NULL past the last. Sections come
 * before what is in them, and what others depend on comes first. */
const struct key *keys_get(const struct model_keys *model, int i);
/* Does the model take a key of this path, if it is known? */
bool keys_takes(const struct model_keys *model, const char *path);
/* Return what is meant by a word that is no key, as it is to be written; NULL:
 * nothing that is known. */
const char *keys_meant(const char *word);
/* Find the key of this path; NULL: the model has none. */
const struct key *keys_find(const struct model_keys *model, const char *path);

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

/* Return the name of side 2d or 2d+1 in this dimension; NULL beyond. */
const char *keys_side_name(int dimension, int side);

/* Say in words what a key accepts: "an integer from 1 to 24". */
void keys_allowed(const struct key *key, int dimension, size_t size,
                  char *text);

#endif
