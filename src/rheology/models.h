/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The list of closures: one line each, rheology_NAME defined in NAME.c. */
#ifndef TALUS_RHEOLOGY_MODELS_H
#define TALUS_RHEOLOGY_MODELS_H

#include "talus/rheology.h"

#define RHEOLOGY_MODELS(MODEL) \
  MODEL(newtonian)             \
  MODEL(bingham)               \
  MODEL(bagnold)               \
  MODEL(coulomb)               \
  MODEL(mu_i)

#define DECLARE(name) extern const struct rheology_model rheology_##name;
RHEOLOGY_MODELS(DECLARE)
#undef DECLARE

/* Length of an array of keys. */
#define NKEYS(keys) ((int)(sizeof(keys) / sizeof((keys)[0])))

#endif
