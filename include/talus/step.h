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
 *   collapse, a = 1.42, level 8 in a box of 8 L0 (median over the steps)
 *     repetition              1       2       3       4       6       8
 *     change             1.4e-2  2.5e-3  1.2e-3  6.2e-4  2.2e-4  9.7e-5
 *   repetitions               0       1       2       4       8
 *     front at t = 3      3.287   3.288   3.289   3.290   3.290
 *     final front         4.044   4.012   4.010   4.011   4.011
 *     time                    1     1.6     2.4     2.9       5
 *
 * One is worth its price where the front is wanted to 1 %, more are not. Where
 * a flow sets off from rest the viscosity lags most: Bagnold's flow of
 * examples/bagnold.lua is, at t = 5 sqrt(H/g), at 0.261, 0.320, 0.334, 0.344
 * with 0, 1, 2, 4, and at the same steady speed with all (2.060 at t = 200).
 */
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
