/* SPDX-License-Identifier: GPL-3.0-or-later */
/* div(alpha grad p) = rhs in the unit box with smooth solutions, by the method
 * of manufactured solutions [roache_2002]: p and log(alpha) are chosen,
 *   rhs = alpha (lap p + grad(log alpha) . grad p)
 * taken at cell centres.
 *   dirichlet: p = 0.7 on all sides; neumann: dp/dn differs from side to side;
 *   periodic; variable: alpha from 0.14 to 7.4, p = 0 and 1 on the sides along
 *   x, closed along y.
 * Residuals go down to 1e-8 of the right-hand side. Where p is determined up
 * to a constant, what the sum of rhs over the leaves lacks of the flux through
 * the sides, of the order of h^2, is spread evenly over the box. */
#include "report.h"
#include "systems.h"
#include "talus/poisson.h"

enum { MOST = 60 };

struct problem {
  const char *name;
  struct smooth p, log_alpha;
  struct bc bc[4];
  bool periodic, singular;
};

static const double kQuarter = 1.57079632679489661923; /* of a wave */

static void problems(struct problem problem[4]) {
  problem[0] = (struct problem){
      .name = "dirichlet",
      .p = {.constant = 0.7,
            .n = 2,
            .mode = {{1, {1, 2}, {0, 0}}, {0.5, {3, 1}, {0, 0}}}},
  };
  problem[1] = (struct problem){
      .name = "neumann",
      .p = {.slope = {0.7, 0.3},
            .curve = {0, 0.8},
            .n = 1,
            .mode = {{1, {1, 2}, {kQuarter, kQuarter}}}},
      .bc = {{.value = -0.7}, {.value = 0.7}, {.value = -0.3}, {.value = 1.1}},
      .singular = true};
  problem[2] = (struct problem){
      .name = "periodic",
      .p = {.n = 2, .mode = {{1, {2, 2}, {0.3, 1.1}}, {0.5, {4, 2}, {0.7, 2}}}},
      .periodic = true,
      .singular = true};
  problem[3] = (struct problem){
      .name = "variable",
      .p = {.slope = {1, 0}, .n = 1, .mode = {{0.5, {1, 2}, {0, kQuarter}}}},
      .log_alpha = {.n = 1, .mode = {{2, {2, 1}, {0.5, 1}}}},
      .bc = {{BC_DIRICHLET, 0, 0}, {BC_DIRICHLET, 1, 0}}};
  for (int side = 0; side < 4; side++) {
    problem[0].bc[side] = (struct bc){BC_DIRICHLET, 0.7, 0};
  }
}

static double source(const struct problem *problem, const double *x) {
  double sum = 0;
  for (int d = 0; d < 2; d++) {
    sum += smooth_second(&problem->p, x, d, d) +
           smooth_slope(&problem->log_alpha, x, d) *
               smooth_slope(&problem->p, x, d);
  }
  return sum * exponential(&problem->log_alpha, x);
}

/* Make rhs balance what flows through the sides of the unit box. */
static void balance(const struct problem *problem, const struct mesh *mesh,
                    const double *alpha_f, double *rhs) {
  double flux = 0;
  if (!problem->singular) return;
  for (int32_t f = 0; f < mesh->nfaces; f++) {
    const int patch = mesh->face_patch[f];
    if (patch >= 0) {
      flux += alpha_f[f] * problem->bc[patch].value * mesh->face_h[f];
    }
  }
  remove_mean(mesh, rhs);
  for (int32_t i = 0; i < mesh->nleaves; i++) rhs[i] += flux;
}

static struct norms error_of(const struct problem *problem,
                             const struct mesh *mesh, const double *p) {
  double *error = MEM_NEW(double, mesh->nleaves);
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    error[i] = p[i] - smooth_value(&problem->p, mesh->x[i]);
  }
  if (problem->singular) remove_mean(mesh, error);
  const struct norms norms = norms_of(mesh, error);
  mem_free(error);
  return norms;
}

static struct norms solve(const void *context, enum grid_kind grid, int level) {
  const struct problem *problem = context;
  struct forest *forest = grid_make(grid, problem->periodic, level);
  struct mesh *mesh = mesh_new(forest);
  struct hierarchy *hierarchy = hierarchy_new(mesh);
  double *alpha_f = face_values(mesh, exponential, &problem->log_alpha, false);
  double *rhs = MEM_NEW(double, mesh->nleaves);
  double *p = MEM_NEW(double, mesh->ncells);
  struct bc bc[MESH_MAX_PATCHES] = {{0}};
  memcpy(bc, problem->bc, sizeof problem->bc);
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    rhs[i] = source(problem, mesh->x[i]);
  }
  balance(problem, mesh, alpha_f, rhs);
  const struct solve_stats stats =
      poisson_solve(mesh, hierarchy, alpha_f, NULL, NULL, rhs, bc,
                    1e-8 * largest_size(mesh, rhs), MOST, p);
  struct norms norms = error_of(problem, mesh, p);
  if (stats.status != SOLVE_CONVERGED) norms.l2 = norms.most = NAN;
  mem_free(alpha_f), mem_free(rhs), mem_free(p);
  hierarchy_destroy(hierarchy);
  mesh_destroy(mesh);
  forest_destroy(forest);
  return norms;
}

static void run(struct report *report) {
  struct problem problem[4];
  problems(problem);
  for (int k = 0; k < 4; k++) {
    report_grids(report, problem[k].name, "p", solve, &problem[k], 1.9, 1.9);
  }
}

const struct convergence_case poisson_case = {
    "poisson", "Poisson equation, smooth solutions", 2, true, run};
