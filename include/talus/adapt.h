/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Adaptation: which leaves to divide or merge, and carrying the fields over.
 *
 * Every criterion of the case asks for a level; a leaf is divided below the
 * finest level asked for, and merged above the level that slightly wider
 * criteria ask for (hysteresis), so that leaves do not flicker. Volume of
 * grains, momentum and the means of linear fields are conserved to round-off
 * (field.h says how each field is carried).
 */
#ifndef TALUS_ADAPT_H
#define TALUS_ADAPT_H

#include <stdbool.h>
#include <stdint.h>

struct two_phase;

/* Cells by which a band is widened before a leaf may be merged. */
enum { ADAPT_HYSTERESIS = 2 };

/* Has the surface moved far enough, or have enough steps passed? */
bool adapt_is_due(const struct two_phase *sim);
/* One round of dividing and merging; fields, mesh and solvers follow.
 * Returns true if the grid changed. Collective. */
bool adapt_grid(struct two_phase *sim);
/* Flags of forest_adapt into flag [nleaves]; c filled. Collective. */
void adapt_flags(struct two_phase *sim, int8_t *flag);

#endif
