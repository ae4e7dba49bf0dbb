/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The list of closures. */
#include <stddef.h>
#include <string.h>

#include "models.h"

#define ADDRESS(name) &rheology_##name,
static const struct rheology_model *const MODELS[] = {RHEOLOGY_MODELS(ADDRESS)};
#undef ADDRESS

enum { NMODELS = sizeof(MODELS) / sizeof(MODELS[0]) };

const struct rheology_model *rheology_get(int i) {
  return i >= 0 && i < NMODELS ? MODELS[i] : NULL;
}

const struct rheology_model *rheology_find(const char *name) {
  for (int i = 0; i < NMODELS; i++)
    if (strcmp(MODELS[i]->name, name) == 0) return MODELS[i];
  return NULL;
}
