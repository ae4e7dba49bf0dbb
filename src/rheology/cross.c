/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Cross fluid: eta = eta_inf + (eta_0 - eta_inf)/(1 + (lambda gamma)^n)
 * [busch_johansen_2020, eq. 27]. Their table 2, at 21 degrees Celsius:
 *
 *            rho      eta_0    eta_inf   lambda    n
 *            kg/m^3   Pa s     Pa s      s         1
 *   air      1.225    1.79e-5  1.79e-5   0         0
 *   water    998      1.002e-3 1.002e-3  0         0
 *   PAC2     1000     7.21e-2  1.002e-3  1.09e-2   0.586
 *   PAC4     1000     2.14e-1  1.002e-3  2.61e-2   0.608
 *
 * PAC: polyanionic cellulose in water, 2 and 4 g/L. The table prints lambda in
 * 1/s, and eta_0 = 0 for air and water, which by its own equation would halve
 * eta_inf; a Newtonian fluid has eta_0 = eta_inf.
 */
#include "models.h"

enum { ETA_0, ETA_INF, LAMBDA, N };

static const struct rheology_key KEYS[] = {
    {"eta_0", "Pa s", 0., 1e30, NAN,
     "viscosity at rest; PAC2 0.0721, PAC4 0.214, water as eta_inf"},
    {"eta_inf", "Pa s", 0., 1e30, NAN,
     "viscosity at high shear rates; PAC2, PAC4, water 1.002e-3"},
    {"lambda", "s", 0., 1e12, NAN, "time; PAC2 0.0109, PAC4 0.0261"},
    {"n", "1", 0., 10., NAN, "exponent; PAC2 0.586, PAC4 0.608"},
};

static void eval(const struct rheology *r, int32_t n,
                 const double *restrict shear_rate,
                 const double *restrict pressure, double *restrict eta) {
  (void)pressure;
  const double eta_inf = r->param[ETA_INF], rise = r->param[ETA_0] - eta_inf;
  const double lambda = r->param[LAMBDA], exponent = r->param[N];
  for (int32_t i = 0; i < n; i++)
    eta[i] = eta_inf + rise / (1 + pow(lambda * shear_rate[i], exponent));
}

const struct rheology_model rheology_cross = {
    .name = "cross",
    .title = "Cross fluid, eta_inf + (eta_0 - eta_inf)/(1 + (lambda gamma)^n)",
    .source = "busch_johansen_2020, eq. 27 and table 2",
    .keys = KEYS,
    .nkeys = NKEYS(KEYS),
    .eval = eval,
};
