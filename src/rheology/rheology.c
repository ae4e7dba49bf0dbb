/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What all closures share: equations (2)-(4) of rheology.h and the bounds. */
#include "talus/rheology.h"

#include <float.h>
#include <math.h>

/* Cells handled at a time: four arrays of this length stay in the L1 cache. */
enum { BLOCK = 512 };

/* Selects, written so that NaN in `a` stays NaN. */
static inline double at_least(double a, double low) {
  return a < low ? low : a;
}

static inline double at_most(double a, double high) {
  return a > high ? high : a;
}

/*
 * eta += tau_y/gamma, equation (2). tau_y/gamma exceeds eta_max below
 * gamma = tau_y/eta_max, and the floor there keeps the division finite; DBL_MIN
 * does where that underflows.
 */
static void add_clip(const struct rheology *r, int32_t n,
                     const double *restrict shear_rate,
                     const double *restrict tau_y, double *restrict eta) {
  const double fluidity = 1. / r->eta_max;
  for (int32_t i = 0; i < n; i++) {
    double floor = at_least(tau_y[i] * fluidity, DBL_MIN);
    eta[i] += tau_y[i] / at_least(shear_rate[i], floor);
  }
}

/* eta += tau_y (1 - exp(-gamma/gamma_r))/gamma, equation (3). The one loop that
 * is not vectorised, for the exponential. */
static void add_papanastasiou(const struct rheology *r, int32_t n,
                              const double *restrict shear_rate,
                              const double *restrict tau_y,
                              double *restrict eta) {
  const double m = 1. / r->gamma_r;
  for (int32_t i = 0; i < n; i++) {
    double x = at_least(m * shear_rate[i], DBL_MIN);
    eta[i] += m * tau_y[i] * (-expm1(-x) / x);
  }
}

/* eta += tau_y/sqrt(gamma^2 + gamma_r^2), equation (4). */
static void add_bercovier_engelman(const struct rheology *r, int32_t n,
                                   const double *restrict shear_rate,
                                   const double *restrict tau_y,
                                   double *restrict eta) {
  const double gamma_r2 = r->gamma_r * r->gamma_r;
  for (int32_t i = 0; i < n; i++)
    eta[i] += tau_y[i] / sqrt(shear_rate[i] * shear_rate[i] + gamma_r2);
}

static void add_yield(const struct rheology *r, int32_t n,
                      const double *shear_rate, const double *tau_y,
                      double *eta) {
  switch (r->regularisation) {
    case RHEOLOGY_CLIP:
      add_clip(r, n, shear_rate, tau_y, eta);
      break;
    case RHEOLOGY_PAPANASTASIOU:
      add_papanastasiou(r, n, shear_rate, tau_y, eta);
      break;
    case RHEOLOGY_BERCOVIER_ENGELMAN:
      add_bercovier_engelman(r, n, shear_rate, tau_y, eta);
      break;
  }
}

static void clip_pressure(int32_t n, const double *restrict pressure,
                          double *restrict clipped) {
  for (int32_t i = 0; i < n; i++) clipped[i] = at_least(pressure[i], 0.);
}

static void clip_eta(const struct rheology *r, int32_t n, double *eta) {
  const double eta_min = r->eta_min, eta_max = r->eta_max;
  for (int32_t i = 0; i < n; i++)
    eta[i] = at_most(at_least(eta[i], eta_min), eta_max);
}

void rheology_eval(const struct rheology *r, int32_t n,
                   const double *shear_rate, const double *pressure,
                   double *eta) {
  const struct rheology_model *model = r->model;
  double p[BLOCK], tau_y[BLOCK];
  for (int32_t begin = 0; begin < n; begin += BLOCK) {
    int32_t m = n - begin < BLOCK ? n - begin : BLOCK;
    const double *gamma = shear_rate + begin;
    clip_pressure(m, pressure + begin, p);
    model->eval(r->param, m, gamma, p, eta + begin);
    if (model->yield) {
      model->yield(r->param, m, gamma, p, tau_y);
      add_yield(r, m, gamma, tau_y, eta + begin);
    }
    clip_eta(r, m, eta + begin);
  }
}
