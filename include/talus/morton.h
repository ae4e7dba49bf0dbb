/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Morton order: the space-filling curve along which leaves are numbered, in
 * integers.
 *
 * Coordinates count cells of FOREST_MAX_LEVEL over the whole brick. The key
 * of a cell is (tree number, Morton index of its first corner); keys order
 * leaves as p4est does. A cell of level l covers the keys
 * [key, key + morton_span(l)).
 */
#ifndef TALUS_MORTON_H
#define TALUS_MORTON_H

#include <stdint.h>

#include "talus/forest.h"

enum { MORTON_BITS = DIM * FOREST_MAX_LEVEL };

static inline uint64_t morton_span(int level) {
  return (uint64_t)1 << (DIM * (FOREST_MAX_LEVEL - level));
}
static inline int64_t morton_edge(int level) {
  return (int64_t)1 << (FOREST_MAX_LEVEL - level);
}

/* Spread the low bits of x so that DIM - 1 zeros follow each. */
static inline uint64_t morton_spread(uint64_t x) {
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

static inline uint64_t morton_gather(uint64_t x) {
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

/* Where the trees of the forest are in the brick. */
struct brick {
  int trees[DIM];
  int32_t ntrees;
  int32_t *tree_number;       /* [ntrees] from i + trees[0] (j + ...) */
  int32_t (*tree_place)[DIM]; /* [ntrees] the inverse */
};

static inline uint64_t morton_key(const struct brick *brick,
                                  const int64_t x[DIM]) {
  const int64_t mask = morton_edge(0) - 1;
  uint64_t morton = 0;
  int64_t place = 0;
  for (int d = DIM - 1; d >= 0; d--) {
    morton |= morton_spread((uint64_t)(x[d] & mask)) << d;
    place = place * brick->trees[d] + (x[d] >> FOREST_MAX_LEVEL);
  }
  return (uint64_t)brick->tree_number[place] << MORTON_BITS | morton;
}

static inline void morton_coordinates(const struct brick *brick, uint64_t key,
                                      int64_t x[DIM]) {
  const int32_t *place = brick->tree_place[key >> MORTON_BITS];
  uint64_t morton = key & (((uint64_t)1 << MORTON_BITS) - 1);
  for (int d = 0; d < DIM; d++) {
    x[d] = (int64_t)morton_gather(morton >> d) +
           ((int64_t)place[d] << FOREST_MAX_LEVEL);
  }
}

/* Give the places of the trees, borrowed from the forest. */
const struct brick *forest_brick(const struct forest *forest);
/* Give the keys of the local leaves, keys [nleaves]. */
void forest_keys(const struct forest *forest, uint64_t *keys);
/* Give the first key of every rank's share, [nranks + 1]; a rank without leaves
 * has the first key of the next. Borrowed, valid until the forest changes. */
const uint64_t *forest_first_keys(const struct forest *forest);

#endif
