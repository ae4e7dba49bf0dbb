/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The shortest step that makes sense.
 *
 * A velocity that runs away takes dt with it, and a run whose steps become ever
 * shorter never ends. With the length L = domain.size, gravity g and the
 * largest speed u_0 that the case gives, a run is given up where
 *
 *   dt < 1e-9 min(sqrt(L/g), L/u_0, stop),                              (1)
 *   stop + dt = stop in double precision, or                            (2)
 *   t + dt = t,                                                         (3)
 *
 * (2) as the time would cease to change before it is at `stop`. (1) and (2) are
 * for steps that the flow binds: not one that lands on an output, one that
 * solver.dt_max sets, or one that grows again after such a one.
 */
#ifndef TALUS_TWO_PHASE_STEP_FLOOR_H
#define TALUS_TWO_PHASE_STEP_FLOOR_H

#include <stdbool.h>

struct step_taken;
struct two_phase;

/* Return the right hand side of (1), or that of (2) if it is more; s. u_0 is
 * taken from the functions of the case at the leaves. Collective. */
double step_floor(const struct two_phase *sim);

/* Return whether the step just made, which began as `taken` says, was too
 * short; then say why on stderr and in the log, with the place and the bound on
 * dt that is to blame. Collective. */
bool step_is_too_short(const struct two_phase *sim, double floor,
                       const struct step_taken *taken);

#endif
