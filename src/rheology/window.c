/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Where a closure of mu(I) is well posed: equation (5) of rheology.h. */
#include <math.h>
#include <string.h>

#include "talus/rheology.h"
#include "talus/roots.h"

/* Decades that are searched, in steps of which none hides a window. */
enum { FIRST = -8, LAST = 8, PER_DECADE = 50 };

static double value(const struct rheology *r, const char *name) {
  const struct rheology_key *key;
  for (int i = 0; (key = rheology_key(r->model, i)) != NULL; i++)
    if (strcmp(key->name, name) == 0) return rheology_value(r, i);
  return NAN;
}

/* Return ln mu at p = 1 */
static double log_mu(const struct rheology *r, double scale, double I) {
  const double p = 1, rate = I * scale;
  double eta;
  rheology_eval(r, 0, 1, &rate, &p, &eta);
  return log(eta * rate / p);
}

/* A closure as C(I) sees it. */
struct neutral {
  const struct rheology *r;
  double scale; /* gamma/I at p = 1 */
};

/* Return C at ln I */
static double condition(double log_I, void *context) {
  const struct neutral *n = (const struct neutral *)context;
  const double h = 1e-4, mu = exp(log_mu(n->r, n->scale, exp(log_I)));
  const double slope = (log_mu(n->r, n->scale, exp(log_I + h)) -
                        log_mu(n->r, n->scale, exp(log_I - h))) /
                       (2 * h);
  const double factor = 1 - 0.5 * slope;
  return 4 * slope * (slope - 1) + mu * mu * factor * factor;
}

bool rheology_window(const struct rheology *r, double window[2]) {
  struct rheology open = *r;
  bool inside = false;
  if (!r->model->mu_of_i) return false;
  open.eta_min = open.cohesion = 0;
  open.eta_max = 1e30;
  open.regularisation = RHEOLOGY_CLIP;
  struct neutral neutral = {&open, 1 / (value(r, "d") * sqrt(value(r, "rho")))};
  window[1] = INFINITY;
  for (int i = FIRST * PER_DECADE; i <= LAST * PER_DECADE; i++) {
    const double step = log(10) / PER_DECADE, log_I = i * step;
    if ((condition(log_I, &neutral) <= 0) == inside) continue;
    const bool first = i == FIRST * PER_DECADE;
    window[inside] =
        first ? 0 : exp(root_between(condition, &neutral, log_I - step, log_I));
    if (inside) return true;
    inside = true;
  }
  return inside;
}
