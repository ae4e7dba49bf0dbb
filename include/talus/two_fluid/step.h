/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The time step of the two-fluid model. */
#ifndef TALUS_TWO_FLUID_STEP_H
#define TALUS_TWO_FLUID_STEP_H

struct two_fluid;

/* Take a step of at most dt_max, as short as need be. Returns EXIT_DONE, or
 * EXIT_NUMERICAL with the state that was before. Collective. */
int two_fluid_step(struct two_fluid *sim, double dt_max);

#endif
