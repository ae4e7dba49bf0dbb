/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Where a closure of mu(I) is well posed: equation (5) of rheology.h. */
#include <math.h>
#include <string.h>

#include "talus/rheology.h"

/* Decades that are searched, in steps of which none hides a window. */
enum { FIRST = -8, LAST = 8, PER_DECADE = 50 };

static double value(const struct rheology *r, const char *name) {
  const struct rheology_key *key;
  for (int i = 0; (key = rheology_key(r->model, i)) != NULL; i++)
    if (strcmp(key->name, name) == 0) return rheology_value(r, i);
  return NAN;
}

/* ln mu at p = 1 */
static double log_mu(const struct rheology *r, double scale, double I) {
  const double p = 1, rate = I * scale;
  double eta;
  rheology_eval(r, 0, 1, &rate, &p, &eta);
  return log(eta * rate / p);
}

/* C(I); scale = gamma/I at p = 1. */
static double condition(const struct rheology *r, double scale, double I) {
  const double h = 1e-4, mu = exp(log_mu(r, scale, I));
  const double slope =
      (log_mu(r, scale, I * exp(h)) - log_mu(r, scale, I * exp(-h))) / (2 * h);
  const double factor = 1 - 0.5 * slope;
  return 4 * slope * (slope - 1) + mu * mu * factor * factor;
}

/* The root between two inertial numbers, by bisection in the logarithm. */
static double neutral(const struct rheology *r, double scale, double low,
                      double high) {
  const bool well = condition(r, scale, low) <= 0;
  while (high / low > 1 + 1e-12) {
    const double middle = sqrt(low * high);
    if ((condition(r, scale, middle) <= 0) == well)
      low = middle;
    else
      high = middle;
  }
  return sqrt(low * high);
}

bool rheology_window(const struct rheology *r, double window[2]) {
  struct rheology open = *r;
  bool inside = false;
  if (!r->model->mu_of_i) return false;
  open.eta_min = open.cohesion = 0;
  open.eta_max = 1e30;
  open.regularisation = RHEOLOGY_CLIP;
  const double scale = 1 / (value(r, "d") * sqrt(value(r, "rho")));
  window[1] = INFINITY;
  for (int i = FIRST * PER_DECADE; i <= LAST * PER_DECADE; i++) {
    const double I = pow(10, (double)i / PER_DECADE);
    const double before = pow(10, (i - 1.) / PER_DECADE);
    if ((condition(&open, scale, I) <= 0) == inside) continue;
    const bool first = i == FIRST * PER_DECADE;
    window[inside] = first ? 0 : neutral(&open, scale, before, I);
    if (inside) return true;
    inside = true;
  }
  return inside;
}
