/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Solvers and the step in 3D, with the bars of the cases in 2D.
 *   poisson    div(alpha grad p) = rhs, p given on all sides, alpha from 0.25
 *              to 4 (test_poisson.c)
 *   viscosity  u - div(eta (grad u + grad u^T)) = rhs, eta over six decades
 *              (test_viscosity.c)
 *   vortices   of Taylor and Green in planes across x, to t = 0.2, uniform and
 *              with a finer ball (test_taylor_green.c)
 *   bed        at rest, its surface tilted along both axes, for 200 steps
 *              (test_hydrostatics.c)
 */
#include "report.h"
#include "systems.h"
#include "talus/poisson.h"
#include "talus/viscous.h"

enum { MOST = 100 };
static const double kQuarter = 1.57079632679489661923; /* of a wave */

/* p or u, and log(alpha) or log(eta) */
struct problem {
  struct smooth field[3], log_alpha;
};

static const struct problem kPoisson = {
    .field = {{.constant = 0.7,
               .n = 2,
               .mode = {{1, {1, 2, 1}, {0}}, {0.5, {3, 1, 2}, {0}}}}},
    .log_alpha = {.n = 1, .mode = {{1.4, {2, 1, 1}, {0.5, 1, 0.3}}}}};

static const struct problem kViscosity = {
    .field = {{.constant = 0.3,
               .n = 2,
               .mode = {{1, {1, 2, 1}, {0}}, {0.5, {2, 1, 1}, {0}}}},
              {.constant = -0.2, .n = 1, .mode = {{0.7, {2, 1, 2}, {0}}}},
              {.constant = 0.1, .n = 1, .mode = {{1, {1, 1, 2}, {0}}}}},
    /* 3 decades up and down */
    .log_alpha = {.n = 1,
                  .mode = {{6.9, {1, 1, 2}, {0.5, 0.8, 0.5 + kQuarter}}}}};

static struct norms error_of(const struct mesh *mesh, const double *v,
                             const struct smooth *exact) {
  double *error = MEM_NEW(double, mesh->nleaves);
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    error[i] = v[i] - smooth_value(exact, mesh->x[i]);
  }
  const struct norms norms = norms_of(mesh, error);
  mem_free(error);
  return norms;
}

static double poisson_source(const struct problem *problem, const double *x) {
  double sum = 0;
  for (int d = 0; d < DIM; d++) {
    sum += smooth_second(&problem->field[0], x, d, d) +
           smooth_slope(&problem->log_alpha, x, d) *
               smooth_slope(&problem->field[0], x, d);
  }
  return sum * exponential(&problem->log_alpha, x);
}

static struct norms solve_poisson(const void *context, enum grid_kind grid,
                                  int level) {
  const struct problem *problem = context;
  struct forest *forest = grid_make(grid, false, level);
  struct mesh *mesh = mesh_new(forest);
  struct hierarchy *hierarchy = hierarchy_new(mesh);
  double *alpha_f = face_values(mesh, exponential, &problem->log_alpha, false);
  double *rhs = MEM_NEW(double, mesh->nleaves);
  double *p = MEM_NEW(double, mesh->ncells);
  struct bc bc[MESH_MAX_PATCHES];
  for (int k = 0; k < MESH_MAX_PATCHES; k++) {
    bc[k] = (struct bc){BC_DIRICHLET, problem->field[0].constant, 0};
  }
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    rhs[i] = poisson_source(problem, mesh->x[i]);
  }
  const struct solve_stats stats =
      poisson_solve(mesh, hierarchy, alpha_f, NULL, NULL, rhs, bc,
                    1e-8 * largest_size(mesh, rhs), MOST, p);
  struct norms norms = error_of(mesh, p, &problem->field[0]);
  if (stats.status != SOLVE_CONVERGED) norms.l2 = norms.most = NAN;
  mem_free(alpha_f), mem_free(rhs), mem_free(p);
  hierarchy_destroy(hierarchy);
  mesh_destroy(mesh);
  forest_destroy(forest);
  return norms;
}

