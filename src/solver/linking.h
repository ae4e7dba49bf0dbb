/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Serves while a hierarchy is built. */
#ifndef TALUS_SOLVER_LINKING_H
#define TALUS_SOLVER_LINKING_H

#include "levels.h"
#include "talus/hash.h"
#include "talus/morton.h"

enum { SLOT_UNKNOWN = -2 }; /* a node that may be on another rank */

struct linking {
  struct hierarchy *h;
  const struct brick *brick;
  const struct forest_layout *layout;
  const uint64_t *first_keys;
  int rank, nranks;
  int gathered;          /* levels up to this one are all rank 0's */
  uint64_t **parent_key; /* [nlevels][nfamilies] sorted */
  int32_t *slot_family;  /* [nactive] family of its children, or -1 */
  uint64_t *key;         /* [nactive] of slots, only if nranks > 1 */
  int8_t *level_of;      /* [nactive] likewise */
  uint8_t *wanted;       /* [nactive] likewise: 1 if its links are needed */
  /* Ghosts, by (key, level) */
  struct hash ghosts;
  uint64_t *ghost_key;
  int8_t *ghost_level;
  int32_t nghosts, ghost_capacity;
  int32_t mirror_capacity;
};

static inline uint64_t key_align(uint64_t key, int level) {
  return key & ~(morton_span(level) - 1);
}
/* Return the child number of a node of level l >= 1. */
static inline int key_child(uint64_t key, int level) {
  return (int)(key / morton_span(level)) & (NCHILD - 1);
}

/* Rank that owns the node of `level` at `key`, if it exists. */
int linking_owner(const struct linking *k, int level, uint64_t key);
/* Return the slot of an owned node, or SLOT_UNKNOWN. */
int32_t linking_find(const struct linking *k, int level, uint64_t key);
/* Return the level of any slot. */
int linking_level(const struct linking *k, int32_t slot);
/* Return the key of the node at an offset of -1, 0 or 1 sizes along each axis;
 * axes that would leave the domain are dropped, and returned as a mask. */
int linking_place(const struct linking *k, uint64_t key, int level,
                  const int offset[DIM], uint64_t *neighbour);

/* Find the neighbours of owned nodes, from the root down (links.c). */
void links_make(struct linking *k);
/* Make room for the links of the first n slots, those of ghosts unknown. */
void links_grow(struct linking *k, int32_t n);
/* Give the offsets that a face or a corner entry stands for. */
void links_face_offset(int face, int offset[DIM]);
void links_corner_offset(int entry, int offset[DIM]);

/* Find the faces beyond which lies a coarser leaf (jumps.c). */
void jumps_make(struct linking *k);

/* Make the images beyond walls, once the jumps are known (mirrors.c). */
void mirrors_make(struct linking *k);

/* Return the ghost slot of a node of another rank, made if new (ghosts.c). */
int32_t ghosts_get(struct linking *k, uint64_t key, int level);
/* Make links to other ranks and message plans. Collective. */
void ghosts_make(struct linking *k);

#endif
