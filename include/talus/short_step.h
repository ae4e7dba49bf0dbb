/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Steps so short that a run would never end, of models without a bound of their
 * own (model.h).
 *
 * A run is given up where its steps, bound by the flow, are shorter than
 *
 *   1e-9 min(sqrt(L/g), stop)  or  2^-53 stop,                          (1)
 *
 * L = domain.size, or where a step does not change the time. A step that lands
 * on an output, is as long as solver.dt_max, or is longer by a tenth than the
 * one before it may be shorter.
 */
#ifndef TALUS_SHORT_STEP_H
#define TALUS_SHORT_STEP_H

#include <stdbool.h>

struct model;
struct params;
struct step_taken;

/* Return the larger of both in (1), s. */
double short_step_floor(const struct params *params);
/* Return whether the step just made was too short; then say so on stderr and in
 * the log. */
bool short_step_is(const struct model *model, const struct params *params,
                   double floor, const struct step_taken *taken);

#endif