static double viscous_source(const struct problem *problem, const double *x,
                             int d) {
  const struct smooth *u = problem->field;
  double sum = 0;
  for (int e = 0; e < DIM; e++) {
    sum += smooth_second(&u[d], x, e, e) + smooth_second(&u[e], x, e, d) +
           smooth_slope(&problem->log_alpha, x, e) *
               (smooth_slope(&u[d], x, e) + smooth_slope(&u[e], x, d));
  }
  return smooth_value(&u[d], x) - sum * exponential(&problem->log_alpha, x);
}

static struct norms solve_viscosity(const void *context, enum grid_kind grid,
                                    int level) {
  const struct problem *problem = context;
  struct forest *forest = grid_make(grid, false, level);
  struct mesh *mesh = mesh_new(forest);
  struct hierarchy *hierarchy = hierarchy_new(mesh);
  double *eta_f = face_values(mesh, exponential, &problem->log_alpha, false);
  double *rho = MEM_NEW(double, mesh->nleaves), *u[DIM], *rhs[DIM], scale = 0;
  struct bc side[DIM][MESH_MAX_PATCHES];
  const struct bc *bc[DIM];
  for (int32_t i = 0; i < mesh->nleaves; i++) rho[i] = 1;
  for (int d = 0; d < DIM; d++) {
    u[d] = MEM_NEW(double, mesh->ncells);
    rhs[d] = MEM_NEW(double, mesh->nleaves);
    bc[d] = side[d];
    for (int32_t i = 0; i < mesh->nleaves; i++) {
      rhs[d][i] = viscous_source(problem, mesh->x[i], d);
    }
    scale = larger(scale, largest_size(mesh, rhs[d]));
    for (int k = 0; k < MESH_MAX_PATCHES; k++) {
      side[d][k] = (struct bc){BC_DIRICHLET, problem->field[d].constant, 0};
    }
  }
  const struct solve_stats stats =
      viscous_solve(mesh, hierarchy, rho, &(struct viscosity){.eta_f = eta_f},
                    1, rhs, bc, 1e-8 * scale, MOST, u);
  struct norms norms = {0};
  for (int d = 0; d < DIM; d++) {
    const struct norms part = error_of(mesh, u[d], &problem->field[d]);
    norms.l2 = hypot(norms.l2, part.l2);
    norms.most = larger(norms.most, part.most);
    mem_free(u[d]), mem_free(rhs[d]);
  }
  if (stats.status != SOLVE_CONVERGED) norms.l2 = norms.most = NAN;
  mem_free(eta_f), mem_free(rho);
  hierarchy_destroy(hierarchy);
  mesh_destroy(mesh);
  forest_destroy(forest);
  return norms;
}

static const double kWave = 6.283185307179586, kEnd = 0.2, kThin = 0.01;
static int kAxis[] = {0, 1, 2};

static double vortices(void *context, const double x[3]) {
  const int d = *(const int *)context;
  if (d == 0) return 0;
  return d == 1 ? sin(kWave * x[1]) * cos(kWave * x[2])
                : -cos(kWave * x[1]) * sin(kWave * x[2]);
}

/* Ask for the finest level in a ball. */
static double ball_level(void *context, const double x[3]) {
  const int level = *(const int *)context;
  const double r2 = (x[0] - 0.4) * (x[0] - 0.4) +
                    (x[1] - 0.55) * (x[1] - 0.55) +
                    (x[2] - 0.45) * (x[2] - 0.45);
  return r2 < 0.09 ? level : level - 1;
}

static void refine_ball(struct params *params) {
  params->level_min = params->level_max - 1;
  params->criterion[params->ncriteria++] =
      (struct criterion){.type = CRITERION_FUNCTION,
                         .level = params->level_max,
                         .function = {ball_level, &params->level_max}};
}

