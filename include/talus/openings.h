/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Openings: inflow and outflow patches, and the ends of all patches, on sides
 * that a function of position divides (side_map.h).
 *
 * Grid. A leaf is divided, down to params.opening_level (the finest unless the
 * case says otherwise), if within OPENINGS_DISTANCE edges of the leaf two
 * boundaries meet on a side, or there is an inflow or outflow that covers at
 * most half of a side. A larger opening, the open air beside a jet, is the same
 * all over, and away from its ends a coarse face does as well; so is a side
 * that is open as a whole. The level asked for is a function of position, so
 * the grid there stays as it is. Cells at the faces alone would not do, as flow
 * converges on an outlet over a few widths (docs/notes/openings.md).
 *
 * Faces. A face that an inflow shares with others belongs to the inflow. With
 * part_j the part of the area that boundary j covers (of the ring, in
 * axisymmetric coordinates), the velocity of the face
 * is sum_j part_j u_j, where u_j = 0 for walls and outflows, and the fraction
 * carried in, over the inflows j, sum_j part_j u_j.n c_j / sum_j part_j u_j.n;
 * so what flows in is that of the function, W V t, on any grid. Other faces
 * belong to the patch at their centre: an outlet or a strip of a wall is as
 * wide as whole faces.
 */
#ifndef TALUS_OPENINGS_H
#define TALUS_OPENINGS_H

#include <stdbool.h>

#include "talus/forest.h"

struct params;
struct grid;

enum { OPENINGS_DISTANCE = 4 };

/* Find the patch of a boundary face; see forest_layout. The context is the
 * params. */
int openings_patch(void *context, int side, const double x[3], double h,
                   struct patch_shares *shares);
/* Find the patch of a boundary of the case that lies across an axis. */
int openings_patch_number(int boundary, int axis);
/* Find out which patches are open and whether a face of the mesh sets the
 * pressure (grid.h). Collective. */
void openings_find(struct grid *grid);
/* Find the level that openings ask of leaf i, at most one above its own. */
int openings_level(const struct grid *grid, int32_t i);
/* Give that level for a cell of this level with centre x. Pure. */
int openings_level_at(const struct params *params, const double x[DIM],
                      int level);
/* Are all faces as fine as openings_level asks? Collective. */
bool openings_are_fine(const struct grid *grid);
/* End the program by a USER_ERROR if a patch that the case's functions return
 * has no face on this grid, as when max_cells stops it from being refined.
 * Collective. */
void openings_check(const struct grid *grid);

#endif
