/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Grains under pressure P = 28 between vertical walls at x = +-14,
 * examples/chute.lua, from rest until max |du/dt| < 1e-6; rho = g = d = 1. With
 * mu(I) of [jop_2006, eq. 1], mu_s = 0.32, delta_mu = 0.28, I0 = 0.4, the
 * balance tau = x makes
 *   I = I0 (x/P - mu_s)/(mu_s + delta_mu - x/P)   beyond x = mu_s P = 8.96,
 * a plug up to there, and its speed the integral of I sqrt(P) from there to the
 * wall, m = 14/P:
 *   I0 sqrt(P) P (delta_mu ln(delta_mu/(mu_s + delta_mu - m)) - m + mu_s),
 * 6.41799. Width of the plug: I/(I + I0) = (x/P - mu_s)/delta_mu is linear in
 * x; a line through its values on faces, from the computed shear rates, is
 * extrapolated to 0. */
#include <gsl/gsl_fit.h>

#include "report.h"
#include "runs.h"

enum { FIRST = 4, N = 3, MOST_FACES = 1 << (FIRST + N) };
static const double kPressure = 28, kWall = 14, kFriction = 0.32, kRise = 0.28,
                    kInertial = 0.4;

/* Return u downwards at x: the integral from x, or the plug's edge, to the
 * wall. */
static double exact(double x) {
  const double from = fmax(x / kPressure, kFriction), to = kWall / kPressure;
  const double top = kFriction + kRise;
  return kInertial * sqrt(kPressure) * kPressure *
         (kRise * log((top - from) / (top - to)) - (to - from));
}

/* Return where the line through I/(I + I0) vanishes. Faces below 0.05 of it are
 * in or next to the plug, where the viscosity may be capped. */
static double plug_width(const struct two_phase *sim) {
  const struct mesh *mesh = sim->grid.mesh;
  double x[MOST_FACES], part[MOST_FACES], c0, c1, cov00, cov01, cov11, rest;
  size_t n = 0;
  for (int32_t f = mesh->face_begin[0]; f < mesh->face_begin[1]; f++) {
    const int32_t *node = mesh->face_node[f], i = mesh->face_owner[f];
    const double *v = sim->u[1]->v;
    const double I =
        fabs(v[node[1]] - v[node[0]]) / mesh->face_h[f] / sqrt(kPressure);
    if (mesh->face_patch[f] >= 0 || I < 0.05 * (I + kInertial)) continue;
    x[n] = mesh->x[i][0] + (node[0] == i ? 0.5 : -0.5) * mesh->h[i];
    part[n++] = I / (I + kInertial);
  }
  if (n < 3) return NAN;
  gsl_fit_linear(x, 1, part, 1, n, &c0, &c1, &cov00, &cov01, &cov11, &rest);
  return -c0 / c1;
}

/* Return the speed of the leaf next to the axis. */
static double plug_speed(const struct two_phase *sim) {
  int32_t axis = 0;
  for (int32_t i = 1; i < sim->grid.mesh->nleaves; i++) {
    if (sim->grid.mesh->x[i][0] < sim->grid.mesh->x[axis][0]) axis = i;
  }
  return -sim->u[1]->v[axis];
}

/* Return the result of a steady chute; NAN if it does not get there. */
struct steady {
  double width, speed, l2, time;
};

static struct steady measure(int level, const char *regularisation) {
  struct steady out = {NAN, NAN, NAN, NAN};
  struct example example =
      example_new("chute", "trees=%d level=1 regularisation=%s",
                  1 << (level - 1), regularisation);
  struct two_phase *sim = example.sim;
  double *error = MEM_NEW(double, sim->grid.mesh->nleaves);
  if (run_steady(sim, 1e-6, 2000)) {
    for (int32_t i = 0; i < sim->grid.mesh->nleaves; i++) {
      error[i] = -sim->u[1]->v[i] - exact(sim->grid.mesh->x[i][0]);
    }
    out.width = fabs(plug_width(sim) / (kFriction * kPressure) - 1);
    out.speed = fabs(plug_speed(sim) / exact(0) - 1);
    out.l2 = norms_of(sim->grid.mesh, error).l2;
    out.time = sim->model.time;
  }
  mem_free(error);
  example_destroy(&example);
  return out;
}

static void run_with(struct report *report, const char *grid,
                     const char *regularisation) {
  const int last = FIRST + N - 1;
  struct steady steady[N];
  double l2[N];
  for (int k = 0; k < N; k++) {
    steady[k] = measure(FIRST + k, regularisation);
    l2[k] = steady[k].l2;
  }
  for (int k = 0; k < N; k++) {
    report_at_most(report, grid, "relative error of the plug's half-width",
                   FIRST + k, steady[k].width, 1e-2);
  }
  for (int k = 0; k < N - 1; k++) {
    report_value(report, grid, "relative error of the plug's speed", FIRST + k,
                 steady[k].speed);
  }
  report_at_most(report, grid, "relative error of the plug's speed", last,
                 steady[N - 1].speed, 1e-2);
  report_errors(report, grid, "L2 of v", FIRST, N, l2, NULL, 0);
  for (int k = 0; k < N; k++) {
    report_value(report, grid, "time to max |du/dt| < 1e-6", FIRST + k,
                 steady[k].time);
  }
}

static void run(struct report *report) {
  run_with(report, "half a chute", "exact");
  run_with(report, "half a chute clip", "clip");
}

const struct convergence_case chute_case = {
    "chute", "Grains in a vertical chute", 2, true, run};
