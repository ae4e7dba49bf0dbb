/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Nodes beyond walls: images of the nodes inside, times what the boundary
 * condition makes of a correction (hierarchy.beyond). The two-point operator
 * has walls in its diagonal; the images are seen by the transposed gradient
 * along a wall and by the prolongation. */
#include "linking.h"
#include "talus/count.h"
#include "talus/memory.h"

/* Add an image beyond a face of a side and return its slot. */
static int32_t add_mirror(struct linking *k, int32_t source,
                          const struct side *side, int face) {
  struct hierarchy *h = k->h;
  if (h->nmirrors == k->mirror_capacity) {
    count_index((int64_t)h->nslots + h->njumps + 2 * (int64_t)h->nmirrors + 64,
                "nodes of the hierarchy");
    k->mirror_capacity = k->mirror_capacity ? 2 * k->mirror_capacity : 64;
    h->mirror =
        mem_resize(h->mirror, (size_t)k->mirror_capacity, sizeof *h->mirror);
  }
  h->mirror[h->nmirrors] = (struct mirror){source, (int32_t)(side - h->sides),
                                           (int8_t)face, side->patch[face]};
  return h->nslots + h->njumps + h->nmirrors++;
}

static void link_faces(struct linking *k, const struct side *side) {
  for (int f = 0; f < NFACE; f++) {
    if (side->patch[f] < 0) continue;
    k->h->neighbour[f][side->slot] = add_mirror(k, side->slot, side, f);
  }
}

/* Link diagonal nodes beyond walls: images of the neighbours along the wall,
 * which may be another rank's and then have none yet. */
static void link_corners(struct linking *k, const struct side *side, int a,
                         int upper) {
  struct hierarchy *h = k->h;
  const int face = 2 * a + upper;
  for (int f = 0; f < NFACE; f++) {
    if (f >> 1 == a || side->patch[f] >= 0) continue;
    int32_t *corner =
        &h->corner[corner_entry(a, upper, f >> 1, f & 1)][side->slot];
    const int32_t image =
        *corner < h->nactive ? h->neighbour[face][*corner] : SLOT_UNKNOWN;
    *corner = image >= h->nslots + h->njumps
                  ? image
                  : add_mirror(k, *corner, side, face);
  }
}

/* Return the place of a mirror of level l in `mirror_run`. */
static int run_of(const struct hierarchy *h, int l,
                  const struct mirror *mirror) {
  const struct level *level = &h->level[l];
  const bool owned = l > 0 && mirror->source < h->nowned;
  return l * (NCHILD + 1) +
         (owned ? (mirror->source - level->begin) / level->nfamilies : NCHILD);
}

static void sort_by_runs(struct hierarchy *h) {
  const int n = h->nlevels * (NCHILD + 1);
  h->mirror_order = MEM_NEW(int32_t, h->nmirrors);
  h->mirror_run = MEM_NEW(int32_t, n + 1);
  for (int pass = 0; pass < 2; pass++) {
    for (int l = 0; l < h->nlevels; l++) {
      const struct level *level = &h->level[l];
      for (int32_t k = level->mirror_begin; k < level->mirror_end; k++) {
        const int run = run_of(h, l, &h->mirror[k]);
        if (pass == 0) {
          h->mirror_run[run + 1]++;
        } else {
          h->mirror_order[h->mirror_run[run]++] = k;
        }
      }
    }
    /* sizes become beginnings, and ends beginnings again */
    for (int q = 0; q < n && pass == 0; q++) {
      h->mirror_run[q + 1] += h->mirror_run[q];
    }
    for (int q = n; q > 0 && pass == 1; q--) {
      h->mirror_run[q] = h->mirror_run[q - 1];
    }
  }
  h->mirror_run[0] = 0;
}

void mirrors_make(struct linking *k) {
  struct hierarchy *h = k->h;
  for (int l = 0; l < h->nlevels; l++) {
    h->level[l].mirror_begin = h->nmirrors;
    for (int32_t n = 0; n < h->nsides; n++) {
      if (linking_level(k, h->sides[n].slot) == l) link_faces(k, &h->sides[n]);
    }
    for (int32_t n = 0; n < h->nsides; n++) {
      const struct side *side = &h->sides[n];
      if (side->slot >= h->nowned || linking_level(k, side->slot) != l)
        continue;
      for (int f = 0; f < NFACE; f++) {
        if (side->patch[f] >= 0) link_corners(k, side, f >> 1, f & 1);
      }
    }
    h->level[l].mirror_end = h->nmirrors;
  }
  sort_by_runs(h);
}
