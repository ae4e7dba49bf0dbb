/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A layer of grains on a plane of 0.43 rad, examples/bagnold.lua, on 8 to 64
 * cells over its thickness, from twice the steady flow and from rest; against
 * the profile of bagnold.h. A flow is steady at max |du/dt| < 1e-6. As it
 * relaxes like exp(-0.03 t), that leaves errors up to 3e-5, which would show on
 * 64 cells: errors are taken at 1e-8. Strips two cells wide, and the square of
 * [lagree_staron_popinet_2011, figure 2], in which waves along x could grow.
 * From twice the flow with a clipped viscosity too: an exact yield may add a
 * tenth to the errors. */
#include "bagnold.h"

enum { FIRST = 3, N = 4 };
static const char kParameters[] =
    "trees=%d level=%d start=%g regularisation=%s";
static const double kSlope = 0.43, kBars[N] = {1.9e-2, 6e-3, 1.7e-3, 4.5e-4};

/* Return the error when the flow is steady; NAN if it does not get there. */
struct steady {
  double l2, most, top, time, across;
};

static struct steady measure(const char *parameters, int trees, int level,
                             double start, const char *regularisation) {
  struct steady out = {NAN, NAN, NAN, NAN, NAN};
  struct example example =
      example_new("bagnold", parameters, trees, level, start, regularisation);
  struct two_phase *sim = example.sim;
  if (run_steady(sim, kBagnoldSteady, 1000)) out.time = sim->model.time;
  if (run_steady(sim, kBagnoldSettled, 1000)) {
    const struct norms norms = bagnold_norms(sim, kSlope);
    out.l2 = norms.l2, out.most = norms.most;
    out.top = bagnold_top_error(sim, kSlope);
    out.across = norms_of(sim->grid.mesh, sim->u[1]->v).most;
  }
  example_destroy(&example);
  return out;
}

/* Report a start; l2 [N] the errors. */
static void run_from(struct report *report, const char *grid, double start,
                     const char *regularisation, double l2[N]) {
  static const char top[] = "relative error of the top cell";
  double most[N];
  struct steady steady[N];
  for (int k = 0; k < N; k++) {
    steady[k] =
        measure(kParameters, 1 << (FIRST + k - 1), 1, start, regularisation);
    l2[k] = steady[k].l2, most[k] = steady[k].most;
  }
  report_errors(report, grid, "L2 of u", FIRST, N, l2, kBars, 1.9);
  report_errors(report, grid, "max of u", FIRST, N, most, NULL, 1.3);
  for (int k = 0; k < N - 1; k++) {
    report_value(report, grid, top, FIRST + k, steady[k].top);
  }
  report_at_most(report, grid, top, FIRST + N - 1, steady[N - 1].top, 1e-3);
  for (int k = 0; k < N; k++) {
    report_value(report, grid, "time to max |du/dt| < 1e-6", FIRST + k,
                 steady[k].time);
  }
}

static void run(struct report *report) {
  double exact[N], clip[N], rest[N];
  run_from(report, "from twice the flow", 2, "exact", exact);
  run_from(report, "from twice clip", 2, "clip", clip);
  for (int k = 0; k < N; k++) {
    report_at_most(report, "from twice the flow", "L2 of u over that of clip",
                   FIRST + k, exact[k] / clip[k], 1.1);
  }
  run_from(report, "from rest", 0, "exact", rest);
  const struct steady square = measure(kParameters, 1, FIRST + 1, 0, "exact");
  report_at_most(report, "square", "L2 of u", FIRST + 1, square.l2, kBars[1]);
  report_at_most(report, "square", "max |v|", FIRST + 1, square.across, 1e-10);
}

const struct convergence_case bagnold_case = {
    "bagnold", "Grains on an inclined plane", 2, true, run};
