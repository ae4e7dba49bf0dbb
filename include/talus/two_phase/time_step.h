/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The length of a time step.
 *
 * dt is bounded by the advection, 1/2 sum |u_f| A dt / V <= cfl in every cell,
 * and by the acceleration g of grains that set off, |u| < sqrt(|g| h): there dt
 * <= 0.1 sqrt(h/|g|); it grows by at most 1.2 from one step to the next. Waves
 * of a surface at rest, w^2 = pi g/h the fastest, are stable for w dt < 2,
 * since their height is a step ahead of their pressure: dt <= sqrt(h/|gravity|)
 * of the finest leaves. (A flat bed, four times that: round-off grows to a
 * speed of 3e-4 sqrt(g H) in 20 steps.)
 *
 * The first two are those of what the last step has left, and say nothing of a
 * flow that starts suddenly. So a step whose own u_f passes the bound on
 * advection by more than 1.8 is repeated with a shorter dt: up to there the
 * next step can make the mean of both dt keep to the bound. In the examples no
 * step is; a restart with other conditions is a new start (conditions.h).
 *
 * What cfl costs and gives (fractions.h says why it may exceed 1/2): collapse
 * by `talus run examples/column.lua cfl=...`.
 *   cfl                  0.25    0.5     0.6     0.7     0.8       1
 *   steps                1607    870     755     678     629     573
 *   front              9.1108  9.1305  9.1360  9.1434  9.1517  9.1611
 *   off the grains     0.0630  0.0629  0.0629  0.0628  0.0628  0.0628
 * (the last line: mean of tools/compare_outline.py). Beyond 0.7 the error in
 * time grows faster than the number of steps falls.
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
/* Largest 1/2 sum |u_f| A / V, 1/s. Collective. */
double time_step_rate(const struct two_phase *sim);
/* Return dt if the step that was taken with it may stand, by its new u_f; else
 * a shorter one to repeat it with. Collective. */
double time_step_allowed(const struct two_phase *sim, double dt);
/* Largest speed that a boundary gives to a face, in leaves per time (per_leaf)
 * or as it is: what a flow at rest is about to feel. This rank only. */
double time_step_boundary_speed(const struct two_phase *sim, bool per_leaf);

#endif
