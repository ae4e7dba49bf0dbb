/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Newtonian fluid: eta constant. */
#include <math.h>

#include "models.h"

enum { ETA };

static const struct rheology_key KEYS[] = {
    {"eta", "Pa s", 0., 1e30, NAN, "viscosity"},
};

static void eval(const struct rheology *r, int32_t n,
                 const double *restrict shear_rate,
                 const double *restrict pressure, double *restrict eta) {
  (void)shear_rate, (void)pressure;
  for (int32_t i = 0; i < n; i++) eta[i] = r->param[ETA];
}

const struct rheology_model rheology_newtonian = {
    .name = "newtonian",
    .title = "Newtonian fluid, eta",
    .source = "lagree_staron_popinet_2011, section 4.1.1",
    .keys = KEYS,
    .nkeys = NKEYS(KEYS),
    .eval = eval,
};
