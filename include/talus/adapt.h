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

struct field;
struct grid;

/* Cells by which a criterion is widened before a leaf may be merged. */
enum { ADAPT_HYSTERESIS = 2 };

/* The fields of a model that the criteria look at. */
struct followed {
  struct field *c;        /* volume fraction of grains */
  struct field *const *u; /* [DIM] velocity */
};

/* Return a checksum of what the case asks of the grid: criteria, levels, cap.
 * Collective. */
uint32_t adapt_criteria(struct grid *grid);
/* Let the grid follow other criteria than it was made for, a round a step until
 * it does not change any more (grid->rounds). */
void adapt_anew(struct grid *grid);
/* Has the surface moved `travel` cells, far enough, or have enough steps
 * passed? */
bool adapt_is_due(const struct grid *grid, int64_t step, double travel);
/* Make one round of dividing and merging; fields, mesh and solvers follow.
 * Returns whether the grid has changed. Collective. */
bool adapt_grid(struct grid *grid, const struct followed *followed);
/* Set the flags of forest_adapt, flag [nleaves]; c is filled. Collective. */
void adapt_flags(struct grid *grid, const struct followed *followed,
                 int8_t *flag);

#endif
