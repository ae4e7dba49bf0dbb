/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Grid: a forest and all that is made anew when its leaves change: mesh,
 * hierarchy, cleaning, fields, and which boundary faces are open.
 *
 * A model holds one. The fields keep their addresses while the leaves change
 * (field.h).
 */
#ifndef TALUS_GRID_H
#define TALUS_GRID_H

#include <stdbool.h>
#include <stdint.h>

#include "talus/field.h"
#include "talus/params.h"

struct clean;
struct forest;
struct forest_layout;
struct hierarchy;
struct level_raster;
struct slip_strip;

struct grid {
  const struct params *params; /* borrowed */
  struct forest *forest;       /* owned, as all below */
  struct mesh *mesh;
  struct hierarchy *hierarchy;
  struct clean *clean;
  struct slip_strip *strip[6]; /* of the sides that are strips, NULL before */
  struct fields fields;
  struct level_raster *level_raster[PARAMS_MAX_CRITERIA]; /* of those that are
                              functions of position; NULL until asked for */
  /* Openings: a patch is open (an outflow), or its normal velocity is given */
  bool open[MESH_MAX_PATCHES], closed[MESH_MAX_PATCHES];
  bool pressure_set;   /* by some face of the mesh, which is open */
  int64_t most_leaves; /* there is memory for; 0: no bound */
  double outgrown;     /* leaves wanted when there was none, else 0 */
  int rounds;          /* of adaptation that are due, whatever has moved */
};

/* Give the layout of the case's forest. */
void grid_layout(const struct params *params, struct forest_layout *layout);
/* Make a grid without fields of a forest, which it takes over. Collective. */
void grid_init(struct grid *grid, const struct params *params,
               struct forest *forest);
void grid_release(struct grid *grid);
/* Make mesh, hierarchy, cleaning tree and openings anew from the forest; the
 * fields are zero then. Collective. */
void grid_remesh(struct grid *grid);

#endif
