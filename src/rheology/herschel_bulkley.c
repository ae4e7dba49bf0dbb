/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Herschel-Bulkley fluid: eta = K gamma^(n-1) + tau_y/gamma
 * [herschel_bulkley_1926]. */
#include "models.h"

enum { TAU_Y, K, N };

static const struct rheology_key KEYS[] = {
    {"tau_y", "Pa", 0., 1e15, NAN, "yield stress"},
    {"K", "Pa s^n", 0., 1e30, NAN, "consistency"},
    {"n", "1", 0., 10., NAN, "exponent; below 1: shear thinning"},
};

static void eval(const struct rheology *r, int32_t n,
                 const double *restrict shear_rate,
                 const double *restrict pressure, double *restrict eta) {
  (void)pressure;
  const double consistency = r->param[K], exponent = r->param[N] - 1;
  for (int32_t i = 0; i < n; i++)
    eta[i] = consistency * rate_power(shear_rate[i], exponent);
}

static void yield(const struct rheology *r, int32_t n,
                  const double *restrict shear_rate,
                  const double *restrict pressure, double *restrict tau_y) {
  (void)shear_rate, (void)pressure;
  for (int32_t i = 0; i < n; i++) tau_y[i] = r->param[TAU_Y];
}

const struct rheology_model rheology_herschel_bulkley = {
    .name = "herschel_bulkley",
    .title = "Herschel-Bulkley fluid, K gamma^(n-1) + tau_y/gamma",
    .source = "herschel_bulkley_1926",
    .keys = KEYS,
    .nkeys = NKEYS(KEYS),
    .eval = eval,
    .yield = yield,
    .holds = true,
};
