/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Power-law fluid: eta = K gamma^(n-1) [herschel_bulkley_1926] without their
 * yield stress. At rest it is infinite for n < 1, so eta_max. */
#include "models.h"

enum { K, N };

static const struct rheology_key KEYS[] = {
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

const struct rheology_model rheology_power_law = {
    .name = "power_law",
    .title = "power-law fluid, K gamma^(n-1)",
    .source = "herschel_bulkley_1926, tau_y = 0",
    .keys = KEYS,
    .nkeys = NKEYS(KEYS),
    .eval = eval,
};