/* Return the error of u_y at the end, with steps of at most 0.4 h. */
static double vortices_error(int level, bool adapted) {
  struct params params = periodic_params(level);
  params.grains.rheology = newtonian(kThin);
  params.theta = 0.5;
  for (int d = 0; d < DIM; d++) {
    params.velocity[d] = (struct function){vortices, &kAxis[d]};
  }
  if (adapted) refine_ball(&params);
  struct two_phase *sim = sim_start(&params);
  const double dt = 0.4 / (1 << level);
  bool good = true;
  while (good && sim->model.time < kEnd - 1e-12) {
    good = step_advance(sim, fmin(dt, kEnd - sim->model.time)) == EXIT_DONE;
  }
  double *error = MEM_NEW(double, sim->grid.mesh->nleaves);
  const double decay = exp(-2 * kThin * kWave * kWave * sim->model.time);
  for (int32_t i = 0; i < sim->grid.mesh->nleaves; i++) {
    double x[3] = {0};
    for (int d = 0; d < DIM; d++) x[d] = sim->grid.mesh->x[i][d];
    error[i] = sim->u[1]->v[i] - decay * vortices(&kAxis[1], x);
  }
  const double l2 = norms_of(sim->grid.mesh, error).l2;
  mem_free(error);
  two_phase_destroy(sim);
  return good ? l2 : NAN;
}

static const double kDepth = 0.53;

static double bed(void *context, const double x[3]) {
  const double *down = context;
  return down[0] * (x[0] - 0.5) + down[1] * (x[1] - 0.5) +
         down[2] * (x[2] - kDepth);
}

/* Return the largest |u| of a bed at rest in sqrt(g H), its slope along x and
 * half of it along y. */
static double bed_speed(int level, bool adapted, double slope) {
  enum { STEPS = 200 };
  const double length = sqrt(1 + 1.25 * slope * slope);
  double down[] = {slope / length, 0.5 * slope / length, -1 / length}, most = 0;
  struct params params = box_params(level);
  params.shape = (struct function){bed, down};
  params.tolerance_pressure = params.tolerance_viscous = 1e-12;
  for (int d = 0; d < DIM; d++) params.gravity[d] = down[d];
  if (adapted) refine_ball(&params);
  struct two_phase *sim = sim_start(&params);
  bool good = true;
  for (int k = 0; k < STEPS && good; k++) {
    good = step_advance(sim, 0.05) == EXIT_DONE;
    most = larger(most, largest(sim, sim->u) / sqrt(kDepth));
  }
  two_phase_destroy(sim);
  return good ? most : NAN;
}

static void run_bed(struct report *report, const char *grid, bool adapted,
                    double slope, double bar) {
  enum { FIRST = 3, N = 2 };
  for (int k = 0; k < N; k++) {
    report_at_most(report, grid, "max |u|", FIRST + k,
                   bed_speed(FIRST + k, adapted, slope), bar);
  }
}

static void run(struct report *report) {
  enum { FIRST = 3, N = 3 };
  report_grids(report, "poisson", "p", solve_poisson, &kPoisson, 1.9, 1.9);
  report_grids(report, "viscosity", "u", solve_viscosity, &kViscosity, 1.9, 0);
  for (int adapted = 0; adapted < 2; adapted++) {
    double error[N];
    for (int k = 0; k < N; k++) error[k] = vortices_error(FIRST + k, adapted);
    report_errors(report, adapted ? "vortices adapted" : "vortices uniform",
                  "L2 of u", FIRST, N, error, NULL, 1.9);
  }
  run_bed(report, "bed flat", false, 0, 1e-10);
  run_bed(report, "bed tilted", false, 0.4, 1e-10);
  run_bed(report, "bed tilted adapted", true, 0.4, 1e-10);
}

const struct convergence_case octree_case = {
    "octree", "solvers and the step in three dimensions", 3, false, run};
