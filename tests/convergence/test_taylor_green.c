/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The vortices of Taylor and Green [taylor_green_1937] in a doubly periodic
 * unit box,
 *   u = sin(kx) cos(ky) exp(-2 nu k^2 t),  v = -cos(kx) sin(ky) exp(...),
 * k = 2 pi, nu = 0.01, to t = 0.4: the whole time step, advection, viscosity
 * and projection. */
#include "report.h"
#include "runs.h"

static const double kWave = 6.283185307179586, kViscosity = 0.01, kEnd = 0.4;
static int kAxis[] = {0, 1};

static double exact(void *context, const double x[3]) {
  const int d = *(const int *)context;
  return d == 0 ? sin(kWave * x[0]) * cos(kWave * x[1])
                : -cos(kWave * x[0]) * sin(kWave * x[1]);
}

static struct params taylor_green(int level, double theta) {
  struct params params = periodic_params(level);
  params.grains.rheology = newtonian(kViscosity);
  params.theta = theta;
  for (int d = 0; d < 2; d++) {
    params.velocity[d] = (struct function){exact, &kAxis[d]};
  }
  return params;
}

/* Error of u at the end, with steps of 0.4 h. */
static double space_error(int level) {
  const struct params params = taylor_green(level, 0.5);
  struct simulation *sim = simulation_new(&params);
  const double dt = 0.4 / (1 << level);
  bool good = true;
  while (good && sim->time < kEnd - 1e-12) {
    good = step_advance(sim, fmin(dt, kEnd - sim->time)) == EXIT_DONE;
  }
  double *error = sim->frozen->v;
  const double decay = exp(-2 * kViscosity * kWave * kWave * sim->time);
  for (int32_t i = 0; i < sim->mesh->nleaves; i++) {
    const double x[3] = {sim->mesh->x[i][0], sim->mesh->x[i][1]};
    error[i] = sim->u[0]->v[i] - decay * exact(&kAxis[0], x);
  }
  const double l2 = norms_of(sim->mesh, error).l2;
  simulation_destroy(sim);
  return good ? l2 : NAN;
}

static void run(struct report *report) {
  enum { FIRST = 4, N = 4 };
  double error[N];
  for (int k = 0; k < N; k++) error[k] = space_error(FIRST + k);
  report_errors(report, "uniform", "L2 of u", FIRST, N, error, NULL, 1.9);
}

const struct convergence_case taylor_green_case = {
    "taylor_green", "Taylor-Green vortices, space order", 2, true, run};
