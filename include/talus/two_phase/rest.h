/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Rest: the end of a run whose grains have stopped (output.stop_at_rest), and
 * the arrest of grains with an exact yield.
 *
 * Grains are still while the root of their mean square speed (of leaves more
 * than half full) is below 1e-3 sqrt(g l), l^DIM (l^3 around an axis) the
 * volume of all grains; a tolerance of 1e-4 of the solvers leaves less. They
 * have come to rest when they have been still for sqrt(l/g), in which what
 * nothing holds falls by l/2, and the arrest is the last time they were not. A
 * yield stress stops grains in finite time: their speed falls through a decade
 * within a few steps there, and then slowly, as the scheme relaxes
 * (docs/notes/arrest.md). The fastest grains tell less: a cell at the tip of a
 * heap may flow on for long, as the law has it. That no stress be at its yield
 * is too much to ask, as some grains at the toe and the surface of a heap at
 * rest are.
 */
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

/* Note after a step whether grains with an exact yield are still, and say in
 * run.log when they have come to rest, or move again. Collective. */
void rest_note(struct two_phase *sim);

#endif
