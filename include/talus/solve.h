/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Result of a linear solve: non-convergence is a result, not an abort. */
#ifndef TALUS_SOLVE_H
#define TALUS_SOLVE_H

enum solve_status { SOLVE_CONVERGED, SOLVE_STALLED, SOLVE_INCOMPATIBLE };

struct solve_stats {
  int iterations;
  double residual_before, residual_after; /* max norm, in the units of the
                                              tolerance */
  enum solve_status status;
};

#endif
