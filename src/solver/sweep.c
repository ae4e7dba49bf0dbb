/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Relaxation of the nodes of a colour, and residuals. See hierarchy.h for the
 * formulas.
 *
 * The pull of the neighbours on a node is written once for `nparts`
 * components, with and without what div u adds to the stress (bulk.c), and
 * compiled for 1, DIM and both, and for each child number: siblings
 * are then a fixed number of slots away, which leaves half of the neighbours to
 * be looked up. Nodes of one child number do not see each other, so that their
 * loops may use vectors (ivdep); in 3D a vector is one node of a velocity
 * (levels.h). These loops are most of the time of a cycle. In 3D they take
 * seconds to compile, so that each is compiled once. */
#include <float.h>
#include <string.h>

#include "levels.h"

enum { ANY_CHILD = -1 /* nodes taken one by one */ };

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

/* Return the place of a value in the array of its component. */
KERNEL int64_t place(int32_t i, int nparts) {
  return (int64_t)i * (nparts > 1 ? LANES : 1);
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
    const double centre = v[place(across(h, run, i, 2 * c + 1), DIM)] -
                          v[place(across(h, run, i, 2 * c), DIM)];
    const double upper = centre +
                         v[place(diagonal(h, run, i, c, 1, d, 1), DIM)] -
                         v[place(diagonal(h, run, i, c, 0, d, 1), DIM)];
    const double lower = centre +
                         v[place(diagonal(h, run, i, c, 1, d, 0), DIM)] -
                         v[place(diagonal(h, run, i, c, 0, d, 0), DIM)];
    sum += (double)h->w[2 * d + 1][i] * upper - (double)h->w[2 * d][i] * lower;
  }
  return 0.25 * sum;
}

/* 4 h times the sum of du_d/dx_d, d != c, on side f of node i; f is of axis c.
 */
KERNEL double divergence_along(const struct hierarchy *h, struct run run,
                               int32_t i, int f) {
  const int c = f >> 1, upper = f & 1;
  double sum = 0;
#pragma GCC unroll 3
  for (int d = 0; d < DIM; d++) {
    const double *v = h->e[d];
    if (d == c) continue;
    sum += v[place(across(h, run, i, 2 * d + 1), DIM)] -
           v[place(across(h, run, i, 2 * d), DIM)] +
           v[place(diagonal(h, run, i, c, upper, d, 1), DIM)] -
           v[place(diagonal(h, run, i, c, upper, d, 0), DIM)];
  }
  return sum;
}

/* Return how lambda (bulk.c) pulls node i. */
KERNEL double bulk_pull(const struct hierarchy *h, struct run run, int32_t i,
                        int c) {
  const double lower = h->e[c][place(across(h, run, i, 2 * c), DIM)] -
                       0.25 * divergence_along(h, run, i, 2 * c);
  const double upper = h->e[c][place(across(h, run, i, 2 * c + 1), DIM)] +
                       0.25 * divergence_along(h, run, i, 2 * c + 1);
  return (double)h->bulk[2 * c][i] * lower +
         (double)h->bulk[2 * c + 1][i] * upper;
}

/* r_i + sum of what the neighbours contribute. */
KERNEL double pull(const struct hierarchy *h, struct run run, int32_t i, int c,
                   int nparts, bool bulk) {
  double sum = h->r[c][place(i, nparts)];
#pragma GCC unroll 6
  for (int f = 0; f < NFACE; f++) {
    const double w =
        (double)h->w[f][i] * h->e[c][place(across(h, run, i, f), nparts)];
    sum += nparts > 1 && f >> 1 == c ? 2 * w : w;
  }
  if (bulk) sum += bulk_pull(h, run, i, c);
  return nparts > 1 ? sum + transposed(h, run, i, c) : sum;
}

/* Hold a node of a velocity in 3D, on any place where a double may be. */
typedef double quad
    __attribute__((vector_size(32), aligned(sizeof(double)), may_alias));

/* Set *sum to what `pull` gives of all components, without bulk viscosity. */
KERNEL void pull_quad(const struct hierarchy *h, struct run run, int32_t i,
                      quad *sum) {
  static const quad unit[] = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}};
  const quad *e = (const quad *)h->e[0];
  quad lower[DIM], upper[DIM], turned[DIM] = {{0}};
  *sum = ((const quad *)h->r[0])[i];
#pragma GCC unroll 3
  for (int d = 0; d < DIM; d++) {
    const double wl = (double)h->w[2 * d][i], wu = (double)h->w[2 * d + 1][i];
    lower[d] = wl * unit[d], upper[d] = wu * unit[d];
    *sum += (1 + unit[d]) * (wl * e[across(h, run, i, 2 * d)] +
                             wu * e[across(h, run, i, 2 * d + 1)]);
  }
