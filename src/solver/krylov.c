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
 * is fixed. */
enum { LANES = 8 };

static double weighted_product(int64_t n, const double *w, const double *a,
                               const double *b) {
  double lane[LANES] = {0}, sum = 0;
  int64_t i = 0;
  for (; i + LANES <= n; i += LANES) {
    for (int k = 0; k < LANES; k++) lane[k] += w[i + k] * a[i + k] * b[i + k];
  }
  for (; i < n; i++) sum += w[i] * a[i] * b[i];
  for (int k = 0; k < LANES; k++) sum += lane[k];
  return sum;
}

/* As unsigned integers, absolute values are ordered and a NaN beats all. */
static inline uint64_t ordered(double v) {
  uint64_t bits;
  v = fabs(v);
  memcpy(&bits, &v, sizeof bits);
  return bits;
}

static uint64_t max_product(int32_t n, const double *scale, const double *v) {
  uint64_t lane[LANES] = {0}, most = 0;
  int32_t i = 0;
  for (; i + LANES <= n; i += LANES) {
    for (int k = 0; k < LANES; k++) {
      const uint64_t a = ordered(scale ? scale[i + k] * v[i + k] : v[i + k]);
      lane[k] = a > lane[k] ? a : lane[k];
    }
  }
  for (; i < n; i++) {
    const uint64_t a = ordered(scale ? scale[i] * v[i] : v[i]);
    most = a > most ? a : most;
  }
  for (int k = 0; k < LANES; k++) most = lane[k] > most ? lane[k] : most;
  return most;
}

/* max |t r|; NaN if any is. */
static double max_residual(const struct krylov_system *s, const double *r) {
  uint64_t most = 0;
  for (int c = 0; c < s->nparts; c++) {
    const uint64_t a = max_product(s->n, s->scale, r + (int64_t)c * s->n);
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

/* Make direction k orthogonal to the `kept` others before it. */
static void orthogonalise(const struct krylov_system *s,
                          struct krylov_space *space, int k, int kept) {
  const int64_t n = (int64_t)s->n * s->nparts;
  double product[KRYLOV_DIRECTIONS];
  if (kept == 0) return;
  for (int j = 0; j < kept; j++) {
    const int other = (k + KRYLOV_DIRECTIONS - 1 - j) % KRYLOV_DIRECTIONS;
    product[j] = weighted_product(n, s->weight, space->q[k], space->q[other]);
  }
  sum_ranks(s, kept, product);
  for (int j = 0; j < kept; j++) {
    const int other = (k + KRYLOV_DIRECTIONS - 1 - j) % KRYLOV_DIRECTIONS;
    const double a = -product[j] * space->inverse[other];
    add_to(n, space->q[k], a, space->q[other]);
    add_to(n, space->z[k], a, space->z[other]);
  }
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
  product[0] = weighted_product(n, s->weight, r, q);
  product[1] = weighted_product(n, s->weight, q, q);
  product[2] = weighted_product(n, s->weight, r, r);
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
