/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Pressures: of the grains with their mass, and of the fluid with its volume;
 * and drag.
 *
 * A face has the mean alpha of its nodes, by which forces are shared out: alpha
 * grad p, grad p_s and alpha (rho_s - rho_f) g go to the grains, a grad p to
 * the fluid, a = 1 - alpha. p is the pressure of the fluid less rho_f g.x, so
 * that a bed at rest is balanced with p = 0. Before, the phases move through a
 * face with w, the mean of the leaves by mass. Then, k = dt K,
 *
 *   alpha rho_s (u_s - w_s) = dt [alpha (rho_s - rho_f) g - alpha grad p
 *                             - grad p_s] + k (u_f - u_s)                 (1)
 *   a rho_f (u_f - w_f)     = - dt a grad p + k (u_s - u_f)               (2)
 *
 * (1)/alpha - (2)/a is free of p. With the total flux j = alpha u_s + a u_f as
 * it is,
 *
 *   M u_s = rho_s w_s - rho_f w_f + N j
 *           + dt [(rho_s - rho_f) g - grad p_s/alpha]                     (3)
 *   M = rho_s + rho_f alpha/a + k/(alpha a^2),  N = rho_f/a + k/(alpha a^2)
 *
 * which granular_pressure.h takes with the mobility 1/(alpha M): that of the
 * pair, rho_s in a gas and Darcy's law in a liquid. Then p follows from div j =
 * 0 with the mobility lambda of both in (1) and (2), which changes j:
 *
 *   div(lambda grad p) = div j* / dt,   j* that of p = 0
 *
 * and both are repeated until j stays. What goes through faces in the end are
 * the flux of the grains by (3) and the rest of j. Leaves get the mean over
 * their faces of u - w, between levels as jumps.h says, and slip that this does
 * not see is dragged in the leaf.
 * Where fluid enters or leaves the box grains do not.
 *
 * Still grains. w of leaves has what p_s and weight of before do to leaves, and
 * (1) what they do to faces, so that dt (a_f - F A a_f) goes through the faces
 * of grains that an exact yield holds. There w lacks it, by the part
 *   (1 - |u_s|/U) (1 - |u_f - u_s|^2/U^2),  U = 0.1 dt |g|,
 * neither factor below 0, at faces to leaves without grains, too. p of the
 * fluid keeps its own, which damps odd and even pressures.
 *
 * Contact. The grains of a leaf lean on a face across the vertical by
 *   chi = min(1, p_s/(h/2 (rho_s - rho_f) alpha g)),
 * p_s and alpha the larger ones of both leaves, g along the vertical axis of
 * the grid, on a slope too: 1 within a bed, and 0 above grains that carry
 * nothing. Along each axis the part s = 1/2 (1 + chi_upper - chi_lower) of a
 * leaf counts for its upper face and the rest for the lower one, in the mean
 * w_s, in the mass rho_s of a face, with its weight, and in what the leaf gets
 * back. So a face between a bed and clear fluid, through which nothing moves,
 * does not let the bed fall; the face below feels the whole leaf of the
 * surface; and a bed that carries p_s at its top is balanced there too. With
 * plain means the leaf of the surface falls for ever, friction shears the bed
 * with it, and beds gain energy (docs/notes/two_fluid.md). Where the surface
 * cuts a leaf chi of a side across is what the bed wets of it, over what it
 * wets of the other one if that is more; along the vertical s is 1/2 where a
 * leaf rests (surface.h), since its p_s is that of the middle.
 */
#ifndef TALUS_TWO_FLUID_PRESSURES_H
#define TALUS_TWO_FLUID_PRESSURES_H

#include "talus/granular_pressure.h"

struct two_fluid;

/* Fill p for a step of dt. Collective. */
void two_fluid_fill_pressure(struct two_fluid *sim, double dt);
/* Set b[k] [nleaves] to the acceleration along axis e of each phase by p, p_s
 * and weight, without drag: the mean over the faces of a leaf. Collective. */
void two_fluid_leaf_forces(struct two_fluid *sim, int e, double *const b[]);
/* Find p_s, p, alpha_new and the fluxes of the end of the step, and accelerate
 * the leaves. Velocities, alpha and both pressures are filled. Collective. */
void two_fluid_pressures(struct two_fluid *sim, double dt);
/* Describe the pressure of the grains, with scratch taken in the name of
 * `taker`. */
struct granular_pressure two_fluid_material(struct two_fluid *sim,
                                            const char *taker);

#endif
