/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The gas limit: a cliff of grains collapses in air by the two-fluid model, and
 * by the two-phase model with the same friction as a heap of one density, on
 * the same leaves. Both have I = d gamma sqrt(rho_s/p) of grains of density
 * rho_s. Both fronts are where the volume of the heap per area falls below half
 * a grain, both heights the largest of it.
 *
 * Heaps come to rest, and run-outs are compared too. With critical_state fronts
 * are up to 7 % behind on the way (docs/notes/two_fluid.md). Without planes of
 * the surface its leaves have no strength, and from 0.4 s on a film of them
 * runs ahead. Friction of critical_state in air is mu_1 + (mu_2 - mu_1)/(1 +
 * J_0/(a_I I^2)), 0.6 at I = 0.08 already. */
#include "../mesh/two_fluid.h"
#include "collapses.h"
#include "report.h"

static const char kCase[] =
    "local x_0, phi, rho, d = 0.1, 0.58, 2560, 1e-3\n"
    "local level, dry = param('level', 7, ''), param('dry', 0, '') == 1\n"
    "local closure = param('closure', 'mu_i_phi_i', '')\n"
    "local function critical(gamma, p)\n"
    "  p, gamma = math.max(p, 1e-9), math.max(gamma, 1e-9)\n"
    "  local J = 0.635*rho*(d*gamma)^2/p\n"
    "  return (0.425 + 0.34*J/(J + 0.004))*p/gamma\n"
    "end\n"
    "local mu = { 'mu_i', mu_s = 0.32, delta_mu = 0.28, I0 = 0.4,\n"
    "             d = d/phi^0.5 }\n"
    "if closure == 'critical_state' then\n"
    "  mu = { 'user', viscosity = critical, eta_max = 1e4 }\n"
    "end\n"
    "return {\n"
    "  model = dry and 'two_phase' or 'two_fluid', dimension = 2,\n"
    "  domain = { size = 4*x_0, level = level, level_min = level - 2 },\n"
    "  gravity = { 0, -9.81 },\n"
    "  grains = {\n"
    "    shape = function(x, y) return math.min(x_0 - x, x_0 - y) end,\n"
    "    density = rho*(dry and phi or 1), d = not dry and d or nil,\n"
    "    alpha_start = not dry and phi or nil, rheology = dry and mu or nil,\n"
    "    surface = not dry and param('surface', 'planes', '') or nil,\n"
    "    regularisation =\n"
    "      not dry and param('regularisation', 'exact', '') or nil,\n"
    "  },\n"
    "  gas = dry and { density = 1.225, rheology = { 'newtonian',\n"
    "                                                eta = 1.79e-5 } } or "
    "nil,\n"
    "  fluid = not dry and 'air' or nil,\n"
    "  closure = not dry and closure or nil,\n"
    "  mu_i_phi_i = not dry and closure == 'mu_i_phi_i' and\n"
    "               { mu_1 = 0.32, mu_2 = 0.6, I_0 = 0.4 } or nil,\n"
    "  boundary = { left = 'slip', right = 'no_slip', bottom = 'no_slip',\n"
    "               top = 'slip' },\n"
    "  adapt = { { 'interface', width = 3 }, { 'inside' } },\n"
    "  solver = { tolerance = 1e-4, cfl = 0.5 }, output = { stop = 1 },\n"
    "}\n";

static const double kTimes[] = {0.1, 0.2, 0.3, 0.4, 1};
enum { LEVEL = 7, NTIMES = 5, FLOWING = 3 }; /* before the film */
static const double kHalfGrain = 5e-4;       /* m */

/* Fronts and heights at kTimes, m. */
struct heaps {
  double front[NTIMES], height[NTIMES];
};

/* Load the case with overrides, "name=value" divided by blanks. */
static struct case_file *load(const char *format) {
  enum { MOST = 8 };
  char words[128], *override[MOST];
  int n = 0;
  snprintf(words, sizeof words, "level=%d %s", LEVEL, format);
  for (char *word = strtok(words, " "); word && n < MOST;
       word = strtok(NULL, " "))
    override[n++] = word;
  return case_load_text("gas.lua", kCase, n, override);
}

static void keep(struct heaps *heaps, int k, bool good,
                 const struct outline *outline) {
  heaps->front[k] = good ? outline_front(outline, kHalfGrain) : NAN;
  heaps->height[k] = good ? outline_height(outline) : NAN;
}

static struct heaps run_grains(const char *overrides) {
  struct heaps heaps;
  struct case_file *file = load(overrides);
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

static struct heaps run_dry(const char *overrides) {
  struct heaps heaps;
  struct example example = {.file = load(overrides)};
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

/* Report where the grains are at the first n times beside dry ones. front: the
 * bar on the front. */
static void compare(struct report *report, const char *what, int n,
                    double front, const struct heaps *grains,
                    const struct heaps *dry) {
  for (int k = 0; k < n; k++) {
    char name[48];
    snprintf(name, sizeof name, "%s, %g s", what, kTimes[k]);
    report_value(report, name, "front, m", LEVEL, grains->front[k]);
    report_at_most(report, name, "front against two_phase", LEVEL,
                   fabs(grains->front[k] / dry->front[k] - 1), front);
    report_at_most(report, name, "height against two_phase", LEVEL,
                   fabs(grains->height[k] / dry->height[k] - 1), 0.05);
  }
}

/* Compare the run-out at the end. */
static void compare_runout(struct report *report, const char *what,
                           const struct heaps *grains,
                           const struct heaps *dry) {
  static const double X_0 = 0.1;
  const double runout = grains->front[NTIMES - 1] / X_0 - 1;
  report_value(report, what, "run-out over x_0", LEVEL, runout);
  report_at_most(report, what, "run-out against two_phase", LEVEL,
                 fabs(runout / (dry->front[NTIMES - 1] / X_0 - 1) - 1), 0.05);
}

static void run(struct report *report) {
  const struct heaps dry = run_dry("dry=1");
  const struct heaps weak = run_grains("surface=none regularisation=clip");
  compare(report, "no surface", FLOWING, 0.05, &weak, &dry);
  const struct heaps resting = run_grains("dry=0");
  compare(report, "mu_i_phi_i", NTIMES, 0.05, &resting, &dry);
  compare_runout(report, "mu_i_phi_i", &resting, &dry);
  const struct heaps slow = run_dry("dry=1 closure=critical_state");
  const struct heaps plastic = run_grains("closure=critical_state");
  compare(report, "critical_state", NTIMES, 0.1, &plastic, &slow);
  compare_runout(report, "critical_state", &plastic, &slow);
}

const struct convergence_case two_fluid_gas_case = {
    .name = "two_fluid_gas",
    .title = "two fluids: a collapse in air is that of one granular fluid",
    .dimension = 2,
    .in_short = false,
    .run = run};
