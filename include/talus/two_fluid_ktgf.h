/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Kinetic theory of grains of the set ktgf of the two-fluid model
 * [busch_johansen_2020, eqs. 29-37; exponent 2 in eq. 33, printed 1/2]. With
 * s = sqrt(Theta),
 *   p = A_p Theta,  A_p = phi rho_s (1 + 2 phi (1+e) g_0)
 *   g_0 = 1/(1 - (phi/phi_max)^(1/3))
 *   eta = A_eta s,  kappa = A_kappa s
 *   A_c = 4/5 phi^2 rho_s d g_0 (1+e)/sqrt(pi),  A_kappa = 5/3 A_c
 *   A_eta = A_c + 10 rho_s d sqrt(pi)/(96 (1+e) g_0) (1 + 4/5 phi (1+e) g_0)^2
 * and s is the root of production = loss, each over s,
 *   A_g s^2 + (A_p div u_s + 3 K) s = 2 A_eta D:D + (A_kappa - 2/3 A_eta) div^2
 *   A_g = 12 (1-e^2) g_0 rho_s phi^2/(d sqrt(pi))
 * with "kinetic" production. "total", as eq. 29 reads, adds the work of p_f and
 * tau_y, (tau_y gamma - p_f div u_s)/s, if positive. Where grains are few the
 * root grows without bound, Theta/(d gamma)^2 as phi^-2; so Theta <=
 * |Delta u|^2/3, with Delta u what u_s differs by over a leaf.
 *
 * g_0 is at most that of 1e-3 below phi_max, and A_p goes on linearly.
 */
#ifndef TALUS_TWO_FLUID_KTGF_H
#define TALUS_TWO_FLUID_KTGF_H

#include "talus/two_fluid_closure.h"

/* Holds A_p, A_eta, A_kappa, A_g of ktgf at a phi. */
struct two_fluid_kinetic {
  double p, eta, kappa, loss;
};
struct two_fluid_kinetic two_fluid_kinetic(const struct two_fluid_closure *c,
                                           double phi);

/* Return Theta >= 0, m^2/s^2; 0 but for ktgf. DD: D:D, div: div u_s, both of
 * the grains; K: drag, kg/(m^3 s); du2: |Delta u|^2, m^2/s^2, INFINITY for no
 * bound. */
double two_fluid_temperature(const struct two_fluid_closure *c, double phi,
                             double DD, double div, double K, double du2);

#endif
