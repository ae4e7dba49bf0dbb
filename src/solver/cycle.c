/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One multigrid cycle. See hierarchy.h for the formulas.
 *
 * Kernels are written once for `nparts` components and compiled for 1 and
 * DIM, and for each child number: siblings are then a fixed number of slots
 * away, which leaves half of the neighbours to be looked up. Nodes of one child
 * number do not see each other, so that their loops may use vectors (ivdep).
 * Where a level is relaxed, coarser leaves beside it have e = 0 on the way down
 * and their final value on the way up. */
#include <float.h>
#include <string.h>

#include "levels.h"

enum {
  SWEEPS_DOWN = 2,
  SWEEPS_UP = 2,
  ANY_CHILD = -1, /* nodes taken one by one */
  BLOCK = 64      /* families taken together between levels */
};

#define KERNEL static inline __attribute__((always_inline))

/* Nodes of one child number. */
struct run {
  int child; /* or ANY_CHILD */
  int32_t n; /* slots of each child number */
  int32_t begin;
};

KERNEL struct run run_of(const struct level *level, int child) {
  return (struct run){child, level->nfamilies, family_slot(level, 0, child)};
}

/* Slots from a child to its sibling. */
KERNEL int32_t sibling_step(struct run run, int sibling) {
  const struct level one = {.nfamilies = 1};
  return (family_slot(&one, 0, sibling) - family_slot(&one, 0, run.child)) *
         run.n;
}

KERNEL bool is_inside(struct run run, int d, int upper) {
  return run.child != ANY_CHILD && (run.child >> d & 1) != upper;
}

/* Node beyond face f of node i. */
KERNEL int32_t across(const struct hierarchy *h, struct run run, int32_t i,
                      int f) {
  return is_inside(run, f >> 1, f & 1)
             ? i + sibling_step(run, run.child ^ 1 << (f >> 1))
             : h->neighbour[f][i];
}

/* Node one step away from node i along axes a != b. */
KERNEL int32_t diagonal(const struct hierarchy *h, struct run run, int32_t i,
                        int a, int upper_a, int b, int upper_b) {
  return is_inside(run, a, upper_a) && is_inside(run, b, upper_b)
             ? i + sibling_step(run, run.child ^ 1 << a ^ 1 << b)
             : h->corner[corner_entry(a, upper_a, b, upper_b)][i];
}

/* Stress of the transposed gradient, integrated over the sides of node i: on
 * a face of direction d, differences along axis c of component d, summed over
 * both sides of the face, are 4 h times du_d/dx_c there. */
KERNEL double transposed(const struct hierarchy *h, struct run run, int32_t i,
                         int c) {
  double sum = 0;
#pragma GCC unroll 3
  for (int d = 0; d < DIM; d++) {
    if (d == c) continue;
    const double *v = h->e[d];
    const double centre =
        v[across(h, run, i, 2 * c + 1)] - v[across(h, run, i, 2 * c)];
    const double upper = centre + v[diagonal(h, run, i, c, 1, d, 1)] -
                         v[diagonal(h, run, i, c, 0, d, 1)];
    const double lower = centre + v[diagonal(h, run, i, c, 1, d, 0)] -
                         v[diagonal(h, run, i, c, 0, d, 0)];
    sum += (double)h->w[2 * d + 1][i] * upper - (double)h->w[2 * d][i] * lower;
  }
  return 0.25 * sum;
}

/* r_i + sum of what the neighbours contribute. */
KERNEL double pull(const struct hierarchy *h, struct run run, int32_t i, int c,
                   int nparts) {
  double sum = h->r[c][i];
#pragma GCC unroll 6
  for (int f = 0; f < NFACE; f++) {
    const double w = (double)h->w[f][i] * h->e[c][across(h, run, i, f)];
    sum += nparts > 1 && f >> 1 == c ? 2 * w : w;
  }
  return nparts > 1 ? sum + transposed(h, run, i, c) : sum;
}

KERNEL void relax_node(struct hierarchy *h, struct run run, int32_t i,
                       int nparts) {
  double e[DIM];
#pragma GCC unroll 3
  for (int c = 0; c < nparts; c++) {
    e[c] = h->inverse[c][i] * pull(h, run, i, c, nparts);
  }
#pragma GCC unroll 3
  for (int c = 0; c < nparts; c++) h->e[c][i] = e[c];
}

KERNEL void relax(struct hierarchy *h, struct run run, int nparts) {
#pragma GCC ivdep
  for (int32_t i = run.begin; i < run.begin + run.n; i++) {
    relax_node(h, run, i, nparts);
  }
}

/* Relax a run as `relax` does, from e = 0. */
KERNEL void relax_first(struct hierarchy *h, struct run run, int nparts) {
  for (int c = 0; c < nparts; c++) {
#pragma GCC ivdep
    for (int32_t i = run.begin; i < run.begin + run.n; i++) {
      h->e[c][i] = h->inverse[c][i] * h->r[c][i];
    }
  }
}

