/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One time step of the two-phase incompressible model. */
#ifndef TALUS_STEP_H
#define TALUS_STEP_H

struct simulation;

/* Advance by one step of at most dt_max. A step in which a solve fails, or
 * the fields are no longer finite, is repeated with a smaller dt; returns
 * EXIT_DONE, or EXIT_NUMERICAL when that does not help: the state is then
 * that before the step. Collective. */
int step_advance(struct simulation *sim, double dt_max);

/* c lags half a step behind `time`. The first call takes it to `time` with
 * the present velocity, so that it can be measured; the second sets back what
 * it was, to the last bit. Nothing else of the state changes. Collective. */
void step_synchronise(struct simulation *sim);
void step_desynchronise(struct simulation *sim);

/* Complete the state at t = 0 from c, u and a first u_f: u_f is projected,
 * p and g are those of the grains at rest (no viscosity), to round-off.
 * Collective. */
void step_start(struct simulation *sim);

#endif
