/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Examples in which a column collapses, carried to a time and measured. */
#ifndef TALUS_TESTS_COLLAPSES_H
#define TALUS_TESTS_COLLAPSES_H

#include <math.h>

#include "runs.h"
#include "talus/two_phase/fractions.h"
#include "talus/two_phase/measure.h"

/* Carry an example to a time and measure. */
static inline bool measure_at(struct example *example, double time,
                              struct diagnostics *d) {
  const bool good = run_to(example->sim, time);
  fractions_synchronise(example->sim);
  diagnostics_measure(example->sim, d);
  fractions_desynchronise(example->sim);
  return good;
}

/* Report run-out and height of an example over `base` at a time, for n values
 * of a parameter. */
static inline void sweep(const char *name, const char *more, double stop,
                         double base, const char *parameter, int n,
                         const double *value, double *runout, double *height) {
  for (int k = 0; k < n; k++) {
    struct diagnostics d;
    struct example example =
        example_new(name, "%s=%g %s", parameter, value[k], more);
    const bool good = measure_at(&example, stop, &d);
    runout[k] = good ? d.front / base - 1 : NAN;
    height[k] = good ? d.height / base : NAN;
    diagnostics_free(&d);
    example_destroy(&example);
  }
}

#endif
