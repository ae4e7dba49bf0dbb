/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "linking.h"

int linking_owner(const struct linking *k, int level, uint64_t key) {
  if (level <= k->gathered) return 0;
  const uint64_t parent = key_align(key, level - 1);
  int low = 0, high = k->nranks - 1;
  while (low < high) { /* last rank whose first key is <= parent */
    const int middle = (low + high + 1) / 2;
    if (k->first_keys[middle] <= parent) {
      low = middle;
    } else {
      high = middle - 1;
    }
  }
  return low;
}

int32_t linking_find(const struct linking *k, int level, uint64_t key) {
  const struct level *l = &k->h->level[level];
  if (level == 0) {
    return l->nowned ? l->begin + (int32_t)(key >> MORTON_BITS) : SLOT_UNKNOWN;
  }
  const uint64_t parent = key_align(key, level - 1);
  const uint64_t *list = k->parent_key[level];
  int32_t low = 0, high = l->nfamilies;
  while (low < high) { /* first family with key >= parent */
    const int32_t middle = low + (high - low) / 2;
    if (list[middle] < parent) {
      low = middle + 1;
    } else {
      high = middle;
    }
  }
  if (low == l->nfamilies || list[low] != parent) return SLOT_UNKNOWN;
  return family_slot(l, low, key_child(key, level));
}

int linking_place(const struct linking *k, uint64_t key, int level,
                  const int offset[DIM], uint64_t *neighbour) {
  int dropped = 0;
  int64_t x[DIM];
  morton_coordinates(k->brick, key, x);
  for (int d = 0; d < DIM; d++) {
    const int64_t extent = (int64_t)k->layout->trees[d] * morton_edge(0);
    const int64_t step = offset[d] * morton_edge(level);
    if (x[d] + step >= 0 && x[d] + step < extent) {
      x[d] += step;
    } else if (k->layout->periodic[d]) {
      x[d] += step + (step < 0 ? extent : -extent);
    } else {
      dropped |= 1 << d;
    }
  }
  *neighbour = morton_key(k->brick, x);
  return dropped;
}

int linking_level(const struct linking *k, int32_t slot) {
  const struct hierarchy *h = k->h;
  if (slot >= h->nowned) return k->ghost_level[slot - h->nowned];
  int l = h->nlevels - 1;
  while (slot < h->level[l].begin) l--;
  return l;
}
