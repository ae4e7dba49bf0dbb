/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One multigrid cycle. See hierarchy.h for the formulas.
 *
 * Where a level is relaxed, coarser leaves beside it have e = 0 on the way down
 * and their final value on the way up. */
#include <string.h>

#include "levels.h"

enum { SWEEPS_DOWN = 2, SWEEPS_UP = 2 };

/* Relax the first runs of a level, up to `end`, where e is 0 everywhere. */
static void relax_first(struct hierarchy *h, const struct level *level,
                        int end) {
  const int64_t last = run_begin(level, end) * h->stride;
  for (int c = 0; c < count_arrays(h); c++) {
    for (int64_t i = level->begin * h->stride; i < last; i++) {
      h->e[c][i] = h->inverse[c][i] * h->r[c][i];
    }
  }
}

/* Set r of parents. */
static void restrict_families(struct hierarchy *h, const struct level *level) {
  const int nruns = sweep_residual_runs(h->nparts);
  const int32_t *parent = h->family_parent + level->family_begin;
  const int64_t stride = h->stride;
  for (int32_t first = 0; first < level->nfamilies; first += SWEEP_BLOCK) {
    const int32_t left = level->nfamilies - first;
    const int32_t n = left < SWEEP_BLOCK ? left : SWEEP_BLOCK;
    double block[NODE_ROOM * SWEEP_BLOCK] = {0};
    double *sum[DIM];
    set_parts(h, block, SWEEP_BLOCK, sum);
    for (int q = 0; q < nruns; q++) {
      sweep_add_residuals(h, level, q, first, n, sum);
    }
    for (int c = 0; c < count_arrays(h); c++) {
      for (int32_t k = 0; k < n; k++) {
        double *r = h->r[c] + parent[first + k] * stride;
        for (int64_t j = 0; j < stride; j++) r[j] = sum[c][k * stride + j];
      }
    }
  }
}

/* Return the flux of component c of a velocity through a jump: transposed
 * gradient. */
static double transposed_flux(const struct hierarchy *h,
                              const struct jump *jump, int c) {
  const int d = jump->face >> 1, upper = jump->face & 1;
  const int32_t i = jump->fine;
  const double *v = h->e[d], w = (double)h->w[jump->face][i];
  const int64_t stride = h->stride;
  const double difference =
      v[h->neighbour[2 * c + 1][i] * stride] -
      v[h->neighbour[2 * c][i] * stride] +
      v[h->corner[corner_entry(c, 1, d, upper)][i] * stride] -
      v[h->corner[corner_entry(c, 0, d, upper)][i] * stride];
  return (upper ? 0.25 : -0.25) * w * difference;
}

/* Add to r of coarser leaves: what leaves the fine nodes enters them. */
static void restrict_jumps(struct hierarchy *h, const struct level *level) {
  const bool velocity = h->nparts > 1;
  for (int32_t k = level->jump_begin; k < level->jump_end; k++) {
    const struct jump *jump = &h->jump[k];
    const int32_t i = jump->fine, beyond = h->neighbour[jump->face][i];
    const double w = (double)h->w[jump->face][i];
    for (int c = 0; c < h->nparts; c++) {
      const bool normal = c == jump->face >> 1;
      const double *e = h->e[c];
      double flux = (velocity && normal ? 2 : 1) * w *
                    (e[i * h->stride] - e[beyond * h->stride]);
      if (velocity && !normal) flux -= transposed_flux(h, jump, c);
      if (h->has_bulk && normal) flux += sweep_bulk_flux(h, i, jump->face);
      h->r[c][jump->coarse * h->stride] += flux;
    }
  }
}

