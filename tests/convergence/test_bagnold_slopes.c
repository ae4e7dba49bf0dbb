/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Layers of grains on planes of eight slopes that let them flow, and on two
 * that hold them, examples/bagnold.lua on 64 cells, until max |du/dt| is below
 * 1e-6 of the exact speed (times sqrt(g/H)). What is compared is u of the top
 * cell with the exact u at its centre: for those that flow bagnold.h, with 0.98
 * of it at the start (the steepest take 1000 sqrt(H/g) to relax); for those
 * held, by a viscosity that ends at eta_max, the creep
 *   u = rho g sin(slope) (H y - y^2/2)/eta_max
 * [lagree_staron_popinet_2011, section 2.2.3: arrest is a very slow creep]. */
#include "bagnold.h"

enum { LEVEL = 6 };

/* Return the relative error of u of the top cell; NAN if the flow does not
 * settle. */
static double top_error(double slope, double eta_max) {
  const double y = 1 - 0.5 / (1 << LEVEL);
  const double exact = tan(slope) > 0.38
                           ? bagnold_exact(slope, y)
                           : sin(slope) * (y - 0.5 * y * y) / eta_max;
  struct example example =
      example_new("bagnold",
                  "trees=%d level=1 slope=%g start=0.98 regularisation=clip "
                  "eta_max=%g",
                  1 << (LEVEL - 1), slope, eta_max);
  struct two_phase *sim = example.sim;
  const bool good = run_steady(sim, kBagnoldSteady * exact, 5000);
  const double u = sim->u[0]->v[bagnold_top(sim->grid.mesh)];
  example_destroy(&example);
  return good ? fabs(u - exact) / exact : NAN;
}

static void run_slope(struct report *report, double slope, double eta_max) {
  char grid[64];
  snprintf(grid, sizeof grid, "slope %.2f eta_max %g", slope, eta_max);
  report_at_most(report, grid, "relative error of the top cell", LEVEL,
                 top_error(slope, eta_max), 1e-2);
}

static void run(struct report *report) {
  for (int k = 0; k < 4; k++) {
    run_slope(report, k < 2 ? 0.30 : 0.35, k % 2 ? 1e4 : 1e3);
  }
  for (int k = 0; k < 8; k++) run_slope(report, 0.38 + 0.02 * k, 1e4);
}

const struct convergence_case bagnold_slopes_case = {
    "bagnold_slopes", "Grains on planes of ten slopes", 2, false, run};
