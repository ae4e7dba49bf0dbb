/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The list of closures: one line each, rheology_NAME defined in NAME.c. */
#ifndef TALUS_RHEOLOGY_MODELS_H
#define TALUS_RHEOLOGY_MODELS_H

#include <math.h>

#include "talus/rheology.h"

#define RHEOLOGY_MODELS(MODEL) \
  MODEL(newtonian)             \
  MODEL(bingham)               \
  MODEL(power_law)             \
  MODEL(herschel_bulkley)      \
  MODEL(cross)                 \
  MODEL(bagnold)               \
  MODEL(coulomb)               \
  MODEL(mu_i)                  \
  MODEL(mu_i_linear)           \
  MODEL(mu_i_quadratic)        \
  MODEL(mu_i_power)            \
  MODEL(mu_i_well_posed)       \
  MODEL(lee_huang)             \
  MODEL(user)

#define DECLARE(name) extern const struct rheology_model rheology_##name;
RHEOLOGY_MODELS(DECLARE)
#undef DECLARE

/* Cells handled at a time: no function of a model is given more, and what it
 * needs of scratch stays in the L1 cache. */
enum { RHEOLOGY_BLOCK = 256 };

/* Length of an array of keys. */
#define NKEYS(keys) ((int)(sizeof(keys) / sizeof((keys)[0])))

/* tau_y = mu_s p, for closures whose first key is mu_s. */
rheology_function rheology_friction;

/* Return the larger one, written so that NaN in `a` stays NaN. */
static inline double at_least(double a, double low) {
  return a < low ? low : a;
}

static inline double at_most(double a, double high) {
  return a > high ? high : a;
}

/* Return gamma^exponent, exponent >= -1; gamma counts as at least 1e-250, so
 * that neither the result nor 1e30 times it overflows. */
static inline double rate_power(double gamma, double exponent) {
  return pow(at_least(gamma, 1e-250), exponent);
}

#endif
