/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Level sets of simple bodies, positive inside, in the unit of x. */
#ifndef TALUS_TESTS_LEVEL_SETS_H
#define TALUS_TESTS_LEVEL_SETS_H

#include <math.h>

/* Return the distance to the nearest face of the box lo[d] < x[d] < hi[d], d <
 * DIM, inside; minus the largest overshoot outside. Bounds may be infinite, but
 * not all of them. */
static inline double level_set_box(const double lo[DIM], const double hi[DIM],
                                   const double x[DIM]) {
  double nearest = INFINITY;
  for (int d = 0; d < DIM; d++) {
    nearest = fmin(nearest, fmin(x[d] - lo[d], hi[d] - x[d]));
  }
  return nearest;
}

/* Return the radius of a ball less the distance to its centre. */
static inline double level_set_ball(const double centre[DIM], double radius,
                                    const double x[DIM]) {
  double square = 0;
  for (int d = 0; d < DIM; d++) {
    square += (x[d] - centre[d]) * (x[d] - centre[d]);
  }
  return radius - sqrt(square);
}

#endif
