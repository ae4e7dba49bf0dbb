/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One time step of the two-phase model; step.c has its formulas.
 *
 * The viscosity of a step comes from the strain rate and the pressure at its
 * beginning. Each repetition (`solver.picard`) takes both from the end just
 * found, and does viscosity and projection again from the advected velocity.
 * The first step of a run from rest is repeated eight times in any case: p is
 * at first that of grains without viscosity.
 * run.log tells how much every repetition changes the face velocity, and
 * repeat_change of series.csv tells it of the last. Iterations are those of all
 * repetitions, and the worst of their solves decides whether the step is good.
 * One repetition is worth its price where a front is wanted to 1 %, more are
 * not (docs/notes/picard.md).
 */
#ifndef TALUS_TWO_PHASE_STEP_H
#define TALUS_TWO_PHASE_STEP_H

#include "talus/mesh.h"

struct two_phase;

/* Advance by one step of at most dt_max. A step in which a solve fails, or
 * the fields are no longer finite, or that was too long for the flow it has
 * made (time_step.h), is repeated with a smaller dt; returns EXIT_DONE, or
 * EXIT_NUMERICAL when that does not help: the state is then that before the
 * step. Collective. */
int step_advance(struct two_phase *sim, double dt_max);

/* Complete the state at t = 0 from c, u and a first u_f: u_f is projected,
 * p and g are those of the grains at rest (no viscosity), to round-off.
 * Collective. */
void step_start(struct two_phase *sim);

/* Make density, planes and skin those of c. Collective. */
void step_density(struct two_phase *sim);

#endif
