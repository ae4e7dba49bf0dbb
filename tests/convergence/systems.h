/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One linear system for convergence cases: the grids it is solved on, and
 * smooth functions with their derivatives to make exact solutions of. */
#ifndef TALUS_TESTS_SYSTEMS_H
#define TALUS_TESTS_SYSTEMS_H

#include "report.h"
#include "runs.h"
#include "talus/hierarchy.h"

/* Grids fixed in advance. The refined parts lie off the middle, so that no
 * solution here is symmetric about a jump of level. */
enum grid_kind { GRID_UNIFORM, GRID_BALL, GRID_TWO_JUMPS, NGRIDS };
static const char *const grid_name[] = {"uniform", "adapted", "two jumps"};

/* Make a grid of level l everywhere, l + 1 in a ball, or l + 2 in a ball and l
 * + 1 around. */
static inline struct forest *grid_make(enum grid_kind grid, bool periodic,
                                       int l) {
  static const double centre[] = {0.31, 0.42, 0.53};
  struct forest *forest = grid_new(MPI_COMM_WORLD, 1, periodic, l, l);
  if (grid == GRID_BALL) grid_refine(forest, centre, 0.2, l + 1);
  if (grid == GRID_TWO_JUMPS) {
    grid_refine(forest, centre, 0.3, l + 1);
    grid_refine(forest, centre, 0.15, l + 2);
  }
  return forest;
}

/* constant + slope.x + sum_d curve_d x_d^2 / 2
 * + sum over modes of a prod_d sin(k_d pi x_d + phase_d). */
struct mode {
  double a, k[3], phase[3];
};
struct smooth {
  double constant, slope[3], curve[3];
  int n;
  struct mode mode[3];
};

/* Return the derivative of the smooth function, of order[d] along axis d; all
 * orders together at most 2. */
static inline double smooth_at(const struct smooth *s, const double *x,
                               const int order[DIM]) {
  static const double pi = 3.14159265358979323846;
  int total = 0;
  for (int d = 0; d < DIM; d++) total += order[d];
  double sum = total == 0 ? s->constant : 0;
  for (int d = 0; d < DIM; d++) {
    const double term[] = {s->slope[d] * x[d] + 0.5 * s->curve[d] * x[d] * x[d],
                           s->slope[d] + s->curve[d] * x[d], s->curve[d]};
    if (order[d] == total) sum += term[order[d]];
  }
  for (int m = 0; m < s->n; m++) {
    double product = s->mode[m].a;
    for (int d = 0; d < DIM; d++) {
      const double k = pi * s->mode[m].k[d];
      product *= pow(k, order[d]) *
                 sin(k * x[d] + s->mode[m].phase[d] + 0.5 * pi * order[d]);
    }
    sum += product;
  }
  return sum;
}

static inline double smooth_value(const struct smooth *s, const double *x) {
  return smooth_at(s, x, (const int[DIM]){0});
}
static inline double smooth_slope(const struct smooth *s, const double *x,
                                  int d) {
  int order[DIM] = {0};
  order[d] = 1;
  return smooth_at(s, x, order);
}
static inline double smooth_second(const struct smooth *s, const double *x,
                                   int d, int e) {
  int order[DIM] = {0};
  order[d]++, order[e]++;
  return smooth_at(s, x, order);
}

/* Set v [nfaces_all], the caller's, to a function of the face centre, 0 on
 * walls if they are closed. */
typedef double (*position_function)(const void *context, const double *x);
static inline double *face_values(const struct mesh *mesh,
                                  position_function function,
                                  const void *context, bool closed) {
  double *v = MEM_NEW(double, mesh->nfaces_all);
  for (int d = 0; d < DIM; d++) {
    for (int32_t f = mesh->face_begin[d]; f < mesh->face_begin[d + 1]; f++) {
      double x[3];
      face_centre(mesh, d, f, x);
      v[f] = closed && mesh->face_patch[f] >= 0 ? 0 : function(context, x);
    }
  }
  mesh_fill_faces(mesh, 1, &v);
  return v;
}

/* Return exp of a smooth function: a coefficient of any contrast. */
static inline double exponential(const void *smooth, const double *x) {
  return exp(smooth_value((const struct smooth *)smooth, x));
}

/* Take the mean over the box off v [nleaves]. */
static inline void remove_mean(const struct mesh *mesh, double *v) {
  double volume = 0;
  for (int32_t i = 0; i < mesh->nleaves; i++) volume += mesh_volume(mesh, i);
  const double mean = integral(mesh, v) / mesh_sum(mesh, volume);
  for (int32_t i = 0; i < mesh->nleaves; i++) v[i] -= mean;
}

static inline double largest_size(const struct mesh *mesh, const double *v) {
  double most = 0;
  for (int32_t i = 0; i < mesh->nleaves; i++) most = larger(most, fabs(v[i]));
  return mesh_max(mesh, most);
}

/* Return the error of the solution of a problem on one grid. */
typedef struct norms grid_solver(const void *problem, enum grid_kind grid,
                                 int level);

/* Report errors on levels 4 to 8 of every grid, in 3D on 3 to 6; orders that L2
 * and max must reach. */
static inline void report_grids(struct report *report, const char *name,
                                const char *field, grid_solver *solve,
                                const void *problem, double order_l2,
                                double order_most) {
  enum { FIRST = DIM == 2 ? 4 : 3, N = DIM == 2 ? 5 : 4, LENGTH = 64 };
  char row[LENGTH], of_l2[LENGTH], of_most[LENGTH];
  snprintf(of_l2, LENGTH, "L2 of %s", field);
  snprintf(of_most, LENGTH, "max of %s", field);
  for (int grid = 0; grid < NGRIDS; grid++) {
    double l2[N], most[N];
    for (int l = 0; l < N; l++) {
      const struct norms norms =
          solve(problem, (enum grid_kind)grid, FIRST + l);
      l2[l] = norms.l2, most[l] = norms.most;
    }
    snprintf(row, LENGTH, "%s %s", name, grid_name[grid]);
    report_errors(report, row, of_l2, FIRST, N, l2, NULL, order_l2);
    report_errors(report, row, of_most, FIRST, N, most, NULL, order_most);
  }
}

#endif
