/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Collapses of columns with other closures and other parameters, against what
 * the papers say of them. There is no exact solution: the bars are signs,
 * exponents and lengths of
 *   [lagree_staron_popinet_2011], section 4.1, figures 14 and 15: which fluids
 *     keep spreading, which keep a corner, how long constant friction will do;
 *     eq. 3.3: run-out 2.2 a;
 *   [valette_2019], section 3.3: run-out ~ mu_s^-1.2, I0^0.11;
 * and the motion of the heap that eta_max lets stand, of which
 * rho g H^2/(2 eta_max) is left if nothing else moves. Where the papers show a
 * picture the bar is what its words mean on a grid (a cell), to grains (a
 * diameter) or by the theory of the law.
 * Levels are log2 of the cells along the box of the example. */
#include "collapses.h"
#include "report.h"

static const double kAspect = 1.42;

static double ratio_of(double a, double b) { return a / b - 1; }

/* Holds for examples/rheologies.lua at level 7. */
static const double kCell = 8. / 128, kGrain = 0.0219;

/* Return the largest rise of an outline on the way out: 0 for a heap. */
static double largest_rise(const struct diagnostics *d) {
  double lowest = HUGE_VAL, rise = 0;
  for (int k = 0; k < d->outline.n[0]; k++) {
    lowest = smaller(lowest, d->outline.height[k]);
    rise = larger(rise, d->outline.height[k] - lowest);
  }
  return rise;
}

/* Return the height of an outline at a distance behind its front. */
static double height_behind_front(const struct diagnostics *d,
                                  double distance) {
  const int k = (int)((d->front - distance) / d->outline.spacing);
  return d->outline.height[k];
}

/* Return the mean distance of two outlines over the longer one. */
static double outline_distance(const struct diagnostics *a,
                               const struct diagnostics *b) {
  double apart = 0;
  for (int k = 0; k < a->outline.n[0]; k++)
    apart += fabs(a->outline.height[k] - b->outline.height[k]);
  return apart * a->outline.spacing / fmax(a->front, b->front);
}

/* Report "never stops": a thin layer of fluid spreads as t^n, n = 1/5 if its
 * viscosity is constant, 2/7 if it is Bagnold's (h L = const, dL/dt ~ L^-5/2),
 * and faster while it is thick; of the three cells that the slower one moves, a
 * front that takes cell after cell is known to a third of one. "Comes to rest":
 * moves by less than a cell. Both from 6 to 8 sqrt(H0/g), when nothing that can
 * stop has not. */
static void report_spreading(struct report *report, const char *law,
                             const struct diagnostics d[2]) {
  if (strcmp(law, "newtonian") == 0 || strcmp(law, "bagnold") == 0) {
    const double n = strcmp(law, "bagnold") == 0 ? 2. / 7 : 1. / 5;
    report_at_least(report, law, "exponent of front over thin layer's", 7,
                    log(d[1].front / d[0].front) / log(8. / 6) / n, 0.9);
  } else {
    report_at_most(report, law, "cells the front moves from 6 to 8", 7,
                   fabs(d[1].front - d[0].front) / kCell, 1);
  }
}

/* Report "a solid-like corner": at 1 sqrt(H0/g) the outline of bingham rises
 * outward by more than a cell, those of grains by less than a quarter, as an
 * outline is second-order. That of bingham is about L0/16 high on any grid:
 * 0.93 cells of level 7, 1.9 of level 8 and 4.0 of level 9. */
static void report_corner(struct report *report, const char *law) {
  const bool bingham = strcmp(law, "bingham") == 0;
  if (!bingham && strcmp(law, "mu_i") != 0 && strcmp(law, "coulomb") != 0)
    return;
  struct diagnostics d;
  struct example example = example_new("rheologies", "law=%s level=8", law);
  const bool good = measure_at(&example, sqrt(kAspect), &d);
  const double rise = good ? largest_rise(&d) / (kCell / 2) : NAN;
  if (bingham)
    report_at_least(report, law, "cells the outline rises at 1", 8, rise, 1);
  else
    report_at_most(report, law, "cells the outline rises at 1", 8, rise, 0.25);
  diagnostics_free(&d);
  example_destroy(&example);
}

/* Report "a rounded front, very different from the sharp angle": at rest, at
 * x = L0/4 behind it, bingham is as high as its yield stress can hold,
 * sqrt(2 tau_y x/(rho g)), within a fifth, and grains are not steeper than
 * their largest friction, mu_s + delta_mu = 0.6. */
