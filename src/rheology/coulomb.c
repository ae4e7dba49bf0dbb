/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Constant friction: eta = mu_s p/gamma, a yield stress mu_s p and no plastic
 * viscosity [lagree_staron_popinet_2011, section 4.1.5]. */
#include <math.h>

#include "models.h"

enum { MU_S };

static const struct rheology_key KEYS[] = {
    {"mu_s", "1", 0., 100., NAN, "friction coefficient"},
};

static void eval(const struct rheology *r, int32_t n,
                 const double *restrict shear_rate,
                 const double *restrict pressure, double *restrict eta) {
  (void)r, (void)shear_rate, (void)pressure;
  for (int32_t i = 0; i < n; i++) eta[i] = 0.;
}

void rheology_friction(const struct rheology *r, int32_t n,
                       const double *restrict shear_rate,
                       const double *restrict pressure,
                       double *restrict tau_y) {
  (void)shear_rate;
  const double mu_s = r->param[MU_S];
  for (int32_t i = 0; i < n; i++) tau_y[i] = mu_s * pressure[i];
}

const struct rheology_model rheology_coulomb = {
    .name = "coulomb",
    .title = "constant friction, mu_s p/gamma",
    .source = "lagree_staron_popinet_2011, section 4.1.5",
    .keys = KEYS,
    .nkeys = NKEYS(KEYS),
    .eval = eval,
    .yield = rheology_friction,
    .holds = true,
};
