/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Krylov: flexible GCR, restarted, for systems too unsymmetric for CG.
 *
 * Solves A x = b from the right: for each iteration k
 *   z_k = M r, q_k = A z_k - sum_(j < k) h_jk q_j, h_jk = <A z_k, q_j> /
 *   <q_j, q_j>; a_k = <r, q_k> / <q_k, q_k>; r -= a_k q_k
 * and at the end, or when there are KRYLOV_DIRECTIONS,
 *   y_j = a_j - sum_(k > j) h_jk y_k, the last first; x += sum_k y_k z_k.
 * M may change from one call to the next [eisenstat_1983]. The inner product
 * is <a, b> = sum_i w_i^2 a_i b_i with weights w given by the caller; w_i =
 * 1 / A_ii measures a residual by the correction it asks for, without which
 * coefficients that differ by 1e4 or more stop the convergence (w_i^2 =
 * 1 / A_ii: 15 % fewer iterations in a collapse with eta_max = 1e4, but discs
 * of contrast 1e6 do not converge). The test is on max |r_i / rho_i|; a guess
 * must pass it a million times better to need no iteration, and one that passes
 * it, or nearly, is made a thousand times better: weights let max |r/rho| of a
 * light phase grow while <r, r> falls, and what one iteration leaves, always
 * below the tolerance, grew tenfold from step to step where density jumps by
 * 1e5 (mu(I) at rest, gas 1e6 times lighter: 4e-6 m/s, now 2e-10; a collapse
 * takes 522 pressure iterations in place of 521). Where an iteration
 * gains little, r is made orthogonal to all q_j again: what rounding leaves of
 * it there is out of reach of new directions.
 *
 * z and q are stored as floats, all else is double. z is rounded before A is
 * applied, so that it is exact; made orthogonal like q it would not be, and
 * where a stiff body moves, A times what rounding does to z is larger than r.
 * Rounding q makes r wrong by at most
 *   lost = 2^-24 sum_k |y_k| max |q_k / rho|,
 * which is added to max |r/rho| in the test. Where lost is more than half the
 * tolerance and r as small as lost, r = b - A x is computed again and the
 * iteration starts anew from there. Where that does not do, as r has grown at
 * first (stiff bodies) or is not reduced, numbers of directions become the sum
 * of two floats, 48 bits, for the rest of the solve. (With floats alone discs
 * of contrast 1e6 and more stall.)
 */
#ifndef TALUS_KRYLOV_H
#define TALUS_KRYLOV_H

#include <mpi.h>
#include <stdint.h>

#include "talus/solve.h"

enum { KRYLOV_DIRECTIONS = 32, KRYLOV_PATIENCE = 12, KRYLOV_PARTS = 3 };

/* What GCR needs to know of a system of `nparts` arrays of `n` numbers each
 * (parts are the components of a vector; they follow one another, so vectors
 * are [nparts * n], nparts <= KRYLOV_PARTS). */
struct krylov_system {
  MPI_Comm comm;
  int32_t n;
  int nparts;
  void *context;
  /* Called once before the first iteration, if there is any. It makes M and
   * the weights. Collective. */
  void (*prepare)(void *context);
  /* z = M r / size, M a cheap approximation of A^-1, size = max |r/rho|: a
   * float's range is z's alone. z[0] is rounded; z[1] what that misses, unless
   * it is NULL. Collective. */
  void (*precondition)(void *context, const double *r, double size,
                       float *const z[2]);
  /* q[part] = A z, [n], in work space of the system's that may be written to
   * and lasts until the next call of any of these. Collective. */
  void (*apply)(void *context, float *const z[2], double *q[KRYLOV_PARTS]);
  /* r = b - A x, x as given to krylov_solve. Collective. */
  void (*residual)(void *context, double *const x[], double *r);
  const float *weight;   /* [nparts * n] w, > 0 */
  const double *density; /* [n] rho, same for all parts; NULL: 1 */
};

/* Set v [n] to n numbers of a direction from number `at` on. */
static inline void krylov_direction(int32_t n, int64_t at, float *const z[2],
                                    double *v) {
  for (int32_t i = 0; i < n; i++) v[i] = (double)z[0][at + i];
  if (!z[1]) return;
  for (int32_t i = 0; i < n; i++) v[i] += (double)z[1][at + i];
}

struct krylov_space; /* directions, kept between solves */

struct krylov_space *krylov_space_new(void);
void krylov_space_destroy(struct krylov_space *space);

/* Reduce r (in: residual of x, out: of the result) until max |r/rho| <=
 * tolerance, adding to x; r [nparts * n], x[nparts] [n]. KRYLOV_PATIENCE
 * iterations that leave the norm of r almost as it was, or a NaN, end it as
 * SOLVE_STALLED; x is then the iterate of least norm, or an earlier one that
 * was finite. Directions are allocated the first time they are needed.
 * Collective. */
struct solve_stats krylov_solve(const struct krylov_system *system,
                                struct krylov_space *space, double tolerance,
                                int max_iterations, double *r,
                                double *const x[]);

#endif
