/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Viscosity and yield stress of faces that grains and gas share.
 *
 * Grains and gas act side by side on a face, of which the part a is wet (by the
 * planes of its leaves):
 *   eta = a eta_1 + (1 - a) eta_2,  tau_y = a (tau_y1(p_f) + cohesion).
 * On a dry face, a = 0, eta_2 is that of the gas in series with the grains on
 * its line (properties.h); so it is on a wet face with gas on its
 * line, beyond which a leaf moves with the gas. Grains touch what a film
 * of gas keeps them from: in a leaf with a part c' < 0.1 of gas a is at least 1
 * - 10 c' (of both leaves), and in the direction of gravity a is at least the
 * lesser c of both leaves, whose planes may miss each other: grains that
 * nothing holds in a leaf would fall for ever on those below. The face that
 * carries a cut leaf bears at least the weight of its grains, p_f >= c rho_1
 * |g_d| h/a.
 *
 * u_f, which carries c, is that of the projection only where grains move: at
 * rest it would leave dt (a_f - mean g_c), which does not vanish. See still.h.
 */
#ifndef TALUS_TWO_PHASE_YIELD_FACES_H
#define TALUS_TWO_PHASE_YIELD_FACES_H

#include "talus/mesh.h"

struct two_phase;

/* Set eta_f, tau_y and gamma_r (yield.h) from the velocity, which is filled,
 * and p. Collective. */
void yield_faces_update(struct two_phase *sim, double *const u[DIM]);

#endif
