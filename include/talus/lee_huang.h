/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * The kinetic / enduring-contact closure of Lee, Huang & Chiew in local
 * balance: four states from solid to inertial in one viscosity.
 *
 * Pressure and stress have a kinetic part, that of the kinetic theory of
 * Jenkins, and one of enduring contact [lee_huang_chiew_2015, eqs. 4-5, 19]:
 *
 *   p = p_K + p_ES + p_EF        tau = eta_K gamma + tau_E
 *   p_K  = rho_d nu T (1 + 2 (1 + e) nu g_0)                         (eq. 9)
 *   p_ES = K f_1(nu), of the packing                                 (eq. 20)
 *   p_EF = max(p_D - p_K, 0), p_D by the dilatancy law   (eqs. 22, 24)
 *            1/nu = 1/nu_0 + a I^delta                               (eq. 23)
 *   tau_E = eta_S p_E (1 - exp(-n gamma/2))                  (eqs. 17-18)
 *
 * with gamma = 2 D of their D, I = gamma d/sqrt(p/rho_d) and, corrected as the
 * paper's own table II demands,
 *
 *   g_0 = (1 - 7 nu/16)/(1 - nu/nu_max)^g0_exponent, exponent 1.     (eq. 14)
 *
 * Read literally, with exponent 2, the model gives I_tran = 0.36 for table I;
 * with 1, 1.17; the paper has 1.18. Production and loss of fluctuations
 * balance, T = f_4^2 d^2 gamma^2 (eq. A2), so that at a given p and gamma nu is
 * a root of
 *
 *   1 = (K/p) f_1 + nu max(f_2, f_3) f_4^2 I^2                       (eq. A3)
 *   nu f_2 f_4^2 = ((1/nu - 1/nu_0)/a)^(-2/delta)
 *
 * of which the densest is meant, and mu = tau/p (their eta) is
 *
 *   mu = eta_S p_E/p + f_4 mu' I^2,  p_E/p = 1 - nu f_3 f_4^2 I^2.   (eq. A6)
 *
 * At I_tran, where f_2 = f_3, contact ends and mu has a kink; beyond I_max no
 * steady shear exists: nu, mu and p_E/p are held there.
 *
 * Tables, made once. For nu <= nu_min, f_1 = 0 and I alone decides:
 * (23) is explicit up to I_tran, and from there to I_max nu is a smooth
 * function of acosh(I_max/I), tabulated between these two ends. Where
 * p_ES counts, I < I_m = I(nu_min), nu depends on I and K/p with boundary
 * layers at I_m and, as I falls, at p = p_ES(nu_0). Two tables, above and below
 * that pressure, over the logarithms of
 *
 *   I^2/(I_m^2 - I^2)   and   p_ES(nu_0)/p - 1 or the inverse of p/p_ES - 1
 *
 * spread all of them out. One more has nu f_3 f_4^2 and f_4 mu' over nu. All
 * are uniform, read by four-point interpolation; for delta >= 0.39 the error is
 * below 1e-6 of mu and nu, for any I and p (4e-6 of nu at delta = 0.2).
 * f_2 > f_3 wherever p_ES counts, or prepare refuses the parameters.
 *
 * With regularisation = "exact" the yield stress is eta_S p_E, without the
 * factor with n, and the plastic viscosity is eta_K.
 *
 * A cell costs 40 times that of mu_i (docs/notes/closures.md).
 *
 *  [lee_huang_chiew_2015] Phys. Fluids 27 (2015) 113303,
 *    doi:10.1063/1.4935626.
 */
#ifndef TALUS_LEE_HUANG_H
#define TALUS_LEE_HUANG_H

#include "talus/rheology.h"

/* The order of its keys in rheology.param. */
enum {
  LEE_HUANG_RHO_D,
  LEE_HUANG_D,
  LEE_HUANG_E_EFF,
  LEE_HUANG_ETA_S,
  LEE_HUANG_NU_MAX,
  LEE_HUANG_NU_MIN,
  LEE_HUANG_NU_0,
  LEE_HUANG_A,
  LEE_HUANG_DELTA,
  LEE_HUANG_K,
  LEE_HUANG_CHI,
  LEE_HUANG_N,
  LEE_HUANG_G0_EXPONENT,
  LEE_HUANG_NKEYS
};

/* Holds what the kinetic theory makes of a solid fraction. */
struct lee_huang_kinetic {
  double f4_2;     /* f_4^2 = T/(d gamma)^2 */
  double pressure; /* nu f_3 f_4^2 = p_K/(p I^2) */
  double stress;   /* f_4 mu' = tau_K/(p I^2) */
};
struct lee_huang_kinetic lee_huang_kinetic(const double *param, double nu);

/* Return f_1 = p_ES/K at a solid fraction. */
double lee_huang_packing(const double *param, double nu);

/* Ends of the branches. */
struct lee_huang_marks {
  double I_m, I_tran, I_max; /* I at nu_min, of the kink, of the last state */
  double nu_tran, nu_last;   /* nu at I_tran and I_max */
};

/* Find the ends of the branches; returns NULL, or what is wrong with the
 * parameters. */
const char *lee_huang_find(const double *param, struct lee_huang_marks *marks);

/* Steady shear at an inertial number and K/p, both >= 0, n infinite, by finding
 * the root of (A3): the reference of the tables. */
struct lee_huang_shear {
  double nu, mu, pE_over_p;
};
struct lee_huang_shear lee_huang_direct(const double *param,
                                        const struct lee_huang_marks *marks,
                                        double I, double K_over_p);

#endif
