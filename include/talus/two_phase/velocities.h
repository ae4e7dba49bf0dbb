/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Velocity of leaves in a step, advected and diffused; step.c has the formulas.
 */
#ifndef TALUS_TWO_PHASE_VELOCITIES_H
#define TALUS_TWO_PHASE_VELOCITIES_H

struct two_phase;

/* Carry momentum away from the band beside the surface with a solenoidal u_f at
 * half steps. Takes scratch for u_half in any case. Collective. */
void velocities_advect(struct two_phase *sim, double dt);
/* Solve the viscous equation for u* - dt g and v, in repetition k of the step.
 * The guess is u + dt (g + v) with v of the last step, less the friction of the
 * walls. With an exact yield its stress follows (yield.h). Collective. */
void velocities_diffuse(struct two_phase *sim, double dt, int k);

#endif
