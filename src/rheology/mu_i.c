/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * The mu(I) rheology: eta = mu(I) p/gamma with
 *
 *   I = gamma d/sqrt(p/rho)
 *   mu(I) = mu_s + delta_mu/(I_0/I + 1)
 *
 * [lagree_staron_popinet_2011, eqs. 2.2 and 2.3 corrected],
 * written as a yield stress and a plastic viscosity [valette_2019, eqs. 4-5]
 *
 *   tau_y = mu_s p
 *   eta_f = delta_mu p/(I_0 sqrt(p/rho)/d + gamma)
 *
 * which is the same, and has no 0/0 at gamma = 0. rho is the density in I: of
 * the flow in the paper above, of the grains themselves in Jop et al. (2006).
 * Defaults: the reference of [lagree_staron_popinet_2011, figures 15-16].
 */
#include <float.h>
#include <math.h>

#include "models.h"

enum { MU_S, DELTA_MU, I_0, D, RHO };

static const struct rheology_key KEYS[] = {
    {"mu_s", "1", 0., 100., 0.32, "friction coefficient at rest"},
    {"delta_mu", "1", 0., 100., 0.28,
     "rise of friction from I = 0 to infinity"},
    {"I0", "1", 1e-6, 1e6, 0.4, "inertial number at half that rise"},
    {"d", "m", 1e-12, 1e6, NAN, "grain diameter"},
    {"rho", "kg/m^3", 1e-12, 1e12, NAN, "density in the inertial number"},
};

static void eval(const struct rheology *r, int32_t n,
                 const double *restrict shear_rate,
                 const double *restrict pressure, double *restrict eta) {
  const double delta_mu = r->param[DELTA_MU];
  const double factor = r->param[I_0] / (r->param[D] * sqrt(r->param[RHO]));
  for (int32_t i = 0; i < n; i++) {
    double p = pressure[i];
    double denominator = factor * sqrt(p) + shear_rate[i];
    /* 0 only for p = 0: the floor turns 0/0 into 0 */
    eta[i] = delta_mu * p / (denominator < DBL_MIN ? DBL_MIN : denominator);
  }
}

const struct rheology_model rheology_mu_i = {
    .name = "mu_i",
    .title = "mu(I) rheology, (mu_s + delta_mu/(I0/I + 1)) p/gamma",
    .source = "lagree_staron_popinet_2011, eqs. 2.2-2.3",
    .keys = KEYS,
    .nkeys = NKEYS(KEYS),
    .eval = eval,
    .yield = rheology_friction,
    .holds = true,
    .mu_of_i = true,
};
