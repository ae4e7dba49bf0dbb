/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Advection of momentum by the scheme of Bell, Colella & Glaz
 * [bell_colella_glaz_1989] in a doubly periodic unit box.
 *
 * Vortex: vortices carried by a uniform flow,
 *   u = 1 + a sin(k(x - t)) cos(k(y - t/2)),
 *   v = 1/2 - a cos(k(x - t)) sin(k(y - t/2)),  k = 2 pi, a = 1/2,
 * solve Euler's equations exactly [taylor_green_1937]; the viscosity is 1e-10.
 * Once across half the box, to t = 0.5: on one level, and through a ball with
 * cells half as large.
 *
 * Step: v = 1 in a strip, 0 elsewhere, carried along x by u = 1, and a square
 * of 1 carried at 45 degrees by a uniform u = v = 1 (advection_momentum alone,
 * where a component that does not move the others is a passive scalar). The
 * limited slopes must leave it between 0 and 1. */
#include "../mesh/bench.h"
#include "report.h"
#include "runs.h"
#include "talus/advection.h"

static const double kWave = 6.283185307179586, kMean[] = {1, 0.5}, kSize = 0.5;
static int kAxis[] = {0, 1};

struct instant {
  int d;
  double time;
};
static double carried_vortices(void *context, const double x[3]) {
  const struct instant *at = (const struct instant *)context;
  const double a = kWave * (x[0] - kMean[0] * at->time);
  const double b = kWave * (x[1] - kMean[1] * at->time);
  return kMean[at->d] +
         kSize * (at->d == 0 ? sin(a) * cos(b) : -cos(a) * sin(b));
}

static double in_ball(void *context, const double x[3]) {
  const int level = *(const int *)context;
  return hypot(x[0] - 0.53, x[1] - 0.46) < 0.23 ? level : level - 1;
}

static double vortex_error(int level, bool adapted, enum limiter limiter) {
  struct params params = periodic_params(level);
  struct instant at[] = {{0, 0}, {1, 0}};
  const double end = 0.5;
  params.grains.rheology = newtonian(1e-10);
  params.limiter = limiter;
  for (int d = 0; d < 2; d++) {
    params.velocity[d] = (struct function){carried_vortices, &at[d]};
  }
  if (adapted) {
    params.level_min = level - 1;
    params.criterion[params.ncriteria++] =
        (struct criterion){.type = CRITERION_FUNCTION,
                           .level = level,
                           .function = {in_ball, &params.level_max}};
  }
  struct two_phase *sim = sim_start(&params);
  const bool good = run_to(sim, end);
  double *error = MEM_NEW(double, sim->grid.mesh->nleaves);
  at[0].time = sim->model.time;
  for (int32_t i = 0; i < sim->grid.mesh->nleaves; i++) {
    const double x[3] = {sim->grid.mesh->x[i][0], sim->grid.mesh->x[i][1]};
    error[i] = sim->u[0]->v[i] - carried_vortices(&at[0], x);
  }
  const double l2 = norms_of(sim->grid.mesh, error).l2;
  mem_free(error);
  two_phase_destroy(sim);
  return good ? l2 : NAN;
}

static void run_vortex(struct report *report) {
  static const char *const grid[] = {"vortex uniform", "vortex adapted"};
  static const char *const limited[] = {"", "vortex minmod",
                                        "vortex generalised"};
  enum { FIRST = 4, N = 4 };
  double error[N];
  for (int adapted = 0; adapted < 2; adapted++) {
    for (int k = 0; k < N; k++) {
      error[k] = vortex_error(FIRST + k, adapted, LIMITER_NONE);
    }
    report_errors(report, grid[adapted], "L2 of u", FIRST, N, error, NULL, 1.8);
  }
  for (int l = LIMITER_MINMOD; l <= LIMITER_GENERALISED; l++) {
    for (int k = 0; k < N; k++) {
      error[k] = vortex_error(FIRST + k, false, (enum limiter)l);
    }
    report_errors(report, limited[l], "L2 of u", FIRST, N, error, NULL, 0);
  }
}

/* Return 1 in a strip, for the component across the flow. */
static double strip(void *context, const double x[3]) {
  const int d = *(const int *)context;
  return d == 0 ? 1 : fabs(x[0] - 0.5) < 0.25;
}

