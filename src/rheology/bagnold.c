/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Bagnold's grain-inertia fluid: eta = rho d^2 gamma
 * [lagree_staron_popinet_2011, eqs. 2.21-2.22], constant of proportionality 1,
 * pressure without effect. It has no threshold and never stops.
 */
#include <math.h>

#include "models.h"

enum { D, RHO };

static const struct rheology_key KEYS[] = {
    {"d", "m", 1e-12, 1e6, NAN, "grain diameter"},
    {"rho", "kg/m^3", 1e-12, 1e12, NAN, "bulk density"},
};

static void eval(const struct rheology *r, int32_t n,
                 const double *restrict shear_rate,
                 const double *restrict pressure, double *restrict eta) {
  (void)pressure;
  const double rho_d2 = r->param[RHO] * r->param[D] * r->param[D];
  for (int32_t i = 0; i < n; i++) eta[i] = rho_d2 * shear_rate[i];
}

const struct rheology_model rheology_bagnold = {
    .name = "bagnold",
    .title = "Bagnold's grain inertia, rho d^2 gamma",
    .source = "lagree_staron_popinet_2011, eqs. 2.21-2.22",
    .keys = KEYS,
    .nkeys = NKEYS(KEYS),
    .eval = eval,
};
