/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The collapse of a column 1.42 times as high as its half-width, as in figure
 * 9 of [lagree_staron_popinet_2011]: how much the heap at t = 4 sqrt(H0/g)
 * depends on the grid, on the time step and on the box.
 *
 * There is no exact solution: each level is compared with the one below it.
 * Front and height are those of outline.h; outlines differ by
 *   int |h - h'| dx / int h dx,
 * with two columns of the finer grid averaged for one of the coarser. What the
 * front does on a floor without slip depends on the cell at the floor, so that
 * its bar is wider there than with a slip length that is the same on all grids,
 * a cell of level 9.
 *
 * Levels are those of a box of 32 L0, as in the paper. The box is 8 L0 wide,
 * with the same cells on two levels less: the front comes to 4.7 L0. */
#include "report.h"
#include "runs.h"
#include "talus/two_phase/fractions.h"
#include "talus/two_phase/measure.h"

enum { FIRST = 8, LAST = 11, LEVELS = LAST - FIRST + 1, MOST_STEPS = 8192 };
static const double kAspect = 1.42;
/* Bounds how much two results differ, relative. */
static const double kHeightBar = 0.015, kOutlineBar = 0.015;

struct heap {
  struct diagnostics at_end;
  bool good;
  int nsteps;
  double dt[MOST_STEPS];
  int iterations[2]; /* the most in a step, but for the first ten */
};

/* Take one step of at most dt_max, written down. */
static void advance_heap(struct two_phase *sim, double dt_max,
                         struct heap *heap) {
  heap->good = step_advance(sim, dt_max) == EXIT_DONE;
  CHECK(heap->nsteps < MOST_STEPS, "more than %d steps", MOST_STEPS);
  heap->dt[heap->nsteps++] = sim->model.dt;
  const int count[2] = {sim->pressure.iterations, sim->viscous.iterations};
  for (int k = 0; k < 2 && sim->model.step > 10; k++) {
    if (count[k] > heap->iterations[k]) heap->iterations[k] = count[k];
  }
}

/* Run the collapse on a level of a box of 32 L0. steps: NULL, or a run each of
 * whose steps is done in two halves. */
static void run_collapse(int level, double box, const char *more,
                         const struct heap *steps, struct heap *heap) {
  const double stop = 4 * sqrt(kAspect);
  struct example example =
      example_new("column", "a=%g d=0.0219 size=%g level=%d %s", kAspect, box,
                  level - (int)lround(log2(32 / box)), more);
  struct two_phase *sim = example.sim;
  memset(heap, 0, sizeof *heap);
  heap->good = true;
  for (int k = 0; heap->good && sim->model.time < stop - 1e-9; k++) {
    double dt_max = stop - sim->model.time;
    if (steps && k < 2 * steps->nsteps) {
      dt_max = fmin(dt_max, 0.5 * steps->dt[k / 2]);
    }
    advance_heap(sim, dt_max, heap);
  }
  fractions_synchronise(sim); /* c to the time of u */
  diagnostics_measure(sim, &heap->at_end);
  fractions_desynchronise(sim);
  example_destroy(&example);
}

/* Relative differences of two heaps, the second on the same grid or on one
 * twice as fine. */
struct change {
  double front, height, outline;
};

/* Return the mean height of n columns. */
static double column_mean(const struct outline *outline, int first, int n) {
  double sum = 0;
  for (int k = 0; k < n && first + k < outline->n[0]; k++) {
    sum += outline->height[first + k];
  }
  return sum / n;
}

static struct change compare(const struct heap *a, const struct heap *b) {
  const struct outline *coarse = &a->at_end.outline, *fine = &b->at_end.outline;
  const int ratio = (int)lround(coarse->spacing / fine->spacing);
  double apart = 0, area = 0;
  const int n =
      coarse->n[0] > fine->n[0] / ratio ? coarse->n[0] : fine->n[0] / ratio;
  for (int k = 0; k < n; k++) {
    const double height = column_mean(fine, ratio * k, ratio);
    apart += fabs(column_mean(coarse, k, 1) - height);
    area += height;
  }
  if (!a->good || !b->good) return (struct change){NAN, NAN, NAN};
  return (struct change){fabs(a->at_end.front / b->at_end.front - 1),
                         fabs(a->at_end.height / b->at_end.height - 1),
                         apart / area};
}

/* Report a change; front_bar: 0 if none of the three has a bar. */
static void report_change(struct report *report, const char *grid, int level,
                          struct change change, double front_bar) {
  static const char *const name[] = {"change of front", "change of height",
                                     "change of outline"};
  const double value[] = {change.front, change.height, change.outline};
  const double bar[] = {front_bar, kHeightBar, kOutlineBar};
  for (int k = 0; k < 3; k++) {
    if (front_bar > 0) {
      report_at_most(report, grid, name[k], level, value[k], bar[k]);
    } else {
      report_value(report, grid, name[k], level, value[k]);
    }
  }
}

/* Report all levels of one kind of floor. */
static void report_levels(struct report *report, const char *grid,
                          const char *more, double front_bar,
                          struct heap heap[LEVELS]) {
  for (int k = 0; k < LEVELS; k++) {
    const int level = FIRST + k;
    run_collapse(level, 8, more, NULL, &heap[k]);
    report_value(report, grid, "front", level, heap[k].at_end.front);
    report_value(report, grid, "height", level, heap[k].at_end.height);
    if (k == 0) continue;
    report_change(report, grid, level, compare(&heap[k - 1], &heap[k]),
                  level == LAST ? front_bar : 0);
  }
}

static void report_work(struct report *report, const struct heap heap[LEVELS]) {
  int count[3][LEVELS];
  for (int k = 0; k < LEVELS; k++) {
    count[0][k] = heap[k].nsteps;
    count[1][k] = heap[k].iterations[0];
    count[2][k] = heap[k].iterations[1];
  }
  static const char *const name[] = {"steps", "pressure iterations",
                                     "viscous iterations"};
  for (int j = 0; j < 3; j++) {
    report_counts(report, "no slip", name[j], FIRST, LEVELS, count[j], 0, 0);
  }
}

static void free_heaps(struct heap heap[LEVELS]) {
  for (int k = 0; k < LEVELS; k++) diagnostics_free(&heap[k].at_end);
}

/* Report a run whose steps are done in two halves: in the box of 8 L0, without
 * slip. */
static void report_halves(struct report *report, int level,
                          const struct heap *whole) {
  static struct heap halves;
  run_collapse(level, 8, "", whole, &halves);
  report_change(report, "dt halved", level, compare(whole, &halves), 0.03);
  report_at_least(report, "dt halved", "steps per step", level,
                  (double)halves.nsteps / whole->nsteps, 2);
  diagnostics_free(&halves.at_end);
}

static void run(struct report *report) {
  static struct heap rough[LEVELS], smooth[LEVELS], other;
  report_levels(report, "no slip", "", 0.03, rough);
  report_levels(report, "slip 1/16", "slip=0.0625", 0.01, smooth);
  report_halves(report, 9, &rough[9 - FIRST]);
  report_halves(report, 10, &rough[10 - FIRST]);
  run_collapse(9, 32, "", NULL, &other);
  report_change(report, "box 32", 9, compare(&rough[9 - FIRST], &other), 0.03);
  diagnostics_free(&other.at_end);
  report_work(report, rough);
  free_heaps(rough);
  free_heaps(smooth);
}

const struct convergence_case collapse_case = {
    "collapse", "a collapse on finer grids and with shorter steps", 2, true,
    run};
