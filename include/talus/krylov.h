/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Krylov: flexible GCR, truncated, for systems too unsymmetric for CG.
 *
 * Solves A x = b from the right, x = sum_k a_k z_k with z_k = M r_k: for each
 * iteration
 *   z = M r, q = A z; make q orthogonal to the last KRYLOV_DIRECTIONS
 *   (z follows); a = <r, q> / <q, q>; x += a z; r -= a q
 * M may change from one call to the next [eisenstat_1983]. The inner product
 * is <a, b> = sum_i w_i^2 a_i b_i with weights w given by the caller; w_i =
 * 1 / A_ii measures a residual by the correction it asks for, without which
 * coefficients that differ by 1e4 or more stop the convergence (w_i^2 =
 * 1 / A_ii: 15 % fewer iterations in a collapse with eta_max = 1e4, but discs
 * of contrast 1e6 do not converge). The test is on max |r_i / rho_i|; a guess
 * must pass it a million times better to need no iteration.
 */
#ifndef TALUS_KRYLOV_H
#define TALUS_KRYLOV_H

#include <mpi.h>
#include <stdint.h>

#include "talus/solve.h"

enum { KRYLOV_DIRECTIONS = 16, KRYLOV_PATIENCE = 12 };

/* What GCR needs to know of a system of `nparts` arrays of `n` numbers each
 * (parts are the components of a vector; they follow one another, so vectors
 * are [nparts * n]). */
struct krylov_system {
  MPI_Comm comm;
  int32_t n;
  int nparts;
  void *context;
  /* Called once before the first iteration, if there is any. It makes M and
   * the weights. Collective. */
  void (*prepare)(void *context);
  /* z = M r, a cheap approximation of A^-1 r. Collective. */
  void (*precondition)(void *context, const double *r, double *z);
  /* q = A z. Collective. */
  void (*apply)(void *context, const double *z, double *q);
  const float *weight;   /* [nparts * n] w, > 0 */
  const double *density; /* [n] rho, same for all parts; NULL: 1 */
};

struct krylov_space; /* directions, kept between solves */

struct krylov_space *krylov_space_new(void);
void krylov_space_destroy(struct krylov_space *space);
int64_t krylov_space_bytes(const struct krylov_space *space);

/* Reduce r (in: residual of x, out: of the result) until max |r/rho| <=
 * tolerance, adding to x; r [nparts * n], x[nparts] [n]. KRYLOV_PATIENCE
 * iterations that leave the norm of r almost as it was, or a NaN, end it as
 * SOLVE_STALLED; x is then the iterate of least norm. Directions are allocated
 * the first time they are needed. Collective. */
struct solve_stats krylov_solve(const struct krylov_system *system,
                                struct krylov_space *space, double tolerance,
                                int max_iterations, double *r,
                                double *const x[]);

#endif
