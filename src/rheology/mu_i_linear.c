/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Linear mu(I) = mu_s + b I [da_cruz_2005], the limit of slow shear: a yield
 * stress mu_s p and, as p I/gamma = d sqrt(rho p), a plastic viscosity
 *
 *   eta_f = b d sqrt(rho p)
 *
 * Defaults: as quoted by [lagree_staron_popinet_2011, section 4.2].
 */
#include "models.h"

enum { MU_S, B, D, RHO };

static const struct rheology_key KEYS[] = {
    {"mu_s", "1", 0., 100., 0.25, "friction coefficient at rest"},
    {"b", "1", 0., 1e6, 1.1, "slope of friction with I"},
    {"d", "m", 1e-12, 1e6, NAN, "grain diameter"},
    {"rho", "kg/m^3", 1e-12, 1e12, NAN, "density in the inertial number"},
};

static void eval(const struct rheology *r, int32_t n,
                 const double *restrict shear_rate,
                 const double *restrict pressure, double *restrict eta) {
  (void)shear_rate;
  const double factor = r->param[B] * r->param[D] * sqrt(r->param[RHO]);
  for (int32_t i = 0; i < n; i++) eta[i] = factor * sqrt(pressure[i]);
}

const struct rheology_model rheology_mu_i_linear = {
    .name = "mu_i_linear",
    .title = "linear mu(I), (mu_s + b I) p/gamma",
    .source = "da_cruz_2005",
    .keys = KEYS,
    .nkeys = NKEYS(KEYS),
    .eval = eval,
    .yield = rheology_friction,
    .holds = true,
    .mu_of_i = true,
};
