/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Order of the whole time step, advection, viscosity and projection, in a
 * doubly periodic unit box of one fluid, Crank-Nicolson.
 *
 * Space: the vortices of Taylor and Green [taylor_green_1937],
 *   u = sin(kx) cos(ky) exp(-2 nu k^2 t),  v = -cos(kx) sin(ky) exp(...),
 * k = 2 pi, nu = 0.01, to t = 0.4, uniform and with a finer rectangle that
 * cuts vortices.
 *
 * Time: their advection is a pure gradient, which the pressure takes up
 * whatever the advection scheme does. So a mean flow and waves of other
 * lengths are added, and as no exact solution is known, runs with dt, dt/2,
 * ... dt/8 on one grid are compared with one of dt/32. Upwind prediction has
 * an error of size h dt, so that dt^2 is seen alone where viscosity is faster
 * than the flow crosses a cell: nu = 0.5, Reynolds number 0.2. At nu = 0.01,
 * without a bar, h dt is all there is; second order is then that of dt ~ h,
 * seen from grid to grid. */
#include "report.h"
#include "runs.h"

static const double kWave = 6.283185307179586, kEnd = 0.4, kThin = 0.01;
static int kAxis[] = {0, 1};

static double vortices(void *context, const double x[3]) {
  const int d = *(const int *)context;
  return d == 0 ? sin(kWave * x[0]) * cos(kWave * x[1])
                : -cos(kWave * x[0]) * sin(kWave * x[1]);
}

/* Return the velocity of vortices in a mean flow, crossed by shear waves along
 * both axes. */
static double crossed(void *context, const double x[3]) {
  const int d = *(const int *)context;
  return 0.3 * (d ? -1 : 1) + 0.5 * vortices(context, x) +
         (d ? 0.3 : 0.2) * sin((d ? 1 : 2) * kWave * (x[1 - d] + 0.1));
}

static struct params flow(int level, double viscosity,
                          double (*velocity)(void *, const double *)) {
  struct params params = periodic_params(level);
  params.grains.rheology = newtonian(viscosity);
  params.theta = 0.5;
  for (int d = 0; d < 2; d++) {
    params.velocity[d] = (struct function){velocity, &kAxis[d]};
  }
  return params;
}

/* Ask for the finest level in [0.2, 0.7] x [0.35, 0.8]. */
static double rectangle(void *context, const double x[3]) {
  const int level = *(const int *)context;
  const bool inside = x[0] > 0.2 && x[0] < 0.7 && x[1] > 0.35 && x[1] < 0.8;
  return inside ? level : level - 1;
}

/* Return the error of u at the end, with steps of at most 0.4 h. */
static double space_error(int level, bool adapted) {
  struct params params = flow(level, kThin, vortices);
  if (adapted) {
    params.level_min = level - 1;
    params.criterion[params.ncriteria++] =
        (struct criterion){.type = CRITERION_FUNCTION,
                           .level = level,
                           .function = {rectangle, &params.level_max}};
  }
  struct two_phase *sim = sim_start(&params);
  const double dt = 0.4 / (1 << level);
  bool good = true;
  while (good && sim->model.time < kEnd - 1e-12) {
    good = step_advance(sim, fmin(dt, kEnd - sim->model.time)) == EXIT_DONE;
  }
  double *error = MEM_NEW(double, sim->grid.mesh->nleaves);
  const double decay = exp(-2 * kThin * kWave * kWave * sim->model.time);
  for (int32_t i = 0; i < sim->grid.mesh->nleaves; i++) {
    const double x[3] = {sim->grid.mesh->x[i][0], sim->grid.mesh->x[i][1]};
    error[i] = sim->u[0]->v[i] - decay * vortices(&kAxis[0], x);
  }
  const double l2 = norms_of(sim->grid.mesh, error).l2;
  mem_free(error);
  two_phase_destroy(sim);
  return good ? l2 : NAN;
}

/* Return u of the crossed flow at `time` after equal steps, in Morton order,
 * for the caller to free; NULL if a step fails or is shorter than asked for. */
static double *crossed_run(int level, double viscosity, double time,
                           int steps) {
  struct params params = flow(level, viscosity, crossed);
  params.tolerance_pressure = params.tolerance_viscous = 1e-10;
  struct two_phase *sim = sim_start(&params);
  const double dt = time / steps;
  bool good = true;
  for (int k = 0; k < steps && good; k++) {
    good = step_advance(sim, dt) == EXIT_DONE &&
           fabs(sim->model.dt / dt - 1) < 1e-12;
  }
  const size_t n = (size_t)1 << (2 * level);
  double *u = good ? MEM_NEW(double, n) : NULL;
  if (good) memcpy(u, sim->u[0]->v, n * sizeof *u);
  two_phase_destroy(sim);
  return u;
}

/* Return the root mean square of the difference, `fine` having 2^(2 finer)
 * cells where u has one: cells are in Morton order. */
static double difference(int level, const double *u, int finer,
                         const double *fine) {
  const size_t n = (size_t)1 << (2 * level), m = (size_t)1 << (2 * finer);
  double sum = 0;
  if (!u || !fine) return NAN;
  for (size_t i = 0; i < n; i++) {
    double mean = 0;
    for (size_t k = 0; k < m; k++) mean += fine[m * i + k] / (double)m;
    sum += (u[i] - mean) * (u[i] - mean);
  }
  return sqrt(sum / (double)n);
}

/* Report orders in time; `level` of the rows: log2 of the number of steps. */
static void time_order(struct report *report, const char *grid,
                       double viscosity, double order) {
  enum { LEVEL = 6, N = 4, FIRST = 5 };
  const double time = 0.03;
  double error[N], *best = crossed_run(LEVEL, viscosity, time, 32 << FIRST);
  for (int k = 0; k < N; k++) {
    double *u = crossed_run(LEVEL, viscosity, time, 1 << (FIRST + k));
    error[k] = difference(LEVEL, u, 0, best);
    mem_free(u);
  }
  mem_free(best);
  report_errors(report, grid, "L2 of u by dt", FIRST, N, error, NULL, order);
}

/* Report orders with dt = h / 4: each grid against the next. */
static void joint_order(struct report *report) {
  enum { N = 4, FIRST = 4 };
  const double time = 0.25;
  double error[N], *u = crossed_run(FIRST, kThin, time, 1 << FIRST);
  for (int k = 0; k < N; k++) {
    const int level = FIRST + k;
    double *next = crossed_run(level + 1, kThin, time, 2 << level);
    error[k] = difference(level, u, 1, next);
    mem_free(u);
    u = next;
  }
  mem_free(u);
  report_errors(report, "crossed", "L2 of u(h) - u(h/2)", FIRST, N, error, NULL,
                1.8);
}

static void run(struct report *report) {
  enum { FIRST = 4, N = 4 };
  for (int adapted = 0; adapted < 2; adapted++) {
    double error[N];
    for (int k = 0; k < N; k++) error[k] = space_error(FIRST + k, adapted);
    report_errors(report, adapted ? "adapted" : "uniform", "L2 of u", FIRST, N,
                  error, NULL, 1.9);
  }
  time_order(report, "crossed nu 0.5", 0.5, 1.8);
  time_order(report, "crossed nu 0.01", kThin, 0);
  joint_order(report);
}

const struct convergence_case taylor_green_case = {
    "taylor_green", "Taylor-Green vortices, order in space and time", 2, true,
    run};