static void report_front(struct report *report, const char *law,
                         const struct diagnostics *late) {
  const double x = 0.25, held = sqrt(2 * 0.1 * x),
               height = height_behind_front(late, x);
  if (strcmp(law, "bingham") == 0) {
    report_at_least(report, law, "height near front over yield's", 7,
                    height / held, 0.8);
  } else if (strcmp(law, "mu_i") == 0 || strcmp(law, "coulomb") == 0) {
    report_at_most(report, law, "slope of front", 7, height / x, 0.6);
  }
}

static void report_laws(struct report *report) {
  static const char *const law[] = {"mu_i", "coulomb", "bingham", "newtonian",
                                    "bagnold"};
  static const double time[] = {6, 8};
  for (int k = 0; k < 5; k++) {
    struct diagnostics d[2];
    struct example example = example_new("rheologies", "law=%s", law[k]);
    for (int i = 0; i < 2; i++) {
      const bool good = measure_at(&example, time[i] * sqrt(kAspect), &d[i]);
      CHECK(good, "%s stops at %g", law[k], example.sim->model.time);
    }
    report_spreading(report, law[k], d);
    report_corner(report, law[k]);
    report_front(report, law[k], &d[1]);
    for (int i = 0; i < 2; i++) diagnostics_free(&d[i]);
    example_destroy(&example);
  }
}

/* Report "good agreement until 1.5 sqrt(H0/g), then it degrades": outlines of
 * grains are known to a diameter (the best fit of the paper misses them by
 * 1.36). */
static void report_constant_friction(struct report *report) {
  static const double time[] = {1, 1.5, 4};
  struct example example[2] = {example_new("rheologies", "law=mu_i"),
                               example_new("rheologies", "law=coulomb")};
  for (int k = 0; k < 3; k++) {
    struct diagnostics d[2];
    bool good = true;
    char norm[32];
    for (int i = 0; i < 2; i++) {
      const double stop = time[k] * sqrt(kAspect);
      good = measure_at(&example[i], stop, &d[i]) && good;
    }
    const double apart = good ? outline_distance(&d[0], &d[1]) : NAN;
    snprintf(norm, sizeof norm, "d from mu_i at %g", time[k]);
    if (k < 2)
      report_at_most(report, "coulomb", norm, 7, apart / kGrain, 1);
    else
      report_at_least(report, "coulomb", norm, 7, apart / kGrain, 1);
    for (int i = 0; i < 2; i++) diagnostics_free(&d[i]);
  }
  for (int i = 0; i < 2; i++) example_destroy(&example[i]);
}

/* Return the slope of ln y over ln x by least squares. */
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

/* Report sensitivities. The floor is that of the paper: grains stick to it, and
 * gas slips on a strip of a few d ahead of them. */
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
    char rough[32];
    snprintf(rough, sizeof rough, "level=%d strip=0", level);
    sweep("sensitivity", rough, 9, 1, "mu_s", 4, mu_s, run, high);
    report_value(report, "mu_s", "exponent without strip", level,
                 exponent(4, mu_s, run));
    sweep("sensitivity", more, 9, 1, "delta_mu", 4, delta_mu, run, high);
    report_at_most(report, "delta_mu", "exponent of run-out", level,
                   exponent(4, delta_mu, run), -0.1);
    sweep("sensitivity", more, 9, 1, "I0", 3, I0, run, high);
    const double n_I0 = exponent(3, I0, run);
    report_value(report, "I0", "exponent of run-out", level, n_I0);
    report_at_most(report, "I0", "exponent less 0.11", level, fabs(n_I0 - 0.11),
                   0.2);
    report_at_least(report, "I0", "rise of run-out", level,
                    smaller(run[1] - run[0], run[2] - run[1]), 0.1);
  }
}

/* Report run-outs against those of Gerris with mu(I), eq. 3.3: run-out = 2.2 a,
 * a fit over a < 7. */
static void report_aspect_ratios(struct report *report) {
  static const double a[] = {1.42, 2.4, 4};
  double run[3], high[3];
  sweep("column", "d=0.02 size=16 level=8", 12, 1, "a", 3, a, run, high);
  for (int k = 0; k < 3; k++) {
    char name[32];
    snprintf(name, sizeof name, "a = %g", a[k]);
    report_at_most(report, name, "run-out off 2.2 a", 8,
                   fabs(ratio_of(run[k], 2.2 * a[k])), 0.1);
  }
}

/* Return the part of the grains that is in cells, not mostly gas, faster than a
 * speed. */
static double faster_part(const struct two_phase *sim, double speed) {
  const struct mesh *mesh = sim->grid.mesh;
  double sum[2] = {0};
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    const double grains = sim->c->v[i] * mesh_volume(mesh, i);
    const double u = hypot(sim->u[0]->v[i], sim->u[1]->v[i]);
    sum[0] += u > speed && sim->c->v[i] > 0.5 ? grains : 0;
    sum[1] += grains;
  }
  return sum[0] / sum[1];
}

