/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Iterations of the viscous solver against contrast of viscosity: a disc of
 * radius 1/4 in the middle of the unit box with no-slip walls, stiffer than
 * the fluid around it by 1 to 1e8, or softer; dt such that
 *   lambda = rho h^2 / (eta_soft dt) = 1 and 1e-4,  h of the finest cells.
 * rhs_d = sin(3 x_d + 1) cos(5 x_(1-d)), from u = 0 until max |residual| is
 * 1e-8 of what it was.
 *
 * Bars: below 40 iterations each. Flat: on the finest level at most 1/4 more
 * than two levels before, and 2. On the adapted grid a ball that holds part
 * of the circle is two levels finer; `level` is that of the ball. */
#include "report.h"
#include "systems.h"
#include "talus/viscous.h"

enum { FIRST = 5, N = 5, MOST = 100, BAR = 39 };

/* Return eta, at least 1; *contrast: of the disc to what is around it. */
static double disc(const void *contrast, const double *x) {
  const double ratio = *(const double *)contrast;
  const double r = hypot(x[0] - 0.5, x[1] - 0.5);
  return r < 0.25 ? fmax(ratio, 1) : fmax(1 / ratio, 1);
}

static int iterations(int base, int level, double contrast, double lambda) {
  struct forest *forest = grid_new(MPI_COMM_WORLD, 1, false, base, level);
  struct mesh *mesh = mesh_new(forest);
  struct hierarchy *hierarchy = hierarchy_new(mesh);
  struct bc side[MESH_MAX_PATCHES] = {{0}};
  double *eta_f = face_values(mesh, disc, &contrast, false);
  double *rho = MEM_NEW(double, mesh->nleaves), *u[DIM], *rhs[DIM], most = 0;
  const struct bc *bc[DIM];
  for (int k = 0; k < MESH_MAX_PATCHES; k++) side[k].type = BC_DIRICHLET;
  for (int32_t i = 0; i < mesh->nleaves; i++) rho[i] = 1;
  for (int d = 0; d < DIM; d++) {
    bc[d] = side;
    u[d] = MEM_NEW(double, mesh->ncells);
    rhs[d] = MEM_NEW(double, mesh->nleaves);
    for (int32_t i = 0; i < mesh->nleaves; i++) {
      const double *x = mesh->x[i];
      rhs[d][i] = sin(3 * x[d] + 1) * cos(5 * x[(d + 1) % DIM]);
    }
    most = larger(most, largest_size(mesh, rhs[d]));
  }
  const struct solve_stats stats = viscous_solve(
      mesh, hierarchy, rho, &(struct viscosity){.eta_f = eta_f},
      ldexp(1, -2 * level) / lambda, rhs, bc, 1e-8 * most, MOST, u);
  for (int d = 0; d < DIM; d++) mem_free(u[d]), mem_free(rhs[d]);
  mem_free(eta_f), mem_free(rho);
  hierarchy_destroy(hierarchy);
  mesh_destroy(mesh);
  forest_destroy(forest);
  return stats.status == SOLVE_CONVERGED ? stats.iterations : MOST;
}

static void sweep(struct report *report, const char *grid, int jumps,
                  double contrast, double lambda) {
  int count[N];
  char name[80], counts[80], growth[80];
  const char *kind = contrast < 1 ? "soft" : "stiff";
  snprintf(name, sizeof name, "%s %g", grid, fmax(contrast, 1 / contrast));
  snprintf(counts, sizeof counts, "iterations: %s disc lambda %g", kind,
           lambda);
  snprintf(growth, sizeof growth,
           "beyond 5/4 of two levels before: %s disc lambda %g", kind, lambda);
  const int first = jumps > 0 ? FIRST + 1 : FIRST; /* up to as many cells */
  for (int k = 0; k < N; k++) {
    const int level = first + k;
    count[k] = iterations(level - jumps, level, contrast, lambda);
  }
  report_counts(report, name, counts, first, N, count, BAR, 0);
  report_at_most(report, name, growth, first + N - 1,
                 count[N - 1] - 1.25 * count[N - 3], 2);
}

static void run(struct report *report) {
  static const double contrast[] = {1,    1e2,  1e4,  1e6, 1e8,
                                    1e-2, 1e-4, 1e-6, 1e-8};
  static const double lambda[] = {1, 1e-4};
  for (int l = 0; l < 2; l++) {
    for (int k = 0; k < 9; k++) {
      sweep(report, "uniform", 0, contrast[k], lambda[l]);
      sweep(report, "adapted", 2, contrast[k], lambda[l]);
    }
  }
}

const struct convergence_case contrast_case = {
    "contrast", "viscous iterations up to a contrast of 1e8", 2, false, run};