/* e is 0 where the inverse is. */
KERNEL double residual(const struct hierarchy *h, struct run run, int32_t i,
                       int c, int nparts) {
  return pull(h, run, i, c, nparts) - h->e[c][i] / (h->inverse[c][i] + DBL_MIN);
}

/* r of parents. Nodes that were relaxed last have no residual: black ones of
 * a single component; of a velocity the last child, but for what its image
 * beyond a wall has changed since. */
KERNEL void restrict_families(struct hierarchy *h, const struct level *level,
                              int nparts) {
  const int nruns = nparts > 1 ? NCHILD - 1 : HALF;
  const int32_t *parent = h->family_parent + level->family_begin;
  for (int32_t first = 0; first < level->nfamilies; first += BLOCK) {
    const int32_t left = level->nfamilies - first;
    const int32_t n = left < BLOCK ? left : BLOCK;
    double sum[DIM][BLOCK] = {{0}};
#pragma GCC unroll 8
    for (int q = 0; q < nruns; q++) {
      const struct run run = run_of(level, run_child(q));
#pragma GCC ivdep
      for (int32_t k = 0; k < n; k++) {
#pragma GCC unroll 3
        for (int c = 0; c < nparts; c++) {
          sum[c][k] += residual(h, run, run.begin + first + k, c, nparts);
        }
      }
    }
    for (int c = 0; c < nparts; c++) {
      for (int32_t k = 0; k < n; k++) h->r[c][parent[first + k]] = sum[c][k];
    }
  }
}

/* r of coarser leaves: what leaves the fine nodes enters them. */
KERNEL void restrict_jumps(struct hierarchy *h, const struct level *level,
                           int nparts) {
  const struct run any = {.child = ANY_CHILD};
  for (int32_t k = level->jump_begin; k < level->jump_end; k++) {
    const struct jump *jump = &h->jump[k];
    const int32_t i = jump->fine, beyond = h->neighbour[jump->face][i];
    const int d = jump->face >> 1, upper = jump->face & 1;
    const double w = (double)h->w[jump->face][i];
    for (int c = 0; c < nparts; c++) {
      const int twice = nparts > 1 && c == d ? 2 : 1;
      double flux = twice * w * (h->e[c][i] - h->e[c][beyond]);
      if (nparts > 1 && c != d) {
        const double *v = h->e[d];
        const double difference = v[h->neighbour[2 * c + 1][i]] -
                                  v[h->neighbour[2 * c][i]] +
                                  v[diagonal(h, any, i, c, 1, d, upper)] -
                                  v[diagonal(h, any, i, c, 0, d, upper)];
        flux -= (upper ? 0.25 : -0.25) * w * difference;
      }
      h->r[c][jump->coarse] += flux;
    }
  }
}

/* Virtual children of coarser leaves. */
KERNEL void prolong_jumps(struct hierarchy *h, const struct level *level,
                          int nparts) {
  for (int32_t k = level->jump_begin; k < level->jump_end; k++) {
    const struct jump *jump = &h->jump[k];
    for (int c = 0; c < nparts; c++) {
      const double *e = h->e[c];
      double sum = e[jump->coarse];
      for (int d = 0; d < DIM; d++) {
        sum += (double)jump->weight[d] *
               (e[jump->node[d][1]] - e[jump->node[d][0]]);
      }
      h->e[c][h->nslots + k] = sum;
    }
  }
}

/* Component c, n families of level l from `first` on, children from run
 * `begin` on. */
KERNEL void prolong_block(struct hierarchy *h, int l, int c, int32_t first,
                          int32_t n, int begin) {
  const struct level *level = &h->level[l];
  const int32_t *parent = h->family_parent + level->family_begin + first;
  const double *above = h->e[c];
  double value[BLOCK], step[NFACE][BLOCK];
  for (int32_t k = 0; k < n; k++) value[k] = above[parent[k]];
  for (int f = 0; f < NFACE; f++) {
    const float *limit = h->limit[f] + level->family_begin + first;
    for (int32_t k = 0; k < n; k++) {
      const double next = above[h->neighbour[f][parent[k]]];
      step[f][k] = 0.25 * (next - value[k]) * (double)limit[k];
    }
  }
#pragma GCC unroll 8
  for (int q = begin; q < NCHILD; q++) {
    const int child = run_child(q);
    double *e = h->e[c] + family_slot(level, first, child);
    for (int32_t k = 0; k < n; k++) {
      double sum = value[k];
#pragma GCC unroll 3
      for (int d = 0; d < DIM; d++) sum += step[2 * d + (child >> d & 1)][k];
      e[k] += sum;
    }
  }
}

/* Prolong e to level l. A single component is relaxed on red nodes
 * next, from black ones alone, so that red children need no value. */
KERNEL void prolong(struct hierarchy *h, int l, int nparts) {
  const int32_t nfamilies = h->level[l].nfamilies;
  for (int32_t first = 0; first < nfamilies; first += BLOCK) {
    const int32_t left = nfamilies - first, n = left < BLOCK ? left : BLOCK;
    for (int c = 0; c < nparts; c++) {
      prolong_block(h, l, c, first, n, nparts > 1 ? 0 : HALF);
    }
  }
}

