/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The slotted disc of [zalesak_1979]: radius 0.15 at (0.5, 0.75) in the unit
 * box, a slot 0.05 wide and 0.25 deep from below, turned once about the middle
 * of the box as a rigid body, 2 pi per unit of time. Exact: it is where it
 * began. The error is the integral of |c - c_0| over the disc's area. */
#include "carried.h"

static const double kPi = 3.14159265358979323846;
static const double kCentre[] = {0.5, 0.75, 0}, kRadius = 0.15;

/* Return the level set of the disc; the slot ends 0.1 above the centre, on a
 * circle's chord from below. */
static double slotted_disc(void *context, const double x[3]) {
  static const double lo[] = {0.475, 0.5, 0}, hi[] = {0.525, 0.85, 0};
  (void)context;
  return fmin(level_set_ball(kCentre, kRadius, x), -level_set_box(lo, hi, x));
}

/* Return u = 2 pi (1/2 - y), v = 2 pi (x - 1/2), constant along faces. */
static double turning(int d, const double x[3], double h) {
  (void)h;
  return 2 * kPi * (d == 0 ? 0.5 - x[1] : x[0] - 0.5);
}

static void run(struct report *report) {
  enum { FIRST = 5, N = 4 };
  const struct carried_flow flow = {
      .velocity = turning, .end = 1, .shape = slotted_disc};
  const double area = kPi * kRadius * kRadius;
  double error[N];
  carried_report(report, "uniform", &flow, FIRST, N, area, NULL, error);
  carried_report(report, "adapted", &flow, FIRST, N, area, NULL, error);
}

const struct convergence_case vof_zalesak_case = {
    "vof_zalesak", "slotted disc turned once", 2, true, run};
