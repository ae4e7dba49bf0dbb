/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Pressure and stress of the grains of the two-fluid model.
 *
 * Three sets know one number of shear, J = X/p_s,
 *   X = eta_f gamma + a_I rho_s d^2 gamma^2                    [trulsson_2012]
 *   p_s = p_c(phi, phi_p) + X (phi/(phi_m - phi))^2
 *   tau = mu p_s,  mu = mu_1 + (mu_2 - mu_1)/(1 + J_0/J)
 * so that where p_c = 0, phi = phi_m/(1 + sqrt(J)), and with the viscosity in
 * the pores (two_fluid_drag.h) the stress of both phases is that of
 * [boyer_2011], mu + J + 2.5 phi_m sqrt(J) over p_s.
 *   rauter          p_c = 130 Pa (phi - phi_rlp)/(phi_rcp - phi)
 *                                                              [rauter_2021]
 *   critical_state  p_c = 100 Pa (phi - phi_p)^3/(phi_max - phi)^5
 *       D_s phi_p/Dt = -delta gamma phi_p                    [montella_2021]
 *       delta = 40 (phi - phi_c/(1 + sqrt(J))), |delta| <= 1/2
 *   mu_i_phi_i      p_c of rauter; X = rho_s (b d gamma)^2 with no viscous
 * part; mu = mu_1 + (mu_2 - mu_1)/(1 + I_0/I),  I = d gamma sqrt(rho_s/p_s),
 *       phi = phi_m/(1 + b I), b = slope/phi_m: phi_m - slope I for small I,
 *       and p_s = 0 at phi = 0, which the straight line lacks; phi_rcp <=
 * phi_m, as a bed that rests denser than all that flows bursts when it yields
 * Grains of rauter forget how they were laid, p_c is of phi; grains of
 * critical_state remember by phi_p. Its phi_m is its phi_max, as in sedFoam's
 * cases of collapse, since dense beds have phi > 0.585.
 *
 * The fourth is ktgf [busch_johansen_2020, eqs. 28-37]:
 *   p_s = p_f(phi) + A_p Theta
 *   p_f = 0.05 Pa (phi - phi_fr)^2/(phi_max - phi)^5         johnson_jackson
 *   p_f = 1e24 Pa (phi - phi_star)^10                        syamlal
 *   tau_y = p_s sin(angle) or p_s tan(angle)                 above phi_fr
 * with A_p and the viscosities of the kinetic theory in two_fluid_ktgf.h.
 *
 * Poles are never reached: X (..)^2, p_f, A_p and p_c of critical_state go on
 * linearly from 1e-3 below theirs; p_c of rauter from 1e-6, for its pole is of
 * first order. So P(phi) is a rising, convex function of all phi >= 0, and the
 * method of granular_pressure.h holds.
 */
#ifndef TALUS_TWO_FLUID_GRAINS_H
#define TALUS_TWO_FLUID_GRAINS_H

#include "talus/two_fluid_closure.h"

/* Holds what P(phi) is taken with while it is solved for phi. */
struct two_fluid_frozen {
  double phi_p; /* of critical_state */
  double X;     /* Pa, two_fluid_shear */
  double Theta; /* m^2/s^2, of ktgf */
};

/* Return X, Pa, of a shear rate >= 0; 0 for ktgf. */
double two_fluid_shear(const struct two_fluid_closure *c, double gamma,
                       double eta_f);
/* Return X after dt of shear where it was `before`: it builds up at the rate
 * relax phi gamma, but for the viscous part of rauter, which is there at once,
 * so that p_s and the stress, which is as p_s, do not chase each other
 * [montella_2021]; nor p_s, which grows as gamma^2 by inertia, and gamma, which
 * p_s drives where phi is near phi_m: grains burst. It falls at once: grains at
 * rest keep none. */
double two_fluid_relaxed_shear(const struct two_fluid_closure *c, double before,
                               double gamma, double eta_f, double phi,
                               double dt);
/* Return P, Pa, at phi >= 0; slope: unless NULL, dP/dphi. */
double two_fluid_pressure(const struct two_fluid_closure *c, double phi,
                          const struct two_fluid_frozen *with, double *slope);
/* Return the phi of a pressure p > 0, to 1e-14. from: any phi with a pressure
 * below p; guess: where to begin, best a little above. */
double two_fluid_solid_fraction(const struct two_fluid_closure *c, double p,
                                const struct two_fluid_frozen *with,
                                double from, double guess);
/* Return the largest phi of a bed at rest without load: phi_p, phi_rlp, phi_fr
 * or phi_star. */
double two_fluid_loosest(const struct two_fluid_closure *c, double phi_p);
/* Return the phi of a bed at rest under a load p >= 0, Pa. */
double two_fluid_settled(const struct two_fluid_closure *c, double p,
                         double phi_p);
/* Return the phi_p of critical_state with which a bed of phi carries p >= 0 at
 * rest, at least 0; phi for other sets. */
double two_fluid_plastic_of(const struct two_fluid_closure *c, double phi,
                            double p);
/* Return the solid fraction that no pressure passes: the pole. */
double two_fluid_densest(const struct two_fluid_closure *c);

/* Return -delta gamma, 1/s, the rate of ln phi_p; 0 but for critical_state. */
double two_fluid_plastic_rate(const struct two_fluid_closure *c, double phi,
                              double p_s, double gamma, double eta_f);
/* Return phi_p after dt at that rate. It never rises above the key phi_p_high
 * nor falls below phi_p_low; where it is beyond already it stays. */
double two_fluid_plastic(const struct two_fluid_closure *c, double phi_p,
                         double rate, double dt);

/* The stress is 2 (eta + tau_y/gamma) D + (kappa - 2/3 eta) div(u_s) I. */
struct two_fluid_stress {
  double eta;   /* plastic or kinetic viscosity, Pa s, finite at gamma = 0 */
  double tau_y; /* yield stress, Pa */
  double kappa; /* bulk viscosity, Pa s */
};

/* Return the stress of grains of phi at a pressure p_s, >= 0, and a shear rate
 * >= 0. Theta: of ktgf. */
struct two_fluid_stress two_fluid_stress(const struct two_fluid_closure *c,
                                         double phi, double p_s, double gamma,
                                         double eta_f, double Theta);
/* Return eta + tau_y/gamma, at most eta_max, without division by 0: equation
 * (2) of rheology.h, or (4) with gamma_r > 0. */
double two_fluid_capped(const struct two_fluid_stress *stress, double gamma,
                        double gamma_r, double eta_max);

#endif
