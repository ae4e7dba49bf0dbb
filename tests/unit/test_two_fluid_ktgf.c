/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/two_fluid_ktgf.h"

#include <check.h>
#include <math.h>

#include "talus/two_fluid_grains.h"

Suite *two_fluid_ktgf_suite(void);

#define EQUAL(a, b, relative) \
  ck_assert_double_eq_tol(a, b, (relative)*fabs(1. * (b)) + 1e-300)

static const double PI = 3.14159265358979323846;

/* Return the set with grains of unit density and diameter, or the default. */
static struct two_fluid_closure closures(bool unit) {
  struct two_fluid_closure c;
  two_fluid_closure_init(&c, TWO_FLUID_KTGF);
  if (unit) {
    two_fluid_take_fluid(&c, TWO_FLUID_AIR);
    c.param[TWO_FLUID_GRAINS_D] = 1;
  }
  ck_assert_ptr_null(two_fluid_prepare(&c));
  return c;
}

/* Plane shear without drag: phi, Theta/(d gamma)^2, p/(rho d^2 gamma^2), tau/p
 * of the kinetic parts, by an independent program. */
static const double SHEAR[][4] = {
    {0.30, 1.0492, 1.9525, 0.2908},
    {0.40, 0.93119, 4.4018, 0.2990},
    {0.50, 0.87692, 11.674, 0.3051},
    {0.55, 0.86017, 22.814, 0.3074},
};
enum { NSHEAR = sizeof SHEAR / sizeof *SHEAR };

/* To the printed digits: half of the last. */
START_TEST(plane_shear_is_the_table) {
  const struct two_fluid_closure c = closures(true);
  const double *row = SHEAR[_i], phi = row[0], gamma = 3;
  const double Theta =
      two_fluid_temperature(&c, phi, gamma * gamma / 2, 0, 0, INFINITY);
  const struct two_fluid_kinetic A = two_fluid_kinetic(&c, phi);
  const double scale = gamma * gamma, p = A.p * Theta;
  EQUAL(Theta / scale, row[1], 6e-6 * (phi == 0.3 ? 10 : 1));
  EQUAL(p / (2560 * scale), row[2], 3e-5);
  EQUAL(A.eta * sqrt(Theta) * gamma / p, row[3], 2e-4);
}
END_TEST

/* By the formulas as printed, but for the exponent of eq. 33. */
START_TEST(kinetic_numbers_are_the_formulas) {
  const struct two_fluid_closure c = closures(false);
  const double e = 0.9, rho = 2560, d = 1e-3, Theta = 0.013;
  for (double phi = 0.01; phi < 0.62; phi += 0.02) {
    const double g_0 = 1 / (1 - pow(phi / 0.63, 1. / 3));
    const struct two_fluid_kinetic A = two_fluid_kinetic(&c, phi);
    EQUAL(A.p * Theta, phi * rho * Theta * (1 + 2 * phi * (1 + e) * g_0),
          1e-12);
    const double eta_c =
        0.8 * phi * phi * rho * d * g_0 * (1 + e) * sqrt(Theta / PI);
    const double base = 1 + 0.8 * phi * (1 + e) * g_0;
    const double eta_k =
        10 * rho * d * sqrt(PI * Theta) / (96 * (1 + e) * g_0) * base * base;
    const struct two_fluid_stress tau =
        two_fluid_stress(&c, phi, 100, 5, 1e-3, Theta);
    EQUAL(tau.eta, eta_c + eta_k, 1e-12);
    EQUAL(tau.kappa,
          4. / 3 * phi * phi * rho * d * g_0 * (1 + e) * sqrt(Theta / PI),
          1e-12);
    EQUAL(tau.tau_y, phi > 0.5 ? 100 * sin(PI / 4) : 0, 1e-12);
    EQUAL(A.loss, 12 * (1 - e * e) * g_0 * rho * phi * phi / (d * sqrt(PI)),
          1e-12);
  }
}
END_TEST

/* phi, p_f, Pa, and the slope where it is printed. */
START_TEST(friction_pressure_has_the_printed_numbers) {
  const struct two_fluid_closure c = closures(false);
  const struct two_fluid_frozen rest = {0};
  const double rows[][4] = {
      {0.55, 38.15, 2e-4, 0},       {0.59, 3955, 2e-4, 5.82e5},
      {0.60, 20576, 3e-5, 3.84e6},  {0.605, 5.6e4, 1e-2, 0},
      {0.625, 2.5e8, 1e-2, 2.5e11},
  };
  for (int k = 0; k < 5; k++) {
    double slope;
    const double p = two_fluid_pressure(&c, rows[k][0], &rest, &slope);
    EQUAL(p, rows[k][1], rows[k][2]);
    if (rows[k][3] > 0) EQUAL(slope, rows[k][3], 2e-2);
    const double room = 0.63 - rows[k][0], x = rows[k][0] - 0.5;
    EQUAL(p, 0.05 * x * x / pow(room, 5), 1e-12);
  }
}
END_TEST

