/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Parts that all closures share: equations (2)-(4) of rheology.h and the
 * bounds. */
#include "talus/rheology.h"

#include <float.h>
#include <math.h>

#include "models.h"
#include "talus/error.h"
#include "talus/memory.h"

/*
 * Add tau_y/gamma to eta, equation (2). tau_y/gamma exceeds eta_max below gamma
 * = tau_y/eta_max, and the floor there keeps the division finite; DBL_MIN does
 * where that underflows.
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

/* Add tau_y (1 - exp(-gamma/gamma_r))/gamma to eta, equation (3). The one loop
 * that is not vectorised, for the exponential. */
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

/* Add tau_y/sqrt(gamma^2 + gamma_r^2) to eta, equation (4). */
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
    case RHEOLOGY_EXACT:
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

static void add_cohesion(const struct rheology *r, int32_t n, double *tau_y) {
  const double cohesion = r->cohesion;
  for (int32_t i = 0; i < n && cohesion > 0; i++) tau_y[i] += cohesion;
}

/* Compute the yield stress of the closure and cohesion. */
static void yield_stress(const struct rheology *r, int32_t n,
                         const double *shear_rate, const double *pressure,
                         double *tau_y) {
  for (int32_t i = 0; i < n && r->model->yield == NULL; i++) tau_y[i] = 0;
  if (r->model->yield != NULL)
    r->model->yield(r, n, shear_rate, pressure, tau_y);
  add_cohesion(r, n, tau_y);
}

bool rheology_yields(const struct rheology *r) {
  return r->model->holds || r->cohesion > 0;
}

const char *rheology_prepare(struct rheology *r) {
  r->table = NULL;
  if (r->model->eval == NULL && r->user == NULL)
    return "viscosity = function(shear_rate, pressure, time) is missing; only "
           "a case file can hold it";
  return r->model->prepare != NULL ? r->model->prepare(r, &r->table) : NULL;
}

void rheology_release(struct rheology *r) {
  mem_free(r->table);
  r->table = NULL;
}

static void check_prepared(const struct rheology *r) {
  CHECK(r->model->prepare == NULL || r->table != NULL,
        "call rheology_prepare for %s first", r->model->name);
}

static void plastic_viscosity(const struct rheology *r, double time, int32_t n,
                              const double *shear_rate, const double *pressure,
                              double *eta) {
  if (r->model->eval != NULL)
    r->model->eval(r, n, shear_rate, pressure, eta);
  else
    r->user(r->context, time, n, shear_rate, pressure, eta);
}

void rheology_eval(const struct rheology *r, double time, int32_t n,
                   const double *shear_rate, const double *pressure,
                   double *eta) {
  double p[RHEOLOGY_BLOCK], tau_y[RHEOLOGY_BLOCK];
  check_prepared(r);
  for (int32_t begin = 0; begin < n; begin += RHEOLOGY_BLOCK) {
    int32_t m = n - begin < RHEOLOGY_BLOCK ? n - begin : RHEOLOGY_BLOCK;
    const double *gamma = shear_rate + begin;
    clip_pressure(m, pressure + begin, p);
    plastic_viscosity(r, time, m, gamma, p, eta + begin);
    if (r->model->yield != NULL || r->cohesion > 0) {
      yield_stress(r, m, gamma, p, tau_y);
      add_yield(r, m, gamma, tau_y, eta + begin);
    }
    clip_eta(r, m, eta + begin);
  }
}

void rheology_parts(const struct rheology *r, double time, int32_t n,
                    const double *shear_rate, const double *pressure,
                    double *eta, double *tau_y) {
  double p[RHEOLOGY_BLOCK];
  check_prepared(r);
  for (int32_t begin = 0; begin < n; begin += RHEOLOGY_BLOCK) {
    int32_t m = n - begin < RHEOLOGY_BLOCK ? n - begin : RHEOLOGY_BLOCK;
    const double *gamma = shear_rate + begin;
    clip_pressure(m, pressure + begin, p);
    if (r->model->parts != NULL) {
      r->model->parts(r, m, gamma, p, eta + begin, tau_y + begin);
      add_cohesion(r, m, tau_y + begin);
    } else {
      plastic_viscosity(r, time, m, gamma, p, eta + begin);
      yield_stress(r, m, gamma, p, tau_y + begin);
    }
    for (int32_t i = begin; i < begin + m; i++) {
      if (r->eta_min * shear_rate[i] < tau_y[i]) continue;
      const double yield = tau_y[i] > 0 ? tau_y[i] / shear_rate[i] : 0;
      eta[i] = at_least(eta[i], r->eta_min - yield);
    }
  }
}

void rheology_output(const struct rheology *r, int k, int32_t n,
                     const double *shear_rate, const double *pressure,
                     double *out) {
  double p[RHEOLOGY_BLOCK];
  check_prepared(r);
  CHECK(k >= 0 && k < r->model->noutputs, "%s has no quantity %d",
        r->model->name, k);
  for (int32_t begin = 0; begin < n; begin += RHEOLOGY_BLOCK) {
    int32_t m = n - begin < RHEOLOGY_BLOCK ? n - begin : RHEOLOGY_BLOCK;
    clip_pressure(m, pressure + begin, p);
    r->model->outputs[k].eval(r, m, shear_rate + begin, p, out + begin);
  }
}
