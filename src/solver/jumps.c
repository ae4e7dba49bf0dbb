/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Faces across which the level jumps, and the virtual children seen there:
 * interpolated from the coarse leaf with the slopes that mesh_fill uses, so
 * that the cycle works on nearly the operator that is solved. */
#include "linking.h"
#include "talus/count.h"
#include "talus/memory.h"

/* Set the slopes of the coarse leaf: centred if both its neighbours are nodes
 * of its level, else one-sided. */
static void set_slopes(const struct linking *k, int l, struct jump *jump) {
  const struct hierarchy *h = k->h;
  const struct level *level = &h->level[l];
  const int32_t i = jump->fine - level->begin;
  const int child = run_child(i / level->nfamilies);
  for (int d = 0; d < DIM; d++) {
    int steps = 0;
    for (int side = 0; side < 2; side++) {
      const int32_t n = h->neighbour[2 * d + side][jump->coarse];
      const bool usable = n != jump->coarse && linking_level(k, n) == l - 1;
      jump->node[d][side] = usable ? n : jump->coarse;
      steps += usable;
    }
    /* the virtual child lies towards the fine node */
    const int upper = d == jump->face >> 1 ? !(jump->face & 1) : child >> d & 1;
    jump->weight[d] = steps ? (upper ? 0.25f : -0.25f) / (float)steps : 0;
  }
}

/* List the faces of owned nodes beyond which lies a coarser leaf. */
static void list_jumps(struct linking *k, int l, bool count_only) {
  struct hierarchy *h = k->h;
  struct level *level = &h->level[l];
  level->jump_begin = h->njumps;
  for (int32_t i = level->begin; i < level->begin + level->nowned; i++) {
    for (int f = 0; f < NFACE; f++) {
      const int32_t j = h->neighbour[f][i];
      if (j >= level->begin && j < h->nowned) continue;
      if (linking_level(k, j) == l) continue;
      if (!count_only) {
        struct jump *jump = &h->jump[h->njumps];
        jump->fine = i;
        jump->coarse = j;
        jump->face = f;
        set_slopes(k, l, jump);
      }
      h->njumps++;
    }
  }
  level->jump_end = h->njumps;
}

void jumps_make(struct linking *k) {
  struct hierarchy *h = k->h;
  for (int l = 1; l < h->nlevels; l++) list_jumps(k, l, true);
  count_index((int64_t)h->nslots + h->njumps, "nodes of the hierarchy");
  h->jump = MEM_NEW(struct jump, h->njumps);
  h->njumps = 0;
  for (int l = 1; l < h->nlevels; l++) list_jumps(k, l, false);
  for (int32_t n = 0; n < h->njumps; n++) {
    h->neighbour[h->jump[n].face][h->jump[n].fine] = h->nslots + n;
  }
}
