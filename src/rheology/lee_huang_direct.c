/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Steady shear of the closure lee_huang by finding roots: slow and plain. */
#include <math.h>
#include <stddef.h>

#include "talus/lee_huang.h"
#include "talus/roots.h"

static const double PI = 3.14159265358979323846;

/* Loosest solid fraction that is looked at, and steps of a search. */
static const double NU_LEAST = 1e-3;
enum { STEPS = 2000 };

struct lee_huang_kinetic lee_huang_kinetic(const double *param, double nu) {
  const double e = param[LEE_HUANG_E_EFF];
  const double g_0 =
      (1 - 7. / 16 * nu) / pow(1 - nu / param[LEE_HUANG_NU_MAX],
                               param[LEE_HUANG_G0_EXPONENT]); /* eq. 14 */
  const double contact = nu * g_0 * (1 + e);
  const double lambda = 4 * nu * contact / (3 * sqrt(PI)); /* eq. 7 */
  const double mu = 5 * sqrt(PI) / (24 * g_0 * (1 + e) * (3 - e)) *
                        (1 + 0.4 * (3 * e - 1) * contact) *
                        (1 + 0.8 * contact) +
                    0.6 * lambda; /* eq. 8 */
  const double f4_2 = mu / (9 * (1 - e) * lambda);
  return (struct lee_huang_kinetic){.f4_2 = f4_2,
                                    .pressure = nu * (1 + 2 * contact) * f4_2,
                                    .stress = sqrt(f4_2) * mu};
}

double lee_huang_packing(const double *param, double nu) {
  const double excess = fmax(nu - param[LEE_HUANG_NU_MIN], 0);
  const double range = param[LEE_HUANG_NU_MAX] - param[LEE_HUANG_NU_MIN];
  /* 1 + sin(x - pi/2) of eq. 20 is 2 sin^2(x/2), without cancellation */
  const double sine = sin(0.5 * PI * excess / range);
  return 2 * nu * pow(excess, param[LEE_HUANG_CHI]) * sine * sine;
}

/* Return I of the dilatancy law (23) at a solid fraction. */
static double dilatancy(const double *param, double nu) {
  const double excess = fmax(1 / nu - 1 / param[LEE_HUANG_NU_0], 0);
  return pow(excess / param[LEE_HUANG_A], 1 / param[LEE_HUANG_DELTA]);
}

/* A point of (A3): the residual is 0 at its root in nu. */
struct balance {
  const double *param;
  double I_2, K_over_p;
};

/* Return the residual of (A3) by contact alone, f_2 >= f_3. */
static double dense_residual(double nu, void *context) {
  const struct balance *b = (const struct balance *)context;
  const double I = dilatancy(b->param, nu);
  return b->K_over_p * lee_huang_packing(b->param, nu) +
         b->I_2 / fmax(I * I, 1e-200) - 1;
}

/* Return the residual of (A3) by collisions alone, f_3 >= f_2, no packing. */
static double inertial_residual(double nu, void *context) {
  const struct balance *b = (const struct balance *)context;
  return lee_huang_kinetic(b->param, nu).pressure * b->I_2 - 1;
}

/* Return f_3/f_2 - 1, < 0 where there is contact. */
static double transition_residual(double nu, void *context) {
  const struct balance *b = (const struct balance *)context;
  const double I = dilatancy(b->param, nu);
  return lee_huang_kinetic(b->param, nu).pressure * I * I - 1;
}

/* Find where the kinetic pressure at given I is least between low and high, by
 * golden section: there I is largest. */
static double find_last(const double *param, double low, double high) {
  const double ratio = 0.5 * (sqrt(5) - 1);
  while (high - low > 1e-10) {
    const double left = high - ratio * (high - low);
    const double right = low + ratio * (high - low);
    if (lee_huang_kinetic(param, left).pressure <
        lee_huang_kinetic(param, right).pressure)
      high = right;
    else
      low = left;
  }
  return 0.5 * (low + high);
}

/* Search downward from nu_tran for the first minimum. */
static double search_last(const double *param, double nu_tran) {
  const double step = (nu_tran - NU_LEAST) / STEPS;
  double least = lee_huang_kinetic(param, nu_tran).pressure;
  for (int i = 1; i <= STEPS; i++) {
    const double nu = nu_tran - i * step;
    const double next = lee_huang_kinetic(param, nu).pressure;
    if (next > least) {
      const double high = fmin(nu + 2 * step, nu_tran);
      return i == 1 ? nu_tran : find_last(param, nu, high);
    }
    least = next;
  }
  return NU_LEAST;
}

const char *lee_huang_find(const double *param, struct lee_huang_marks *marks) {
  struct balance balance = {.param = param};
  const double nu_0 = param[LEE_HUANG_NU_0], nu_min = param[LEE_HUANG_NU_MIN];
  if (!(nu_min < nu_0 && nu_0 < param[LEE_HUANG_NU_MAX]))
    return "nu_min < nu_0 < nu_max is needed";
  const double step = (nu_0 - NU_LEAST) / STEPS;
  double nu = nu_0 - 1e-6 * step;
  while (nu > NU_LEAST && transition_residual(nu, &balance) < 0) nu -= step;
  if (nu <= NU_LEAST)
    return "grains never fly: the dilatancy law (a, delta, nu_0) and e_eff "
           "do not fit";
  marks->nu_tran = root_between(transition_residual, &balance, nu,
                                fmin(nu + step, nu_0 * (1 - 1e-15)));
  if (marks->nu_tran >= nu_min)
    return "nu_min must be above the solid fraction at which contact ends; "
           "raise nu_min or a";
  marks->nu_last = search_last(param, marks->nu_tran);
  marks->I_m = dilatancy(param, nu_min);
  marks->I_tran = 1 / sqrt(lee_huang_kinetic(param, marks->nu_tran).pressure);
  marks->I_max = 1 / sqrt(lee_huang_kinetic(param, marks->nu_last).pressure);
  return NULL;
}

struct lee_huang_shear lee_huang_direct(const double *param,
                                        const struct lee_huang_marks *marks,
                                        double I, double K_over_p) {
  const double nu_0 = param[LEE_HUANG_NU_0];
  /* Below this, nu of (23) is nu_0 to 1e-12. */
  const double I_least =
      pow(1e-12 / (param[LEE_HUANG_A] * nu_0), 1 / param[LEE_HUANG_DELTA]);
  I = fmin(fmax(I, I_least), marks->I_max);
  struct balance balance = {param, I * I, K_over_p};
  const double highest =
      1 / (1 / nu_0 + param[LEE_HUANG_A] * pow(I, param[LEE_HUANG_DELTA]));
  const bool contact = I < marks->I_tran;
  const double lowest =
      I < marks->I_m ? param[LEE_HUANG_NU_MIN] : marks->nu_tran;
  const double nu =
      contact ? root_between(dense_residual, &balance, lowest, highest)
              : root_between(inertial_residual, &balance, marks->nu_last,
                             marks->nu_tran);
  const struct lee_huang_kinetic kinetic = lee_huang_kinetic(param, nu);
  const double pE = contact ? 1 - kinetic.pressure * I * I : 0;
  return (struct lee_huang_shear){
      .nu = nu,
      .mu = param[LEE_HUANG_ETA_S] * pE + kinetic.stress * I * I,
      .pE_over_p = pE};
}
