/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The list of models: a line for each, and those of `make MODELS=FILE.c ...`,
 * which the build writes into models.inc. */
#include "talus/model.h"

#include <float.h>

#include "talus/memory.h"

#define MODELS MODEL(two_phase) MODEL(four_state) MODEL(two_fluid)

#define MODEL(name) extern const struct model_kind name##_model;
MODELS
#include "models.inc"
#undef MODEL

#define MODEL(name) &name##_model,
static const struct model_kind *const KINDS[] = {MODELS
#include "models.inc"
};
#undef MODEL

#define MODEL(name) #name,
const char *const models_names[] = {MODELS
#include "models.inc"
                                        NULL};

enum { NKINDS = sizeof KINDS / sizeof *KINDS };

const struct model_kind *models_get(int k) {
  return k >= 0 && k < NKINDS ? KINDS[k] : NULL;
}

const struct model_keys *models_keys(int k) {
  const struct model_kind *kind = models_get(k);
  return kind != NULL ? kind->keys : NULL;
}

const struct scalar model_scalars[MODEL_NSCALARS] = {
    {"time", SCALAR_REAL, offsetof(struct model, time), 0, DBL_MAX},
    {"dt", SCALAR_REAL, offsetof(struct model, dt), 0, DBL_MAX},
    {"step", SCALAR_INTEGER, offsetof(struct model, step), 0, SCALAR_MOST}};

void model_outline_free(struct model_outline *outline) {
  outline_free(&outline->outline);
  for (int k = 0; k < PARAMS_MAX_TRACERS; k++) mem_free(outline->layer[k]);
}
