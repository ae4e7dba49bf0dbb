/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * The smaller of the two parts into which a plane cuts a cell, reflected to
 * m_d >= 0 and sorted: m and a of plane.h, equation (2). Shared by plane.c and
 * plane_normal.c, inline because it is called for each cell of a stencil.
 */
#ifndef TALUS_GEOMETRY_CUT_H
#define TALUS_GEOMETRY_CUT_H

#include <math.h>
#include <stdbool.h>

#include "talus/minmax.h"

/* The smaller side of a cut, reflected and sorted: plane.h, above eq. (2). */
struct cut {
  double m[DIM];  /* |n_d|/|n|_1, ascending */
  int place[DIM]; /* |n_d|/|n|_1 = m[place[d]] */
  double norm;    /* |n|_1 */
};

static inline double positive(double a) { return a > 0. ? a : 0.; }

static inline double clip01(double a) { return min2(positive(a), 1.); }

static inline double norm1(const double n[DIM]) {
  double sum = 0.;
  for (int d = 0; d < DIM; d++) sum += fabs(n[d]);
  return sum;
}

/* Write |n_d|/norm into m, in ascending order. */
static inline void sorted_components(const double n[DIM], double norm,
                                     double m[DIM]) {
#if DIM == 2
  double a = fabs(n[0]) / norm, b = fabs(n[1]) / norm;
  m[0] = min2(a, b);
  m[1] = max2(a, b);
#else
  double a = fabs(n[0]) / norm, b = fabs(n[1]) / norm, c = fabs(n[2]) / norm;
  double low = min2(a, b), high = max2(a, b);
  m[0] = min2(low, c);
  m[1] = max2(low, min2(high, c));
  m[2] = max2(high, c);
#endif
}

#if DIM == 2

/* Evaluate equation (2) for 0 <= a <= 1/2. */
static inline double small_volume(const double m[2], double a) {
  if (a < m[0]) return a / m[0] * a / (2. * m[1]);
  return (a - 0.5 * m[0]) / m[1];
}

/* Return the derivative dV/da of small_volume. */
static inline double small_slope(const double m[2], double a) {
  return a < m[0] ? a / m[0] / m[1] : 1. / m[1];
}

/* Return the inverse of small_volume for 0 < c <= 1/2. */
static inline double small_offset(const double m[2], double c) {
  if (c * 2. * m[1] < m[0]) return sqrt(2. * m[0] * m[1] * c);
  return c * m[1] + 0.5 * m[0];
}

/* Find the centroid y of the cut in the unit square with its corner on the
 * origin. */
static inline void small_centroid(const double m[2], double a, double y[2]) {
  if (a < m[0]) {
    y[0] = 0.5 * a / m[0];
    y[1] = 0.5 * a / m[1];
  } else {
    y[0] = 0.5;
    y[1] = (a - 0.5 * m[0]) / m[1];
  }
}

#else

/*
 * Pieces of equation (2), DIM = 3, m1 <= m2 <= m3, m12 = m1 + m2:
 *   triangle       a < m1
 *   quadrilateral  m1 <= a < m2
 *   its corners cut off where a > m2 and a > m3 (a < m12)
 *   linear         m12 <= a
 * With t_i = <a - m_i>/m1, which lies in [0, 1] for a < m12, the cut corner i
 * takes m1^2 t_i^3/(6 m2 m3) from the volume.
 */

/* Evaluate equation (2) for 0 <= a <= 1/2. */
static inline double small_volume(const double m[3], double a) {
  if (a < m[0]) return a / m[0] * (a / m[1]) * a / (6. * m[2]);
  double m12 = m[0] + m[1];
  if (a >= m12) return (a - 0.5 * m12) / m[2];
  double v = 3. * a * (a - m[0]) + m[0] * m[0];
  if (a > m[1]) {
    double b2 = a - m[1], b3 = positive(a - m[2]);
    v -= (b2 * b2 * b2 + b3 * b3 * b3) / m[0];
  }
  return v / (6. * m[1] * m[2]);
}

/* Return the derivative dV/da of small_volume. */
static inline double small_slope(const double m[3], double a) {
  if (a < m[0]) return a / m[0] * (a / m[1]) / (2. * m[2]);
  if (a >= m[0] + m[1]) return 1. / m[2];
  double v = 2. * a - m[0];
  if (a > m[1]) {
    double b2 = a - m[1], b3 = positive(a - m[2]);
    v -= (b2 * b2 + b3 * b3) / m[0];
  }
  return v / (2. * m[1] * m[2]);
}

