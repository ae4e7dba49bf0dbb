/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One multigrid cycle. See hierarchy.h for the formulas.
 *
 * Kernels are written once for `nparts` components and compiled for 1 and
 * DIM. Where a level is relaxed, coarser leaves beside it have e = 0 on the
 * way down and their final value on the way up. */
#include <string.h>

#include "levels.h"

enum { SWEEPS_DOWN = 2, SWEEPS_UP = 2 };

#define KERNEL static inline __attribute__((always_inline))

/* Difference along axis c of component d, summed over node i and its
 * neighbour across a face of direction d: 4 h times du_d/dx_c there. */
KERNEL double tangential(const struct hierarchy *h, int32_t i, int c, int d,
                         int upper, double centre) {
  const int32_t *corner = h->corner[i];
  return centre + h->e[corner[corner_entry(c, 1, d, upper)] * DIM + d] -
         h->e[corner[corner_entry(c, 0, d, upper)] * DIM + d];
}

/* Stress of the transposed gradient, integrated over the sides of node i. */
KERNEL double transposed(const struct hierarchy *h, int32_t i, int c) {
  const int32_t *n = h->neighbour[i];
  double sum = 0;
  for (int d = 0; d < DIM; d++) {
    if (d == c) continue;
    const double centre =
        h->e[n[2 * c + 1] * DIM + d] - h->e[n[2 * c] * DIM + d];
    sum += h->w[i][2 * d + 1] * tangential(h, i, c, d, 1, centre) -
           h->w[i][2 * d] * tangential(h, i, c, d, 0, centre);
  }
  return 0.25 * sum;
}

/* r_i + sum of what the neighbours contribute. */
KERNEL double pull(const struct hierarchy *h, int32_t i, int c, int nparts) {
  double sum = h->r[i * nparts + c];
  for (int f = 0; f < NFACE; f++) {
    const double w = h->w[i][f] * h->e[h->neighbour[i][f] * nparts + c];
    sum += nparts > 1 && f >> 1 == c ? 2 * w : w;
  }
  return nparts > 1 ? sum + transposed(h, i, c) : sum;
}

/* Every `stride`th node from begin to end. */
KERNEL void relax(struct hierarchy *h, int32_t begin, int32_t end, int stride,
                  int nparts) {
  for (int32_t i = begin; i < end; i += stride) {
    double e[DIM];
    for (int c = 0; c < nparts; c++) {
      e[c] = h->inverse[i * nparts + c] * pull(h, i, c, nparts);
    }
    for (int c = 0; c < nparts; c++) h->e[i * nparts + c] = e[c];
  }
}

/* The same from e = 0. */
KERNEL void relax_first(struct hierarchy *h, int32_t begin, int32_t end,
                        int stride, int nparts) {
  for (int32_t i = begin; i < end; i += stride) {
    for (int c = 0; c < nparts; c++) {
      h->e[i * nparts + c] = h->inverse[i * nparts + c] * h->r[i * nparts + c];
    }
  }
}

KERNEL double residual(const struct hierarchy *h, int32_t i, int c,
                       int nparts) {
  const double inverse = h->inverse[i * nparts + c];
  const double own = inverse > 0 ? h->e[i * nparts + c] / inverse : 0;
  return pull(h, i, c, nparts) - own;
}

/* r of parents. A single component has no residual on black nodes, which
 * were relaxed last. */
KERNEL void restrict_families(struct hierarchy *h, const struct level *level,
                              int nparts) {
  const int ncolours = nparts > 1 ? 2 : 1;
  for (int32_t k = 0; k < level->nfamilies; k++) {
    double sum[DIM] = {0};
    for (int black = 0; black < ncolours; black++) {
      const int32_t first = family_first(level, k, black);
      for (int j = 0; j < HALF; j++) {
        for (int c = 0; c < nparts; c++) {
          sum[c] += residual(h, first + j, c, nparts);
        }
      }
    }
    const int32_t parent = h->family_parent[level->family_begin + k];
    for (int c = 0; c < nparts; c++) h->r[parent * nparts + c] += sum[c];
  }
}

