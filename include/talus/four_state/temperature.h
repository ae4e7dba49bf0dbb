/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Granular temperature over a step, once carried with the grains (eq. 3):
 *
 *   3/2 rho_d nu dT/dt = div(kappa grad T - delta grad nu) + tau_K:D - eps
 *
 * Production and collisions are integrated exactly over dt, to T_r
 * (four_state_closure.h), production by no more than twice what mu_K and
 * lambda_K of T^n take from the flow, or else rho_d nu D:D h^2/dt, what the
 * shear of a leaf has: T of thin grains may grow a hundredfold in a step, and
 * mu_K with it, which in truth stops them on the way. Heat comes to a store
 * that they damp at the rate k = -d(dT/dt)/dT of the start,
 *
 *   phi nu (T - T_r) = dt/(3/2 rho_d) div(kappa grad T - delta grad nu),
 *   phi = k dt/(1 - exp(-k dt)), 1 for k < 0,
 *
 * kappa implicit, delta and k of T^n: where heat that comes is heat that is
 * lost T does not depend on dt. One after the other without phi, the error of a
 * steady flow was of first order in dt (docs/notes/four_state.md). What delta
 * moves is bounded by a part of the store of the donor. Then T is bounded by
 * the key vacuum.T_max, and is 0 where there are no grains to speak of.
 */
#ifndef TALUS_FOUR_STATE_TEMPERATURE_H
#define TALUS_FOUR_STATE_TEMPERATURE_H

struct four_state;

/* Advance T; shear_f is valid on all faces, nu and u are those of the end of
 * the step and not filled. Collective. */
void four_state_heat(struct four_state *sim, double dt);
/* Return the energy of fluctuations, J/m (3D: J). Collective. */
double four_state_fluctuating(const struct four_state *sim);

#endif
