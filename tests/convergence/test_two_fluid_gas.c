/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The gas limit: a cliff of grains collapses in air by the two-fluid model with
 * mu(I) and phi(I), and by the two-phase model with the same mu(I) as a heap of
 * one density, on the same leaves. In the latter d is larger by 1/sqrt(phi), so
 * that its I = d gamma sqrt(rho phi/p) is that of grains of rho. Both fronts
 * are where the volume of the heap per area falls below half a grain, both
 * heights the largest of it. */
#include "../mesh/two_fluid.h"
#include "collapses.h"
#include "report.h"

static const char kCase[] =
    "local x_0, phi = 0.1, 0.58\n"
    "local level, dry = param('level', 7, ''), param('dry', 0, '') == 1\n"
    "local mu_i = { 'mu_i', mu_s = 0.32, delta_mu = 0.28, I0 = 0.4,\n"
    "               d = 1e-3/phi^0.5 }\n"
    "return {\n"
    "  model = dry and 'two_phase' or 'two_fluid', dimension = 2,\n"
    "  domain = { size = 4*x_0, level = level, level_min = level - 2 },\n"
    "  gravity = { 0, -9.81 },\n"
    "  grains = {\n"
    "    shape = function(x, y) return math.min(x_0 - x, x_0 - y) end,\n"
    "    density = 2560*(dry and phi or 1), d = not dry and 1e-3 or nil,\n"
    "    alpha_start = not dry and phi or nil, rheology = dry and mu_i or "
    "nil,\n"
    "  },\n"
    "  gas = dry and { density = 1.225, rheology = { 'newtonian',\n"
    "                                                eta = 1.79e-5 } } or "
    "nil,\n"
    "  fluid = not dry and 'air' or nil,\n"
    "  closure = not dry and 'mu_i_phi_i' or nil,\n"
    "  mu_i_phi_i = not dry and { mu_1 = 0.32, mu_2 = 0.6, I_0 = 0.4 } or "
    "nil,\n"
    "  boundary = { left = 'slip', right = 'no_slip', bottom = 'no_slip',\n"
    "               top = 'slip' },\n"
    "  adapt = { { 'interface', width = 3 }, { 'inside' } },\n"
    "  solver = { tolerance = 1e-4, cfl = 0.5 }, output = { stop = 1 },\n"
    "}\n";

static const double kTimes[] = {0.1, 0.2, 0.3, 0.4};
enum { NTIMES = 4 };
static const double kHalfGrain = 5e-4; /* m */

/* Fronts and heights at kTimes, m. */
struct heaps {
  double front[NTIMES], height[NTIMES];
};

static struct case_file *load(int level, bool dry) {
  char words[2][16];
  char *const override[] = {words[0], words[1]};
  snprintf(words[0], sizeof words[0], "level=%d", level);
  snprintf(words[1], sizeof words[1], "dry=%d", dry);
  return case_load_text("gas.lua", kCase, 2, override);
}

static void keep(struct heaps *heaps, int k, bool good,
                 const struct outline *outline) {
  heaps->front[k] = good ? outline_front_at(outline, kHalfGrain) : NAN;
  heaps->height[k] = good ? outline_height(outline) : NAN;
}

static struct heaps run_grains(int level) {
  struct heaps heaps;
  struct case_file *file = load(level, false);
  struct two_fluid *sim = grains_new(case_params(file));
  for (int k = 0; k < NTIMES; k++) {
    struct two_fluid_measures m;
    const bool good = grains_run(sim, kTimes[k], 100000);
    two_fluid_measure(sim, &m);
    keep(&heaps, k, good, &m.outline);
    outline_free(&m.outline);
  }
  two_fluid_destroy(sim);
  case_destroy(file);
  return heaps;
}

static struct heaps run_dry(int level) {
  struct heaps heaps;
  struct example example = {.file = load(level, true)};
  example.sim = sim_start(case_params(example.file));
  for (int k = 0; k < NTIMES; k++) {
    struct diagnostics d;
    const bool good = measure_at(&example, kTimes[k], &d);
    keep(&heaps, k, good, &d.outline);
    diagnostics_free(&d);
  }
  example_destroy(&example);
  return heaps;
}

static void run(struct report *report) {
  static const double BAR = 0.05;
  enum { LEVEL = 7 };
  const struct heaps dry = run_dry(LEVEL), grains = run_grains(LEVEL);
  for (int k = 0; k < NTIMES; k++) {
    char name[32];
    snprintf(name, sizeof name, "%g s", kTimes[k]);
    report_value(report, name, "front, m", LEVEL, grains.front[k]);
    report_at_most(report, name, "front against two_phase", LEVEL,
                   fabs(grains.front[k] / dry.front[k] - 1), BAR);
    report_at_most(report, name, "height against two_phase", LEVEL,
                   fabs(grains.height[k] / dry.height[k] - 1), BAR);
  }
}

const struct convergence_case two_fluid_gas_case = {
    .name = "two_fluid_gas",
    .title = "two fluids: a collapse in air is that of one granular fluid",
    .dimension = 2,
    .in_short = false,
    .run = run};