START_TEST(friction_of_syamlal_and_of_the_tangent) {
  struct two_fluid_closure c = closures(false);
  const struct two_fluid_frozen rest = {0};
  c.frictional_pressure = TWO_FLUID_SYAMLAL;
  EQUAL(two_fluid_pressure(&c, 0.59, &rest, NULL), 1e4, 1e-9);
  ck_assert_double_eq(two_fluid_pressure(&c, 0.58, &rest, NULL), 0);
  c.param[TWO_FLUID_KT_ANGLE] = 30;
  EQUAL(two_fluid_stress(&c, 0.55, 7, 1, 1, 0).tau_y, 3.5, 1e-12);
  c.friction = TWO_FLUID_TAN;
  EQUAL(two_fluid_stress(&c, 0.55, 7, 1, 1, 0).tau_y, 7 / sqrt(3), 1e-12);
  /* a slope with sin 45 degrees stands to 35.3 degrees */
  ck_assert_double_eq_tol(atan(sin(PI / 4)) * 180 / PI, 35.3, 0.05);
}
END_TEST

/* Return production less loss of fluctuations, W/m^3, at a temperature. */
static double balance(const struct two_fluid_closure *c, double phi, double DD,
                      double div, double K, double Theta) {
  const struct two_fluid_kinetic A = two_fluid_kinetic(c, phi);
  const struct two_fluid_frozen with = {.Theta = Theta};
  const double s = sqrt(Theta), p = two_fluid_pressure(c, phi, &with, NULL);
  const bool total = c->production == TWO_FLUID_TOTAL;
  const double rub = two_fluid_stress(c, phi, p, 1, 1, 0).tau_y;
  double made = 2 * A.eta * s * DD +
                (A.kappa - 2. / 3 * A.eta) * s * div * div -
                (total ? p : A.p * Theta) * div;
  if (total) made += rub * sqrt(2 * DD);
  return made - A.loss * s * s * s - 3 * K * Theta;
}

START_TEST(temperature_balances) {
  struct two_fluid_closure c = closures(false);
  c.production = (enum two_fluid_production)_i;
  const double phis[] = {0.05, 0.3, 0.49, 0.51, 0.58, 0.62};
  const double divs[] = {-30, -1, 0, 1, 30}, drags[] = {0, 10, 1e4, 1e8};
  for (int n = 0; n < 6 * 5 * 4; n++) {
    const double phi = phis[n / 20], div = divs[n / 4 % 5], K = drags[n % 4];
    const double DD = 500 + div * div / 3;
    const double Theta = two_fluid_temperature(&c, phi, DD, div, K, INFINITY);
    ck_assert(isfinite(Theta) && Theta >= 0);
    const struct two_fluid_kinetic A = two_fluid_kinetic(&c, phi);
    const double scale = 2 * A.eta * sqrt(Theta) * DD +
                         A.p * Theta * fabs(div) + 3 * K * Theta +
                         A.loss * Theta * sqrt(Theta);
    /* expansion that takes more than friction makes is left out of it */
    if (_i == TWO_FLUID_TOTAL && sqrt(DD) < div) continue;
    const double miss = balance(&c, phi, DD, div, K, Theta);
    ck_assert_double_le(fabs(miss), 1e-12 * scale);
  }
}
END_TEST

START_TEST(temperature_has_limits) {
  struct two_fluid_closure c = closures(false);
  for (int total = 0; total < 2; total++) {
    c.production = (enum two_fluid_production)total;
    /* rest, no grains, no drag, few grains */
    ck_assert_double_eq(two_fluid_temperature(&c, 0.55, 0, 0, 0, INFINITY), 0);
    ck_assert_double_eq(two_fluid_temperature(&c, 0.55, 0, 0, 9, 1), 0);
    ck_assert_double_eq(two_fluid_temperature(&c, 0, 0, 0, 0, 1), 0);
    EQUAL(two_fluid_temperature(&c, 0, 2, 0, 0, 0.3), 0.1, 1e-14);
    EQUAL(two_fluid_temperature(&c, 1e-9, 2, 0, 0, 0.3), 0.1, 1e-14);
    ck_assert_double_eq(two_fluid_temperature(&c, 0.55, 1e6, 0, 0, 0), 0);
    ck_assert(isfinite(two_fluid_temperature(&c, 0.9, 1e6, -9, 0, 1e9)));
  }
  /* Theta/(d gamma)^2 without the bound, to the digits of the design */
  const double rows[][2] = {{0.4, 0.93119}, {0.1, 3.5}, {0.05, 13}};
  c.production = TWO_FLUID_KINETIC;
  for (int k = 0; k < 3; k++) {
    const double T = two_fluid_temperature(&c, rows[k][0], 0.5, 0, 0, INFINITY);
    EQUAL(T / 1e-6, rows[k][1], 5e-2);
  }
}
END_TEST

Suite *two_fluid_ktgf_suite(void) {
  Suite *suite = suite_create("two_fluid_ktgf");
  TCase *tcase = tcase_create("ktgf");
  tcase_add_loop_test(tcase, plane_shear_is_the_table, 0, NSHEAR);
  tcase_add_test(tcase, kinetic_numbers_are_the_formulas);
  tcase_add_test(tcase, friction_pressure_has_the_printed_numbers);
  tcase_add_test(tcase, friction_of_syamlal_and_of_the_tangent);
  tcase_add_loop_test(tcase, temperature_balances, 0, 2);
  tcase_add_test(tcase, temperature_has_limits);
  suite_add_tcase(suite, tcase);
  return suite;
}
