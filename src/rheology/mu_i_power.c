/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Power law mu(I) = mu_s + s I^n [hatano_2007]: a yield stress mu_s p and
 *
 *   eta_f = s (d sqrt(rho))^n p^(1 - n/2) gamma^(n-1)
 *
 * which for n < 1 is infinite at rest, more weakly than mu_s p/gamma is.
 */
#include "models.h"

enum { MU_S, S, N, D, RHO };

static const struct rheology_key KEYS[] = {
    {"mu_s", "1", 0., 100., NAN, "friction coefficient at rest"},
    {"s", "1", 0., 100., NAN, "rise of friction at I = 1"},
    {"n", "1", 0.01, 2., NAN, "exponent"},
    {"d", "m", 1e-12, 1e6, NAN, "grain diameter"},
    {"rho", "kg/m^3", 1e-12, 1e12, NAN, "density in the inertial number"},
};

static void eval(const struct rheology *r, int32_t n,
                 const double *restrict shear_rate,
                 const double *restrict pressure, double *restrict eta) {
  const double exponent = r->param[N];
  const double factor =
      r->param[S] * pow(r->param[D] * sqrt(r->param[RHO]), exponent);
  for (int32_t i = 0; i < n; i++)
    eta[i] = factor * pow(pressure[i], 1 - 0.5 * exponent) *
             rate_power(shear_rate[i], exponent - 1);
}

const struct rheology_model rheology_mu_i_power = {
    .name = "mu_i_power",
    .title = "power-law mu(I), (mu_s + s I^n) p/gamma",
    .source = "hatano_2007",
    .keys = KEYS,
    .nkeys = NKEYS(KEYS),
    .eval = eval,
    .yield = rheology_friction,
    .holds = true,
    .mu_of_i = true,
};
