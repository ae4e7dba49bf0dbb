/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/openings.h"

#include <math.h>

#include "talus/error.h"
#include "talus/forest.h"
#include "talus/grid.h"
#include "talus/minmax.h"
#include "talus/side_map.h"

/* Patches of the mesh: one per side, then one per further boundary of the
 * case and axis it lies across (slip needs to know its normal). */
enum { SIDES = 6 };
int openings_patch_number(int boundary, int axis) {
  return SIDES + (boundary - SIDES) * DIM + axis;
}

static int patch_of(int boundary, int side) {
  return boundary < SIDES ? side : openings_patch_number(boundary, side / 2);
}

/* Return the bits of the boundaries of these types. */
static uint32_t list_types(const struct params *params, bool outflow) {
  uint32_t found = 0;
  for (int b = 0; b < params->nboundaries; b++) {
    const enum boundary_type type = params->boundary[b].type;
    if (type == BOUNDARY_INFLOW || (outflow && type == BOUNDARY_OUTFLOW)) {
      found |= 1u << b;
    }
  }
  return found;
}

/* Give the coordinates along a side of a point on it. */
static void point_on_side(int side, const double x[3], double t[2]) {
  int n = 0;
  for (int d = 0; d < DIM; d++) {
    if (d != side / 2) t[n++] = x[d];
  }
}

/* Return the velocity into the box, through the side, of an inflow. */
static double inward(const struct params *params, int boundary, int side) {
  const struct boundary *of = &params->boundary[boundary];
  if (of->type != BOUNDARY_INFLOW) return 0;
  return max2(0, (side & 1 ? -1 : 1) * of->velocity[side / 2]);
}

/* Turn parts of the width of a face along r, around x, into parts of the ring
 * that it sweeps: exactly where one boundary ends and another begins, else by
 * points. */
static void weigh_rings(const struct params *params, int side,
                        const double x[3], double h, double part[]) {
  enum { POINTS = 4096 };
  const double slant = 0.5 * h / x[0];
  double at[3] = {x[0] - 0.5 * h * (1 - 1e-6), x[1], x[2]};
  const int first = params->boundary_select(params->boundary_context, side, at);
  at[0] = x[0] + 0.5 * h * (1 - 1e-6);
  const int last = params->boundary_select(params->boundary_context, side, at);
  if (first != last && part[first] + part[last] > 1 - 1e-9) {
    part[first] *= 1 - slant * (1 - part[first]);
    part[last] = 1 - part[first];
    return;
  }
  for (int b = 0; b < SIDE_MAP_MOST; b++) part[b] = 0;
  for (int k = 0; k < POINTS; k++) {
    const double away = (k + 0.5) / POINTS - 0.5;
    at[0] = x[0] + away * h;
    const int b = params->boundary_select(params->boundary_context, side, at);
    part[b] += (1 + 2 * slant * away) / POINTS;
  }
}

/* Share a face among patches, the largest parts first. */
static void share_face(const struct params *params, int side,
                       const double part[], struct patch_shares *shares) {
  double flux = 0, left[SIDE_MAP_MOST];
  for (int b = 0; b < SIDE_MAP_MOST; b++) {
    left[b] = part[b];
    flux += part[b] * inward(params, b, side);
  }
  for (; shares->n < PATCH_SHARES; shares->n++) {
    int most = 0;
    for (int b = 1; b < SIDE_MAP_MOST; b++) {
      if (left[b] > left[most]) most = b;
    }
    if (left[most] <= 0) break;
    const double own = part[most] * inward(params, most, side);
    shares->patch[shares->n] = (int8_t)patch_of(most, side);
    shares->part[shares->n] = part[most];
    shares->flux[shares->n] = flux > 0 ? own / flux : 0;
    left[most] = 0;
  }
}

int openings_patch(void *context, int side, const double x[3], double h,
                   struct patch_shares *shares) {
  const struct params *params = context;
  const struct side_map *map = params->side_map[side];
  int boundary = side;
  if (map) {
    const uint32_t inflows = list_types(params, false);
    double t[2] = {0}, part[SIDE_MAP_MOST];
    point_on_side(side, x, t);
    const bool alone = side_map_parts(map, t, h, part) >= 0;
    boundary = side_map_owner(map, t, h, inflows);
    if (!alone && inflows >> boundary & 1) {
      if (side > 1 && params_axisymmetric(params)) {
        weigh_rings(params, side, x, h, part);
      }
      share_face(params, side, part, shares);
    }
  } else if (params->boundary_select) {
    boundary = params->boundary_select(params->boundary_context, side, x);
  }
  CHECK(
      boundary == side || (boundary >= SIDES && boundary < params->nboundaries),
      "boundary %d chosen on side %d", boundary, side);
  return patch_of(boundary, side);
}

/* Return the side of the box that face f lies on; also gives its place there.
 */
static int place_of(const struct mesh *mesh, int32_t f, double t[2]) {
  const int32_t i = mesh->face_owner[f];
  int d = 0;
  while (f >= mesh->face_begin[d + 1]) d++;
  const int side = 2 * d + (mesh->face_leaf[f][1] < 0);
  double x[3] = {0};
  for (int e = 0; e < DIM; e++) x[e] = mesh->x[i][e];
  point_on_side(side, x, t);
  return side;
}

