/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/krylov.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "talus/error.h"
#include "talus/memory.h"
#include "talus/minmax.h"

/* A guess passes only at this part of the tolerance: errors just below it, of
 * one sign, would add up from step to step. */
#define KRYLOV_GUESS 1e-6
/* A solve that begins below NEAR times its tolerance ends below that part of
 * what it began with. */
#define KRYLOV_NEAR 10
#define KRYLOV_LEFT 1e-3
/* A step that takes less than this part of <r, r> is a poor one. */
#define KRYLOV_LITTLE 0.1

struct krylov_space {
  int64_t size; /* of each direction */
  int used;     /* directions of the solve under way */
  double *z[KRYLOV_DIRECTIONS], *q[KRYLOV_DIRECTIONS]; /* NULL: never */
  double inverse[KRYLOV_DIRECTIONS];                   /* 1 / <q, q> */
  double a[KRYLOV_DIRECTIONS]; /* steps that r has made and x has not */
  double h[KRYLOV_DIRECTIONS][KRYLOV_DIRECTIONS]; /* h_jk at [k][j], j < k */
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

/* Open a space for vectors of `size` numbers. */
static void space_open(struct krylov_space *space, int64_t size) {
  space->used = 0;
  if (size <= space->size) return;
  space_clear(space);
  space->size = size;
}

static void space_take(struct krylov_space *space, int k) {
  space->a[k] = 0;
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

/* Sum of w^2 a b. */
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

/* Sum of w^2 a^2. */
static void add_squares(int64_t n, const float *w, const double *a,
                        struct lanes *restrict lanes) {
  int64_t i = 0;
  for (; i + LANES <= n; i += LANES) {
    for (int k = 0; k < LANES; k++) {
      const double v = (double)w[i + k] * a[i + k];
      lanes->sum[k] += v * v;
    }
  }
  for (int k = 0; i + k < n; k++) {
    const double v = (double)w[i + k] * a[i + k];
    lanes->sum[k] += v * v;
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

/* Return |v| as an unsigned integer: these are ordered as the absolute values,
 * and a NaN beats all. */
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

/* Return max |r/rho|; NaN if any is. */
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

/* Add f b to a. */
static void add_to(int64_t n, double *restrict a, double f,
                   const double *restrict b) {
  for (int64_t i = 0; i < n; i++) a[i] += f * b[i];
}

/* Set c_j = <v, q_j> / <q_j, q_j>, j of all directions so far. */
static void project(const struct krylov_system *s,
                    const struct krylov_space *space, double *const v[],
                    double *c) {
  struct lanes lanes[KRYLOV_DIRECTIONS] = {{{0}}};
  for (int p = 0; p < s->nparts; p++) {
    const int64_t at = (int64_t)p * s->n;
    for (int64_t i = 0; i < s->n; i += BLOCK) {
      for (int k = 0; k < space->used; k++) {
        add_products(block_size(s->n, i), s->weight + at + i, v[p] + i,
                     space->q[k] + at + i, &lanes[k]);
      }
    }
  }
  for (int j = 0; j < space->used; j++) c[j] = lanes_sum(&lanes[j]);
  sum_ranks(s, space->used, c);
  for (int j = 0; j < space->used; j++) c[j] *= space->inverse[j];
}

/* Add sign sum_j c_j d_j to v, d the z or q of all directions so far. */
static void add_all(const struct krylov_system *s,
                    const struct krylov_space *space, double *const v[],
                    double sign, const double *c,
                    double *const d[KRYLOV_DIRECTIONS]) {
  for (int p = 0; p < s->nparts; p++) {
    const int64_t at = (int64_t)p * s->n;
    for (int64_t i = 0; i < s->n; i += BLOCK) {
      for (int k = 0; k < space->used; k++) {
        add_to(block_size(s->n, i), v[p] + i, sign * c[k], d[k] + at + i);
      }
    }
  }
}

/* Make v orthogonal to the directions so far: v -= sum c_j q_j. */
static void orthogonalise(const struct krylov_system *s,
                          const struct krylov_space *space, double *const v[],
                          double *c) {
  if (space->used == 0) return;
  project(s, space, v, c);
  add_all(s, space, v, -1, c, space->q);
}

/* Store v as the q of the next direction. Leaves <r, q>, <q, q>, <r, r>. */
static void store(const struct krylov_system *s, struct krylov_space *space,
                  double *const v[], const double *r, double product[3]) {
  struct lanes lanes[3] = {{{0}}};
  for (int p = 0; p < s->nparts; p++) {
    for (int64_t i = 0; i < s->n; i += BLOCK) {
      const int64_t at = (int64_t)p * s->n + i, size = block_size(s->n, i);
      const float *w = s->weight + at;
      memcpy(space->q[space->used] + at, v[p] + i,
             (size_t)size * sizeof(double));
      add_products(size, w, r + at, v[p] + i, &lanes[0]);
      add_squares(size, w, v[p] + i, &lanes[1]);
      add_squares(size, w, r + at, &lanes[2]);
    }
  }
  for (int j = 0; j < 3; j++) product[j] = lanes_sum(&lanes[j]);
  sum_ranks(s, 3, product);
  space->inverse[space->used] = 1 / product[1];
}

/* Make the next direction, for r of size max |r/rho|: precondition, apply, make
 * orthogonal to those before it. Leaves <r, q>, <q, q>, <r, r>. */
static void make_direction(const struct krylov_system *s,
                           struct krylov_space *space, const double *r,
                           double size, double product[3]) {
  const int k = space->used;
  double *q[KRYLOV_PARTS];
  space_take(space, k);
  s->precondition(s->context, r, size, space->z[k]);
  s->apply(s->context, space->z[k], q);
  orthogonalise(s, space, q, space->h[k]);
  store(s, space, q, r, product);
}

/* Find y, the steps along z that a are along directions made orthogonal. */
static void find_steps(const struct krylov_space *space, double *y) {
  memcpy(y, space->a, (size_t)space->used * sizeof *y);
  for (int k = space->used - 1; k > 0; k--) {
    for (int j = 0; j < k; j++) y[j] -= space->h[k][j] * y[k];
  }
}

/* Where an iteration stands. */
struct progress {
  double size;      /* max |r/rho| */
  int waited;       /* iterations since <r, r> was halved */
  double reference; /* <r, r> then, 0: none yet */
};

static void progress_count(struct progress *p, double rr) {
  const bool halved = p->reference == 0 || rr < 0.5 * p->reference;
  p->waited = halved ? 0 : p->waited + 1;
  if (halved) p->reference = rr;
}

/* Let x follow r and forget the directions. */
static void restart(const struct krylov_system *s, struct krylov_space *space,
                    double *const x[]) {
  double y[KRYLOV_DIRECTIONS];
  find_steps(space, y);
  add_all(s, space, x, 1, y, space->z);
  space->used = 0;
}

/* Subtract a q from r along the next direction. Where that is little gain, what
 * rounding has left of r along old directions may be in the way, which new
 * ones, orthogonal to them, cannot remove: r is made orthogonal to all again.
 */
static void step(const struct krylov_system *s, struct krylov_space *space,
                 struct progress *p, const double product[3], double *r) {
  const int k = space->used++;
  const double a = product[0] / product[1];
  double *part[KRYLOV_PARTS], c[KRYLOV_DIRECTIONS];
  add_to((int64_t)s->n * s->nparts, r, -a, space->q[k]);
  space->a[k] = a;
  if (a * product[0] < KRYLOV_LITTLE * product[2]) {
    for (int e = 0; e < s->nparts; e++) part[e] = r + (int64_t)e * s->n;
    orthogonalise(s, space, part, c);
    for (int j = 0; j <= k; j++) space->a[j] += c[j];
  }
  p->size = max_residual(s, r);
}

/* Make one iteration; returns false if it leads nowhere. */
static bool iterate(const struct krylov_system *s, struct krylov_space *space,
                    struct progress *p, double *r, double *const x[]) {
  double product[3];
  if (space->used == KRYLOV_DIRECTIONS) restart(s, space, x);
  make_direction(s, space, r, p->size, product);
  if (!isfinite(product[0] / product[1]) || product[0] == 0) return false;
  progress_count(p, product[2]);
  step(s, space, p, product, r);
  return true;
}

/* Is r as small as it must be (krylov.h)? Where it began near the tolerance,
 * round-off that two iterations cannot halve is small enough. */
static bool is_done(const struct progress *p, const struct solve_stats *stats,
                    double tolerance) {
  const double size = p->size, guess = KRYLOV_GUESS * tolerance;
  const double before = stats->residual_before;
  if (stats->iterations == 0) return size <= guess;
  if (size > tolerance) return false;
  return before > KRYLOV_NEAR * tolerance || p->waited >= 2 ||
         size <= max2(guess, KRYLOV_LEFT * before);
}

struct solve_stats krylov_solve(const struct krylov_system *s,
                                struct krylov_space *space, double tolerance,
                                int max_iterations, double *r,
                                double *const x[]) {
  struct solve_stats stats = {.status = SOLVE_STALLED};
  struct progress p = {0};
  p.size = max_residual(s, r);
  stats.residual_before = p.size;
  space_open(space, (int64_t)s->n * s->nparts);
  for (;;) {
    stats.residual_after = p.size;
    if (!isfinite(p.size)) return stats;
    if (is_done(&p, &stats, tolerance)) {
      stats.status = SOLVE_CONVERGED;
      break;
    }
    if (stats.iterations == max_iterations) break;
    if (stats.iterations == 0) s->prepare(s->context);
    if (p.waited == KRYLOV_PATIENCE) break;
    if (iterate(s, space, &p, r, x)) {
      stats.iterations++;
    } else {
      p.waited = KRYLOV_PATIENCE;
    }
  }
  if (stats.iterations > 0 && p.size <= tolerance) {
    stats.status = SOLVE_CONVERGED;
  }
  restart(s, space, x);
  return stats;
}
