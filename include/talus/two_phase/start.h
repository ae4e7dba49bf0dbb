/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The initial state of the two-phase model: the grid is adapted to the shape of
 * the grains and their velocity, the pressure is that of rest (step_start).
 */
#ifndef TALUS_TWO_PHASE_START_H
#define TALUS_TWO_PHASE_START_H

#include <stdint.h>

struct params;
struct two_phase;

/* How a model starts, which takes long on a fine grid. */
struct model_start {
  int64_t most_leaves; /* for which there is memory; 0: no bound */
  /* Told now and then what is being done, what part of it is done, and the
   * leaves so far; on every rank for itself. NULL: nobody is told. */
  void (*tell)(void *context, const char *what, double part, int64_t leaves);
  void *context;
};

/* Make the initial state of a case. Collective. The caller owns it. */
struct two_phase *two_phase_new(const struct params *params);
/* Make it and tell what is being done; where the grid would outgrow the memory,
 * grid.outgrown is set and the grid stays coarser. */
struct two_phase *two_phase_new_told(const struct params *params,
                                     const struct model_start *start);
/* Adapt the grid of a restart, whose conditions may be new, until openings are
 * as fine as they are to be (openings.h). Collective. */
void two_phase_refine_openings(struct two_phase *sim);

#endif
