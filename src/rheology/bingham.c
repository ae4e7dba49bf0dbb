/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Bingham fluid: eta = eta_0 + tau_y/gamma
 * [lagree_staron_popinet_2011, eq. 4.1]. */
#include <math.h>

#include "models.h"

enum { TAU_Y, ETA_0 };

static const struct rheology_key KEYS[] = {
    {"tau_y", "Pa", 0., 1e15, NAN, "yield stress"},
    {"eta_0", "Pa s", 0., 1e30, NAN, "plastic viscosity"},
};

static void eval(const struct rheology *r, int32_t n,
                 const double *restrict shear_rate,
                 const double *restrict pressure, double *restrict eta) {
  (void)shear_rate, (void)pressure;
  for (int32_t i = 0; i < n; i++) eta[i] = r->param[ETA_0];
}

static void yield(const struct rheology *r, int32_t n,
                  const double *restrict shear_rate,
                  const double *restrict pressure, double *restrict tau_y) {
  (void)shear_rate, (void)pressure;
  for (int32_t i = 0; i < n; i++) tau_y[i] = r->param[TAU_Y];
}

const struct rheology_model rheology_bingham = {
    .name = "bingham",
    .title = "Bingham fluid, eta_0 + tau_y/gamma",
    .source = "lagree_staron_popinet_2011, eq. 4.1",
    .keys = KEYS,
    .nkeys = NKEYS(KEYS),
    .eval = eval,
    .yield = yield,
    .holds = true,
};
