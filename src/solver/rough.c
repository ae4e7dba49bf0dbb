/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Nodes near jumps of the coefficient, which cycles relax more often than the
 * rest once the first one has shown the need: it raises max |r/rho| where
 * coarse levels misplace the jump, by alpha / h^2 times an error at it. */
#include <math.h>
#include <string.h>

#include "levels.h"
#include "talus/memory.h"
#include "talus/minmax.h"

/* Coefficients jump at a node whose sides differ by this factor. */
#define ROUGH_JUMP 10
/* A node is near one this many nodes away; sweeps there, before the last one
 * over all. Fewer of either (6 and 12) need one iteration more, more do not
 * help (Poisson, 1 : 1000 across a circle, levels 5 to 10). */
enum { ROUGH_LAYERS = 10, ROUGH_SWEEPS = 20 };

static bool is_rough(const struct hierarchy *h, int32_t i) {
  double least = HUGE_VAL, most = 0;
  for (int f = 0; f < NFACE; f++) {
    const double w = (double)h->w[f][i];
    if (w > 0) least = min2(least, w);
    most = max2(most, w);
  }
  return most > ROUGH_JUMP * least;
}

/* Set mark to 1 at a jump, n + 1 in n nodes' distance, 0 far away. Virtual
 * children and images have none. */
static void set_marks(const struct hierarchy *h, double *mark) {
  const size_t n = (size_t)(h->nslots + h->njumps + h->nmirrors);
  memset(mark, 0, n * sizeof *mark);
  for (int32_t i = 0; i < h->nowned; i++) mark[i] = is_rough(h, i);
  for (int layer = 1; layer <= ROUGH_LAYERS; layer++) {
    for (int l = 0; l < h->nlevels; l++) {
      plan_run(&h->level[l].copy, 1, &mark, 1, false);
    }
    for (int32_t i = 0; i < h->nowned; i++) {
      bool near = false;
      for (int f = 0; f < NFACE; f++) {
        near = near || (int)mark[h->neighbour[f][i]] == layer;
      }
      if (near && mark[i] == 0) mark[i] = layer + 1;
    }
  }
}

static void list_marked(struct hierarchy *h, const double *mark) {
  int32_t n = 0;
  for (int l = 0; l < h->nlevels; l++) {
    const struct level *level = &h->level[l];
    for (int colour = 0; colour < NCHILD; colour++) {
      const int32_t first = run_begin(level, colour);
      h->rough_begin[l * NCHILD + colour] = n;
      for (int32_t k = 0; k < level->nfamilies; k++) {
        if (mark[first + k] > 0) h->rough[n++] = first + k;
      }
    }
  }
  h->rough_begin[h->nlevels * NCHILD] = n;
}

void rough_watch(struct hierarchy *h, double residual) {
  if (h->ncycles > 1) return;
  const double before = h->first_residual;
  h->first_residual = residual;
  if (h->ncycles == 0 || h->first_residual <= before) return;
  if (!h->rough) {
    h->rough = MEM_NEW(int32_t, h->nowned);
    h->rough_begin = MEM_NEW(int32_t, h->nlevels * NCHILD + 1);
  }
  set_marks(h, h->arena);
  list_marked(h, h->arena);
  h->rough_sweeps = ROUGH_SWEEPS;
}
