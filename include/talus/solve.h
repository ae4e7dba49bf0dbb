/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Result of a linear solve: non-convergence is a result, not an abort. */
#ifndef TALUS_SOLVE_H
#define TALUS_SOLVE_H

#include <stdbool.h>

enum solve_status { SOLVE_CONVERGED, SOLVE_STALLED, SOLVE_INCOMPATIBLE };

struct solve_stats {
  int iterations;
  double residual_before, residual_after; /* max norm, in the units of the
                                              tolerance */
  enum solve_status status;
};

/* Add an earlier solve of the step to the last one: the iterations of both, and
 * the worse result, as a repetition that converges must not hide one that did
 * not. */
void solve_add(struct solve_stats *last, const struct solve_stats *before);
/* Is a solve good enough? One that has stalled is with a residual of ten times
 * the tolerance, or of `floor`, where round-off may be. */
bool solve_passes(const struct solve_stats *stats, double tolerance,
                  double floor);

#endif
