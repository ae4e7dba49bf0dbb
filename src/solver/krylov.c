/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/krylov.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "talus/error.h"
#include "talus/memory.h"

/* A guess passes only at this part of the tolerance: errors just below it, of
 * one sign, would add up from step to step. */
#define KRYLOV_GUESS 1e-6

enum { KRYLOV_FEW = 8 }; /* directions, at least, between forgetting them */

struct krylov_space {
  int64_t size;                                        /* of each direction */
  double *z[KRYLOV_DIRECTIONS], *q[KRYLOV_DIRECTIONS]; /* NULL: never used */
  double inverse[KRYLOV_DIRECTIONS];                   /* 1 / <q, q> */
};

struct krylov_space *krylov_space_new(void) {
  return MEM_NEW(struct krylov_space, 1);
}

static void space_clear(struct krylov_space *space) {
  for (int k = 0; k < KRYLOV_DIRECTIONS; k++) {
    mem_free(space->z[k]);
    mem_free(space->q[k]);
    space->z[k] = space->q[k] = NULL;
  }
}

void krylov_space_destroy(struct krylov_space *space) {
  if (!space) return;
  space_clear(space);
  mem_free(space);
}

int64_t krylov_space_bytes(const struct krylov_space *space) {
  int64_t n = 0;
  for (int k = 0; k < KRYLOV_DIRECTIONS; k++) n += space->z[k] ? 2 : 0;
  return n * space->size * (int64_t)sizeof(double);
}

static void space_take(struct krylov_space *space, int k, int64_t size) {
  if (size > space->size) {
    space_clear(space);
    space->size = size;
  }
  if (space->z[k]) return;
  space->z[k] = MEM_NEW(double, space->size);
  space->q[k] = MEM_NEW(double, space->size);
}

static void sum_ranks(const struct krylov_system *s, int n, double *v) {
  MPI_CHECK(MPI_Allreduce(MPI_IN_PLACE, v, n, MPI_DOUBLE, MPI_SUM, s->comm));
}

/* Sums run in LANES parts, so that the compiler may use vectors and the order
 * is fixed. Long vectors are taken in pieces of BLOCK numbers that stay in
 * cache while all directions pass by. */
enum { LANES = 8, BLOCK = 1024 };

struct lanes {
  double sum[LANES];
};

static void add_products(int64_t n, const float *w, const double *a,
                         const double *b, struct lanes *restrict lanes) {
  int64_t i = 0;
  for (; i + LANES <= n; i += LANES) {
    for (int k = 0; k < LANES; k++) {
      const double s = (double)w[i + k] * (double)w[i + k];
      lanes->sum[k] += s * a[i + k] * b[i + k];
    }
  }
  for (int k = 0; i + k < n; k++) {
    const double s = (double)w[i + k] * (double)w[i + k];
    lanes->sum[k] += s * a[i + k] * b[i + k];
  }
}

static double lanes_sum(const struct lanes *lanes) {
  double sum = 0;
  for (int k = 0; k < LANES; k++) sum += lanes->sum[k];
  return sum;
}

static int64_t block_size(int64_t n, int64_t begin) {
  return n - begin < BLOCK ? n - begin : BLOCK;
}

/* As unsigned integers, absolute values are ordered and a NaN beats all. */
static inline uint64_t ordered(double v) {
  uint64_t bits;
  v = fabs(v);
  memcpy(&bits, &v, sizeof bits);
  return bits;
}

static uint64_t max_ratio(int32_t n, const double *density, const double *v) {
  uint64_t lane[LANES] = {0}, most = 0;
  int32_t i = 0;
  for (; i + LANES <= n; i += LANES) {
    for (int k = 0; k < LANES; k++) {
      const uint64_t a =
          ordered(density ? v[i + k] / density[i + k] : v[i + k]);
      lane[k] = a > lane[k] ? a : lane[k];
    }
  }
  for (; i < n; i++) {
    const uint64_t a = ordered(density ? v[i] / density[i] : v[i]);
    most = a > most ? a : most;
  }
  for (int k = 0; k < LANES; k++) most = lane[k] > most ? lane[k] : most;
  return most;
}

/* max |r/rho|; NaN if any is. */
static double max_residual(const struct krylov_system *s, const double *r) {
  uint64_t most = 0;
  for (int c = 0; c < s->nparts; c++) {
    const uint64_t a = max_ratio(s->n, s->density, r + (int64_t)c * s->n);
    most = a > most ? a : most;
  }
  MPI_CHECK(
      MPI_Allreduce(MPI_IN_PLACE, &most, 1, MPI_UINT64_T, MPI_MAX, s->comm));
  double value;
  memcpy(&value, &most, sizeof value);
  return value;
}

/* a += f b */
static void add_to(int64_t n, double *restrict a, double f,
                   const double *restrict b) {
  for (int64_t i = 0; i < n; i++) a[i] += f * b[i];
}

