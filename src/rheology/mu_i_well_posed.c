/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * The partially regularised mu(I) of [barker_gray_2017]: with
 * I = gamma d/sqrt(p/rho),
 *
 *   I <= I_1:  mu = sqrt(alpha/ln(A_-/I))
 *   I >  I_1:  mu = (mu_s I_0 + mu_2 I + mu_inf I^2)/(I_0 + I)
 *
 * A_- follows from continuity at I_1: ln(A_-/I) = alpha/mu(I_1)^2 + ln(I_1/I),
 * which is how it is computed here. The lower branch is well posed for
 * alpha < 2, the upper one from its lower neutral limit (equation (5) of
 * talus/rheology.h), which I_1 is unless given, to an upper limit that mu_inf
 * moves far up. As mu falls to 0 with I there is no yield stress in the limit,
 * but tau/gamma is infinite there all the same; so all of mu p passes for a
 * yield stress, but for "exact" for a plastic viscosity: nothing would hold
 * grains, which creep at I = A_- exp(-alpha/tan^2) on a slope. Defaults: glass
 * beads, in the paper.
 */
#include <float.h>

#include "models.h"
#include "talus/memory.h"

enum { MU_S, MU_2, MU_INF, I_0, ALPHA, I_1, D, RHO };

static const struct rheology_key KEYS[] = {
    {"mu_s", "1", 1e-6, 100., 0.342, "friction coefficient at small I"},
    {"mu_2", "1", 0., 100., 0.557, "friction coefficient at large I"},
    {"mu_inf", "1", 0., 100., 0.05, "slope of friction at very large I"},
    {"I0", "1", 1e-6, 1e6, 0.069, "inertial number between the two"},
    {"alpha", "1", 1e-6, 2., 1.9, "of the lower branch; < 2 is well posed"},
    {"I_1", "1", 0., 1e6, 0., "where it ends; 0: lower neutral limit"},
    {"d", "m", 1e-12, 1e6, NAN, "grain diameter"},
    {"rho", "kg/m^3", 1e-12, 1e12, NAN, "density in the inertial number"},
};

/* Viscosity at rest, Pa s, in place of infinity. */
#define MOST 1e30
/* I sqrt(p) at rest, in place of 0: sqrt(p) over it does not overflow. */
#define AT_REST 1e-250

struct lower_branch {
  double I_1;       /* its end; 0: there is none */
  double alpha_mu2; /* alpha/mu(I_1)^2 */
};

static double upper(const double *param, double I) {
  return (param[MU_S] * param[I_0] + param[MU_2] * I + param[MU_INF] * I * I) /
         (param[I_0] + I);
}

static const char *prepare(const struct rheology *r, void **table) {
  struct lower_branch *lower = MEM_NEW(struct lower_branch, 1);
  struct rheology trial = *r;
  double window[2] = {0};
  trial.table = lower; /* the upper branch alone */
  if (r->param[I_1] == 0 && !rheology_window(&trial, window)) {
    mem_free(lower);
    return "I_1 is needed: the upper branch is nowhere well posed";
  }
  lower->I_1 = r->param[I_1] > 0 ? r->param[I_1] : window[0];
  const double mu = upper(r->param, lower->I_1);
  lower->alpha_mu2 = r->param[ALPHA] / (mu * mu);
  *table = lower;
  return NULL;
}

static void eval(const struct rheology *r, int32_t n,
                 const double *restrict shear_rate,
                 const double *restrict pressure, double *restrict eta) {
  (void)r, (void)shear_rate, (void)pressure;
  for (int32_t i = 0; i < n; i++) eta[i] = 0.;
}

/* Compute mu p, with root = sqrt(p) and I = rate/root. */
static void yield(const struct rheology *r, int32_t n,
                  const double *restrict shear_rate,
                  const double *restrict pressure, double *restrict tau_y) {
  const struct lower_branch *lower = (const struct lower_branch *)r->table;
  const double *param = r->param;
  const double d_rho = param[D] * sqrt(param[RHO]);
  for (int32_t i = 0; i < n; i++) {
    const double root = sqrt(pressure[i]);
    const double rate = at_least(shear_rate[i] * d_rho, AT_REST);
    if (rate < lower->I_1 * root) {
      const double logarithm = log(lower->I_1 * root / rate);
      tau_y[i] =
          pressure[i] * sqrt(param[ALPHA] / (lower->alpha_mu2 + logarithm));
    } else {
      const double sum = param[MU_S] * param[I_0] * pressure[i] +
                         param[MU_2] * rate * root +
                         param[MU_INF] * rate * rate;
      tau_y[i] = root * sum / (param[I_0] * root + rate);
    }
  }
}

static void parts(const struct rheology *r, int32_t n,
                  const double *restrict shear_rate,
                  const double *restrict pressure, double *restrict eta,
                  double *restrict tau_y) {
  yield(r, n, shear_rate, pressure, eta);
  for (int32_t i = 0; i < n; i++) {
    eta[i] = at_most(eta[i] / at_least(shear_rate[i], DBL_MIN), MOST);
    tau_y[i] = 0;
  }
}

const struct rheology_model rheology_mu_i_well_posed = {
    .name = "mu_i_well_posed",
    .title = "mu(I) regularised at both ends, mu(I) p/gamma",
    .source = "barker_gray_2017",
    .keys = KEYS,
    .nkeys = NKEYS(KEYS),
    .eval = eval,
    .yield = yield,
    .parts = parts,
    .mu_of_i = true,
    .prepare = prepare,
};