/* Return the root z = -2 r sin(phi) of z^3 - 3 r^2 z = 2 r^3 sin(3 phi). */
static inline double cubic_root(double r, double sin3phi) {
  return -2. * r * sin(asin(min2(sin3phi, 1.)) / 3.);
}

/* Return the inverse of small_volume for 0 < c <= 1/2. */
static inline double small_offset(const double m[3], double c) {
  double m12 = m[0] + m[1], gap = m12 - m[2];
  if (m[1] <= 0. || (gap <= 0. && 2. * c * m[2] >= m12))
    return c * m[2] + 0.5 * m12;
  double v1 = m[0] * m[0] / (6. * m[1] * m[2]);
  if (c < v1) return cbrt(6. * m[0] * m[1] * m[2] * c);
  if (2. * m[2] * (c - v1) < m[1] - m[0])
    return 0.5 * (m[0] + sqrt(m[0] * m[0] + 8. * m[1] * m[2] * (c - v1)));
  /* Hexagon, a > m3. Then m12 > m3, and about a = 1/2 + z equation (2) reads
   * z^3 - 3/4 (4 m1 m2 - gap^2) z = 3 m1 m2 m3 (1/2 - c). */
  if (gap > 0. && c > small_volume(m, m[2])) {
    double r = 0.5 * sqrt(4. * m[0] * m[1] - gap * gap);
    double r3 = r * r * r;
    return 0.5 + cubic_root(r, 1.5 * m[0] * m[1] * m[2] * (0.5 - c) / r3);
  }
  /* Pentagon, m2 < a < min(m12, m3). About a = m12 + z equation (2) reads
   * z^3 - 6 m1 m2 z = 3 m1 m2 (m12 - 2 m3 c). */
  double r = sqrt(2. * m[0] * m[1]);
  return m12 + cubic_root(r, 0.75 * (m12 - 2. * m[2] * c) / r);
}

/*
 * Find the centroid y of the cut in the unit cube with its corner on the
 * origin: the centroid of its shadow on (y1, y2), then y3 from the plane. m3 >=
 * 1/3.
 */
static inline void small_centroid(const double m[3], double a, double y[3]) {
  if (a < m[0]) {
    for (int d = 0; d < 3; d++) y[d] = a / (3. * m[d]);
    return;
  }
  y[0] = y[1] = 0.5;
  if (a < m[0] + m[1]) {
    /* Moments of 0 < y2 < (a - m1 y1)/m2, times 2 m2, less the cut corners. */
    double area = 2. * a - m[0];
    double s1 = a - 2. / 3. * m[0];
    double s2 = (a * (a - m[0]) + m[0] * m[0] / 3.) / m[1];
    if (a > m[1]) {
      double b2 = a - m[1], b3 = positive(a - m[2]);
      double t2 = b2 / m[0], t3 = b3 / m[0];
      area -= b2 * t2 + b3 * t3;
      s1 -= (b2 * t2 * t2 + b3 * t3 * t3) / 3.;
      s2 -= b2 * t2 * (1. + b2 / (3. * m[1])) + b3 * t3 * b3 / (3. * m[1]);
    }
    y[0] = s1 / area;
    y[1] = s2 / area;
  }
  y[2] = (a - m[0] * y[0] - m[1] * y[1]) / m[2];
}

#endif

/* Sort as sorted_components, and remember where each component went. */
static inline struct cut cut_sorted(const double n[DIM], double norm) {
  struct cut cut = {.norm = norm};
  double m[DIM];
  for (int d = 0; d < DIM; d++) m[d] = fabs(n[d]) / norm;
  for (int d = 0; d < DIM; d++) {
    int place = 0;
    for (int e = 0; e < DIM; e++) place += e < d ? m[e] <= m[d] : m[e] < m[d];
    cut.place[d] = place;
    cut.m[place] = m[d];
  }
  return cut;
}

/*
 * Find the centroid x of the cut of the plane n . x = alpha, in the cell's own
 * coordinates. cut is that of n; cut->norm > 0.
 */
static inline void cut_centroid(const struct cut *cut, const double n[DIM],
                                double alpha, double x[DIM]) {
  double y[DIM];
  /* 1e-100 stands for the limit a -> 0 and has a square that is not 0 */
  small_centroid(cut->m, max2(0.5 - fabs(alpha) / cut->norm, 1e-100), y);
  for (int d = 0; d < DIM; d++) {
    bool mirrored = (n[d] < 0.) != (alpha > 0.);
    x[d] = mirrored ? 0.5 - y[cut->place[d]] : y[cut->place[d]] - 0.5;
  }
}

#endif
