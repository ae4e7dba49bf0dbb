/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Grains that fall on a bare floor, examples/drop.lua: the run is to be that of
 * grains that start on the floor with the speed of the fall, and that of a gap
 * of a tenth of a leaf the one without a gap. Gas between grains and floor
 * leaves through the grains (percolation.h).
 *
 * Bars: a leaf of the finest grid is 8, 4, 2 % of the height of the block, and
 * by up to one of them the block is stopped early, for grains that enter the
 * last leaf above the floor move on with what is in it; so 8, 5, 3 % at levels
 * 7, 8, 9. By 0.1 sqrt(0.8/g) after the impact the floor holds grains alone but
 * for two leaves at the front. Kinetic + potential + dissipated energy stays
 * below what there was at the start, but for the first two steps over a gap of
 * less than a leaf (1.6e-4: gas leaves by the centres of leaves, potential
 * energy goes by the grains in them), and rises from no step to a later one by
 * more than that. */
#include "report.h"
#include "runs.h"
#include "talus/outline.h"
#include "talus/two_phase/fractions.h"
#include "talus/two_phase/measure.h"

static const double kStop = 8, kMixed = 0.01;

struct drop {
  double front, height, drift, gain, rise, behind;
  bool good;
};

/* Return the distance of the last mixed leaf of the floor behind the front, in
 * leaves. */
static double mixed_behind_front(const struct two_phase *sim) {
  const struct mesh *mesh = sim->grid.mesh;
  double front = 0, first = HUGE_VAL, h = HUGE_VAL;
  for (int pass = 0; pass < 2; pass++) {
    for (int32_t i = 0; i < mesh->nleaves; i++) {
      const double c = sim->c->v[i], x = mesh->x[i][0];
      if (mesh->x[i][DIM - 1] > mesh->h[i] || c < kMixed) continue;
      h = fmin(h, mesh->h[i]);
      front = larger(front, x);
      if (c < 1 - kMixed) first = fmin(first, x);
    }
  }
  return first < HUGE_VAL ? (front - first) / h : 0;
}

static double energy_of(struct two_phase *sim, struct diagnostics *d) {
  fractions_synchronise(sim);
  diagnostics_measure(sim, d);
  fractions_desynchronise(sim);
  return d->kinetic + d->potential + sim->energy.dissipated;
}

static struct drop run_drop(int level, double gap, double fall) {
  struct example example =
      example_new("drop", "level=%d gap=%g fall=%g", level, gap, fall);
  struct two_phase *sim = example.sim;
  struct diagnostics d;
  struct drop drop = {.good = true, .gain = -HUGE_VAL};
  const double landed = sqrt(2 * gap) + 0.1 * sqrt(0.8);
  double least = energy_of(sim, &d);
  const double first = least, volume = d.volume;
  for (bool seen = false; drop.good && sim->model.time < kStop * (1 - 1e-12);) {
    const double event = seen ? kStop : landed;
    diagnostics_free(&d);
    drop.good = step_advance(sim, event - sim->model.time) == EXIT_DONE;
    if (!seen && sim->model.time >= landed * (1 - 1e-12)) {
      seen = true;
      drop.behind = mixed_behind_front(sim);
    }
    const double energy = energy_of(sim, &d);
    drop.gain = larger(drop.gain, energy / first - 1);
    drop.rise = larger(drop.rise, (energy - least) / first);
    least = fmin(least, energy);
  }
  drop.front = d.front, drop.height = d.height;
  drop.drift = fabs(d.volume / volume - 1);
  diagnostics_free(&d);
  example_destroy(&example);
  return drop;
}

static void compare(struct report *report, const char *grid, int level,
                    const struct drop *a, const struct drop *b, double bar) {
  report_at_most(report, grid, "front against start on the floor", level,
                 fabs(a->front / b->front - 1), bar);
  report_at_most(report, grid, "height against start on the floor", level,
                 fabs(a->height / b->height - 1), bar);
  report_at_most(report, grid, "mixed leaves behind the front", level,
                 a->behind, 2);
  report_at_most(report, grid, "drift of volume", level, a->drift, 1e-12);
  report_at_most(report, grid, "energy above the start", level, a->gain, 2e-4);
  report_at_most(report, grid, "rise of energy", level, a->rise, 2e-4);
}

static void run(struct report *report) {
  static const double fall[] = {0.05, 0.5, 2.2}, bar[] = {0.08, 0.05, 0.03};
  for (int level = 7; level <= 9; level++) {
    for (int k = 0; k < 3; k++) {
      char grid[32];
      snprintf(grid, sizeof grid, "fall %g", fall[k]);
      if (level == 9 && k == 2) continue; /* a minute */
      const struct drop dropped = run_drop(level, fall[k], fall[k]);
      const struct drop started = run_drop(level, 0, fall[k]);
      compare(report, grid, level, &dropped, &started, bar[level - 7]);
    }
  }
  const double leaf = 8.0 / (1 << 7);
  const struct drop missed = run_drop(7, 0.1 * leaf, 0);
  const struct drop placed = run_drop(7, 0, 0);
  compare(report, "misses the floor", 7, &missed, &placed, 0.01);
}

const struct convergence_case drop_case = {
    "drop", "grains that fall on a floor, and those that start there", 2, false,
    run};
