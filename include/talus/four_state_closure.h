/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Closures of the four-state model: stress and pressure of grains from their
 * solid fraction nu and granular temperature T [lee_huang_chiew_2015].
 *
 *   p = p_K + p_ES + max(p_D - p_K, 0)                    (eqs. 5, 19, 22)
 *   p_K  = rho_d T nu (1 + 2 C),  C = (1 + e) nu g_0      (eq. 9)
 *   p_ES = K f_1(nu)                                      (eq. 20)
 *   p_D  = rho_d T 9 (1 - e) lambda'/mu' (a nu_0 nu/(nu_0 - nu))^(2/delta)
 *                                                         (eq. 24)
 *   lambda_K = rho_d d s lambda',  mu_K = rho_d d s mu',  s = sqrt(T)
 *                                                         (eqs. 7, 8)
 *   q = -kappa grad T + delta grad nu                     (eqs. 10-12)
 *   kappa = rho_d d s kappa',  delta = rho_d d s^3 delta'
 *   tau_E = p_E eta_S (1 - exp(-n gamma/2)), p_E = p - p_K (eqs. 16-18)
 *
 * Poles are never reached: p_D goes on linearly above nu_0 - 1e-3, p_K above
 * nu_0 and p_ES above nu_max; mu', lambda', kappa', delta' keep their values
 * above nu_0. So p is a function of all nu >= 0, rising, with an inverse.
 *
 * Where grains are few, mu_K of (8) stays finite while their dissipation falls
 * as nu^2: a hot sticky cloud. Therefore mu', kappa' and delta' may be divided
 * by 1 + l/(k d), l = d/(6 sqrt(2) nu g_0) the mean free path and k the key
 * `knudsen`; k = INFINITY is the paper.
 *
 * Fluctuations are made by tau_K : D (eq. 15 prints twice that, which A1 and
 * table II contradict) and lost by collisions (eq. 13). With s,
 *   3 rho_d nu ds/dt = A - B s^2,   B = 9 (1 - e) lambda' rho_d/d
 *   A = rho_d d (2 mu' D:D + (lambda' - 2/3 mu') (div u)^2)
 * whose solution is a tanh.
 *
 * All functions are pure. Parameters are those of the closure lee_huang
 * (lee_huang.h), in its order.
 */
#ifndef TALUS_FOUR_STATE_CLOSURE_H
#define TALUS_FOUR_STATE_CLOSURE_H

#include "talus/lee_huang.h"

struct four_state_closure {
  double param[LEE_HUANG_NKEYS];
  double knudsen; /* k above, > 0 */
  double nu_D;    /* p_D is linear above */
  double p_D[2];  /* p_D/(rho_d T) at nu_D and its slope */
  double p_K[2];  /* p_K/(rho_d T) at nu_0 and its slope */
  double p_ES[2]; /* p_ES at nu_max and its slope, Pa */
  /* Curves and their slopes at nodes every 1/per_nu up to nu_max, those of p in
   * the first; owned */
  double (*table[2])[4];
  double per_nu;
};

/* Prepare the closures for parameters [LEE_HUANG_NKEYS]; returns NULL, or what
 * is wrong with them; then there is nothing to release. */
const char *four_state_closure_init(struct four_state_closure *closure,
                                    const double *param, double knudsen);
void four_state_closure_release(struct four_state_closure *closure);

/* Return p, Pa; slope: unless NULL, its derivative in nu at fixed T. nu >= 0,
 * T >= 0. From a table of cubic pieces, to 1e-7. */
double four_state_pressure(const struct four_state_closure *closure, double nu,
                           double T, double *slope);
/* Return p_K, Pa. */
double four_state_kinetic_pressure(const struct four_state_closure *closure,
                                   double nu, double T);
/* Return the nu of a pressure p > 0 at T, to 1e-14. from: any nu with a
 * pressure below p; guess: where to begin, best a little above. */
double four_state_solid_fraction(const struct four_state_closure *closure,
                                 double p, double T, double from, double guess);
/* Return the nu > nu_min at which p_ES = p >= 0, nu_min for 0. */
double four_state_packed(const struct four_state_closure *closure, double p);
/* Return the integral of p_ES/nu^2 from nu_min to nu: the elastic energy per
 * volume of grains, J/m^3. */
double four_state_elastic(const struct four_state_closure *closure, double nu);

/* The primed numbers above. */
struct four_state_numbers {
  double lambda, mu, kappa, delta;
};
struct four_state_numbers four_state_numbers(
    const struct four_state_closure *closure, double nu);

/* Return tau_E/gamma, Pa s, of p_E >= 0 at a shear rate gamma >= 0, 1/s. */
double four_state_contact_viscosity(const struct four_state_closure *closure,
                                    double p_E, double gamma);

/* Describe how grains are deformed, and how much that may heat them. */
struct four_state_rates {
  double DD;   /* D:D, 1/s^2 */
  double div;  /* div u, 1/s */
  double most; /* of tau_K:D in the mean over a step, W/m^3 */
};
/* Return T after dt by production and collisions. damping: unless NULL, gets k
 * = -d(dT/dt)/dT at the start, 1/s, at which they take back a small change of
 * T; below 0 where it grows. */
double four_state_temperature(const struct four_state_closure *closure,
                              double nu, double T,
                              const struct four_state_rates *rates, double dt,
                              double *damping);

/* Return the state, as enum rheology_state (rheology.h), from the share of p_E
 * in p and the shear rate. */
int four_state_name(const struct four_state_closure *closure, double pE_over_p,
                    double gamma);

#endif
