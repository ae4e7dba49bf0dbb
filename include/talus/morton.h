/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The space-filling curve in integers.
 *
 * Coordinates count cells of FOREST_MAX_LEVEL over the whole brick. The key
 * of a cell is (tree number, Morton index of its first corner); it orders
 * leaves as p4est does. A cell of level l covers the keys
 * [key, key + curve_span(l)).
 */
#ifndef TALUS_MORTON_H
#define TALUS_MORTON_H

#include <stdint.h>

#include "talus/forest.h"

enum { CURVE_BITS = DIM * FOREST_MAX_LEVEL };

static inline uint64_t curve_span(int level) {
  return (uint64_t)1 << (DIM * (FOREST_MAX_LEVEL - level));
}
static inline int64_t curve_edge(int level) {
  return (int64_t)1 << (FOREST_MAX_LEVEL - level);
}

/* Spread the low bits of x so that DIM - 1 zeros follow each. */
static inline uint64_t curve_spread(uint64_t x) {
#if DIM == 2
  x &= 0xffffffffu;
  x = (x | x << 16) & 0x0000ffff0000ffffu;
  x = (x | x << 8) & 0x00ff00ff00ff00ffu;
  x = (x | x << 4) & 0x0f0f0f0f0f0f0f0fu;
  x = (x | x << 2) & 0x3333333333333333u;
  x = (x | x << 1) & 0x5555555555555555u;
#else
  x &= 0x1fffffu;
  x = (x | x << 32) & 0x001f00000000ffffu;
  x = (x | x << 16) & 0x001f0000ff0000ffu;
  x = (x | x << 8) & 0x100f00f00f00f00fu;
  x = (x | x << 4) & 0x10c30c30c30c30c3u;
  x = (x | x << 2) & 0x1249249249249249u;
#endif
  return x;
}

static inline uint64_t curve_gather(uint64_t x) {
#if DIM == 2
  x &= 0x5555555555555555u;
  x = (x | x >> 1) & 0x3333333333333333u;
  x = (x | x >> 2) & 0x0f0f0f0f0f0f0f0fu;
  x = (x | x >> 4) & 0x00ff00ff00ff00ffu;
  x = (x | x >> 8) & 0x0000ffff0000ffffu;
  x = (x | x >> 16) & 0x00000000ffffffffu;
#else
  x &= 0x1249249249249249u;
  x = (x | x >> 2) & 0x10c30c30c30c30c3u;
  x = (x | x >> 4) & 0x100f00f00f00f00fu;
  x = (x | x >> 8) & 0x001f0000ff0000ffu;
  x = (x | x >> 16) & 0x001f00000000ffffu;
  x = (x | x >> 32) & 0x1fffffu;
#endif
  return x;
}

/* Private view of a forest, shared by forest.c and mesh.c. */
struct curve {
  int trees[DIM];
  int32_t ntrees;
  int32_t *tree_number;       /* [ntrees] from i + trees[0] (j + ...) */
  int32_t (*tree_place)[DIM]; /* [ntrees] the inverse */
};

static inline uint64_t curve_key(const struct curve *curve,
                                 const int64_t x[DIM]) {
  const int64_t mask = curve_edge(0) - 1;
  uint64_t morton = 0;
  int64_t place = 0;
  for (int d = DIM - 1; d >= 0; d--) {
    morton |= curve_spread((uint64_t)(x[d] & mask)) << d;
    place = place * curve->trees[d] + (x[d] >> FOREST_MAX_LEVEL);
  }
  return (uint64_t)curve->tree_number[place] << CURVE_BITS | morton;
}

static inline void curve_coordinates(const struct curve *curve, uint64_t key,
                                     int64_t x[DIM]) {
  const int32_t *place = curve->tree_place[key >> CURVE_BITS];
  uint64_t morton = key & (((uint64_t)1 << CURVE_BITS) - 1);
  for (int d = 0; d < DIM; d++) {
    x[d] = (int64_t)curve_gather(morton >> d) +
           ((int64_t)place[d] << FOREST_MAX_LEVEL);
  }
}

/* Borrowed views into the forest. */
const struct curve *forest_curve(const struct forest *forest);
/* Keys of the local leaves, keys [nleaves]. */
void forest_keys(const struct forest *forest, uint64_t *keys);
/* First key of every rank's share, [nranks + 1]; a rank without leaves has
 * the first key of the next. Borrowed, valid until the forest changes. */
const uint64_t *forest_first_keys(const struct forest *forest);

#endif
