/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_bagnold.c in 3D: a layer that flows down a slope at 0.5 rad to its x
 * axis, in a channel that is periodic along x and y, with the bars of 2D.
 * Columns of two by two cells begin with the steady flow of bagnold.h, which is
 * soonest where the discrete one is; a cube of 8 cells along its edges, in
 * which waves could grow and where nothing may flow across the slope, from
 * rest. */
#include "bagnold.h"

static void run(struct report *report) {
  double l2[BAGNOLD_N];
  bagnold_report(report, "from the flow", 1, "exact", l2);
  const struct bagnold_flow cube = bagnold_run(1, BAGNOLD_FIRST, 0, "exact");
  report_at_most(report, "cube from rest", "L2 of u", BAGNOLD_FIRST, cube.l2,
                 kBagnoldBars[0]);
  report_at_most(report, "cube from rest", "max |u| across the flow",
                 BAGNOLD_FIRST, cube.across, 1e-10);
}

const struct convergence_case bagnold_channel_case = {
    "bagnold_channel", "Grains on an inclined plane in 3D", 3, false, run};
