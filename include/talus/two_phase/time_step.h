/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The length of a time step.
 *
 *   1/2 sum |u_f| A dt / V <= cfl             in every leaf: advection
 *   dt <= max(0.1 sqrt(h/a), |u|/(4 a))       where grains set off, u^2 < a h
 *   dt <= sqrt(h/|gravity|)                   of the finest leaves
 *   dt <= 1.2 (dt of the last step)
 *
 * a is |g| or, where friction takes a part of it, |g + v| (step.c), at least
 * 0.6 |g|. The viscosity of grains that set off lags behind their strain rate,
 * hence the second: from rest they go 1/200 of a cell in a step, then their
 * speed may grow by a quarter. The third keeps waves of a surface at rest
 * stable: the height of a wave is a step ahead of its pressure, which needs w
 * dt < 2 with w^2 = pi g/h.
 *
 * The first two look at what the last step has left, and say nothing of a flow
 * that starts suddenly. So a step is repeated with a shorter dt where its own
 * u_f passes the bound on advection by more than 1.8; up to there the next step
 * can make the mean of both dt keep to the bound.
 *
 * The last two steps before a time that must be met are equal: a short last one
 * would hold back the steps after it.
 *
 * cfl may exceed 1/2 (fractions.h); beyond its default of 0.7 the error in time
 * grows faster than the number of steps falls (docs/notes/time_step.md).
 */
#ifndef TALUS_TWO_PHASE_TIME_STEP_H
#define TALUS_TWO_PHASE_TIME_STEP_H

#include <stdbool.h>
#include <stdint.h>

struct two_phase;

/* Choose dt of the next step, s, at most dt_max. c advances by the mean of the
 * last dt (0 at the start) and this one; where possible both that mean and this
 * dt keep to the bound. *rate is time_step_rate. Collective. */
double time_step_choose(const struct two_phase *sim, double dt_max,
                        double *rate);
/* Return the largest 1/2 sum |u_f| A / V, 1/s. Collective. */
double time_step_rate(const struct two_phase *sim);
/* Return the longest dt for the grains of leaf i that set off, s; HUGE_VAL:
 * they do not. */
double time_step_of_start(const struct two_phase *sim, int32_t i);
/* Return dt if a step of dt may stand, by the u_f that it has made; else a
 * shorter dt to repeat the step with. Collective. */
double time_step_allowed(const struct two_phase *sim, double dt);
/* Return the largest speed that a boundary gives to a face, in leaves per time
 * (per_leaf) or in m/s, which a flow at rest is about to feel. This rank only.
 */
double time_step_boundary_speed(const struct two_phase *sim, bool per_leaf);

#endif
