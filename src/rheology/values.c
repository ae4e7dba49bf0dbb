/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Keys and values of a closure, as the case file and the log see them. */
#include <math.h>
#include <stddef.h>
#include <string.h>

#include "models.h"

/* In the order of shared_value. */
static const struct rheology_key SHARED[] = {
    {"eta_min", "Pa s", 0., 1e30, 0., "smallest viscosity"},
    {"eta_max", "Pa s", 1e-30, 1e30, 1e30, "largest viscosity"},
    {"gamma_r", "1/s", 1e-12, 1e12, 1e-3,
     "shear rate of papanastasiou and bercovier_engelman"},
    {"cohesion", "Pa", 0., 1e15, 0., "added to the yield stress"},
};

static const char *const REGULARISATIONS[] = {
    [RHEOLOGY_CLIP] = "clip",
    [RHEOLOGY_PAPANASTASIOU] = "papanastasiou",
    [RHEOLOGY_BERCOVIER_ENGELMAN] = "bercovier_engelman",
    [RHEOLOGY_EXACT] = "exact",
};

const struct rheology_key *rheology_key(const struct rheology_model *model,
                                        int i) {
  if (i < 0) return NULL;
  if (i < model->nkeys) return &model->keys[i];
  i -= model->nkeys;
  return i < NKEYS(SHARED) ? &SHARED[i] : NULL;
}

/* Return where r keeps the value of key i, rheology_key(r->model, i) not being
 * NULL */
static double *value_of(struct rheology *r, int i) {
  double *shared_value[NKEYS(SHARED)] = {&r->eta_min, &r->eta_max, &r->gamma_r,
                                         &r->cohesion};
  int nkeys = r->model->nkeys;
  return i < nkeys ? &r->param[i] : shared_value[i - nkeys];
}

double rheology_value(const struct rheology *r, int i) {
  struct rheology copy = *r;
  return *value_of(&copy, i);
}

void rheology_init(struct rheology *r, const struct rheology_model *model) {
  *r = (struct rheology){.model = model, .regularisation = RHEOLOGY_CLIP};
  const struct rheology_key *key;
  for (int i = 0; (key = rheology_key(model, i)) != NULL; i++)
    *value_of(r, i) = key->initial;
}

int rheology_set(struct rheology *r, const char *key, double value) {
  const struct rheology_key *known;
  for (int i = 0; (known = rheology_key(r->model, i)) != NULL; i++) {
    if (strcmp(known->name, key) != 0) continue;
    if (isnan(value) || value < known->min || value > known->max) return -2;
    *value_of(r, i) = value;
    return 0;
  }
  return -1;
}

const struct rheology_key *rheology_missing(const struct rheology *r) {
  const struct rheology_key *key;
  for (int i = 0; (key = rheology_key(r->model, i)) != NULL; i++)
    if (isnan(rheology_value(r, i))) return key;
  return NULL;
}

int rheology_set_regularisation(struct rheology *r, const char *name) {
  const char *known;
  for (int i = 0; (known = rheology_regularisation_name(i)) != NULL; i++) {
    if (strcmp(known, name) != 0) continue;
    r->regularisation = (enum rheology_regularisation)i;
    return 0;
  }
  return -1;
}

const char *rheology_regularisation_name(int i) {
  int n = (int)(sizeof(REGULARISATIONS) / sizeof(REGULARISATIONS[0]));
  return i >= 0 && i < n ? REGULARISATIONS[i] : NULL;
}
