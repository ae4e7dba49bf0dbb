/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A ball drawn into a sheet by the flow of LeVeque [leveque_1996;
 * enright_2002] and brought back: radius 0.15 at (0.35, 0.35, 0.35)
 * in the unit box, t from 0 to T = 3,
 *   u =  2 sin^2(pi x) sin(2 pi y) sin(2 pi z) cos(pi t/T)
 *   v =   -sin(2 pi x) sin^2(pi y) sin(2 pi z) cos(pi t/T)
 *   w =   -sin(2 pi x) sin(2 pi y) sin^2(pi z) cos(pi t/T).
 * Face values are its means over the faces, which is what a vector potential on
 * their edges gives. The error is the integral of |c - c_0|, absolute as in the
 * literature. At half time the sheet is thinner than a cell of these grids. */
#include "carried.h"

static const double kPi = 3.14159265358979323846, kPeriod = 3;
static struct body sphere = {{0.35, 0.35, 0.35}, 0.15};

/* Return the mean velocity of a face: that of sin(2 pi x) over h is sin(pi h) /
 * (pi h) of that in the middle.
 */
static double deformation(int d, const double x[3], double h) {
  const double mean = sin(kPi * h) / (kPi * h);
  double value = d == 0 ? 2 : -1;
  for (int e = 0; e < DIM; e++) {
    const double s = sin(kPi * x[e]);
    value *= e == d ? s * s : sin(2 * kPi * x[e]) * mean;
  }
  return value;
}

static double path(double t) { return kPeriod / kPi * sin(kPi * t / kPeriod); }

static void run(struct report *report) {
  enum { FIRST = 5, N = 2 };
  const struct carried_flow flow = {.velocity = deformation,
                                    .path = path,
                                    .turn = 0.5 * kPeriod,
                                    .end = kPeriod,
                                    .shape = ball,
                                    .context = &sphere};
  double error[2][N];
  carried_report(report, "uniform", &flow, FIRST, N, 1, NULL, error[0]);
  carried_report(report, "adapted", &flow, FIRST, N, 1, NULL, error[1]);
  for (int k = 0; k < N; k++) {
    report_at_most(report, "adapted", "|error / uniform - 1|", FIRST + k,
                   fabs(error[1][k] / error[0][k] - 1), 0.1);
  }
}

const struct convergence_case vof_deformation_case = {
    "vof_deformation", "ball in a flow that turns back", 3, false, run};