/* Prolong to the virtual children of coarser leaves. */
static void prolong_jumps(struct hierarchy *h, const struct level *level) {
  const int64_t stride = h->stride;
  for (int32_t k = level->jump_begin; k < level->jump_end; k++) {
    const struct jump *jump = &h->jump[k];
    for (int c = 0; c < h->nparts; c++) {
      const double *e = h->e[c];
      double sum = e[jump->coarse * stride];
      for (int d = 0; d < DIM; d++) {
        const int32_t *node = jump->node[d];
        sum += (double)jump->weight[d] *
               (e[node[1] * stride] - e[node[0] * stride]);
      }
      h->e[c][(h->nslots + k) * stride] = sum;
    }
  }
}

/* Prolong component c of n families of level l from `first` on, children from
 * run `begin` on. */
static void prolong_block(struct hierarchy *h, int l, int c, int32_t first,
                          int32_t n, int begin) {
  const struct level *level = &h->level[l];
  const int32_t *parent = h->family_parent + level->family_begin + first;
  const double *above = h->e[c];
  const int64_t stride = h->stride;
  double value[SWEEP_BLOCK], step[NFACE][SWEEP_BLOCK];
  for (int32_t k = 0; k < n; k++) value[k] = above[parent[k] * stride];
  for (int f = 0; f < NFACE; f++) {
    const float *limit = h->limit[f] + level->family_begin + first;
    for (int32_t k = 0; k < n; k++) {
      const double next = above[h->neighbour[f][parent[k]] * stride];
      step[f][k] = 0.25 * (next - value[k]) * (double)limit[k];
    }
  }
#pragma GCC unroll 8
  for (int q = 0; q < NCHILD; q++) {
    const int child = run_child(q);
    double *e = h->e[c] + (run_begin(level, q) + first) * stride;
    if (q < begin) continue;
    for (int32_t k = 0; k < n; k++) {
      double sum = value[k];
#pragma GCC unroll 3
      for (int d = 0; d < DIM; d++) sum += step[2 * d + (child >> d & 1)][k];
      e[k * stride] += sum;
    }
  }
}

/* Prolong e to level l. A single component is relaxed on red nodes next, from
 * black ones alone, so that red children need no value. */
static void prolong(struct hierarchy *h, int l) {
  const int32_t nfamilies = h->level[l].nfamilies;
  for (int32_t first = 0; first < nfamilies; first += SWEEP_BLOCK) {
    const int32_t left = nfamilies - first,
                  n = left < SWEEP_BLOCK ? left : SWEEP_BLOCK;
    for (int c = 0; c < h->nparts; c++) {
      prolong_block(h, l, c, first, n, h->nparts > 1 ? 0 : HALF);
    }
  }
}

static void copy_ghosts(struct hierarchy *h, int l) {
  run_plan(h, &h->level[l].copy, h->e, false);
}

/* Set the images beyond walls. */
static void reflect(struct hierarchy *h, int l) {
  const struct level *level = &h->level[l];
  const int64_t stride = h->stride, begin = h->nslots + h->njumps;
  for (int c = 0; c < h->nparts; c++) {
    double *e = h->e[c], *image = e + begin * stride;
    for (int32_t k = level->mirror_begin; k < level->mirror_end; k++) {
      const struct mirror *mirror = &h->mirror[k];
      image[k * stride] =
          h->beyond[l][c][mirror->patch] * e[mirror->source * stride];
    }
  }
}

/* Set the images of the nodes of run q of a level, NCHILD: of ghosts. */
static void reflect_run(struct hierarchy *h, int l, int q) {
  const int32_t *begin = h->mirror_run + l * (NCHILD + 1) + q;
  const int64_t stride = h->stride;
  for (int c = 0; c < h->nparts; c++) {
    const double *beyond = h->beyond[l][c];
    double *e = h->e[c], *image = e + (h->nslots + h->njumps) * stride;
    for (int32_t k = begin[0]; k < begin[1]; k++) {
      const int32_t n = h->mirror_order[k];
      const struct mirror *mirror = &h->mirror[n];
      image[n * stride] = beyond[mirror->patch] * e[mirror->source * stride];
    }
  }
}