#pragma GCC unroll 3
  for (int c = 0; c < DIM; c++) {
    const quad centre =
        e[across(h, run, i, 2 * c + 1)] - e[across(h, run, i, 2 * c)];
#pragma GCC unroll 3
    for (int d = 0; d < DIM; d++) {
      if (d == c) continue;
      const quad above = e[diagonal(h, run, i, c, 1, d, 1)] -
                         e[diagonal(h, run, i, c, 0, d, 1)];
      const quad below = e[diagonal(h, run, i, c, 1, d, 0)] -
                         e[diagonal(h, run, i, c, 0, d, 0)];
      /* component d of it pulls component c */
      turned[(d - c + DIM) % DIM] +=
          upper[d] * (centre + above) - lower[d] * (centre + below);
    }
  }
  const quad s = turned[1], t = turned[DIM - 1];
  *sum += 0.25 * ((quad){s[1], s[2], s[0], 0} + (quad){t[2], t[0], t[1], 0});
}

/* Where relaxed values go: of slot i to e[c][i - shift]. */
struct target {
  double *e[DIM];
  int32_t shift;
};

KERNEL void relax_node(const struct hierarchy *h, struct run run, int32_t i,
                       int nparts, bool bulk, const struct target *to) {
  if (DIM == 3 && nparts > 1 && !bulk) {
    quad sum;
    pull_quad(h, run, i, &sum);
    ((quad *)to->e[0])[i - to->shift] = ((const quad *)h->inverse[0])[i] * sum;
    return;
  }
  double e[DIM];
#pragma GCC unroll 3
  for (int c = 0; c < nparts; c++) {
    e[c] = h->inverse[c][place(i, nparts)] * pull(h, run, i, c, nparts, bulk);
  }
#pragma GCC unroll 3
  for (int c = 0; c < nparts; c++) {
    to->e[c][place(i - to->shift, nparts)] = e[c];
  }
}

/* One copy for each child number. */
KERNEL void relax_run(const struct hierarchy *h, const struct level *level,
                      int q, int nparts, bool bulk, const struct target *to) {
#pragma GCC unroll 8
  for (int number = 0; number < NCHILD; number++) {
    const struct run run = run_of(level, run_child(number));
    if (number != q) continue;
#pragma GCC ivdep
    for (int32_t i = run.begin; i < run.begin + run.n; i++) {
      relax_node(h, run, i, nparts, bulk, to);
    }
  }
}

static void relax_scalar(const struct hierarchy *h, const struct level *level,
                         int q, const struct target *to) {
  relax_run(h, level, q, 1, false, to);
}

static void relax_velocity(const struct hierarchy *h, const struct level *level,
                           int q, const struct target *to) {
  relax_run(h, level, q, DIM, false, to);
}

static void relax_compressible(const struct hierarchy *h,
                               const struct level *level, int q,
                               const struct target *to) {
  relax_run(h, level, q, DIM, true, to);
}

/* Return where the values of run q of the runs [first, end) go. Runs of a
 * velocity see each other, so that all but the last stay apart until all are
 * relaxed. */
static struct target target_of(const struct hierarchy *h,
                               const struct level *level, int first, int q,
                               int end) {
  struct target to = {.shift = 0};
  const bool apart = h->nparts > 1 && q < end - 1;
  set_parts(h, h->apart, h->apart_room, to.e);
  for (int c = 0; c < DIM && !apart; c++) to.e[c] = h->e[c];
  if (apart) to.shift = run_begin(level, first);
  return to;
}

void sweep_relax(struct hierarchy *h, const struct level *level, int first,
                 int end) {
  for (int q = first; q < end; q++) {
    const struct target to = target_of(h, level, first, q, end);
    if (h->nparts == 1) {
      relax_scalar(h, level, q, &to);
    } else if (h->has_bulk) {
      relax_compressible(h, level, q, &to);
    } else {
      relax_velocity(h, level, q, &to);
    }
  }
  if (h->nparts == 1 || end == first + 1) return;
  const int64_t n = h->stride * (end - 1 - first) * level->nfamilies;
  for (int c = 0; c < count_arrays(h); c++) {
    memcpy(h->e[c] + run_begin(level, first) * h->stride,
           h->apart + c * h->apart_room, (size_t)n * sizeof(double));
  }
}

