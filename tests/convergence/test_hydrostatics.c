/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A bed at rest under gravity normal to its surface, a thousand times denser
 * than the gas above it, in a closed unit box with slip walls, for 1000 steps
 * with solvers to 1e-12. Exact: u = 0, p = rho g (depth). Flat beds cut the
 * cells anywhere, tilted ones at any slope; on one level, and with a rectangle
 * of finer cells whose sides the surface crosses. Velocities are in units of
 * sqrt(g H), H = 0.53 the depth below the middle of the box.
 */
#include "report.h"
#include "runs.h"

enum { FIRST = 4, N = 3, STEPS = 1000 };
static const double kDepth = 0.53, kStep = 0.05;
static const double kRoundOff = 1e-10, kTolerance = 1e-12;

/* Downwards, and a point of the surface. */
struct bed {
  double down[3];
};
static double inside(void *context, const double x[3]) {
  const double *down = ((const struct bed *)context)->down;
  return down[0] * (x[0] - 0.5) + down[1] * (x[1] - kDepth);
}

/* Ask for the finest level in [0.3, 0.6] x [0, 1]: the surface of any bed
 * passes in and out. */
static double strip(void *context, const double x[3]) {
  const int level = *(const int *)context;
  return x[0] > 0.3 && x[0] < 0.6 ? level : level - 1;
}

/* Measure the largest |u| in the first half of the steps and in the second. */
static void rest(int level, bool adapted, struct bed *bed, double most[2]) {
  struct params params = box_params(level);
  params.shape = (struct function){inside, bed};
  params.tolerance_pressure = params.tolerance_viscous = kTolerance;
  for (int d = 0; d < 2; d++) params.gravity[d] = bed->down[d];
  if (adapted) {
    params.level_min = level - 1;
    params.criterion[params.ncriteria++] =
        (struct criterion){.type = CRITERION_FUNCTION,
                           .level = level,
                           .function = {strip, &params.level_max}};
  }
  struct two_phase *sim = sim_start(&params);
  bool good = true;
  most[0] = most[1] = 0;
  for (int k = 0; k < STEPS && good; k++) {
    good = step_advance(sim, kStep) == EXIT_DONE;
    double *half = &most[2 * k / STEPS];
    *half = larger(*half, largest(sim, sim->u) / sqrt(kDepth));
  }
  two_phase_destroy(sim);
  if (!good) most[0] = most[1] = NAN;
}

/* Report the speed of a bed: first order in h, or at round-off; and no growth:
 * round-off wanders by a factor of two, what grows from step to step gains
 * more. */
static void run_bed(struct report *report, const char *grid, bool adapted,
                    double slope, double bar) {
  struct bed bed = {{slope / hypot(1, slope), -1 / hypot(1, slope)}};
  const double bars[N] = {bar, bar, bar};
  double most[N][2], error[N];
  for (int k = 0; k < N; k++) {
    rest(FIRST + k, adapted, &bed, most[k]);
    error[k] = larger(most[k][0], most[k][1]);
  }
  report_errors(report, grid, "max |u|", FIRST, N, error, bars,
                error[N - 1] > kRoundOff ? 1 : 0);
  for (int k = 0; k < N; k++) {
    report_at_most(report, grid, "its second 500 steps", FIRST + k, most[k][1],
                   fmax(2 * most[k][0], kTolerance));
  }
}

static void run(struct report *report) {
  run_bed(report, "flat uniform", false, 0, kRoundOff);
  run_bed(report, "flat adapted", true, 0, 1e-3);
  run_bed(report, "slope 0.2 uniform", false, 0.2, 1e-3);
  run_bed(report, "slope 0.2 adapted", true, 0.2, 1e-3);
  run_bed(report, "slope 0.7 uniform", false, 0.7, 1e-3);
  run_bed(report, "slope 0.7 adapted", true, 0.7, 1e-3);
  run_bed(report, "slope 1 adapted", true, 1, 1e-3);
}

const struct convergence_case hydrostatics_case = {
    "hydrostatics", "beds at rest, flat and tilted", 2, true, run};