/* Return how far v leaves [0, 1] while the strip goes once around. */
static double strip_excess(enum limiter limiter) {
  struct params params = periodic_params(6);
  double most = 0;
  params.grains.rheology = newtonian(1e-10);
  params.limiter = limiter;
  for (int d = 0; d < 2; d++) {
    params.velocity[d] = (struct function){strip, &kAxis[d]};
  }
  struct two_phase *sim = sim_start(&params);
  bool good = true;
  while (good && sim->model.time < 1) {
    good = step_advance(sim, 1 - sim->model.time) == EXIT_DONE;
    for (int32_t i = 0; i < sim->grid.mesh->nleaves; i++) {
      const double v = sim->u[1]->v[i];
      most = larger(most, larger(-v, v - 1));
    }
  }
  two_phase_destroy(sim);
  return good ? most : NAN;
}

/* A passive component on a bench: what leaves [0, 1] when a square of 1 goes
 * around along the direction (1, slope). */
static double diagonal;
static double along(int d, const double x[3]) {
  (void)x;
  return d == 0 ? 1 : diagonal;
}
static double square(int d, const double x[3]) {
  return d == 0 && fabs(x[0] - 0.5) < 0.2 && fabs(x[1] - 0.5) < 0.2;
}

static double square_excess(enum limiter limiter, double slope) {
  enum { U, G, OUT, SLOPE, TRANSVERSE, NVECTORS };
  static const char *const names[NVECTORS][3] = {
      {"u_x", "u_y", "u_z"},
      {"g_x", "g_y", "g_z"},
      {"out_x", "out_y", "out_z"},
      {"slope_x", "slope_y", "slope_z"},
      {"transverse_x", "transverse_y", "transverse_z"}};
  static const char *const flux[] = {"flux_x", "flux_y", "flux_z"};
  struct bench *b = bench_new(1, true, 6, 6);
  struct field *field[NVECTORS][DIM];
  double *v[NVECTORS][DIM], *u_f = bench_face(b, "u_f")->v, most = 0;
  struct advection_work work = {.limiter = limiter,
                                .volume = bench_face(b, "volume")->v};
  for (int k = 0; k < NVECTORS; k++) {
    bench_vector(b, names[k], field[k]);
    field_arrays(field[k], v[k]);
  }
  for (int e = 0; e < DIM; e++) {
    work.slope[e] = v[SLOPE][e], work.transverse[e] = v[TRANSVERSE][e];
    work.flux[e] = bench_face(b, flux[e])->v;
  }
  diagonal = slope;
  fill_faces(b->mesh, along, u_f);
  fill_cells(b->mesh, square, field[U]);
  const double dt = courant_dt(b->mesh, u_f, 0.5);
  for (double time = 0; time < 1; time += dt) {
    field_fill_many(b->mesh, DIM, field[U]);
    for (int e = 0; e < DIM; e++) {
      memcpy(v[OUT][e], v[U][e], (size_t)b->mesh->nleaves * sizeof(double));
    }
    advection_momentum(b->mesh, dt, v[U], v[G], u_f, NULL, &work, v[OUT]);
    memcpy(v[U][0], v[OUT][0], (size_t)b->mesh->nleaves * sizeof(double));
    for (int32_t i = 0; i < b->mesh->nleaves; i++) {
      most = larger(most, larger(-v[U][0][i], v[U][0][i] - 1));
    }
  }
  bench_destroy(b);
  return most;
}

static void run_step(struct report *report) {
  static const char *const grid[] = {"step none", "step minmod",
                                     "step generalised"};
  for (int l = LIMITER_NONE; l <= LIMITER_GENERALISED; l++) {
    const enum limiter limiter = (enum limiter)l;
    const double excess[] = {strip_excess(limiter), square_excess(limiter, 1),
                             square_excess(limiter, 0.4),
                             square_excess(limiter, 0.2)};
    const char *const norm[] = {"new extrema of strip", "of square at 45 deg",
                                "of square at 22 deg", "of square at 11 deg"};
    for (int k = 0; k < 4; k++) {
      if (l == LIMITER_NONE) {
        report_value(report, grid[l], norm[k], 6, excess[k]);
      } else {
        report_at_most(report, grid[l], norm[k], 6, excess[k], 1e-3);
      }
    }
  }
}

static void run(struct report *report) {
  run_vortex(report);
  run_step(report);
}

const struct convergence_case advection_case = {
    "advection", "vortex and step carried by a uniform flow", 2, true, run};
