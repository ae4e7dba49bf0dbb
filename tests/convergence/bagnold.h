/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Bagnold's profile with mu(I), mu_s = 0.38, delta_mu = 0.26, I0 = 0.3,
 * d = 0.04, in a layer of thickness 1 on a slope, rho = g = 1: friction
 * balances weight, so I is the same at all depths,
 *   mu(I) = tan(slope),  du/dy = I/d sqrt(p/rho),  p = (1 - y) cos(slope),
 *   u = 2/3 I/d sqrt(cos(slope)) (1 - (1 - y)^(3/2))
 * [lagree_staron_popinet_2011, eqs. 2.24-2.26; the prefactor of 2.26 is
 * misprinted, eq. 2.25 gives this one]. On 0.43 rad u(1) = 2.06631. y stands
 * for the last axis; in 3D the flow goes along neither of the other two. */
#ifndef TALUS_TESTS_BAGNOLD_H
#define TALUS_TESTS_BAGNOLD_H

#include "report.h"
#include "runs.h"

/* max |du/dt| of a flow that counts as steady (at the start it is 0.4), and of
 * one whose distance from the steady one no longer shows. */
static const double kBagnoldSteady = 1e-6, kBagnoldSettled = 1e-8;

static inline double bagnold_inertial(double slope) {
  const double t = tan(slope);
  return 0.3 * (t - 0.38) / (0.38 + 0.26 - t);
}

/* Return the shear rate, or the speed. */
static inline double bagnold_rate(double slope, double y) {
  return bagnold_inertial(slope) / 0.04 * sqrt(cos(slope) * fmax(1 - y, 0));
}
static inline double bagnold_exact(double slope, double y) {
  return 2. / 3 * bagnold_rate(slope, 0) * (1 - pow(1 - y, 1.5));
}

static const double kBagnoldSlope = 0.43;
static const double kBagnoldHeading = 0.5; /* in 3D, of the flow from x */

/* Return the velocity of a leaf along the flow, or (`across`) its largest
 * component that should be 0. */
static inline double bagnold_along(const struct two_phase *sim, int32_t i) {
  const double *u = sim->u[0]->v, *v = sim->u[1]->v;
  if (DIM == 2) return u[i];
  return u[i] * cos(kBagnoldHeading) + v[i] * sin(kBagnoldHeading);
}
static inline double bagnold_across(const struct two_phase *sim, int32_t i) {
  const double *u = sim->u[0]->v, *v = sim->u[1]->v;
  const double w = fabs(sim->u[DIM - 1]->v[i]);
  if (DIM == 2) return w;
  const double side = v[i] * cos(kBagnoldHeading) - u[i] * sin(kBagnoldHeading);
  return fmax(w, fabs(side));
}

/* Return the error of u in every leaf, [nleaves], for the caller to free. */
static inline double *bagnold_errors(const struct two_phase *sim,
                                     double slope) {
  const struct mesh *mesh = sim->grid.mesh;
  double *error = MEM_NEW(double, mesh->nleaves);
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    error[i] =
        bagnold_along(sim, i) - bagnold_exact(slope, mesh->x[i][DIM - 1]);
  }
  return error;
}

static inline struct norms bagnold_norms(const struct two_phase *sim,
                                         double slope) {
  double *error = bagnold_errors(sim, slope);
  const struct norms norms = norms_of(sim->grid.mesh, error);
  mem_free(error);
  return norms;
}

/* Return a leaf next to the surface. */
static inline int32_t bagnold_top(const struct mesh *mesh) {
  int32_t top = 0;
  for (int32_t i = 1; i < mesh->nleaves; i++) {
    if (mesh->x[i][DIM - 1] > mesh->x[top][DIM - 1]) top = i;
  }
  return top;
}

/* Return the relative error of u there. */
static inline double bagnold_top_error(const struct two_phase *sim,
                                       double slope) {
  const int32_t i = bagnold_top(sim->grid.mesh);
  const double exact = bagnold_exact(slope, sim->grid.mesh->x[i][DIM - 1]);
  return fabs(bagnold_along(sim, i) - exact) / exact;
}

/* Errors of a steady flow of examples/bagnold.lua on 0.43 rad, and when it was
 * steady; NAN if it does not get there. */
struct bagnold_flow {
  double l2, most, top, across, time;
};

/* Make a run; start: speed over that of the steady flow. */
static inline struct bagnold_flow bagnold_run(int trees, int level,
                                              double start,
                                              const char *regularisation) {
  struct bagnold_flow out = {
      .l2 = NAN, .most = NAN, .top = NAN, .across = NAN, .time = NAN};
  struct example example = example_new(
      "bagnold",
      "dimension=%d heading=%g trees=%d level=%d start=%g regularisation=%s",
      DIM, kBagnoldHeading, trees, level, start, regularisation);
  struct two_phase *sim = example.sim;
  if (run_steady(sim, kBagnoldSteady, 1000)) out.time = sim->model.time;
  if (run_steady(sim, kBagnoldSettled, 1000)) {
    const struct norms norms = bagnold_norms(sim, kBagnoldSlope);
    out.l2 = norms.l2, out.most = norms.most;
    out.top = bagnold_top_error(sim, kBagnoldSlope);
    out.across = 0;
    for (int32_t i = 0; i < sim->grid.mesh->nleaves; i++) {
      out.across = fmax(out.across, bagnold_across(sim, i));
    }
  }
  example_destroy(&example);
  return out;
}

enum { BAGNOLD_FIRST = 3, BAGNOLD_N = 4 };
static const double kBagnoldBars[BAGNOLD_N] = {1.9e-2, 6e-3, 1.7e-3, 4.5e-4};

/* Report strips two cells wide, of 8 to 64 cells; l2 [BAGNOLD_N] the errors. */
static inline void bagnold_report(struct report *report, const char *grid,
                                  double start, const char *regularisation,
                                  double l2[BAGNOLD_N]) {
  enum { FIRST = BAGNOLD_FIRST, N = BAGNOLD_N };
  static const char top[] = "relative error of the top cell";
  double most[N];
  struct bagnold_flow flow[N];
  for (int k = 0; k < N; k++) {
    flow[k] = bagnold_run(1 << (FIRST + k - 1), 1, start, regularisation);
    l2[k] = flow[k].l2, most[k] = flow[k].most;
  }
  report_errors(report, grid, "L2 of u", FIRST, N, l2, kBagnoldBars, 1.9);
  report_errors(report, grid, "max of u", FIRST, N, most, NULL, 1.3);
  for (int k = 0; k < N - 1; k++) {
    report_value(report, grid, top, FIRST + k, flow[k].top);
  }
  report_at_most(report, grid, top, FIRST + N - 1, flow[N - 1].top, 1e-3);
  for (int k = 0; k < N; k++) {
    report_value(report, grid, "time to max |du/dt| < 1e-6", FIRST + k,
                 flow[k].time);
  }
}

#endif
