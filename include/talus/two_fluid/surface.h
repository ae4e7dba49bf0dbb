/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The surface of a bed inside closures and fluxes.
 *
 * The mean solid fraction alpha of a leaf that a bed fills in part is below
 * every packing that carries load, so the leaf has no strength, and a heap of
 * such leaves levels out. Here the bed in a leaf that rests on another one has
 * a packing phi of its own, which its grains carry along, and fills c =
 * alpha/phi of the leaf. What it weighs in its middle is
 *
 *   L = s alpha,  s = h (rho_s - rho_f) g/2,
 *
 * of which its grains carry m L, m = P(phi)/L, at most 1, and the fluid in the
 * pores the rest. Where alpha > phi it fills all of the leaf, so
 *
 *   P_surface(alpha) = max(P(alpha), m s alpha)
 *
 * rises and is convex like P, and beds on leaves that rest (m = 1) are balanced
 * as they are in the continuum: the difference of p_s from leaf to leaf is the
 * weight between their middles, (alpha_0 + alpha_1)/2 of it. A leaf rests on a
 * wall, on a bed, or on a leaf below that carries the weight of half of its own
 * grains; and it has fewer grains above than it holds itself, which lie half a
 * grain thick.
 *
 * phi. Grains that shear get denser than they were before they carry their
 * load again only as fast as fluid leaves them, and a thin front of them runs
 * on it meanwhile. With j the volume flux of both, div u_s = div(u_s - j): the
 * top of a bed sinks through the fluid by w, its bottom by what the face there
 * has, -r, so that
 *
 *   d phi/dt = phi/(c h) (w + r)
 *   M w = (rho_s + rho_f phi/a) w^n + dt (rho_s - rho_f) g (1 - P(phi)/L)
 *
 * with M, a of (3) in pressures.h and w^n = a (u_s - u_f) downwards, implicit
 * in phi. Without w^n the top of a suspension sinks before its bottom, and gets
 * denser. Fluid that drains at once (K small) gives m = 1. Grains that
 * dilate expand at once, to P(phi) = L: suction that would hold them back is
 * not felt (m <= 1; as P(phi) of the last step, m > 1 bursts), and if they
 * stayed dense their pressure would jump as the leaf fills. Leaves that do not
 * rest have phi = alpha if that is a packing, else that which their grains have
 * brought.
 *
 * On a slope the surface cuts two leaves of a column, one above the other. The
 * lower one rests, and carries the upper one if it is more than half full: it
 * has s alpha + W, W = 2 s alpha of the leaf above, and that one rests too,
 * however thin, as the bed goes on below it. Else the grains of the upper one
 * carry nothing, nothing holds them, and they slide off whatever the slope.
 *
 * Across the vertical p_s is taken as the mean over the leaf, c p_s: what two
 * leaves filled by c_0 and c_1 push on each other with is (c_0^2 - c_1^2)/2 of
 * the weight, not (c_0 - c_1)/2 of it, which drives thin leaves off as if the
 * surface was twice as steep or more. With W the sum over both leaves of a
 * column is (c_0 + c_1)^2/2 of it.
 *
 * grains.surface = "none" turns this off. With planes and an exact yield, the
 * defaults, heaps and flat beds stand (docs/notes/two_fluid.md).
 *
 * Faces of such a leaf pass phi times the part of the volume swept that the
 * plane of c fills (vof.h): nothing where the bed does not reach.
 */
#ifndef TALUS_TWO_FLUID_SURFACE_H
#define TALUS_TWO_FLUID_SURFACE_H

#include <stdint.h>

#include "talus/granular_pressure.h"

struct two_fluid;

/* Set c, phi and s of leaves and the planes of the surface. alpha is filled.
 * Collective. */
void two_fluid_find_surface(struct two_fluid *sim);
/* Let the beds of a start in balance carry their load: by phi, or by the
 * plastic packing of a dense start. alpha is filled. Collective. */
void two_fluid_lay_beds(struct two_fluid *sim);
/* Set the packing of beds at the end of dt, after transport. */
void two_fluid_settle_beds(struct two_fluid *sim, double dt);
/* Return the part of side s (2d lower, 2d + 1 upper) of leaf i that its bed
 * reaches: 1 unless the surface cuts the leaf. */
double two_fluid_wetted(const struct two_fluid *sim, int32_t i, int s);
/* Set the part of the grains of a leaf that counts for its upper face along an
 * axis (pressures.h). p_s is filled. Collective. */
void two_fluid_find_contact(struct two_fluid *sim);
/* As passing of granular_pressure.h; context is the struct two_fluid. */
double two_fluid_passing(const void *context, int d, int32_t f, double dt,
                         double u_f, double otherwise);

#endif
