/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/plane.h"

#include <math.h>

#include "cut.h"

double plane_volume(const double n[DIM], double alpha) {
  double norm = norm1(n);
  if (norm <= 0.) return clip01(alpha + 0.5);
  double a = 0.5 - fabs(alpha) / norm;
  if (a <= 0.) return alpha > 0. ? 1. : 0.;
  double m[DIM];
  sorted_components(n, norm, m);
  double v = small_volume(m, a);
  return alpha > 0. ? 1. - v : v;
}

double plane_alpha(const double n[DIM], double c) {
  double norm = norm1(n);
  c = clip01(c);
  if (norm <= 0.) return c - 0.5;
  double smaller = min2(c, 1. - c), a = 0.;
  if (smaller > 0.) {
    double m[DIM];
    sorted_components(n, norm, m);
    a = min2(small_offset(m, smaller), 0.5);
  }
  return c > 0.5 ? norm * (0.5 - a) : norm * (a - 0.5);
}

double plane_box_volume(const double n[DIM], double alpha, const double lo[DIM],
                        const double hi[DIM]) {
  double scaled[DIM];
  for (int d = 0; d < DIM; d++) {
    alpha -= n[d] * (0.5 * (lo[d] + hi[d]));
    scaled[d] = n[d] * (hi[d] - lo[d]);
  }
  return plane_volume(scaled, alpha);
}

void plane_foot(const double n[DIM], double alpha, double x[DIM]) {
  double squares = 0.;
  for (int d = 0; d < DIM; d++) squares += n[d] * n[d];
  for (int d = 0; d < DIM; d++) {
    x[d] = squares > 0. ? alpha * n[d] / squares : 0.;
  }
}