static void copy_ghosts(struct hierarchy *h, int l) {
  plan_run(&h->level[l].copy, h->nparts, h->e, 1, false);
}

/* Images beyond walls. */
static void reflect(struct hierarchy *h, int l) {
  const struct level *level = &h->level[l];
  for (int c = 0; c < h->nparts; c++) {
    double *image = h->e[c] + h->nslots + h->njumps;
    for (int32_t k = level->mirror_begin; k < level->mirror_end; k++) {
      const struct mirror *mirror = &h->mirror[k];
      image[k] = h->beyond[l][c][mirror->patch] * h->e[c][mirror->source];
    }
  }
}

/* Is everything of a colour relaxed after run q? Red and black keep the face
 * neighbours apart; for velocities, coupled across edges too, each child number
 * is a colour of its own, so that the order of nodes (and ranks) does not
 * matter. */
KERNEL bool ends_colour(int q, int nparts) {
  return nparts > 1 || q % HALF == HALF - 1;
}

/* Sweeps over the nodes near jumps of the coefficient. */
KERNEL void smooth_rough(struct hierarchy *h, int l, int nparts) {
  const struct run any = {.child = ANY_CHILD};
  for (int k = 0; k < h->rough_sweeps; k++) {
    for (int q = 0; q < NCHILD; q++) {
      const int32_t *begin = h->rough_begin + l * NCHILD + q;
      for (int32_t j = begin[0]; j < begin[1]; j++) {
        relax_node(h, any, h->rough[j], nparts);
      }
      if (nparts > 1) skin_nodes_relax(h, l, q);
      if (ends_colour(q, nparts)) copy_ghosts(h, l);
      if (nparts > 1) reflect(h, l);
    }
  }
}

/* Sweeps over the colours. The last sweep goes over all, as no residual may be
 * left on nodes relaxed last. */
KERNEL void smooth(struct hierarchy *h, int l, int nsweeps, bool from_zero,
                   int nparts) {
  const int nfirst = nparts > 1 ? 1 : HALF; /* runs that see only zeros */
  for (int k = 0; k < nsweeps; k++) {
    if (k == nsweeps - 1) smooth_rough(h, l, nparts);
#pragma GCC unroll 8
    for (int q = 0; q < NCHILD; q++) {
      const struct run run = run_of(&h->level[l], run_child(q));
      if (k == 0 && from_zero && q < nfirst) {
        relax_first(h, run, nparts);
      } else {
        relax(h, run, nparts);
      }
      if (nparts > 1) skin_nodes_relax(h, l, q);
      if (ends_colour(q, nparts)) copy_ghosts(h, l);
      if (nparts > 1) reflect(h, l);
    }
  }
}

KERNEL void cycle(struct hierarchy *h, int nparts) {
  for (int l = h->nlevels - 1; l > 0; l--) {
    plan_run(&h->level[l].add, nparts, h->r, 1, true);
    smooth(h, l, SWEEPS_DOWN, true, nparts);
    restrict_families(h, &h->level[l], nparts);
    if (nparts > 1) skin_nodes_restrict(h, l);
    restrict_jumps(h, &h->level[l], nparts);
  }
  plan_run(&h->level[0].add, nparts, h->r, 1, true);
  coarse_solve(h);
  copy_ghosts(h, 0);
  for (int l = 1; l < h->nlevels; l++) {
    reflect(h, l - 1);
    prolong_jumps(h, &h->level[l], nparts);
    prolong(h, l, nparts);
    copy_ghosts(h, l);
    if (nparts > 1) reflect(h, l);
    smooth(h, l, SWEEPS_UP, false, nparts);
  }
}

KERNEL void run(struct hierarchy *h, double factor, const double *r,
                float *const e[2], int nparts) {
  const struct mesh *mesh = h->mesh;
  const size_t size = (size_t)h->nslots * sizeof(double);
  for (int c = 0; c < nparts; c++) {
    memset(h->e[c], 0,
           size + (size_t)(h->njumps + h->nmirrors) * sizeof(double));
    if (h->nranks > 1) memset(h->r[c], 0, size); /* what others add to */
    for (int32_t i = 0; i < mesh->nleaves; i++) {
      h->r[c][h->leaf_slot[i]] =
          factor * mesh_volume(mesh, i) * r[(int64_t)c * mesh->nleaves + i];
    }
  }
  cycle(h, nparts);
  for (int c = 0; c < nparts; c++) {
    const int64_t at = (int64_t)c * mesh->nleaves;
    for (int32_t i = 0; i < mesh->nleaves; i++) {
      e[0][at + i] = (float)h->e[c][h->leaf_slot[i]];
    }
    if (!e[1]) continue;
    for (int32_t i = 0; i < mesh->nleaves; i++) {
      e[1][at + i] = (float)(h->e[c][h->leaf_slot[i]] - (double)e[0][at + i]);
    }
  }
}

void cycle_run(struct hierarchy *h, double factor, const double *r,
               float *const e[2]) {
  h->ncycles++;
  if (h->nparts == 1) {
    run(h, factor, r, e, 1);
  } else {
    run(h, factor, r, e, DIM);
  }
}
