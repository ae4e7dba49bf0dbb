/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/ring.h"

#include <math.h>

#include "cut.h"
#include "talus/plane.h"

/* A cut reflected to n_d >= 0, seen from the corner where the grains are: where
 * the width along x_1 begins and ends to fall, and what it is there. */
struct profile {
  double from, to; /* 0 <= from <= to <= 1 */
  double high, low;
  double slope; /* of the width with alpha */
};

static struct profile profile_of(const double n[DIM], double alpha) {
  const double n0 = fabs(n[0]), n1 = fabs(n[DIM - 1]);
  const double offset = alpha + 0.5 * (n0 + n1);
  struct profile p = {0, 1, 0, 0, 0};
  if (n0 > 0) p.from = clip01((offset - n1) / n0), p.to = clip01(offset / n0);
  if (n1 > 0) {
    p.high = clip01((offset - n0 * p.from) / n1);
    p.low = clip01((offset - n0 * p.to) / n1);
    p.slope = (p.to - p.from) / n1;
  } else {
    p.slope = p.from > 0 && p.to < 1 ? 1 / n0 : 0;
  }
  if (n0 == 0) p.from = 0;
  return p;
}

/* Give volume and its derivative with alpha, for n[0] >= 0 where slant counts.
 */
static double weigh(const struct profile *p, double slant, double *slope) {
  const double length = p->to - p->from, middle = 0.5 * (p->to + p->from);
  const double area = p->from + 0.5 * length * (p->high + p->low);
  const double moment =
      0.5 * p->from * p->from +
      length / 6 *
          (p->high * (2 * p->from + p->to) + p->low * (p->from + 2 * p->to));
  *slope = p->slope * (1 + 2 * slant * (middle - 0.5));
  return clip01(area + 2 * slant * (moment - 0.5 * area));
}

static double volume_and_slope(const double n[DIM], double alpha, double slant,
                               double *slope) {
  const struct profile p = profile_of(n, alpha);
  return weigh(&p, n[0] < 0 ? -slant : slant, slope);
}

double ring_volume(const double n[DIM], double alpha, double slant) {
  double slope;
  if (slant == 0 || DIM == 3 || norm1(n) <= 0) return plane_volume(n, alpha);
  return volume_and_slope(n, alpha, slant, &slope);
}

double ring_alpha(const double n[DIM], double c, double slant) {
  enum { STEPS = 60 };
  const double norm = norm1(n), most = 0.5 * norm;
  double alpha = plane_alpha(n, c), low = -most, high = most;
  if (slant == 0 || DIM == 3 || norm <= 0) return alpha;
  if (c <= 0) return -most;
  if (c >= 1) return most;
  for (int k = 0; k < STEPS; k++) {
    double slope;
    const double excess = volume_and_slope(n, alpha, slant, &slope) - c;
    if (fabs(excess) < 2e-16) break;
    *(excess > 0 ? &high : &low) = alpha;
    const double next = slope > 0 ? alpha - excess / slope : high + 1;
    if (high - low < 1e-17 * norm) break;
    alpha = next > low && next < high ? next : 0.5 * (low + high);
  }
  return alpha;
}

double ring_box_volume(const double n[DIM], double alpha, const double lo[DIM],
                       const double hi[DIM], double slant) {
  double scaled[DIM];
  if (slant == 0 || DIM == 3) return plane_box_volume(n, alpha, lo, hi);
  for (int d = 0; d < DIM; d++) {
    alpha -= n[d] * (0.5 * (lo[d] + hi[d]));
    scaled[d] = n[d] * (hi[d] - lo[d]);
  }
  const double middle = 1 + slant * (lo[0] + hi[0]);
  if (!(middle > 0)) return plane_volume(scaled, alpha);
  return ring_volume(scaled, alpha, slant * (hi[0] - lo[0]) / middle);
}
