/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Collapses of columns with other closures and other parameters, against what
 * the papers say of them. There is no exact solution: the bars are signs,
 * exponents and lengths of
 *   [lagree_staron_popinet_2011], section 4.1, figures 14 and 15: which fluids
 *     keep spreading, which keep a corner, how long constant friction will do;
 *   [valette_2019], section 3.3: run-out ~ mu_s^-1.2, I0^0.11;
 *   [lee_huang_chiew_2015], table II: case 2, run-out 20.7 cm, height 6.48 cm,
 *     and their changes with eta_S and e_eff;
 * and the creep of the heap that eta_max lets stand, of which
 * rho g H^2/(2 eta_max) is left if nothing else moves.
 * Levels are log2 of the cells along the box of the example. */
#include "report.h"
#include "runs.h"
#include "talus/diagnostics.h"

static const double kAspect = 1.42;

static double ratio_of(double a, double b) { return a / b - 1; }

/* Carry an example to a time and measure. */
static bool measure_at(struct example *example, double time,
                       struct diagnostics *d) {
  const bool good = run_to(example->sim, time);
  step_synchronise(example->sim);
  diagnostics_measure(example->sim, d);
  step_desynchronise(example->sim);
  return good;
}

/* Largest rise of an outline on the way out, over its height: 0 for a heap. */
static double largest_rise(const struct diagnostics *d) {
  double lowest = HUGE_VAL, rise = 0;
  for (int k = 0; k < d->outline.n[0]; k++) {
    lowest = fmin(lowest, d->outline.height[k]);
    rise = fmax(rise, d->outline.height[k] - lowest);
  }
  return rise / d->height;
}

static double outline_difference(const struct diagnostics *a,
                                 const struct diagnostics *b) {
  double apart = 0, area = 0;
  for (int k = 0; k < a->outline.n[0]; k++) {
    apart += fabs(a->outline.height[k] - b->outline.height[k]);
    area += a->outline.height[k];
  }
  return apart / area;
}

/* Which fluids spread on, between 6 and 8 sqrt(H0/g), and which have a corner
 * at 4. */
static void report_laws(struct report *report) {
  static const char *const law[] = {"mu_i", "coulomb", "bingham", "newtonian",
                                    "bagnold"};
  const double unit = sqrt(kAspect);
  for (int k = 0; k < 5; k++) {
    struct diagnostics d[3];
    struct example example = example_new("rheologies", "law=%s", law[k]);
    bool good = measure_at(&example, 4 * unit, &d[0]);
    good = good && measure_at(&example, 6 * unit, &d[1]);
    good = good && measure_at(&example, 8 * unit, &d[2]);
    const double more = good ? ratio_of(d[2].front, d[1].front) : NAN;
    const double rise = good ? largest_rise(&d[0]) : NAN;
    if (k < 3)
      report_at_most(report, law[k], "growth of front from 6 to 8", 7, more,
                     0.01);
    else
      report_at_least(report, law[k], "growth of front from 6 to 8", 7, more,
                      0.04);
    if (k == 2)
      report_at_least(report, law[k], "rise of outline at 4", 7, rise, 0.04);
    else if (k < 2)
      report_at_most(report, law[k], "rise of outline at 4", 7, rise, 0.01);
    else
      report_value(report, law[k], "rise of outline at 4", 7, rise);
    for (int i = 0; i < 3 && good; i++) diagnostics_free(&d[i]);
    example_destroy(&example);
  }
}

/* Constant friction will do until 1.5 sqrt(H0/g), not at 4. */
static void report_constant_friction(struct report *report) {
  static const double time[] = {1.5, 4};
  struct example example[2] = {example_new("rheologies", "law=mu_i"),
                               example_new("rheologies", "law=coulomb")};
  for (int k = 0; k < 2; k++) {
    struct diagnostics d[2];
    bool good = true;
    for (int i = 0; i < 2; i++) {
      const double stop = time[k] * sqrt(kAspect);
      good = measure_at(&example[i], stop, &d[i]) && good;
    }
    const double apart = good ? outline_difference(&d[0], &d[1]) : NAN;
    if (k == 0)
      report_at_most(report, "coulomb", "from mu_i at 1.5", 7, apart, 0.03);
    else
      report_at_least(report, "coulomb", "from mu_i at 4", 7, apart, 0.08);
    for (int i = 0; i < 2; i++) diagnostics_free(&d[i]);
  }
  for (int i = 0; i < 2; i++) example_destroy(&example[i]);
}

/* Slope of ln y over ln x by least squares. */
static double exponent(int n, const double *x, const double *y) {
  double mean[2] = {0}, sum[2] = {0};
  for (int k = 0; k < n; k++)
    mean[0] += log(x[k]) / n, mean[1] += log(y[k]) / n;
  for (int k = 0; k < n; k++) {
    const double from = log(x[k]) - mean[0];
    sum[0] += from * (log(y[k]) - mean[1]);
    sum[1] += from * from;
  }
  return sum[0] / sum[1];
}

/* Run-out and height of an example over `base` at a time, for n values of a
 * parameter. */
