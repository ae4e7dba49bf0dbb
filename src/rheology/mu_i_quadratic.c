/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Quadratic mu(I) = mu_s + mu_T I^2 [josserand_2004]: Coulomb's friction and
 * Bagnold's stress, since p I^2/gamma is
 *
 *   eta_f = mu_T rho d^2 gamma
 *
 * without pressure.
 */
#include "models.h"

enum { MU_S, MU_T, D, RHO };

static const struct rheology_key KEYS[] = {
    {"mu_s", "1", 0., 100., NAN, "friction coefficient at rest"},
    {"mu_T", "1", 0., 1e6, NAN, "rise of friction with I^2"},
    {"d", "m", 1e-12, 1e6, NAN, "grain diameter"},
    {"rho", "kg/m^3", 1e-12, 1e12, NAN, "density in the inertial number"},
};

static void eval(const struct rheology *r, int32_t n,
                 const double *restrict shear_rate,
                 const double *restrict pressure, double *restrict eta) {
  (void)pressure;
  const double d = r->param[D], factor = r->param[MU_T] * r->param[RHO] * d * d;
  for (int32_t i = 0; i < n; i++) eta[i] = factor * shear_rate[i];
}

const struct rheology_model rheology_mu_i_quadratic = {
    .name = "mu_i_quadratic",
    .title = "quadratic mu(I), (mu_s + mu_T I^2) p/gamma",
    .source = "josserand_2004",
    .keys = KEYS,
    .nkeys = NKEYS(KEYS),
    .eval = eval,
    .yield = rheology_friction,
    .holds = true,
    .mu_of_i = true,
};
