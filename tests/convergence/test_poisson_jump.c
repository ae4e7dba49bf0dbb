/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Iterations of the Poisson solver where alpha jumps by 1000 across a circle
 * of radius 1/4 in the middle of the closed unit box: 1/rho of a heavy disc,
 * and of heavy surroundings. rhs = sin(2 pi x) sin(2 pi y), from p = 0 until
 * max |residual| is 1e-8 of max |rhs|.
 *
 * Flat: within 2 of the middle of the range over levels 5 to 10 (5 to 8 and
 * two levels more in a ball that holds part of the circle). */
#include "report.h"
#include "systems.h"
#include "talus/poisson.h"

enum { FIRST = 5, UNIFORM = 6, ADAPTED = 4, MOST = 60, SPREAD = 2 };

/* Return alpha across the circle; `inside` of it is 1 or 1000 times the
 * outside. */
static double jump(const void *inside_is_heavy, const double *x) {
  const double r = hypot(x[0] - 0.5, x[1] - 0.5);
  return (r < 0.25) == *(const bool *)inside_is_heavy ? 1 : 1000;
}

static int iterations(int base, int level, bool inside_is_heavy) {
  static const double two_pi = 6.28318530717958647693;
  struct forest *forest = grid_new(MPI_COMM_WORLD, 1, false, base, level);
  struct mesh *mesh = mesh_new(forest);
  struct hierarchy *hierarchy = hierarchy_new(mesh);
  double *alpha_f = face_values(mesh, jump, &inside_is_heavy, true);
  double *rhs = MEM_NEW(double, mesh->nleaves);
  double *p = MEM_NEW(double, mesh->ncells);
  const struct bc bc[MESH_MAX_PATCHES] = {{0}};
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    rhs[i] = sin(two_pi * mesh->x[i][0]) * sin(two_pi * mesh->x[i][1]);
  }
  remove_mean(mesh, rhs);
  const struct solve_stats stats =
      poisson_solve(mesh, hierarchy, alpha_f, NULL, NULL, rhs, bc,
                    1e-8 * largest_size(mesh, rhs), MOST, p);
  mem_free(alpha_f), mem_free(rhs), mem_free(p);
  hierarchy_destroy(hierarchy);
  mesh_destroy(mesh);
  forest_destroy(forest);
  return stats.status == SOLVE_CONVERGED ? stats.iterations : MOST;
}

static void run(struct report *report) {
  static const char *const name[2][2] = {
      {"heavy outside", "heavy outside adapted"},
      {"heavy inside", "heavy inside adapted"}};
  for (int inside = 0; inside < 2; inside++) {
    int uniform[UNIFORM], adapted[ADAPTED];
    for (int l = 0; l < UNIFORM; l++) {
      uniform[l] = iterations(FIRST + l, FIRST + l, inside);
    }
    for (int l = 0; l < ADAPTED; l++) {
      adapted[l] = iterations(FIRST + l, FIRST + l + 2, inside);
    }
    report_counts(report, name[inside][0], "iterations", FIRST, UNIFORM,
                  uniform, MOST - 1, SPREAD);
    report_counts(report, name[inside][1], "iterations", FIRST, ADAPTED,
                  adapted, MOST - 1, SPREAD);
  }
}

const struct convergence_case poisson_jump_case = {
    "poisson_jump", "Poisson equation, coefficient jump of 1000", 2, true, run};
