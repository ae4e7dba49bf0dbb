/* SPDX-License-Identifier: GPL-3.0-or-later */
/* div(alpha grad p) - mass p = rhs in the closed unit box.
 *
 * Smooth: p = 1 + cos(2 pi x) cos(pi y), alpha and mass exp of a wave, alpha
 * from 0.4 to 2.7, mass 1 or 1e4 times that; rhs by the method of manufactured
 * solutions [roache_2002].
 *
 * Jump: alpha = 1, mass 1 and 1e6 on the two sides of a circle of radius 1/4 in
 * the middle, rhs = sin(2 pi x) sin(2 pi y), from p = 0 until max |residual| is
 * 1e-8 of max |rhs|. Where the mass is large p is 0: for what is around it that
 * is a wall. Flat: within 2 of the middle of the range over levels 5 to 10 (5
 * to 8 and two levels more in a ball that holds part of the circle). */
#include "report.h"
#include "systems.h"
#include "talus/poisson.h"

enum { FIRST = 5, UNIFORM = 6, ADAPTED = 4, MOST = 60, SPREAD = 2 };

static const double kPi = 3.14159265358979323846;

struct system {
  struct forest *forest;
  struct mesh *mesh;
  struct hierarchy *hierarchy;
  double *alpha_f, *mass, *rhs, *p;
};

static struct system system_new(struct forest *forest, position_function alpha,
                                const void *context) {
  struct system s = {.forest = forest};
  s.mesh = mesh_new(forest);
  s.hierarchy = hierarchy_new(s.mesh);
  s.alpha_f = face_values(s.mesh, alpha, context, true);
  s.mass = MEM_NEW(double, s.mesh->nleaves);
  s.rhs = MEM_NEW(double, s.mesh->nleaves);
  s.p = MEM_NEW(double, s.mesh->ncells);
  return s;
}

static void system_destroy(struct system *s) {
  mem_free(s->alpha_f), mem_free(s->mass), mem_free(s->rhs), mem_free(s->p);
  hierarchy_destroy(s->hierarchy);
  mesh_destroy(s->mesh);
  forest_destroy(s->forest);
}

static struct solve_stats system_solve(struct system *s) {
  const struct bc bc[MESH_MAX_PATCHES] = {{0}};
  return poisson_solve(s->mesh, s->hierarchy, s->alpha_f, s->mass, NULL, s->rhs,
                       bc, 1e-8 * largest_size(s->mesh, s->rhs), MOST, s->p);
}

struct problem {
  struct smooth p, log_alpha, log_mass;
};

static double source(const struct problem *problem, const double *x) {
  double sum = 0;
  for (int d = 0; d < 2; d++) {
    sum += smooth_second(&problem->p, x, d, d) +
           smooth_slope(&problem->log_alpha, x, d) *
               smooth_slope(&problem->p, x, d);
  }
  return sum * exponential(&problem->log_alpha, x) -
         exponential(&problem->log_mass, x) * smooth_value(&problem->p, x);
}

static struct norms smooth_error(const void *context, enum grid_kind grid,
                                 int level) {
  const struct problem *problem = context;
  struct system s = system_new(grid_make(grid, false, level), exponential,
                               &problem->log_alpha);
  for (int32_t i = 0; i < s.mesh->nleaves; i++) {
    s.mass[i] = exponential(&problem->log_mass, s.mesh->x[i]);
    s.rhs[i] = source(problem, s.mesh->x[i]);
  }
  const struct solve_stats stats = system_solve(&s);
  for (int32_t i = 0; i < s.mesh->nleaves; i++) {
    s.rhs[i] = s.p[i] - smooth_value(&problem->p, s.mesh->x[i]);
  }
  struct norms norms = norms_of(s.mesh, s.rhs);
  if (stats.status != SOLVE_CONVERGED) norms.l2 = norms.most = NAN;
  system_destroy(&s);
  return norms;
}

static double one(const void *context, const double *x) {
  (void)context, (void)x;
  return 1;
}

static int jump_iterations(int base, int level, bool heavy_inside) {
  struct system s =
      system_new(grid_new(MPI_COMM_WORLD, 1, false, base, level), one, NULL);
  for (int32_t i = 0; i < s.mesh->nleaves; i++) {
    const double *x = s.mesh->x[i];
    const bool inside = hypot(x[0] - 0.5, x[1] - 0.5) < 0.25;
    s.mass[i] = inside == heavy_inside ? 1e6 : 1;
    s.rhs[i] = sin(2 * kPi * x[0]) * sin(2 * kPi * x[1]);
  }
  const struct solve_stats stats = system_solve(&s);
  system_destroy(&s);
  return stats.status == SOLVE_CONVERGED ? stats.iterations : MOST;
}

static void report_jump(struct report *report, const char *name,
                        bool heavy_inside) {
  int uniform[UNIFORM], adapted[ADAPTED];
  char row[64];
  for (int l = 0; l < UNIFORM; l++) {
    uniform[l] = jump_iterations(FIRST + l, FIRST + l, heavy_inside);
  }
  for (int l = 0; l < ADAPTED; l++) {
    adapted[l] = jump_iterations(FIRST + l, FIRST + l + 2, heavy_inside);
  }
  report_counts(report, name, "iterations", FIRST, UNIFORM, uniform, MOST - 1,
                SPREAD);
  snprintf(row, sizeof row, "%s adapted", name);
  report_counts(report, row, "iterations", FIRST, ADAPTED, adapted, MOST - 1,
                SPREAD);
}

static void run(struct report *report) {
  struct problem problem = {
      .p = {.constant = 1,
            .n = 1,
            .mode = {{1, {2, 1}, {0.5 * kPi, 0.5 * kPi}}}},
      .log_alpha = {.n = 1, .mode = {{1, {2, 1}, {0.5, 1}}}},
      .log_mass = {.n = 1, .mode = {{1, {1, 2}, {1, 0.5}}}}};
  report_grids(report, "mass 1", "p", smooth_error, &problem, 1.9, 1.9);
  problem.log_mass.constant = log(1e4);
  report_grids(report, "mass 1e4", "p", smooth_error, &problem, 1.9, 1.9);
  report_jump(report, "heavy inside", true);
  report_jump(report, "heavy outside", false);
}

const struct convergence_case helmholtz_case = {
    "helmholtz", "Poisson equation with a mass", 2, true, run};
