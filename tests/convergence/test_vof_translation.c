/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A disc of radius 0.2 and a square of edge 0.3 go once around a periodic unit
 * box along its diagonal, u = (1, 1), by the sweeps of [weymouth_yue_2010].
 * Exact: they are where they began. The error is the integral of |c - c_0| over
 * the area of the shape; the disc's is of second order, the square's of first,
 * as its corners are rounded over a few cells. */
#include "carried.h"

static struct body disc = {{0.52, 0.47}, 0.2}, square = {{0.52, 0.47}, 0.15};

static double along_diagonal(int d, const double x[3], double h) {
  (void)d, (void)x, (void)h;
  return 1;
}

static void run(struct report *report) {
  enum { FIRST = 5, N = 4 };
  static const char *const grid[2][2] = {{"disc uniform", "disc adapted"},
                                         {"square uniform", "square adapted"}};
  double error[N];
  for (int shape = 0; shape < 2; shape++) {
    struct body *body = shape ? &square : &disc;
    const double area = shape ? 0.3 * 0.3 : acos(-1) * 0.2 * 0.2;
    const struct carried_flow flow = {.velocity = along_diagonal,
                                      .end = 1,
                                      .shape = shape ? cube : ball,
                                      .context = body};
    for (int adapted = 0; adapted < 2; adapted++) {
      carried_report(report, grid[shape][adapted], &flow, FIRST, N, area, NULL,
                     error);
    }
  }
}

const struct convergence_case vof_translation_case = {
    "vof_translation", "disc and square once around a periodic box", 2, true,
    run};
