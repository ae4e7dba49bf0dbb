/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Neighbours of the nodes of a hierarchy, from the root down: beyond an outer
 * face of a child lies a child of its parent's neighbour, or that neighbour
 * itself if it is a leaf. 2:1 balance gives a merged node neighbours of its
 * own level on all sides. */
#include "linking.h"
#include "talus/error.h"
#include "talus/memory.h"

void links_face_offset(int face, int offset[DIM]) {
  for (int d = 0; d < DIM; d++) offset[d] = 0;
  offset[face >> 1] = face & 1 ? 1 : -1;
}

void links_corner_offset(int entry, int offset[DIM]) {
  static const int axes[][2] = {{0, 1}, {0, 2}, {1, 2}};
  for (int d = 0; d < DIM; d++) offset[d] = 0;
  offset[axes[entry / 4][0]] = entry & 1 ? 1 : -1;
  offset[axes[entry / 4][1]] = entry & 2 ? 1 : -1;
}

static void link_trees(struct linking *k) {
  struct hierarchy *h = k->h;
  for (int32_t i = 0; i < h->level[0].nowned; i++) {
    const uint64_t key = (uint64_t)i << MORTON_BITS;
    uint64_t other;
    int offset[DIM];
    for (int f = 0; f < NFACE; f++) {
      links_face_offset(f, offset);
      if (linking_place(k, key, 0, offset, &other)) {
        h->wall[i] = (uint8_t)(h->wall[i] | 1 << f);
      }
      h->neighbour[f][i] = linking_find(k, 0, other);
    }
    for (int e = 0; e < NCORNER; e++) {
      links_corner_offset(e, offset);
      linking_place(k, key, 0, offset, &other);
      h->corner[e][i] = linking_find(k, 0, other);
    }
  }
}

/* Return child c of node `above`, one level up, or `above` if it is a leaf. */
static inline int32_t child_of(const struct linking *k, int l, int32_t above,
                               int c) {
  if (above < 0) return SLOT_UNKNOWN;
  if (k->nranks > 1 && (above >= k->h->nactive ||
                        linking_owner(k, l, k->key[above]) != k->rank)) {
    return SLOT_UNKNOWN;
  }
  const int32_t family = k->slot_family[above];
  return family < 0 ? above : family_slot(&k->h->level[l], family, c);
}

static void link_faces(struct linking *k, int l, int32_t family, int c) {
  struct hierarchy *h = k->h;
  const struct level *level = &h->level[l];
  const int32_t parent = h->family_parent[level->family_begin + family];
  const int32_t i = family_slot(level, family, c);
  for (int f = 0; f < NFACE; f++) {
    const int d = f >> 1, other = c ^ 1 << d;
    int32_t n;
    if ((c >> d & 1) != (f & 1)) {
      n = family_slot(level, family, other);
    } else if (h->wall[parent] >> f & 1) {
      h->wall[i] = (uint8_t)(h->wall[i] | 1 << f);
      n = i;
    } else {
      n = child_of(k, l, h->neighbour[f][parent], other);
    }
    h->neighbour[f][i] = n;
  }
}

/* Return the node a step away along both axes; a step across a wall is dropped.
 */
static int32_t corner_of(struct linking *k, int l, int32_t family, int c, int a,
                         int upper_a, int b, int upper_b) {
  const struct hierarchy *h = k->h;
  const struct level *level = &h->level[l];
  const int32_t parent = h->family_parent[level->family_begin + family];
  const int face_a = 2 * a + upper_a, face_b = 2 * b + upper_b;
  const bool out_a = (c >> a & 1) == upper_a, out_b = (c >> b & 1) == upper_b;
  const bool wall_a = out_a && h->wall[parent] >> face_a & 1;
  const bool wall_b = out_b && h->wall[parent] >> face_b & 1;
  const int32_t i = family_slot(level, family, c);
  if (wall_a || wall_b) {
    return wall_a ? wall_b ? i : h->neighbour[face_b][i]
                  : h->neighbour[face_a][i];
  }
  const int other = c ^ 1 << a ^ 1 << b;
  if (!out_a && !out_b) return family_slot(level, family, other);
  int32_t above;
  if (out_a && out_b) {
    above = h->corner[corner_entry(a, upper_a, b, upper_b)][parent];
  } else {
    above = h->neighbour[out_a ? face_a : face_b][parent];
  }
  return child_of(k, l, above, other);
}

static void link_corners(struct linking *k, int l, int32_t family, int c) {
  const int32_t i = family_slot(&k->h->level[l], family, c);
  for (int a = 0; a < DIM; a++) {
    for (int b = a + 1; b < DIM; b++) {
      for (int q = 0; q < 4; q++) {
        k->h->corner[4 * pair_number(a, b) + q][i] =
            corner_of(k, l, family, c, a, q & 1, b, q >> 1);
      }
    }
  }
}

/* List keys and levels of owned slots, for the search of nodes elsewhere. */
static void list_keys(struct linking *k) {
  const struct hierarchy *h = k->h;
  for (int32_t i = 0; i < h->level[0].nowned; i++) {
    k->key[i] = (uint64_t)i << MORTON_BITS;
    k->level_of[i] = 0;
  }
  for (int l = 1; l < h->nlevels; l++) {
    for (int32_t n = 0; n < h->level[l].nfamilies; n++) {
      for (int c = 0; c < NCHILD; c++) {
        const int32_t i = family_slot(&h->level[l], n, c);
        k->key[i] = k->parent_key[l][n] + (uint64_t)c * morton_span(l);
        k->level_of[i] = (int8_t)l;
      }
    }
  }
}

void links_grow(struct linking *k, int32_t n) {
  struct hierarchy *h = k->h;
  const size_t size = (size_t)n;
  const int32_t old = h->neighbour[0] ? h->nactive : h->nowned;
  for (int f = 0; f < NFACE; f++) {
    h->neighbour[f] = mem_resize(h->neighbour[f], size, sizeof(int32_t));
  }
  for (int e = 0; e < NCORNER; e++) {
    h->corner[e] = mem_resize(h->corner[e], size, sizeof(int32_t));
  }
  h->wall = mem_resize(h->wall, size, sizeof *h->wall);
  if (k->nranks > 1) {
    k->key = mem_resize(k->key, size, sizeof *k->key);
    k->level_of = mem_resize(k->level_of, size, sizeof *k->level_of);
    k->wanted = mem_resize(k->wanted, size, sizeof *k->wanted);
  }
  for (int32_t i = old; i < n; i++) {
    for (int f = 0; f < NFACE; f++) h->neighbour[f][i] = SLOT_UNKNOWN;
    for (int e = 0; e < NCORNER; e++) h->corner[e][i] = SLOT_UNKNOWN;
    h->wall[i] = 0;
    k->key[i] = k->ghost_key[i - h->nowned];
    k->level_of[i] = k->ghost_level[i - h->nowned];
  }
  h->nactive = n;
}

void links_make(struct linking *k) {
  struct hierarchy *h = k->h;
  links_grow(k, h->nactive);
  if (k->nranks > 1) list_keys(k);
  link_trees(k);
  for (int l = 1; l < h->nlevels; l++) {
    for (int32_t n = 0; n < h->level[l].nfamilies; n++) {
      for (int c = 0; c < NCHILD; c++) {
        link_faces(k, l, n, c);
        link_corners(k, l, n, c);
      }
    }
  }
}