/* Return the end of the runs that are of one colour with run q, their first.
 * Red and black keep the face neighbours apart. Velocities are coupled across
 * edges too, so that each child number is a colour of its own; but in 3D the
 * two that change places with the horizontal axes, 5 and 6, 1 and 2, are of one
 * colour, so that neither axis comes first. */
static int colour_end(const struct hierarchy *h, int q) {
  if (h->nparts == 1) return q < HALF ? HALF : NCHILD;
  const bool pair = DIM == 3 && (q == 2 || q == 4);
  return pair ? q + 2 : q + 1;
}

/* Finish the relaxation of the runs of a colour: skin, ghosts, images. */
static void end_colour(struct hierarchy *h, int l, int first, int end) {
  const bool velocity = h->nparts > 1;
  if (velocity) skin_nodes_relax(h, l, first, end);
  copy_ghosts(h, l);
  for (int q = first; q < end && velocity; q++) reflect_run(h, l, q);
  if (velocity && h->nranks > 1) reflect_run(h, l, NCHILD);
}

/* Sweep over the nodes near jumps of the coefficient. */
static void smooth_rough(struct hierarchy *h, int l) {
  for (int k = 0; k < h->rough_sweeps; k++) {
    for (int q = 0, end; q < NCHILD; q = end) {
      end = colour_end(h, q);
      sweep_relax_rough(h, l, q, end);
      end_colour(h, l, q, end);
    }
  }
}

/* Sweep over the colours. The last sweep goes over all, as no residual may be
 * left on nodes relaxed last. */
static void smooth(struct hierarchy *h, int l, int nsweeps, bool from_zero) {
  for (int k = 0; k < nsweeps; k++) {
    if (k == nsweeps - 1) smooth_rough(h, l);
    for (int q = 0, end; q < NCHILD; q = end) {
      end = colour_end(h, q);
      if (k == 0 && from_zero && q == 0) { /* sees only zeros */
        relax_first(h, &h->level[l], end);
      } else {
        sweep_relax(h, &h->level[l], q, end);
      }
      end_colour(h, l, q, end);
    }
  }
}

static void cycle(struct hierarchy *h) {
  for (int l = h->nlevels - 1; l > 0; l--) {
    run_plan(h, &h->level[l].add, h->r, true);
    smooth(h, l, SWEEPS_DOWN, true);
    restrict_families(h, &h->level[l]);
    if (h->nparts > 1) skin_nodes_restrict(h, l);
    restrict_jumps(h, &h->level[l]);
  }
  run_plan(h, &h->level[0].add, h->r, true);
  coarse_solve(h);
  copy_ghosts(h, 0);
  for (int l = 1; l < h->nlevels; l++) {
    reflect(h, l - 1);
    prolong_jumps(h, &h->level[l]);
    prolong(h, l);
    copy_ghosts(h, l);
    if (h->nparts > 1) reflect(h, l);
    smooth(h, l, SWEEPS_UP, false);
  }
}

void cycle_run(struct hierarchy *h, double factor, const double *r, double *e) {
  const struct mesh *mesh = h->mesh;
  const int64_t n = h->nslots, stride = h->stride, nleaves = mesh->nleaves;
  const size_t each = (size_t)stride * sizeof(double);
  h->ncycles++;
  for (int c = 0; c < count_arrays(h); c++) {
    memset(h->e[c], 0, (size_t)(n + h->njumps + h->nmirrors) * each);
    if (h->nranks > 1) memset(h->r[c], 0, (size_t)n * each); /* is added to */
  }
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    const int64_t at = h->leaf_slot[i] * stride;
    const double volume = factor * mesh_volume(mesh, i);
    for (int c = 0; c < h->nparts; c++) {
      h->r[c][at] = volume * r[c * nleaves + i];
    }
    if (stride > h->nparts) h->r[0][at + h->nparts] = 0;
  }
  cycle(h);
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    const int64_t at = h->leaf_slot[i] * stride;
    for (int c = 0; c < h->nparts; c++) e[c * nleaves + i] = h->e[c][at];
  }
}