/* r of coarser leaves: what leaves the fine nodes enters them. */
KERNEL void restrict_jumps(struct hierarchy *h, const struct level *level,
                           int nparts) {
  for (int32_t k = level->jump_begin; k < level->jump_end; k++) {
    const struct jump *jump = &h->jump[k];
    const int32_t i = jump->fine, *n = h->neighbour[i];
    const int d = jump->face >> 1, upper = jump->face & 1;
    const double w = h->w[i][jump->face];
    for (int c = 0; c < nparts; c++) {
      const int twice = nparts > 1 && c == d ? 2 : 1;
      double flux =
          twice * w * (h->e[i * nparts + c] - h->e[n[jump->face] * nparts + c]);
      if (nparts > 1 && c != d) {
        const double centre =
            h->e[n[2 * c + 1] * DIM + d] - h->e[n[2 * c] * DIM + d];
        const double cross = 0.25 * w * tangential(h, i, c, d, upper, centre);
        flux -= upper ? cross : -cross;
      }
      h->r[jump->coarse * nparts + c] += flux;
    }
  }
}

/* Virtual children of coarser leaves. */
KERNEL void prolong_jumps(struct hierarchy *h, const struct level *level,
                          int nparts) {
  for (int32_t k = level->jump_begin; k < level->jump_end; k++) {
    const struct jump *jump = &h->jump[k];
    for (int c = 0; c < nparts; c++) {
      double sum = h->e[jump->coarse * nparts + c];
      for (int d = 0; d < DIM; d++) {
        sum += (double)jump->weight[d] * (h->e[jump->node[d][1] * nparts + c] -
                                          h->e[jump->node[d][0] * nparts + c]);
      }
      h->e[(h->nslots + k) * nparts + c] = sum;
    }
  }
}

/* Quarter steps from node p on level l towards its neighbours. */
KERNEL void steps(const struct hierarchy *h, int l, int32_t p, int c,
                  const float limit[NFACE], int nparts, double step[NFACE]) {
  const double e = h->e[p * nparts + c];
  for (int f = 0; f < NFACE; f++) {
    step[f] = 0.25 * (h->e[h->neighbour[p][f] * nparts + c] - e);
  }
  if (h->side[p] >= 0) {
    const struct side *side = &h->sides[h->side[p]];
    for (int f = 0; f < NFACE; f++) {
      const int patch = side->patch[f];
      if (patch >= 0) step[f] = 0.25 * (h->beyond[l][c][patch] - 1) * e;
    }
  }
  for (int f = 0; f < NFACE; f++) step[f] *= (double)limit[f];
}

/* Add what the parent's value and steps give to the children of a colour. */
KERNEL void add_to_children(double *e, int black, double parent,
                            const double step[NFACE], int nparts) {
#pragma GCC unroll 4
  for (int j = 0; j < HALF; j++) {
    const int child = colour_child(j, black);
    double sum = parent;
#pragma GCC unroll 3
    for (int d = 0; d < DIM; d++) sum += step[2 * d + (child >> d & 1)];
    e[j * nparts] += sum;
  }
}

/* A single component is relaxed on red nodes next, from black ones alone, so
 * that red children need no value. */
KERNEL void prolong(struct hierarchy *h, int l, int nparts) {
  const struct level *level = &h->level[l];
  for (int32_t k = 0; k < level->nfamilies; k++) {
    const int32_t p = h->family_parent[level->family_begin + k];
    for (int c = 0; c < nparts; c++) {
      const double parent = h->e[p * nparts + c];
      double step[NFACE];
      steps(h, l - 1, p, c, h->limit[level->family_begin + k], nparts, step);
      for (int black = nparts > 1 ? 0 : 1; black < 2; black++) {
        double *e = h->e + family_first(level, k, black) * nparts + c;
        add_to_children(e, black, parent, step, nparts);
      }
    }
  }
}