static void sweep(const char *name, const char *more, double stop, double base,
                  const char *parameter, int n, const double *value,
                  double *runout, double *height) {
  for (int k = 0; k < n; k++) {
    struct diagnostics d;
    struct example example =
        example_new(name, "%s=%g %s", parameter, value[k], more);
    const bool good = measure_at(&example, stop, &d);
    runout[k] = good ? d.front / base - 1 : NAN;
    height[k] = good ? d.height / base : NAN;
    diagnostics_free(&d);
    example_destroy(&example);
  }
}

static void report_sensitivity(struct report *report) {
  static const double mu_s[] = {0.32, 0.42, 0.52, 0.62};
  static const double delta_mu[] = {0.18, 0.28, 0.38, 0.48};
  static const double I0[] = {0.04, 0.4, 4};
  for (int level = 7; level <= 8; level++) {
    char more[32];
    double run[4], high[4];
    snprintf(more, sizeof more, "level=%d", level);
    sweep("sensitivity", more, 9, 1, "mu_s", 4, mu_s, run, high);
    const double n_mu = exponent(4, mu_s, run);
    report_value(report, "mu_s", "exponent of run-out", level, n_mu);
    report_at_most(report, "mu_s", "exponent less -1.2", level,
                   fabs(n_mu + 1.2), 0.2);
    report_at_least(report, "mu_s", "exponent of height", level,
                    exponent(4, mu_s, high), 0.1);
    sweep("sensitivity", more, 9, 1, "delta_mu", 4, delta_mu, run, high);
    report_at_most(report, "delta_mu", "exponent of run-out", level,
                   exponent(4, delta_mu, run), -0.1);
    sweep("sensitivity", more, 9, 1, "I0", 3, I0, run, high);
    const double n_I0 = exponent(3, I0, run);
    report_value(report, "I0", "exponent of run-out", level, n_I0);
    report_at_most(report, "I0", "exponent less 0.11", level, fabs(n_I0 - 0.11),
                   0.2);
    report_at_least(report, "I0", "rise of run-out", level,
                    fmin(run[1] - run[0], run[2] - run[1]), 0.1);
  }
}

/* Of table II, in the order of the paper's changes: the run-out falls with
 * eta_S by 22 % of its base value and rises with e_eff by 5 %. */
static void report_glass_beads(struct report *report) {
  static const double eta_S[] = {0.30, 0.42, 0.51}, e_eff[] = {0.46, 0.58, 0.7};
  const double length = 0.056, stop = 7 * sqrt(0.1344 / 9.81);
  double run[3], high[3];
  sweep("lee_huang_column", "level=8", stop, length, "eta_S", 3, eta_S, run,
        high);
  report_value(report, "glass beads", "run-out in cm", 8,
               100 * run[1] * length);
  report_value(report, "glass beads", "height in cm", 8,
               100 * high[1] * length);
  report_at_most(report, "glass beads", "run-out off table II", 8,
                 fabs(ratio_of(run[1] * length, 0.207)), 0.15);
  report_at_most(report, "glass beads", "height off table II", 8,
                 fabs(ratio_of(high[1] * length, 0.0648)), 0.1);
  report_at_most(report, "glass beads", "eta_S: change of run-out", 8,
                 fmax(run[1] - run[0], run[2] - run[1]) / run[1], -0.05);
  report_at_least(report, "glass beads", "eta_S: change of height", 8,
                  fmin(high[1] - high[0], high[2] - high[1]) / high[1], 0.05);
  sweep("lee_huang_column", "level=8", stop, length, "e_eff", 3, e_eff, run,
        high);
  report_at_least(report, "glass beads", "e_eff: change of run-out", 8,
                  fmin(run[1] - run[0], run[2] - run[1]) / run[1], 0);
  report_at_most(report, "glass beads", "e_eff: change of height", 8,
                 fmax(high[1] - high[0], high[2] - high[1]) / high[1], 0);
}

/* Speeds between t = 8 and 12, in sqrt(g L0). */
static void report_creep(struct report *report) {
  static const double eta_max[] = {423, 1e4}, bar[] = {5e-3, 1e-3};
  static const char *const name[] = {"eta_max 250 H^1.5", "eta_max 1e4"};
  for (int k = 0; k < 2; k++) {
    for (int level = 7; level <= 9; level++) {
      double fastest = 0, mean = 0;
      struct example example =
          example_new("column", "a=%g d=0.0219 size=8 level=%d eta_max=%g",
                      kAspect, level, eta_max[k]);
      bool good = run_to(example.sim, 8);
      while (good && example.sim->time < 12) {
        struct diagnostics d;
        good = measure_at(&example, example.sim->time + 0.05, &d);
        fastest = fmax(fastest, d.max_speed);
        mean = fmax(mean, sqrt(2 * d.kinetic / d.volume));
        diagnostics_free(&d);
      }
      example_destroy(&example);
      report_at_most(report, name[k], "rms speed of the heap", level,
                     good ? mean : NAN, bar[k]);
      report_at_most(report, name[k], "speed of the fastest grains", level,
                     good ? fastest : NAN, bar[k]);
    }
  }
}

static void run(struct report *report) {
  report_laws(report);
  report_constant_friction(report);
  report_sensitivity(report);
  report_glass_beads(report);
  report_creep(report);
}

const struct convergence_case rheologies_case = {
    "rheologies", "collapses: closures, sensitivity, creep", 2, false, run};