/* v += sum of a[j] times the `kept` vectors before number k. */
static void add_others(int64_t n, double *const vector[KRYLOV_DIRECTIONS],
                       int k, int kept, const double *a) {
  for (int64_t i = 0; i < n; i += BLOCK) {
    for (int j = 0; j < kept; j++) {
      const int other = (k + KRYLOV_DIRECTIONS - 1 - j) % KRYLOV_DIRECTIONS;
      add_to(block_size(n, i), vector[k] + i, a[j], vector[other] + i);
    }
  }
}

/* Make direction k orthogonal to the `kept` others before it. */
static void orthogonalise(const struct krylov_system *s,
                          struct krylov_space *space, int k, int kept) {
  const int64_t n = (int64_t)s->n * s->nparts;
  struct lanes lanes[KRYLOV_DIRECTIONS] = {{{0}}};
  double a[KRYLOV_DIRECTIONS];
  if (kept == 0) return;
  for (int64_t i = 0; i < n; i += BLOCK) {
    for (int j = 0; j < kept; j++) {
      const int other = (k + KRYLOV_DIRECTIONS - 1 - j) % KRYLOV_DIRECTIONS;
      add_products(block_size(n, i), s->weight + i, space->q[k] + i,
                   space->q[other] + i, &lanes[j]);
    }
  }
  for (int j = 0; j < kept; j++) a[j] = lanes_sum(&lanes[j]);
  sum_ranks(s, kept, a);
  for (int j = 0; j < kept; j++) {
    a[j] *=
        -space->inverse[(k + KRYLOV_DIRECTIONS - 1 - j) % KRYLOV_DIRECTIONS];
  }
  add_others(n, space->q, k, kept, a);
  add_others(n, space->z, k, kept, a);
}

/* Next direction: precondition, apply, make orthogonal to the `kept` ones
 * before it. Leaves <r, q>, <q, q>, <r, r>. */
static void make_direction(const struct krylov_system *s,
                           struct krylov_space *space, int k, int kept,
                           const double *r, double product[3]) {
  const int64_t n = (int64_t)s->n * s->nparts;
  space_take(space, k, n);
  double *q = space->q[k];
  s->precondition(s->context, r, space->z[k]);
  s->apply(s->context, space->z[k], q);
  orthogonalise(s, space, k, kept);
  struct lanes lanes[3] = {{{0}}};
  for (int64_t i = 0; i < n; i += BLOCK) {
    const int64_t size = block_size(n, i);
    add_products(size, s->weight + i, r + i, q + i, &lanes[0]);
    add_products(size, s->weight + i, q + i, q + i, &lanes[1]);
    add_products(size, s->weight + i, r + i, r + i, &lanes[2]);
  }
  for (int j = 0; j < 3; j++) product[j] = lanes_sum(&lanes[j]);
  sum_ranks(s, 3, product);
  space->inverse[k] = 1 / product[1];
}

/* Where an iteration stands. */
struct progress {
  int kept;         /* directions that new ones are made orthogonal to */
  int waited;       /* iterations since <r, r> was halved */
  double reference; /* <r, r> then */
  double first;     /* <r, r> at the start */
};

/* Count an iteration. What round-off leaves of r along old directions cannot
 * be removed by new ones orthogonal to them: forget them when they are in the
 * way, 12 digits down; but not again before there are a few new ones, without
 * which a hard system makes no way at all. */
static void progress_count(struct progress *p, const double product[3]) {
  const double rr = product[2];
  const double gain = product[0] * product[0] / product[1];
  const bool halved = p->first == 0 || rr < 0.5 * p->reference;
  if (p->first == 0) p->first = rr;
  p->waited = halved ? 0 : p->waited + 1;
  if (halved) p->reference = rr;
  p->kept += p->kept < KRYLOV_DIRECTIONS - 1;
  const bool stuck = gain < 0.1 * rr && rr < 1e-24 * p->first;
  if (stuck && p->kept >= KRYLOV_FEW) p->kept = 0;
}

struct solve_stats krylov_solve(const struct krylov_system *s,
                                struct krylov_space *space, double tolerance,
                                int max_iterations, double *r,
                                double *const x[]) {
  const int64_t n = (int64_t)s->n * s->nparts;
  struct solve_stats stats = {.status = SOLVE_STALLED};
  struct progress progress = {0};
  stats.residual_before = stats.residual_after = max_residual(s, r);
  for (int k = 0;; k = (k + 1) % KRYLOV_DIRECTIONS) {
    double product[3];
    if (!isfinite(stats.residual_after)) return stats;
    const double enough = stats.iterations > 0 ? 1 : KRYLOV_GUESS;
    if (stats.residual_after <= enough * tolerance) break;
    if (stats.iterations == max_iterations) return stats;
    if (stats.iterations == 0) s->prepare(s->context);
    make_direction(s, space, k, progress.kept, r, product);
    const double a = product[0] / product[1];
    if (!isfinite(a) || a == 0) return stats;
    progress_count(&progress, product);
    if (progress.waited == KRYLOV_PATIENCE) return stats;
    for (int c = 0; c < s->nparts; c++) {
      add_to(s->n, x[c], a, space->z[k] + (int64_t)c * s->n);
    }
    add_to(n, r, -a, space->q[k]);
    stats.iterations++;
    stats.residual_after = max_residual(s, r);
  }
  stats.status = SOLVE_CONVERGED;
  return stats;
}
