/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Implicit viscosity with the full stress tensor,
 *   u - dt div(eta (grad u + grad u^T)) = rhs,   rho = 1, dt = 1,
 * by the method of manufactured solutions [roache_2002]:
 *   rhs_d = u_d - dt eta (lap u_d + d_d div u
 *                         + sum_e a_e (d_e u_d + d_d u_e)),  a = grad log(eta)
 * at cell centres, with eta = 10^(3 sin cos) smooth over six decades (from
 * 1e-3 to 1e3) and u not solenoidal, so that the transposed gradient counts.
 * Dirichlet: u = (0.3, -0.2) on all walls (u = 0 would have the same errors);
 * periodic. There most of the error on adapted grids is the mean velocity: the
 * exact forces at the centres of leaves of two sizes do not add up to 0. */
#include "report.h"
#include "systems.h"
#include "talus/viscous.h"

enum { MOST = 100 };

struct problem {
  const char *name;
  struct smooth u[2], log_eta;
  bool periodic;
};

static const double kQuarter = 1.57079632679489661923; /* of a wave */
static const double kDt = 1;

static void problems(struct problem problem[2]) {
  const double decades = 3 * log(10);
  const struct smooth walls[2] = {
      {.n = 2, .mode = {{1, {1, 2}, {0, 0}}, {0.5, {2, 1}, {0, 0}}}},
      {.n = 2, .mode = {{0.7, {2, 3}, {0, 0}}, {1, {1, 1}, {0, 0}}}}};
  const struct smooth waves[2] = {
      {.n = 2, .mode = {{1, {2, 2}, {0.4, 1.1}}, {0.5, {2, 0}, {2, 1}}}},
      {.n = 2, .mode = {{0.7, {2, 2}, {1.3, 0.2}}, {0.6, {0, 4}, {1, 0.3}}}}};
  const struct smooth log_eta = {
      .n = 1, .mode = {{decades, {2, 2}, {0.5, 0.5 + kQuarter}}}};
  problem[0] = (struct problem){"dirichlet", {walls[0], walls[1]}, log_eta, 0};
  problem[1] = (struct problem){"periodic", {waves[0], waves[1]}, log_eta, 1};
  problem[0].u[0].constant = 0.3;
  problem[0].u[1].constant = -0.2;
}

static double source(const struct problem *problem, const double *x, int d) {
  const struct smooth *u = problem->u;
  double sum = 0;
  for (int e = 0; e < 2; e++) {
    sum += smooth_second(&u[d], x, e, e) + smooth_second(&u[e], x, e, d) +
           smooth_slope(&problem->log_eta, x, e) *
               (smooth_slope(&u[d], x, e) + smooth_slope(&u[e], x, d));
  }
  return smooth_value(&u[d], x) - kDt * sum * exponential(&problem->log_eta, x);
}

struct system {
  struct forest *forest;
  struct mesh *mesh;
  struct hierarchy *hierarchy;
  struct bc side[DIM][MESH_MAX_PATCHES];
  double *eta_f, *rho, *u[DIM], *rhs[DIM];
};

static void system_start(struct system *s, const struct problem *problem,
                         enum grid_kind grid, int level) {
  s->forest = grid_make(grid, problem->periodic, level);
  s->mesh = mesh_new(s->forest);
  s->hierarchy = hierarchy_new(s->mesh);
  s->eta_f = face_values(s->mesh, exponential, &problem->log_eta, false);
  s->rho = MEM_NEW(double, s->mesh->nleaves);
  for (int32_t i = 0; i < s->mesh->nleaves; i++) s->rho[i] = 1;
  for (int d = 0; d < DIM; d++) {
    s->u[d] = MEM_NEW(double, s->mesh->ncells);
    s->rhs[d] = MEM_NEW(double, s->mesh->nleaves);
    for (int32_t i = 0; i < s->mesh->nleaves; i++) {
      s->rhs[d][i] = source(problem, s->mesh->x[i], d);
    }
    for (int k = 0; k < MESH_MAX_PATCHES; k++) {
      s->side[d][k] = (struct bc){BC_DIRICHLET, problem->u[d].constant, 0};
    }
  }
}

static void system_end(struct system *s) {
  for (int d = 0; d < DIM; d++) mem_free(s->u[d]), mem_free(s->rhs[d]);
  mem_free(s->eta_f), mem_free(s->rho);
  hierarchy_destroy(s->hierarchy);
  mesh_destroy(s->mesh);
  forest_destroy(s->forest);
}

/* Measure L2 of the error of the velocity vector, and its largest component. */
static struct norms solve(const void *context, enum grid_kind grid, int level) {
  const struct problem *problem = context;
  struct system s = {0};
  const struct bc *bc[DIM];
  double scale = 0;
  system_start(&s, problem, grid, level);
  for (int d = 0; d < DIM; d++) {
    bc[d] = s.side[d];
    scale = larger(scale, largest_size(s.mesh, s.rhs[d]));
  }
  const struct solve_stats stats = viscous_solve(
      s.mesh, s.hierarchy, s.rho, &(struct viscosity){.eta_f = s.eta_f}, kDt,
      s.rhs, bc, 1e-8 * scale, MOST, s.u);
  struct norms norms = {0};
  for (int d = 0; d < DIM; d++) {
    double *error = s.rhs[d]; /* done with */
    for (int32_t i = 0; i < s.mesh->nleaves; i++) {
      error[i] = s.u[d][i] - smooth_value(&problem->u[d], s.mesh->x[i]);
    }
    const struct norms part = norms_of(s.mesh, error);
    norms.l2 = hypot(norms.l2, part.l2);
    norms.most = larger(norms.most, part.most);
  }
  if (stats.status != SOLVE_CONVERGED) norms.l2 = norms.most = NAN;
  system_end(&s);
  return norms;
}

static void run(struct report *report) {
  struct problem problem[2];
  problems(problem);
  for (int k = 0; k < 2; k++) {
    report_grids(report, problem[k].name, "u", solve, &problem[k], 1.9, 0);
  }
}

const struct convergence_case viscosity_case = {
    "viscosity", "implicit viscosity over six decades", 2, true, run};
