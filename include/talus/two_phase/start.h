/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The initial state of the two-phase model: the grid is adapted to the shape of
 * the grains and their velocity, the pressure is that of rest (step_start).
 */
#ifndef TALUS_TWO_PHASE_START_H
#define TALUS_TWO_PHASE_START_H

struct model_start;
struct params;
struct two_phase;

/* Make the initial state of a case and tell what is being done; where the grid
 * would outgrow the memory, grid.outgrown is set and the grid stays coarser.
 * Collective. The caller owns it. */
struct two_phase *two_phase_new(const struct params *params,
                                const struct model_start *start);
/* Adapt the grid of a restart, whose conditions may be new, until openings are
 * as fine as they are to be (openings.h). Collective. */
void two_phase_refine_openings(struct two_phase *sim);

#endif
