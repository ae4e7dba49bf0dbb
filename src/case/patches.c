/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Patches: where on the sides the functions of a case put them, and whether the
 * grid can show them. */
#include <math.h>
#include <string.h>

#include "case_file.h"
#include "talus/side_map.h"

/* Return the boundary at the point t of a side. */
static int select_at(void *context, const double t[2]) {
  const struct case_side *of = (const struct case_side *)context;
  const struct params *params = &of->file->params;
  const int across = of->side / 2;
  double x[3] = {0};
  for (int d = 0, n = 0; d < params->dimension; d++) {
    x[d] = d != across    ? t[n++]
           : of->side % 2 ? params->origin[d] + params->size * params->trees[d]
                          : params->origin[d];
  }
  return params->boundary_select(params->boundary_context, of->side, x);
}

static void map_side(struct case_file *file, int side) {
  struct params *params = &file->params;
  struct side_map_layout layout = {.size = params->size,
                                   .level = params->level_max,
                                   .select = select_at,
                                   .context = &file->side[side]};
  for (int d = 0; d < params->dimension; d++) {
    if (d == side / 2) continue;
    layout.origin[layout.naxes] = params->origin[d];
    layout.trees[layout.naxes++] = params->trees[d];
  }
  file->side[side] = (struct case_side){.file = file, .side = side};
  file->side[side].map = side_map_new(&layout);
  params->side_map[side] = file->side[side].map;
}

static double finest(const struct params *params) {
  return ldexp(params->size, -params->level_max);
}

static uint32_t list_inflows(const struct params *params) {
  uint32_t found = 0;
  for (int b = 6; b < params->nboundaries; b++)
    if (params->boundary[b].type == BOUNDARY_INFLOW) found |= 1u << b;
  return found;
}

/* Complain that boundary b is returned on a side, but takes none of its faces.
 */
static _Noreturn void fail_narrow(struct case_file *file, int side, int b) {
  const struct params *params = &file->params;
  const double covered = side_map_covered(file->side[side].map)[b];
  /* of a slot; of a disc the diagonal of a face has to fit in */
  const double width = params->dimension == 2 ? covered : 0.8 * sqrt(covered);
  const double level = ceil(log2(params->size / width) + 1e-9);
  char path[PATH_LENGTH], advice[VALUE_LENGTH] = "";
  path_join(path, "boundary.patches", params->boundary[b].name);
  if (width > 0 && level <= CASE_MAX_LEVEL_2D)
    snprintf(advice, sizeof advice, ", or set domain.level = %g", level);
  read_fail_at(file, path,
               "%s: boundary.%s returns it on %g of the side, but no face of "
               "the finest grid has its centre there, so it would be missing: "
               "these faces are %g wide; make it wider than that%s",
               path, keys_side_name(params->dimension, side), covered,
               finest(params), advice);
}

/* Append what boundary b covers of a side. */
static void add_cover(const struct case_file *file, int side, int b,
                      double taken, size_t size, char *text) {
  const struct params *params = &file->params;
  const double covered = side_map_covered(file->side[side].map)[b];
  const double h = finest(params), face = params->dimension == 2 ? h : h * h;
  const char *unit = params->dimension == 2 ? "m" : "m^2";
  const size_t used = strlen(text);
  char whole[VALUE_LENGTH] = "";
  if (params->boundary[b].type != BOUNDARY_INFLOW)
    snprintf(whole, sizeof whole, ", in all %.6g %s", taken, unit);
  else if (fabs(taken - covered) > 1e-6 * face)
    snprintf(whole, sizeof whole, ", those at the ends by their covered part");
  snprintf(text + used, size - used, "%s %.6g %s of %s, %.0f faces of %.6g m%s",
           used > 0 ? "; " : " covers", covered, unit,
           keys_side_name(params->dimension, side), taken / face, h, whole);
}

/* Say what boundary b covers. */
static void say_cover(struct case_file *file, int b) {
  struct params *params = &file->params;
  char path[PATH_LENGTH], text[PARAMS_LINE_LENGTH - PATH_LENGTH] = "";
  for (int side = 0; side < 2 * params->dimension; side++) {
    const struct side_map *map = file->side[side].map;
    double taken[SIDE_MAP_MOST];
    if (map == NULL || !(side_map_seen(map) >> b & 1)) continue;
    side_map_taken(map, list_inflows(params), taken);
    const bool weighted = params->boundary[b].type == BOUNDARY_INFLOW &&
                          side_map_covered(map)[b] > 0;
    if (taken[b] == 0 && !weighted) fail_narrow(file, side, b);
    add_cover(file, side, b, taken[b], sizeof text, text);
  }
  const char *name = params->boundary[b].name;
  const bool declared = strcmp(name, "slip") != 0; /* by the case */
  if (!declared && *text == '\0') return;
  path_join(path, declared ? "boundary.patches" : "", name);
  snprintf(params->cover[params->ncovers++], PARAMS_LINE_LENGTH, "%s%s", path,
           *text ? text : " covers nothing: no side returns it");
}

void patches_map(struct case_file *file) {
  struct params *params = &file->params;
  for (int side = 0; side < 2 * params->dimension; side++)
    if (file->side_function[side] != NULL) map_side(file, side);
  for (int b = 6; b < params->nboundaries; b++) say_cover(file, b);
}

void patches_destroy(struct case_file *file) {
  for (int side = 0; side < 6; side++) side_map_destroy(file->side[side].map);
}

bool patches_find_outflow(const struct case_file *file,
                          char path[PATH_LENGTH]) {
  const struct params *params = &file->params;
  for (int b = 0; b < params->nboundaries; b++) {
    bool found = b < 2 * params->dimension;
    if (params->boundary[b].type != BOUNDARY_OUTFLOW) continue;
    for (int side = 0; side < 6 && b >= 6; side++) {
      const struct side_map *map = file->side[side].map;
      found = found || (map != NULL && side_map_seen(map) >> b & 1);
    }
    if (!found) continue;
    if (b < 6)
      path_join(path, "boundary", keys_side_name(params->dimension, b));
    else
      path_join(path, "boundary.patches", params->boundary[b].name);
    return true;
  }
  return false;
}
