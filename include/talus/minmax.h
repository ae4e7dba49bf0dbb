/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Smaller and larger of two numbers, and minmod, inline: fmin and fmax of C are
 * calls, as they must tell NaN from numbers. Here a NaN in b is passed over, so
 * that most = max2(most, value) is the largest of the numbers among the values;
 * a NaN in a stays. */
#ifndef TALUS_MINMAX_H
#define TALUS_MINMAX_H

#include <math.h>

static inline double min2(double a, double b) { return b < a ? b : a; }

static inline double max2(double a, double b) { return b > a ? b : a; }

/* Return the smaller of a and b by size if they have one sign, else 0: a slope
 * that lets a line between neighbours pass none of them. */
static inline double minmod(double a, double b) {
  if (!(a * b > 0)) return 0;
  return fabs(a) < fabs(b) ? a : b;
}

#endif
