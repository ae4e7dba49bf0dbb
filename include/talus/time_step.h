/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The length of a time step.
 *
 * dt is bounded by the advection, 1/2 sum |u_f| A dt / V <= cfl in every cell,
 * and by the acceleration g of the grains, dt <= 0.1 sqrt(h / |g|); it grows by
 * at most 1.2 from one step to the next.
 */
#ifndef TALUS_TIME_STEP_H
#define TALUS_TIME_STEP_H

#include <stdbool.h>

struct simulation;

/* dt of the next step, s, at most dt_max, and dt_c that takes c from t^{n-1/2}
 * to t^{n+1/2}: the mean of the last dt (0 at the start) and this one, which is
 * chosen so that both keep to the bound. Collective. */
double time_step_choose(const struct simulation *sim, double dt_max,
                        double *dt_c);
/* Largest speed that a boundary gives to a face, in leaves per time (per_leaf)
 * or as it is: what a flow at rest is about to feel. This rank only. */
double time_step_boundary_speed(const struct simulation *sim, bool per_leaf);

#endif
