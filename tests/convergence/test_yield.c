/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Layers that stop, with an exact yield (yield.h), one viscous solve
 * a step; depth 1 in 32 cells on a slope, rho = g = 1, no slip below.
 *
 * Coulomb: mu = 0.38, 10 degrees, u = y at first. Where it moves it loses k =
 *   cos(a) (mu - tan(a)) = 0.200579 a time, u = max(0, y - k t), so that the
 * top cell stops at 63/64/k = 4.9077. Bingham: tau_y = 0.25, eta_0 = 0.1, half
 * a channel with the flow that a force of 1 keeps, left with one of 0.1. No
 * closed form; stops at 5.0625 with 128 cells and dt = 5e-4 of another code,
 * within the bound 6.2977 of energy. mu(I): 0.38, 0.26, I0 = 0.3, d = 0.04,
 * Bagnold's flow of 25 degrees on 15; stops at 13.15 (128 cells, another code).
 * Tilt: the same from rest on 25 degrees has at t = 1 the speed 0.0782 (dt =
 * 5e-4, up to five solves a step).
 *
 * The bars are those of a scheme of first order in time: 4 % at dt = 0.02, 2.5
 * % at 0.01; the time of stopping is that when the fastest cell is below 1e-9.
 */
#include "bagnold.h"

enum { CELLS = 32 };

struct layer {
  const char *name;
  double degrees, force; /* slope, or along it without one */
  double (*velocity)(void *context, const double x[3]);
  double stop; /* exact */
};

static double shear(void *context, const double x[3]) {
  (void)context;
  return x[1];
}

static double channel(void *context, const double x[3]) {
  const double y = fmin(x[1], 0.75);
  (void)context;
  return (0.75 * y - 0.5 * y * y) / 0.1;
}

static double steep(void *context, const double x[3]) {
  (void)context;
  return bagnold_exact(25 * acos(-1) / 180, x[1]);
}

static const struct layer kLayers[] = {
    {"coulomb", 10, 0, shear, 4.9077},
    {"bingham", 0, 0.1, channel, 5.0625},
    {"mu_i", 15, 0, steep, 13.15},
};

static struct rheology closure(const char *name) {
  static const struct {
    const char *key;
    double value;
  } values[] = {{"mu_s", 0.38}, {"delta_mu", 0.26}, {"I0", 0.3},   {"d", 0.04},
                {"rho", 1},     {"tau_y", 0.25},    {"eta_0", 0.1}};
  struct rheology r;
  rheology_init(&r, rheology_find(name));
  for (size_t k = 0; k < sizeof values / sizeof *values; k++)
    rheology_set(&r, values[k].key, values[k].value);
  rheology_set_regularisation(&r, "exact");
  return r;
}

static struct params params_of(const struct layer *layer, double dt) {
  const double slope = layer->degrees * acos(-1) / 180;
  struct params p = box_params(1);
  p.single_phase = true;
  p.size = 2. / CELLS;
  p.trees[1] = CELLS / 2;
  p.grains = (struct phase){1, closure(layer->name)};
  p.velocity[0] = (struct function){layer->velocity, NULL};
  p.gravity[0] = layer->force > 0 ? layer->force : sin(slope);
  p.gravity[1] = layer->force > 0 ? 0 : -cos(slope);
  p.boundary[0].type = p.boundary[1].type = BOUNDARY_PERIODIC;
  p.boundary[2].type = BOUNDARY_NO_SLIP;
  p.boundary[3].type = layer->force > 0 ? BOUNDARY_SLIP : BOUNDARY_OUTFLOW;
  p.tolerance_pressure = p.tolerance_viscous = 1e-12;
  p.cfl = 1;
  p.dt_max = dt;
  return p;
}

static double fastest(const struct two_phase *sim) {
  double most = 0;
  for (int32_t i = 0; i < sim->grid.mesh->nleaves; i++)
    most = larger(most, fabs(sim->u[0]->v[i]));
  return most;
}

/* Return when the layer stops; NAN if it does not by twice its time. */
static double stop_of(const struct layer *layer, double dt) {
  const struct params p = params_of(layer, dt);
  struct two_phase *sim = sim_start(&p);
  bool good = true;
  while (good && fastest(sim) > 1e-9 && sim->model.time < 2 * layer->stop)
    good = step_advance(sim, 1) == EXIT_DONE;
  const double time = good && fastest(sim) <= 1e-9 ? sim->model.time : NAN;
  two_phase_destroy(sim);
  return time;
}

/* Return the speed of a layer 1 after it has been tilted to 25 degrees from 15,
 * at which it had rested for a time. */
static double speed_of_tilted(double dt, double rested) {
  const struct layer from = {"mu_i", rested > 0 ? 15 : 25, 0, NULL, 0};
  const double slope = 25 * acos(-1) / 180;
  struct params p = params_of(&from, dt);
  struct two_phase *sim = sim_start(&p);
  const bool good = run_to(sim, rested);
  p.gravity[0] = sin(slope), p.gravity[1] = -cos(slope);
  const double speed = good && run_to(sim, rested + 1) ? fastest(sim) : NAN;
  two_phase_destroy(sim);
  return speed;
}

static void run(struct report *report) {
  static const double dt[] = {0.02, 0.01}, bar[] = {0.04, 0.025};
  for (int k = 0; k < 3; k++) {
    for (int j = 0; j < 2; j++) {
      char name[64];
      snprintf(name, sizeof name, "%s dt %g", kLayers[k].name, dt[j]);
      const double stop = stop_of(&kLayers[k], dt[j]);
      report_at_most(report, name, "stops late by", 5,
                     fabs(stop / kLayers[k].stop - 1), bar[j]);
    }
  }
  report_at_most(report, "let go dt 0.01", "speed off by", 5,
                 fabs(speed_of_tilted(0.01, 0) / 0.0782 - 1), 0.03);
  report_at_most(report, "tilted dt 0.01", "speed off by", 5,
                 fabs(speed_of_tilted(0.01, 1) / 0.0782 - 1), 0.03);
}

const struct convergence_case yield_case = {
    "yield", "layers with an exact yield stop when they should", 2, true, run};