static void copy_ghosts(struct hierarchy *h, int l) {
  plan_run(&h->level[l].copy, 1, &h->e, h->nparts, false);
}

/* Sweeps over the nodes near jumps of the coefficient. */
KERNEL void smooth_rough(struct hierarchy *h, int l, int nparts) {
  for (int k = 0; k < h->rough_sweeps; k++) {
    for (int colour = 0; colour < NCHILD; colour++) {
      const int32_t *begin = h->rough_begin + l * NCHILD + colour;
      for (int32_t j = begin[0]; j < begin[1]; j++) {
        relax(h, h->rough[j], h->rough[j] + 1, 1, nparts);
      }
      if (nparts > 1 || colour % HALF == HALF - 1) copy_ghosts(h, l);
    }
  }
}

/* Sweeps over the colours. Red and black keep the face neighbours apart; for
 * velocities, coupled across edges too, each child number is a colour of its
 * own, so that the order of nodes (and ranks) does not matter. The last sweep
 * goes over all, as no residual may be left on black nodes. */
KERNEL void smooth(struct hierarchy *h, int l, int nsweeps, bool from_zero,
                   int nparts) {
  const struct level *level = &h->level[l];
  const int stride = nparts > 1 ? HALF : 1;
  const int32_t n = level->nfamilies * HALF;
  for (int k = 0; k < nsweeps; k++) {
    if (k == nsweeps - 1) smooth_rough(h, l, nparts);
    for (int colour = 0; colour < 2 * stride; colour++) {
      const int32_t half = level->begin + colour / stride * n;
      const int32_t begin = half + colour % stride;
      if (k == 0 && from_zero && colour == 0) {
        relax_first(h, begin, half + n, stride, nparts);
      } else {
        relax(h, begin, half + n, stride, nparts);
      }
      copy_ghosts(h, l);
    }
  }
}

KERNEL void cycle(struct hierarchy *h, int nparts) {
  for (int l = h->nlevels - 1; l > 0; l--) {
    plan_run(&h->level[l].add, 1, &h->r, nparts, true);
    smooth(h, l, SWEEPS_DOWN, true, nparts);
    restrict_families(h, &h->level[l], nparts);
    restrict_jumps(h, &h->level[l], nparts);
  }
  plan_run(&h->level[0].add, 1, &h->r, nparts, true);
  coarse_solve(h);
  copy_ghosts(h, 0);
  for (int l = 1; l < h->nlevels; l++) {
    prolong_jumps(h, &h->level[l], nparts);
    prolong(h, l, nparts);
    copy_ghosts(h, l);
    smooth(h, l, SWEEPS_UP, false, nparts);
  }
}

KERNEL void run(struct hierarchy *h, double sign, const double *r, double *e,
                int nparts) {
  const struct mesh *mesh = h->mesh;
  const size_t size = (size_t)(h->nslots * nparts) * sizeof *h->e;
  memset(h->e, 0, size + (size_t)(h->njumps * nparts) * sizeof *h->e);
  memset(h->r, 0, size);
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    const int32_t s = h->leaf_slot[i];
    const double volume = sign * mesh->volume[i];
    for (int c = 0; c < nparts; c++) {
      h->r[s * nparts + c] = volume * r[(int64_t)c * mesh->nleaves + i];
    }
  }
  cycle(h, nparts);
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    const int32_t s = h->leaf_slot[i];
    for (int c = 0; c < nparts; c++) {
      e[(int64_t)c * mesh->nleaves + i] = h->e[s * nparts + c];
    }
  }
}

void cycle_run(struct hierarchy *h, double sign, const double *r, double *e) {
  h->ncycles++;
  if (h->nparts == 1) {
    run(h, sign, r, e, 1);
  } else {
    run(h, sign, r, e, DIM);
  }
}
