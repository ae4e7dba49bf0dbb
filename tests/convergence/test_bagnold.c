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

static void run(struct report *report) {
  double exact[BAGNOLD_N], clip[BAGNOLD_N], rest[BAGNOLD_N];
  bagnold_report(report, "from twice the flow", 2, "exact", exact);
  bagnold_report(report, "from twice clip", 2, "clip", clip);
  for (int k = 0; k < BAGNOLD_N; k++) {
    report_at_most(report, "from twice the flow", "L2 of u over that of clip",
                   BAGNOLD_FIRST + k, exact[k] / clip[k], 1.1);
  }
  bagnold_report(report, "from rest", 0, "exact", rest);
  const struct bagnold_flow square =
      bagnold_run(1, BAGNOLD_FIRST + 1, 0, "exact");
  report_at_most(report, "square", "L2 of u", BAGNOLD_FIRST + 1, square.l2,
                 kBagnoldBars[1]);
  report_at_most(report, "square", "max |v|", BAGNOLD_FIRST + 1, square.across,
                 1e-10);
}

const struct convergence_case bagnold_case = {
    "bagnold", "Grains on an inclined plane", 2, true, run};
