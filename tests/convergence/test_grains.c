/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Heaps against grains computed one by one, and the column of glass beads of
 * [lee_huang_chiew_2015].
 *
 * Outlines: examples/lee_huang_column.lua, case 2, against discrete_case2.csv
 * and examples/column.lua against contact_dynamics_a6.26.csv, both in
 * examples/reference; the symmetric difference over the area, the reference
 * scaled to equal area (outlines.h). The bars are what the closures reach, with
 * a twentieth to spare: nothing may come out worse.
 *
 * Run-out of case 2: the paper prints 20.7 cm. Its equations do not give that:
 * their viscosity stays finite where grains are few while dissipation falls as
 * nu^2, so that a hot, sticky cloud above the bed drags on the front, and the
 * run-out is set by where the solver cuts the temperature off: 25.8, 22.9, 21.0
 * cm for 1, 10, 100 m^2/s^2; without that cloud 26.6 cm, height 6.0 cm (a
 * prototype of the equations, 2.5 mm). Nor do beads: at rest 99 % of them are
 * within 26.3 cm of the gate, the outline ends, at half a bead, at 30.6 cm, and
 * is 5.5 cm high. Our front, where the outline comes down to half a cell, which
 * is a bead, must lie between the two. What is left of the paper's table II are
 * the signs of its changes. */
#include "collapses.h"
#include "outlines.h"
#include "report.h"

static const char kBeads[] = "examples/reference/discrete_case2.csv";
static const char kDiscs[] = "examples/reference/contact_dynamics_a6.26.csv";
static const double kLength = 0.056, kHeight = 0.1344, kGravity = 9.81;

/* Report outlines at the times of kBeads. */
static void report_bead_outlines(struct report *report, int level,
                                 const char *regularisation) {
  static const double time[] = {0.5, 1, 2, 3}, bar = 0.055;
  struct example example = example_new(
      "lee_huang_column", "level=%d regularisation=%s", level, regularisation);
  for (int k = 0; k < 4; k++) {
    static struct curve ours, beads;
    struct diagnostics d;
    char norm[64];
    snprintf(norm, sizeof norm, "difference of outlines at %g tau_c %s",
             time[k], regularisation);
    const bool good =
        measure_at(&example, time[k] * sqrt(kHeight / kGravity), &d);
    curve_of_outline(&d.outline, &ours);
    reference_read_rows(kBeads, time[k], &beads);
    report_at_most(report, "glass beads", norm, level,
                   good ? curve_difference(&ours, &beads) : NAN, bar);
    diagnostics_free(&d);
  }
  example_destroy(&example);
}

/* Report outlines at the times of kDiscs, in sqrt(H0/g), and their mean. */
static void report_disc_outlines(struct report *report, int level) {
  static const double time[] = {0.66, 0.95, 1.24, 1.52, 2.28}, aspect = 6.26;
  struct example example = example_new("column", "level=%d", level);
  double mean = 0;
  for (int k = 0; k < 5; k++) {
    static struct curve ours, discs;
    struct diagnostics d;
    char norm[64];
    snprintf(norm, sizeof norm, "difference of outlines at %g", time[k]);
    const bool good = measure_at(&example, time[k] * sqrt(aspect), &d);
    curve_of_outline(&d.outline, &ours);
    reference_read_columns(kDiscs, time[k], &discs);
    const double apart = good ? curve_difference(&ours, &discs) : NAN;
    report_value(report, "column", norm, level, apart);
    mean += apart / 5;
    diagnostics_free(&d);
  }
  report_at_most(report, "column", "mean difference of outlines", level, mean,
                 0.065);
  example_destroy(&example);
}

/* Report run-outs between limits. Steady friction of the closure is between
 * eta_S = 0.42 and mu_tran = 0.539: its run-out must lie between those of
 * constant friction of these two values, and the latter is the least that any
 * such closure can have. */
static void report_friction_limits(struct report *report, double runout) {
  static const double friction[] = {0.42, 0.539};
  double run[2], high[2];
  sweep("lee_huang_column", "level=8", 7 * sqrt(kHeight / kGravity), kLength,
        "friction", 2, friction, run, high);
  report_value(report, "friction 0.539", "run-out in cm", 8,
               100 * kLength * run[1]);
  report_at_least(report, "friction 0.42", "run-out less the closure's in cm",
                  8, 100 * kLength * (run[0] - runout), 0);
  report_at_most(report, "friction 0.539", "run-out less the closure's in cm",
                 8, 100 * kLength * (run[1] - runout), 0);
}

/* Report table II: the run-out falls with eta_S by 22 % of its base value and
 * rises with e_eff by 5 %; the height the other way round. */
static void report_glass_beads(struct report *report) {
  static const double eta_S[] = {0.30, 0.42, 0.51}, e_eff[] = {0.46, 0.58, 0.7};
  const double length = kLength, stop = 7 * sqrt(kHeight / kGravity);
  double run[3], high[3];
  sweep("lee_huang_column", "level=8", stop, length, "eta_S", 3, eta_S, run,
        high);
  const double runout = 100 * run[1] * length;
  report_at_least(report, "glass beads", "run-out in cm", 8, runout, 26.3);
  report_at_most(report, "glass beads", "run-out in cm", 8, runout, 30.6);
  report_value(report, "glass beads", "height in cm", 8,
               100 * high[1] * length);
  report_at_most(report, "glass beads", "height off the beads'", 8,
                 fabs(high[1] * length / 0.055 - 1), 0.1);
  report_friction_limits(report, run[1]);
  report_at_most(report, "glass beads", "eta_S: change of run-out", 8,
                 larger(run[1] - run[0], run[2] - run[1]) / run[1], -0.05);
  report_at_least(report, "glass beads", "eta_S: change of height", 8,
                  smaller(high[1] - high[0], high[2] - high[1]) / high[1],
                  0.05);
  sweep("lee_huang_column", "level=8", stop, length, "e_eff", 3, e_eff, run,
        high);
  report_at_least(report, "glass beads", "e_eff: change of run-out", 8,
                  smaller(run[1] - run[0], run[2] - run[1]) / run[1], 0);
  report_at_most(report, "glass beads", "e_eff: change of height", 8,
                 larger(high[1] - high[0], high[2] - high[1]) / high[1], 0);
}

static void run(struct report *report) {
  report_bead_outlines(report, 8, "exact");
  report_bead_outlines(report, 8, "clip");
  report_glass_beads(report);
  for (int level = 9; level <= 10; level++) report_disc_outlines(report, level);
}

const struct convergence_case grains_case = {
    "grains", "heaps against grains computed one by one", 2, false, run};
