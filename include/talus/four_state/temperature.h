/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Granular temperature over a step, once carried with the grains (eq. 3):
 *
 *   3/2 rho_d nu dT/dt = div(kappa grad T - delta grad nu) + tau_K:D - eps
 *
 * delta grad nu runs up the gradient of nu, out of leaves that must have what
 * they give: it is taken from the donor and bounded by a part of its store;
 * kappa is implicit; production and collisions are integrated exactly over dt
 * (four_state_closure.h). Then T is bounded by the key vacuum.T_max, and is 0
 * where there are no grains to speak of.
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
