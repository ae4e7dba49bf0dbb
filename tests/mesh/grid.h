/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Grids for tests: a brick refined around a point off its centre, with jumps
 * of level in every direction. */
#ifndef TALUS_TESTS_GRID_H
#define TALUS_TESTS_GRID_H

#include <math.h>
#include <stddef.h>

#include "talus/error.h"
#include "talus/forest.h"
#include "talus/memory.h"
#include "talus/mesh.h"

/* Return the larger or the smaller of two measured values, NaN if one of them
 * is: fmax and fmin would pass over it, and a bar could not fail. */
static inline double larger(double a, double b) {
  return a > b || a != a ? a : b;
}
static inline double smaller(double a, double b) {
  return a < b || a != a ? a : b;
}

/* Refine leaves whose centre lies within `radius` of `centre`, up to
 * `level`, and give every rank its share. */
static inline void grid_refine(struct forest *forest, const double *centre,
                               double radius, int level) {
  for (bool changed = true; changed;) {
    struct mesh *mesh = mesh_new(forest);
    int8_t *flag = MEM_NEW(int8_t, mesh->nleaves);
    for (int32_t i = 0; i < mesh->nleaves; i++) {
      double r2 = 0;
      for (int d = 0; d < DIM; d++) {
        r2 += (mesh->x[i][d] - centre[d]) * (mesh->x[i][d] - centre[d]);
      }
      flag[i] = r2 < radius * radius;
    }
    mesh_destroy(mesh);
    struct forest_map map;
    changed = forest_adapt(forest, flag, 0, level, &map);
    forest_map_destroy(&map);
    mem_free(flag);
    forest_partition(forest, 0, NULL);
  }
}

/* Make a unit box of `trees` trees along x, uniform at level `base`, refined to
 * `level` in a ball. */
static inline struct forest *grid_new(MPI_Comm comm, int trees, bool periodic,
                                      int base, int level) {
  struct forest_layout layout = {.size = 1.0 / trees};
  for (int d = 0; d < DIM; d++) {
    layout.trees[d] = trees;
    layout.periodic[d] = periodic;
  }
  struct forest *forest = forest_new(comm, &layout, base);
  const double centre[] = {0.31, 0.42, 0.53};
  if (level > base) grid_refine(forest, centre, 0.2, level);
  return forest;
}

/* Make a brick that lies anywhere, of edges 1/2, with another number of trees
 * along each axis, refined around its lowest corner and a place on its upper
 * side: with periodic sides leaves of two levels meet there. */
static inline struct forest *grid_brick(bool periodic, int base, int level) {
  struct forest_layout layout = {.size = 0.5};
  double corner[DIM], upper[DIM];
  for (int d = 0; d < DIM; d++) {
    layout.origin[d] = corner[d] = d == 0 ? -1.2 : 7.3 - d;
    layout.trees[d] = 3 - d;
    layout.periodic[d] = periodic;
    upper[d] = corner[d] + layout.size * layout.trees[d] * (d == 0 ? 1 : 0.5);
  }
  struct forest *forest = forest_new(MPI_COMM_WORLD, &layout, base);
  grid_refine(forest, corner, 0.2, level);
  grid_refine(forest, upper, 0.2, level);
  return forest;
}

/* Is a condition true on every rank? */
static inline bool all_ranks(bool good) {
  int value = good;
  MPI_CHECK(
      MPI_Allreduce(MPI_IN_PLACE, &value, 1, MPI_INT, MPI_MIN, MPI_COMM_WORLD));
  return value;
}

#endif
