/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The length of a time step.
 *
 *   1/2 sum |u_f| A dt / V <= cfl         in every leaf: advection
 *   dt <= 0.1 sqrt(h/|g|)                 where grains set off, u^2 < |g| h
 *   dt <= sqrt(h/|gravity|)               of the finest leaves
 *   dt <= 1.2 (dt of the last step)
 *
 * The viscosity of grains that set off lags behind their
 * strain rate, hence the second. The third keeps waves of a surface at rest
 * stable: their height is a step ahead of their pressure, which needs w dt < 2,
 * w^2 = pi g/h.
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

struct two_phase;

/* Choose dt of the next step, s, at most dt_max. c goes from t^{n-1/2} to
 * t^{n+1/2}, by the mean of the last dt (0 at the start) and this one, which is
 * chosen so that where it can be both keep to the bound; *rate is that of
 * u_f, as below. Collective. */
double time_step_choose(const struct two_phase *sim, double dt_max,
                        double *rate);
/* Return the largest 1/2 sum |u_f| A / V, 1/s. Collective. */
double time_step_rate(const struct two_phase *sim);
/* Return dt if the step that was taken with it may stand, by its new u_f; else
 * a shorter one to repeat it with. Collective. */
double time_step_allowed(const struct two_phase *sim, double dt);
/* Return the largest speed that a boundary gives to a face, in leaves per time
 * (per_leaf) or in m/s, which a flow at rest is about to feel. This rank only.
 */
double time_step_boundary_speed(const struct two_phase *sim, bool per_leaf);

#endif
