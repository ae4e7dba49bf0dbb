/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Krylov: flexible GCR, restarted, for systems too unsymmetric for CG.
 *
 * A x = b is solved with a preconditioner M from the right [eisenstat_1983].
 * Iteration k makes a direction z_k, its image q_k, and a step along them:
 *   z_k = M r
 *   q_k = A z_k - sum_(j < k) h_jk q_j,   h_jk = <A z_k, q_j> / <q_j, q_j>
 *   r  -= a_k q_k,                        a_k  = <r, q_k> / <q_k, q_k>
 * After KRYLOV_DIRECTIONS iterations, and at the end, x follows r:
 *   x += sum_k y_k z_k,   y_j = a_j - sum_(k > j) h_jk y_k, the last first.
 * M may change from one iteration to the next.
 *
 * Inner product. <a, b> = sum_i w_i^2 a_i b_i, the weights w being given by the
 * caller. w_i = 1 / A_ii measures a residual by the correction that it asks
 * for; without it coefficients that differ by 1e4 or more stop the convergence.
 *
 * End. A solve ends where max |r_i / rho_i| is below the tolerance. Two rules
 * keep errors of one sign from adding up over time steps: a guess needs no
 * iteration only if it is a million times better than that, and a guess that is
 * nearly good enough is made a thousand times better. Where one iteration gains
 * little, r is made orthogonal to all q_j once more, as what rounding leaves of
 * r along them is out of reach of new directions.
 *
 * docs/notes/solver.md has the trials.
 */
#ifndef TALUS_KRYLOV_H
#define TALUS_KRYLOV_H

#include <mpi.h>
#include <stdint.h>

#include "talus/solve.h"

enum { KRYLOV_DIRECTIONS = 32, KRYLOV_PATIENCE = 12, KRYLOV_PARTS = 3 };

/* A system of `nparts` arrays of `n` numbers each, as GCR sees it
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
  /* z = M r, M a cheap approximation of A^-1, size = max |r/rho|. Collective.
   */
  void (*precondition)(void *context, const double *r, double size, double *z);
  /* q[part] = A z, [n], in work space of the system's that may be written to
   * and lasts until the next call of any of these. Collective. */
  void (*apply)(void *context, const double *z, double *q[KRYLOV_PARTS]);
  const float *weight;   /* [nparts * n] w, > 0 */
  const double *density; /* [n] rho, same for all parts; NULL: 1 */
};

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
