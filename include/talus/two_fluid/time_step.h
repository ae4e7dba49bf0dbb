/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The length of a step. What carries grains or fluid through faces crosses less
 * than cfl of a leaf, grains that are packed change their solid fraction by at
 * most a fifth of it, and gravity waves cross less than a leaf: dt < 0.4
 * sqrt(h/g'), as weight follows grains that have moved by one step; 0.1
 * sqrt(h/g') where grains of critical_state are denser than in steady shear.
 * Sound, drag, viscosity and consolidation do not bound dt, nor do velocities
 * of leaves that carry nothing. */
#ifndef TALUS_TWO_FLUID_TIME_STEP_H
#define TALUS_TWO_FLUID_TIME_STEP_H

struct two_fluid;

/* Return dt, at most dt_max. Collective. */
double two_fluid_time_step(const struct two_fluid *sim, double dt_max);
/* Return the rate, 1/s, at which the last fluxes replace what leaves hold, the
 * larger of both phases. Fills alpha. Collective. */
double two_fluid_rate(const struct two_fluid *sim);

#endif
