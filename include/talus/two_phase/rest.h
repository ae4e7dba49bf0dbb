/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Rest: the end of a run whose grains have stopped (output.stop_at_rest). */
#ifndef TALUS_TWO_PHASE_REST_H
#define TALUS_TWO_PHASE_REST_H

#include <stdbool.h>

struct two_phase;

/* Return the largest speed, m/s, of leaves more than half full of grains, the
 * max_speed of series.csv; 0 if there are none. Collective. */
double rest_fastest(const struct two_phase *sim);
/* Note after a step whether the grains are slow, and return whether they have
 * been for as long as the case asks. False where it does not ask. Collective.
 */
bool rest_is_reached(struct two_phase *sim);

#endif
