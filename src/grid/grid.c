/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/grid.h"

#include <string.h>

#include "talus/clean.h"
#include "talus/error.h"
#include "talus/forest.h"
#include "talus/hierarchy.h"
#include "talus/level_raster.h"
#include "talus/openings.h"
#include "talus/slip_strip.h"

void grid_layout(const struct params *params, struct forest_layout *layout) {
  memset(layout, 0, sizeof *layout);
  layout->size = params->size;
  layout->axisymmetric = params_axisymmetric(params);
  for (int d = 0; d < DIM; d++) {
    layout->origin[d] = params->origin[d];
    layout->trees[d] = params->trees[d];
    layout->periodic[d] = params->boundary[2 * d].type == BOUNDARY_PERIODIC;
  }
  layout->patch = openings_patch;
  layout->patch_context = (void *)params;
}

void grid_init(struct grid *grid, const struct params *params,
               struct forest *forest) {
  memset(grid, 0, sizeof *grid);
  grid->params = params;
  grid->forest = forest;
  grid_remesh(grid);
}

void grid_remesh(struct grid *grid) {
  fields_release(&grid->fields, true);
  clean_destroy(grid->clean);
  hierarchy_destroy(grid->hierarchy);
  mesh_destroy(grid->mesh);
  grid->mesh = mesh_new(grid->forest);
  grid->hierarchy = hierarchy_new(grid->mesh);
  grid->clean = clean_new(grid->mesh);
  fields_reset(&grid->fields, grid->mesh);
  openings_find(grid);
}

void grid_release(struct grid *grid) {
  fields_destroy(&grid->fields);
  for (int k = 0; k < PARAMS_MAX_CRITERIA; k++) {
    level_raster_destroy(grid->level_raster[k]);
  }
  for (int side = 0; side < NFACE; side++) {
    slip_strip_destroy(grid->strip[side]);
  }
  clean_destroy(grid->clean);
  hierarchy_destroy(grid->hierarchy);
  mesh_destroy(grid->mesh);
  forest_destroy(grid->forest);
}
