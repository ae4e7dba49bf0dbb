/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/slip_strip.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "talus/error.h"
#include "talus/forest.h"
#include "talus/grid.h"
#include "talus/hierarchy.h"
#include "talus/memory.h"
#include "talus/openings.h"

/* Kinds of place on the floor. */
enum { BELOW_GAS, BELOW_GRAINS, STRIP };

struct slip_strip {
  int axis[2]; /* along the floor; in 2D the second has one place */
  int n[2];
  double origin[2], spacing;
  uint8_t *place; /* [n[1]][n[0]] */
};

void slip_strip_destroy(struct slip_strip *strip) {
  if (!strip) return;
  mem_free(strip->place);
  mem_free(strip);
}

/* Lay out the places of a side of the box. */
static struct slip_strip *strip_new(const struct mesh *mesh, int side) {
  const struct forest_layout *layout = forest_layout(mesh->forest);
  struct slip_strip *strip = MEM_NEW(struct slip_strip, 1);
  int naxes = 0, level = mesh->level_finest;
  double trees = 1;
  strip->n[0] = strip->n[1] = 1;
  for (int d = 0; d < DIM; d++) {
    if (d != side / 2) strip->axis[naxes++] = d, trees *= layout->trees[d];
  }
  while (level > 0 && trees * ldexp(1, naxes * level) > SLIP_STRIP_PLACES) {
    level--;
  }
  strip->spacing = ldexp(layout->size, -level);
  for (int k = 0; k < naxes; k++) {
    strip->n[k] = layout->trees[strip->axis[k]] << level;
    strip->origin[k] = layout->origin[strip->axis[k]];
  }
  strip->place = MEM_NEW(uint8_t, (size_t)strip->n[0] * (size_t)strip->n[1]);
  return strip;
}

/* Find the places [begin, end) that a square around x covers. */
static void cover(const struct slip_strip *strip, const double x[DIM], double h,
                  int begin[2], int end[2]) {
  begin[1] = 0, end[1] = 1;
  for (int k = 0; k < DIM - 1; k++) {
    const double from =
        (x[strip->axis[k]] - strip->origin[k] - 0.5 * h) / strip->spacing;
    const int width = (int)lround(h / strip->spacing);
    begin[k] = (int)floor(from + 0.25);
    end[k] = begin[k] + (width > 1 ? width : 1);
  }
}

/* Mark the places below leaves that hold grains. */
static void find_grains(const struct mesh *mesh, const double *c, int side,
                        struct slip_strip *strip) {
  const int d = side / 2;
  const size_t n = (size_t)strip->n[0] * (size_t)strip->n[1];
  memset(strip->place, BELOW_GAS, n);
  for (int32_t f = mesh->face_begin[d]; f < mesh->face_begin[d + 1]; f++) {
    const int32_t i = mesh->face_owner[f];
    int begin[2], end[2];
    if (mesh->face_leaf[f][side & 1] >= 0 || !(c[i] > PARAMS_GAS)) continue;
    cover(strip, mesh->x[i], mesh->h[i], begin, end);
    for (int b = begin[1]; b < end[1]; b++) {
      memset(strip->place + (size_t)b * (size_t)strip->n[0] + begin[0],
             BELOW_GRAINS, (size_t)(end[0] - begin[0]));
    }
  }
  MPI_CHECK(MPI_Allreduce(MPI_IN_PLACE, strip->place, (int)n, MPI_UINT8_T,
                          MPI_MAX, mesh->comm));
}

/* Is a place at (a, b) beside one that is not below grains? */
static bool is_edge(const struct slip_strip *strip, int a, int b) {
  for (int k = 0; k < 4; k++) {
    const int i = a + (k == 0) - (k == 1), j = b + (k == 2) - (k == 3);
    if (i < 0 || j < 0 || i >= strip->n[0] || j >= strip->n[1]) continue;
    if (strip->place[(size_t)j * (size_t)strip->n[0] + (size_t)i] !=
        BELOW_GRAINS)
      return true;
  }
  return false;
}

/* Mark the places below gas nearer than `reach` places to the square (a, b). */
static void mark_near(struct slip_strip *strip, int a, int b, double reach) {
  const int most = (int)fmin(ceil(reach), strip->n[0] + strip->n[1]);
  const int across = DIM == 2 ? 0 : most;
  for (int j = b - across; j <= b + across; j++) {
    for (int i = a - most; i <= a + most; i++) {
      if (i < 0 || j < 0 || i >= strip->n[0] || j >= strip->n[1]) continue;
      uint8_t *place =
          &strip->place[(size_t)j * (size_t)strip->n[0] + (size_t)i];
      const double along = fmax(abs(i - a) - 1, 0);
      const double aside = fmax(abs(j - b) - 1, 0);
      if (*place == BELOW_GAS && hypot(along, aside) < reach) *place = STRIP;
    }
  }
}

static void find_near(struct slip_strip *strip, double length) {
  const double reach = length / strip->spacing;
  for (int b = 0; b < strip->n[1]; b++) {
    for (int a = 0; a < strip->n[0]; a++) {
      const size_t k = (size_t)b * (size_t)strip->n[0] + (size_t)a;
      if (strip->place[k] == BELOW_GRAINS && is_edge(strip, a, b)) {
        mark_near(strip, a, b, reach);
      }
    }
  }
}

/* Choose the patch of a face for mesh_renew_patches. */
static int choose(const void *context, int side, const double x[DIM], double h,
                  int now) {
  const struct grid *grid = (const struct grid *)context;
  const struct slip_strip *strip = grid->strip[side];
  int begin[2], end[2];
  if (!strip) return now;
  cover(strip, x, h, begin, end);
  const size_t a = (size_t)(begin[0] + end[0]) / 2;
  const size_t b = (size_t)(begin[1] + end[1]) / 2;
  return strip->place[b * (size_t)strip->n[0] + a] == STRIP
             ? openings_patch_number(grid->params->smooth, side / 2)
             : side;
}

void slip_strip_renew(struct grid *grid, const double *c) {
  const struct params *params = grid->params;
  if (params->smooth == 0) return;
  for (int side = 0; side < NFACE; side++) {
    if (params->boundary[side].type != BOUNDARY_STRIP) continue;
    slip_strip_destroy(grid->strip[side]);
    grid->strip[side] = strip_new(grid->mesh, side);
    find_grains(grid->mesh, c, side, grid->strip[side]);
    find_near(grid->strip[side], params->boundary[side].strip);
  }
  mesh_renew_patches(grid->mesh, choose, grid);
  hierarchy_renew_patches(grid->hierarchy);
}
