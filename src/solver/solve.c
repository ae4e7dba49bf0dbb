/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/solve.h"

#include <math.h>

#include "talus/minmax.h"

/* A solve that stalls passes within this many times its tolerance. */
#define SLACK 10

static bool is_worse(const struct solve_stats *a, const struct solve_stats *b) {
  const bool failed = a->status != SOLVE_CONVERGED;
  if (failed != (b->status != SOLVE_CONVERGED)) return failed;
  return isnan(a->residual_after) || a->residual_after > b->residual_after;
}

void solve_add(struct solve_stats *last, const struct solve_stats *before) {
  const int iterations = last->iterations + before->iterations;
  if (is_worse(before, last)) *last = *before;
  last->iterations = iterations;
}

bool solve_passes(const struct solve_stats *stats, double tolerance,
                  double floor) {
  return stats->status == SOLVE_CONVERGED ||
         (stats->status == SOLVE_STALLED &&
          stats->residual_after <= max2(SLACK * tolerance, floor));
}
