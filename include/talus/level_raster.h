/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Level raster: the level that a function of position asks for, anywhere in a
 * cell of any size.
 *
 * A leaf takes the finest level asked for at the centres of the cells of the
 * finest level in it, so that what is small is not missed between the centres
 * of coarse leaves. The function does not change, so it is asked once, the
 * ranks sharing the work, down to the finest level at which there are no more
 * than LEVEL_RASTER_POINTS cells in the box (level 12 of a square, 8 of a
 * cube); below that level each leaf asks anew. Values beyond the levels of
 * the grid are taken as its coarsest or finest one.
 */
#ifndef TALUS_LEVEL_RASTER_H
#define TALUS_LEVEL_RASTER_H

#include <mpi.h>

#include "talus/forest.h"
#include "talus/params.h"

enum { LEVEL_RASTER_POINTS = 1 << 24 };

struct level_raster;

/* Ask the function all over the box of the layout, `finest` being the finest
 * level of the grid. Collective. Owned by the caller; the function is
 * borrowed. */
struct level_raster *level_raster_new(MPI_Comm comm,
                                      const struct forest_layout *layout,
                                      const struct function *function,
                                      int finest);
void level_raster_destroy(struct level_raster *raster);

/* Find the finest level asked for in a cell of this level with centre x, in
 * [0, finest]. */
int level_raster_most(const struct level_raster *raster, const double x[DIM],
                      int level);

#endif
