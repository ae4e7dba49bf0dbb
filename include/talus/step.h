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

/* Static pressure at t = 0: u = 0, no viscosity; sets p and g. Collective. */
struct solve_stats step_static_pressure(struct simulation *sim);

#endif
