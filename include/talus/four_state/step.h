/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The time step of the four-state model. */
#ifndef TALUS_FOUR_STATE_STEP_H
#define TALUS_FOUR_STATE_STEP_H

#include "talus/granular_pressure.h"

struct four_state;

/* Take a step of at most dt_max, as short as need be. Returns EXIT_DONE, or
 * EXIT_NUMERICAL with the state that was before. Collective. */
int four_state_step(struct four_state *sim, double dt_max);
/* Describe the pressure of the grains, with scratch taken in the name of
 * `taker`; p_old and nu_old are those of the state, filled. */
struct granular_pressure four_state_material(struct four_state *sim,
                                             const char *taker);

#endif
