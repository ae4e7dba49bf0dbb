/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The fluid of the two-fluid model and its drag on grains.
 *
 * Drag is a force K (u_f - u_s) per volume on the grains [busch_johansen_2020,
 * eqs. 24-26; with few grains the exponent is Gidaspow's 1.65, not the printed
 * 0.65, so that grains settle by (1 - phi)^4.65 in the limit of Stokes]. With
 * a = 1 - phi:
 *   Ergun      K = 150 phi^2 eta_f/(a d^2) + 1.75 phi rho_f u_r/d
 *   Wen & Yu   K = 3/4 C_D phi rho_f u_r a^-1.65/d
 *              C_D = 24 (1 + 0.15 Re^0.687)/Re,  Re = a rho_f d u_r/eta_f
 *              and at least 0.44 (reached at Re = 1000; 0 is as printed)
 *   gidaspow   Wen & Yu below phi = 0.19, Ergun above 0.21, a smooth blend
 *              between, as Ergun is 1.15 times Wen & Yu at 0.2 for slow grains,
 *              1.04 times at Re = 8 and 3.7 times for fast ones
 * eta_f in them may be taken at the shear rate of the fluid phase (as Fluent
 * does) or of the pores (below).
 *
 * The viscosity of the fluid is that of a Cross fluid,
 *   eta_f = eta_inf + (eta_0 - eta_inf)/(1 + (lambda gamma)^n)    (eq. 27)
 * and between grains, where grains cannot turn with the flow [boyer_2011],
 *   (1 - phi) eta = eta_f (1 + 2.5 phi/(1 - phi/phi_m)).
 * It is divided by 1 - phi because the fluid counts by (1 - phi) tau_f. The
 * room 1 - phi/phi_m is at least 1e-3. Set ktgf has no such part.
 */
#ifndef TALUS_TWO_FLUID_DRAG_H
#define TALUS_TWO_FLUID_DRAG_H

#include "talus/two_fluid_closure.h"

/* Return eta_f, Pa s, at a shear rate >= 0, 1/s. */
double two_fluid_viscosity(const struct two_fluid_closure *c, double gamma);
/* Return the viscosity eta in the pores, Pa s, >= eta_f, whose stress counts by
 * the part 1 - phi of the fluid. eta_f itself for ktgf. */
double two_fluid_pore_viscosity(const struct two_fluid_closure *c, double phi,
                                double eta_f);
/* Return K, kg/(m^3 s), of a phi from 0 to 1, u_r >= 0, m/s; and K/phi, which
 * is finite at phi = 0. */
double two_fluid_drag(const struct two_fluid_closure *c, double phi, double u_r,
                      double eta_f);
double two_fluid_drag_per_phi(const struct two_fluid_closure *c, double phi,
                              double u_r, double eta_f);
/* Return the shear rate in the pores of which the fluid dissipates what drag
 * takes, sqrt(K u_r^2/((1 - phi) eta_f)): an option for eta_f of fluids that
 * thin, where Fluent takes the shear rate of the phase. */
double two_fluid_pore_shear_rate(double phi, double K, double u_r,
                                 double eta_f);

/* Return the numbers of [busch_johansen_2020, eqs. 9, 10] at gravity g, m/s^2:
 * St = sqrt(rho_s (rho_s - rho_f) g d^3/2)/(18 eta_0). */
double two_fluid_stokes_number(const struct two_fluid_closure *c, double g);
/* Return r = sqrt(rho_s/rho_f). */
double two_fluid_density_ratio(const struct two_fluid_closure *c);

#endif
