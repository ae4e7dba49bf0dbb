/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Size of the grid that a case asks for, before it is made.
 *
 * Leaves are counted by walking down the tree level by level. On each a cell is
 * divided where a criterion wants it finer, as adapt.c would do, the functions
 * of the case sampled on a lattice over the cell and what is around it. Of
 * more than some hundred cells of a level a random one in each stretch of
 * Morton order stands for all of that stretch: the sum over them is an unbiased
 * estimate, and the work grows with the number of levels only. A uniform grid
 * is counted exactly; adapted ones are within 25 % of the real ones
 * (tests/mesh/test_grid_size.c), columns of 1e5 leaves within 3 %.
 */
#ifndef TALUS_GRID_SIZE_H
#define TALUS_GRID_SIZE_H

struct params;

/* Estimate the leaves at t = 0 over all ranks, at most params->max_cells; the
 * result is the same on all ranks. */
double grid_size_leaves(const struct params *params);
/* Return the bytes that a run needs for each leaf: neighbours, helper nodes,
 * fields, multigrid and what is there twice while the grid changes. */
double grid_size_bytes(const struct params *params);

#endif