/* e is 0 where the inverse is. */
KERNEL double residual(const struct hierarchy *h, struct run run, int32_t i,
                       int c, int nparts, bool bulk) {
  const int64_t k = place(i, nparts);
  return pull(h, run, i, c, nparts, bulk) -
         h->e[c][k] / (h->inverse[c][k] + DBL_MIN);
}

/* Add the residual of node i, all components, to *sum. */
KERNEL void add_residual_quad(const struct hierarchy *h, struct run run,
                              int32_t i, quad *sum) {
  const quad e = ((const quad *)h->e[0])[i];
  const quad inverse = ((const quad *)h->inverse[0])[i];
  quad all;
  pull_quad(h, run, i, &all);
  *sum += all - e / (inverse + DBL_MIN);
}

KERNEL void add_residuals(const struct hierarchy *h, const struct level *level,
                          int q, int32_t first, int32_t n,
                          double *const sum[DIM], int nparts, bool bulk) {
  const int nruns = sweep_residual_runs(nparts);
#pragma GCC unroll 8
  for (int number = 0; number < nruns; number++) {
    const struct run run = run_of(level, run_child(number));
    if (number != q) continue;
#pragma GCC ivdep
    for (int32_t k = 0; k < n; k++) {
      const int32_t i = run.begin + first + k;
      if (DIM == 3 && nparts > 1 && !bulk) {
        add_residual_quad(h, run, i, (quad *)sum[0] + k);
        continue;
      }
#pragma GCC unroll 3
      for (int c = 0; c < nparts; c++) {
        sum[c][place(k, nparts)] += residual(h, run, i, c, nparts, bulk);
      }
    }
  }
}

static void residuals_scalar(const struct hierarchy *h,
                             const struct level *level, int q, int32_t first,
                             int32_t n, double *const sum[DIM]) {
  add_residuals(h, level, q, first, n, sum, 1, false);
}

static void residuals_velocity(const struct hierarchy *h,
                               const struct level *level, int q, int32_t first,
                               int32_t n, double *const sum[DIM]) {
  add_residuals(h, level, q, first, n, sum, DIM, false);
}

static void residuals_compressible(const struct hierarchy *h,
                                   const struct level *level, int q,
                                   int32_t first, int32_t n,
                                   double *const sum[DIM]) {
  add_residuals(h, level, q, first, n, sum, DIM, true);
}

void sweep_add_residuals(const struct hierarchy *h, const struct level *level,
                         int q, int32_t first, int32_t n,
                         double *const sum[DIM]) {
  if (h->nparts == 1) {
    residuals_scalar(h, level, q, first, n, sum);
  } else if (h->has_bulk) {
    residuals_compressible(h, level, q, first, n, sum);
  } else {
    residuals_velocity(h, level, q, first, n, sum);
  }
}

KERNEL void relax_nodes(const struct hierarchy *h, int32_t n,
                        const int32_t *node, int nparts, bool bulk,
                        const struct target *to) {
  const struct run any = {.child = ANY_CHILD};
  for (int32_t k = 0; k < n; k++) {
    relax_node(h, any, node[k], nparts, bulk, to);
  }
}

void sweep_relax_rough(struct hierarchy *h, int l, int first, int end) {
  const struct level *level = &h->level[l];
  const int32_t *begin = h->rough_begin + l * NCHILD;
  for (int q = first; q < end; q++) {
    const struct target to = target_of(h, level, first, q, end);
    const int32_t n = begin[q + 1] - begin[q], *node = h->rough + begin[q];
    if (h->nparts == 1) {
      relax_nodes(h, n, node, 1, false, &to);
    } else if (h->has_bulk) {
      relax_nodes(h, n, node, DIM, true, &to);
    } else {
      relax_nodes(h, n, node, DIM, false, &to);
    }
  }
  double *apart[DIM];
  set_parts(h, h->apart, h->apart_room, apart);
  for (int c = 0; c < h->nparts && h->nparts > 1; c++) {
    for (int32_t k = begin[first]; k < begin[end - 1]; k++) {
      const int64_t i = h->rough[k], at = i - run_begin(level, first);
      h->e[c][i * h->stride] = apart[c][at * h->stride];
    }
  }
}

double sweep_bulk_flux(const struct hierarchy *h, int32_t i, int f) {
  const struct run any = {.child = ANY_CHILD};
  const double *e = h->e[f >> 1];
  return (double)h->bulk[f][i] *
         (e[place(i, DIM)] - e[place(h->neighbour[f][i], DIM)] -
          (f & 1 ? 0.25 : -0.25) * divergence_along(h, any, i, f));
}
