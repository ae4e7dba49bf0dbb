/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One time step of the two-phase incompressible model.
 *
 * Repetitions (Picard, `solver.picard`). The viscosity of a step comes from the
 * strain rate and pressure at its beginning. A repetition takes them from the
 * end just found, sets back the advected velocity and does viscosity and
 * projection again; the log says how much the face velocity has changed by it,
 * `repeat_change` in series.csv how much by the last one. Iterations count over
 * all repetitions, and of their solves the worst decides whether the step is
 * good. What they do, tolerance 1e-4, change relative to the largest speed:
 *
 *   collapse, a = 1.42: examples/sensitivity.lua level=8 slip=0 picard=...
 *     repetition              1       2       3       4       6       8
 *     change (median)    2.4e-2  4.6e-3  1.9e-3  1.1e-3  3.8e-4  1.8e-4
 *   repetitions               0       1       2       4       8
 *     front at t = 3      3.435   3.416   3.418   3.417   3.418
 *     final front         4.302   4.246   4.242   4.243   4.242
 *     time                    1     1.4     1.8     2.6       4
 *
 * One is worth its price where the front is wanted to 1 %, more are not. Where
 * a flow sets off from rest the viscosity lags most: Bagnold's flow,
 * examples/bagnold.lua picard=..., is at t = 5 sqrt(H/g) at 0.274, 0.333,
 * 0.348, 0.357 with 0, 1, 2, 4, and at the same steady speed with all (2.060
 * at t = 200).
 */
#ifndef TALUS_TWO_PHASE_STEP_H
#define TALUS_TWO_PHASE_STEP_H

#include "talus/mesh.h"

struct two_phase;

/* Advance by one step of at most dt_max. A step in which a solve fails, or
 * the fields are no longer finite, or that was too long for the flow it has
 * made (time_step.h), is repeated with a smaller dt; returns EXIT_DONE, or
 * EXIT_NUMERICAL when that does not help: the state is then that before the
 * step. Collective. */
int step_advance(struct two_phase *sim, double dt_max);

/* Complete the state at t = 0 from c, u and a first u_f: u_f is projected,
 * p and g are those of the grains at rest (no viscosity), to round-off.
 * Collective. */
void step_start(struct two_phase *sim);

/* Make density, planes and skin those of c. Collective. */
void step_density(struct two_phase *sim);

/* Find gravity less pressure gradient over density, of p with the conditions
 * as they are: g[d] [nleaves]. The density is that of c (step_density).
 * Collective. */
void step_acceleration(struct two_phase *sim, double *const g[DIM]);

#endif
