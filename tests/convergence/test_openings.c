/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Openings on a grid that is coarse but for what they ask of it: a jet brings
 * in W V t whatever its width, and examples/silo.lua without refinement inside
 * the grains discharges as it does with it.
 *
 * The bar of the jet is that of the issue, 1e-3; what is lost is round-off, as
 * the faces at its ends are weighted by the part that it covers. That of the
 * silo is the change of its rate from level 7 to 8 with refinement inside,
 * 3 % (test_silo.c): the coarse cells above the outlet must not cost more. */
#include <gsl/gsl_fit.h>

#include "report.h"
#include "runs.h"

static const char kJet[] =
    "local W, level = param('W', 0.25), param('level', 6)\n"
    "return { dimension = 2,\n"
    "  domain = { size = 4, level = level, level_min = 3 },\n"
    "  gravity = { 0, -1 },\n"
    "  grains = { density = 1, rheology = { 'mu_i', mu_s = 0.6, d = 0.02,\n"
    "      eta_min = 3e-3, regularisation = 'clip', eta_max = 100 },\n"
    "    shape = function(x, y) return -y end },\n"
    "  gas = { density = 1e-3, rheology = { 'newtonian', eta = 1e-5 } },\n"
    "  boundary = { left = 'symmetry', right = { 'outflow' },\n"
    "    bottom = 'no_slip',\n"
    "    top = function(x, y) return x < W and 'jet' or 'open' end,\n"
    "    patches = { jet = { 'inflow', velocity = { 0, -0.5 },\n"
    "                        fraction = 1 }, open = { 'outflow' } } },\n"
    "  adapt = { { 'interface', width = 3 }, { 'inside' } },\n"
    "  output = { stop = 2 } }\n";

/* Return the largest relative error of the volume in the steps to t = 2. */
static double jet_error(double width, int level) {
  char words[2][32], *override[] = {words[0], words[1]};
  snprintf(words[0], sizeof words[0], "W=%.17g", width);
  snprintf(words[1], sizeof words[1], "level=%d", level);
  struct case_file *file = case_load_text("jet.lua", kJet, 2, override);
  struct two_phase *sim = sim_start(case_params(file));
  double most = 0;
  while (sim->model.time < 2 * (1 - 1e-12) && isfinite(most)) {
    if (step_advance(sim, 2 - sim->model.time) != EXIT_DONE) most = NAN;
    const double time = sim->model.time - 0.5 * sim->model.dt; /* of c */
    const double volume = integral(sim->grid.mesh, sim->c->v);
    most = larger(most, fabs(volume / (width * 0.5 * time) - 1));
  }
  two_phase_destroy(sim);
  case_destroy(file);
  return most;
}

/* Return minus the slope of V(t), 2 <= t <= 4, of half a silo. */
static double silo_rate(const char *width, const char *inside) {
  enum { MOST = 4096 };
  static double time[MOST], volume[MOST];
  double c0, slope = NAN, cov00, cov01, cov11, sum;
  bool good = true;
  int n = 0;
  struct example example = example_new("silo", "W=%s inside=%s", width, inside);
  struct two_phase *sim = example.sim;
  while (good && sim->model.time < 4 * (1 - 1e-12)) {
    good = step_advance(sim, 4 - sim->model.time) == EXIT_DONE;
    if (sim->model.time < 2 || n == MOST) continue;
    time[n] = sim->model.time - 0.5 * sim->model.dt;
    volume[n++] = integral(sim->grid.mesh, sim->c->v);
  }
  if (good) {
    gsl_fit_linear(time, 1, volume, 1, (size_t)n, &c0, &slope, &cov00, &cov01,
                   &cov11, &sum);
  }
  example_destroy(&example);
  return -slope;
}

static void run(struct report *report) {
  static const double jet[] = {0.25, 0.2713, 0.3137, 0.031};
  static const char *const silo[] = {"0.157", "0.235125", "0.31325"};
  char grid[32];
  for (int k = 0; k < 4; k++) {
    snprintf(grid, sizeof grid, "jet %g", jet[k]);
    for (int level = 5; level <= 6; level++) {
      report_at_most(report, grid, "V from W V t", level,
                     jet_error(jet[k], level), 1e-3);
    }
  }
  for (int k = 0; k < 3; k++) {
    const double fine = silo_rate(silo[k], "true");
    const double coarse = silo_rate(silo[k], "false");
    snprintf(grid, sizeof grid, "silo %s", silo[k]);
    report_value(report, grid, "Q", 7, coarse);
    report_at_most(report, grid, "change of Q: coarse inside", 7,
                   fabs(coarse / fine - 1), 0.03);
  }
}

const struct convergence_case openings_case = {
    "openings", "Openings are as wide on a coarse grid", 2, true, run};
