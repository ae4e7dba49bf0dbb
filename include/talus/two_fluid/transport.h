/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Transport: what grains and fluid carry, on the fluxes that move alpha.
 *
 *   a^{n+1} q' = a^n q - dt div(F q_f)
 *
 * with a = alpha and F = alpha u_s, or 1 - alpha and j - F: momentum rides with
 * mass, and what no grains cross does not count. q_f of grains is the donor's
 * value with a slope, half a step earlier; loose grains, with friction at work
 * beside leaves that have none, have no slope. q_f of the fluid is that of
 * advection.h, with u between u^n and what forces have made of it.
 *
 * Foresight. The fluid pushes itself along by the momentum it carries, and the
 * pressure, which is found before that, has to hold against it. So
 * two_fluid_foresee adds the gain of u_f, by the last fluxes, before pressure
 * is found, and two_fluid_transport takes it out again, so that momentum is
 * kept. Else u_f would end a step with a part dt grad(u^2/2) that p of the next
 * step removes.
 */
#ifndef TALUS_TWO_FLUID_TRANSPORT_H
#define TALUS_TWO_FLUID_TRANSPORT_H

#include <stdint.h>

struct two_fluid;

/* Add to u_f what the fluid will gain by what it carries, with the last fluxes.
 * u_f is filled. Collective. */
void two_fluid_foresee(struct two_fluid *sim, double dt);
/* Carry both velocities, phi_p and X over dt and set alpha to alpha_new;
 * fields_save has kept u^n. Collective. */
void two_fluid_transport(struct two_fluid *sim, double dt);
/* Return the part of its grains that leaf i gives away over dt by the last
 * flux; alpha is that of before. */
double two_fluid_part_given(const struct two_fluid *sim, double dt, int32_t i);
/* Return the largest of a leaf that has grains. Collective. */
double two_fluid_given(const struct two_fluid *sim, double dt);

#endif