/* Return the speed at the surface of a layer as steep and as thick as the front
 * is so many cells behind its end, by Bagnold's profile (bagnold.h) with the
 * numbers of examples/column.lua; 0 if mu_s holds it. The front is where the
 * outline comes down to half a cell. */
static double layer_speed(const struct diagnostics *d, int cells) {
  static const double mu_s = 0.32, delta_mu = 0.28, I0 = 0.4;
  const double cell = d->outline.spacing;
  const int k = (int)((d->front - d->outline.first[0]) / cell) - cells + 1;
  const double x = d->outline.first[0] + k * cell, h = d->outline.height[k];
  const double slope = (h - 0.5 * cell) / (d->front - x);
  const double excess = fmin(slope, 0.99 * (mu_s + delta_mu)) - mu_s;
  if (excess < 0) return 0;
  const double I = I0 * excess / (delta_mu - excess);
  return 2. / 3 * I / kGrain * pow(h, 1.5) / pow(1 + slope * slope, 0.25);
}

/* Return what a tip may do, of two cells or of three. */
static double tip_speed(const struct diagnostics *d) {
  return larger(layer_speed(d, 2), layer_speed(d, 3));
}

/* Motion of the deposit between t = 8 and 12, speeds in sqrt(g L0). */
struct creep {
  bool good;
  double mean, outline, front; /* root of the mean square; of its outline */
  double part;                 /* of it that is faster than `bar` */
  double fastest;
  double beyond; /* the most that it is over the bar and what the tip may */
};

static struct creep creep_of(int level, double eta_max, double bar) {
  struct creep creep = {0};
  struct diagnostics first, d;
  struct example example =
      example_new("column", "a=%g d=%g size=8 level=%d eta_max=%g", kAspect,
                  kGrain, level, eta_max);
  creep.good = measure_at(&example, 8, &first);
  while (creep.good && example.sim->model.time < 12) {
    creep.good = measure_at(&example, example.sim->model.time + 0.05, &d);
    creep.fastest = larger(creep.fastest, d.max_speed);
    creep.mean = larger(creep.mean, sqrt(2 * d.kinetic / d.volume));
    creep.part = larger(creep.part, faster_part(example.sim, bar));
    creep.beyond = larger(creep.beyond, d.max_speed / (bar + tip_speed(&d)));
    creep.outline = outline_distance(&first, &d) / 4;
    creep.front = (d.front - first.front) / 4;
    diagnostics_free(&d);
  }
  diagnostics_free(&first);
  example_destroy(&example);
  return creep;
}

/* Report creep. Faster than the bar is only the cell at the tip of the front,
 * or two, whatever eta_max. There the law itself lets grains flow: where the
 * front is steeper than mu_s by e over a thickness h, they slide like a layer
 * on that slope, at u = 2/3 I/d sqrt(g) h^(3/2), I = I0 e/(delta_mu - e), and
 * take the excess away in the time l h/(u h), l = h/mu_s. At constant e this
 * grows as h^(-1/2): the thinner the tip that a grid can tell, the slower it
 * comes to rest. (Level 9: h = 1.5 cells of L0/64, e = 0.06, u up to 0.012;
 * seen 1.2e-3 to 5e-3.) So the fastest cell may do what the tip may, and the
 * bar on top. */
static void report_creep(struct report *report) {
  static const double eta_max[] = {423, 1e4}, bar[] = {5e-3, 1e-3};
  static const char *const name[] = {"eta_max 250 H^1.5", "eta_max 1e4"};
  for (int k = 0; k < 2; k++) {
    for (int level = 7; level <= 9; level++) {
      const struct creep creep = creep_of(level, eta_max[k], bar[k]);
      report_at_most(report, name[k], "rms speed of the heap", level,
                     creep.good ? creep.mean : NAN, bar[k]);
      report_at_most(report, name[k], "speed of its outline", level,
                     creep.good ? creep.outline : NAN, bar[k]);
      report_value(report, name[k], "speed of its front", level, creep.front);
      report_at_most(report, name[k], "part of it that is faster", level,
                     creep.good ? creep.part : NAN, 1e-3);
      report_value(report, name[k], "speed of the fastest cell", level,
                   creep.fastest);
      report_at_most(report, name[k], "the same over the bar and the tip's",
                     level, creep.good ? creep.beyond : NAN, 1);
    }
  }
}

static void run(struct report *report) {
  report_laws(report);
  report_constant_friction(report);
  report_aspect_ratios(report);
  report_sensitivity(report);
  report_creep(report);
}

const struct convergence_case rheologies_case = {
    "rheologies", "collapses: closures, sensitivity, creep", 2, false, run};