/* Return the bits of the boundaries that cover at most half of a side. */
static uint32_t list_small(const struct side_map *map) {
  const double *covered = side_map_covered(map);
  double all = 0;
  uint32_t found = 0;
  for (int b = 0; b < SIDE_MAP_MOST; b++) all += covered[b];
  for (int b = 0; b < SIDE_MAP_MOST; b++) {
    if (covered[b] <= 0.5 * all) found |= 1u << b;
  }
  return found;
}

/* Is a cell with centre x and edge h too coarse for a patch on a side? */
static bool is_coarse(const struct params *params, int side, const double x[3],
                      double h) {
  const struct side_map *map = params->side_map[side];
  const int d = side / 2;
  const double reach = OPENINGS_DISTANCE * h;
  double t[2] = {0}, lo[2], hi[2];
  double plane = params->origin[d];
  if (side % 2) plane += params->size * params->trees[d];
  if (fabs(x[d] - plane) - 0.5 * h >= reach) return false;
  point_on_side(side, x, t);
  for (int e = 0; e < 2; e++) {
    lo[e] = t[e] - 0.5 * h - reach, hi[e] = t[e] + 0.5 * h + reach;
  }
  const uint32_t near = side_map_within(map, lo, hi);
  const bool is_end = near & (near - 1); /* of one or more */
  return is_end || near & list_types(params, true) & list_small(map);
}

static void set_open(struct grid *grid, int patch, int boundary) {
  CHECK(patch < MESH_MAX_PATCHES, "more than %d boundary patches",
        MESH_MAX_PATCHES);
  const enum boundary_type type = grid->params->boundary[boundary].type;
  grid->open[patch] = type == BOUNDARY_OUTFLOW;
  grid->closed[patch] = !grid->open[patch];
}

void openings_find(struct grid *grid) {
  const struct mesh *mesh = grid->mesh;
  double open = 0;
  for (int side = 0; side < NFACE; side++) set_open(grid, side, side);
  for (int b = SIDES; b < grid->params->nboundaries; b++) {
    for (int axis = 0; axis < DIM; axis++) {
      set_open(grid, openings_patch_number(b, axis), b);
    }
  }
  for (int32_t f = 0; f < mesh->nfaces; f++) {
    const int patch = mesh->face_patch[f];
    if (patch >= 0 && grid->open[patch]) open = 1;
  }
  grid->pressure_set = mesh_max(mesh, open) > 0;
}

static bool is_divided(const struct params *params) {
  for (int side = 0; side < NFACE; side++) {
    if (params->side_map[side]) return true;
  }
  return false;
}

int openings_level(const struct grid *grid, int32_t i) {
  return openings_level_at(grid->params, grid->mesh->x[i],
                           grid->mesh->level[i]);
}

int openings_level_at(const struct params *params, const double centre[DIM],
                      int level) {
  if (!is_divided(params)) return 0;
  const double h = ldexp(params->size, -level);
  double x[3] = {0}, parent[3] = {0};
  int wanted = 0;
  for (int d = 0; d < DIM; d++) {
    x[d] = centre[d];
    const double place = floor((x[d] - params->origin[d]) / (2 * h));
    parent[d] = params->origin[d] + 2 * h * (place + 0.5);
  }
  for (int side = 0; side < NFACE; side++) {
    if (!params->side_map[side]) continue;
    if (level < params->opening_level && is_coarse(params, side, x, h)) {
      return level + 1;
    }
    if (level <= params->opening_level && wanted < level &&
        is_coarse(params, side, parent, 2 * h)) {
      wanted = level;
    }
  }
  return wanted;
}

bool openings_are_fine(const struct grid *grid) {
  const struct mesh *mesh = grid->mesh;
  double coarse = 0;
  for (int32_t i = 0; i < mesh->nleaves && grid->params->ncriteria > 0; i++) {
    if (mesh->level[i] < openings_level(grid, i)) coarse = 1;
  }
  return mesh_max(mesh, coarse) == 0;
}

/* Return the bits of the boundaries that have a face on a side of the grid.
 * Collective. */
static uint32_t list_on_grid(const struct grid *grid, int side) {
  const struct mesh *mesh = grid->mesh;
  uint32_t found = 0;
  for (int32_t f = 0; f < mesh->nfaces; f++) {
    double t[2];
    const int patch = mesh->face_patch[f];
    if (patch < SIDES || place_of(mesh, f, t) != side) continue;
    found |= 1u << (SIDES + (patch - SIDES) / DIM);
  }
  MPI_CHECK(MPI_Allreduce(MPI_IN_PLACE, &found, 1, MPI_UINT32_T, MPI_BOR,
                          mesh->comm));
  return found;
}

void openings_check(const struct grid *grid) {
  const struct params *params = grid->params;
  for (int side = 0; side < NFACE; side++) {
    const struct side_map *map = params->side_map[side];
    if (!map) continue;
    const uint32_t found = list_on_grid(grid, side) | list_types(params, false);
    const uint32_t lost = side_map_seen(map) & ~found;
    for (int b = SIDES; b < params->nboundaries; b++) {
      if (!(lost >> b & 1)) continue;
      USER_ERROR(
          "boundary.patches.%s covers %g of its side and has no face on a grid "
          "of %lld cells, whose finest faces are %g: let adapt.opening_level "
          "be domain.level, raise adapt.max_cells or make the patch wider",
          params->boundary[b].name, side_map_covered(map)[b],
          (long long)forest_nleaves_global(grid->forest),
          ldexp(params->size, -grid->mesh->level_finest));
    }
  }
}
