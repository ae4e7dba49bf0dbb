/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The length of a step: grains move less than cfl of a leaf, and while they set
 * off less than what they fall in 1/16 sqrt(h/g). The first step is short: in
 * it p goes from that of rest to that of the flow, and predicted with the
 * former columns start late (docs/notes/four_state.md). Sound, viscosity and
 * collisions do not bound dt. */
#ifndef TALUS_FOUR_STATE_TIME_STEP_H
#define TALUS_FOUR_STATE_TIME_STEP_H

#include <stdint.h>

struct four_state;

/* Return dt, at most dt_max. Collective. */
double four_state_time_step(const struct four_state *sim, double dt_max);
/* Return the part of its grains nu_old that leaf i has given away over dt by
 * the flux of the last pressure. */
double four_state_part_given(const struct four_state *sim, double dt, int32_t i,
                             double nu_old);
/* Return the largest part of its grains that a leaf has given away over dt by
 * the flux of the last pressure, nu_old [nleaves] being what it had.
 * Collective. */
double four_state_given(const struct four_state *sim, double dt,
                        const double *nu_old);

#endif
