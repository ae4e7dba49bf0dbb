/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/roots.h"

#include <gsl/gsl_errno.h>
#include <gsl/gsl_roots.h>
#include <math.h>
#include <stdbool.h>

#include "talus/error.h"
#include "talus/rheology.h"

static void end_with_words(const char *reason, const char *file, int line,
                           int code) {
  FATAL("GSL: %s (%s, %s:%d)", reason, gsl_strerror(code), file, line);
}

void rheology_begin(void) { gsl_set_error_handler(end_with_words); }

double root_between(double (*f)(double, void *), void *context, double low,
                    double high) {
  gsl_function function = {f, context};
  const double f_low = f(low, context), f_high = f(high, context);
  if (low >= high || f_low == 0 || f_high == 0 || (f_low > 0) == (f_high > 0))
    return fabs(f_low) < fabs(f_high) ? low : high;
  gsl_root_fsolver *solver = gsl_root_fsolver_alloc(gsl_root_fsolver_brent);
  gsl_root_fsolver_set(solver, &function, low, high);
  double root = low;
  for (int i = 0; i < 200 && high - low > 4e-16 * fabs(high); i++) {
    gsl_root_fsolver_iterate(solver);
    root = gsl_root_fsolver_root(solver);
    low = gsl_root_fsolver_x_lower(solver);
    high = gsl_root_fsolver_x_upper(solver);
    if (f(root, context) == 0) break;
  }
  gsl_root_fsolver_free(solver);
  return root;
}

double root_of_rising(double (*f)(double x, double *slope, const void *context),
                      const void *context, double target, double low,
                      double guess) {
  enum { MOST = 200 };
  double high = INFINITY, x = fmax(low, guess);
  for (int k = 0; k < MOST; k++) {
    double slope;
    const double value = f(x, &slope, context), miss = value - target;
    if (miss > 0) high = x;
    if (miss < 0) low = x;
    /* in ln f, which tames poles: from far above the plain method comes nearer
     * to one of fifth order by a sixth each time */
    const double step = value > 2 * target && target > 0
                            ? value * (log(value) - log(target))
                            : miss;
    const bool moves = fabs(step) < slope * (x + 1);
    double next = moves ? x - step / slope : INFINITY;
    if (fabs(next - x) <= 1e-14 * x || miss == 0) return moves ? next : x;
    if (!(next > low && next < high))
      next = isinf(high) ? 2 * x + 1 : 0.5 * (low + high);
    x = next;
  }
  return x;
}
