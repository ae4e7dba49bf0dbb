/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/two_fluid_grains.h"

#include <check.h>
#include <fenv.h>
#include <math.h>

#include "talus/two_fluid_drag.h"
#include "talus/two_fluid_ktgf.h"

Suite *two_fluid_grains_suite(void);

#define EQUAL(a, b, relative) \
  ck_assert_double_eq_tol(a, b, (relative)*fabs(1. * (b)) + 1e-300)

static struct two_fluid_closure closures(enum two_fluid_set set) {
  struct two_fluid_closure c;
  two_fluid_closure_init(&c, set);
  ck_assert_ptr_null(two_fluid_prepare(&c));
  return c;
}

/* Frozen numbers from rest to fast shear. */
static const struct two_fluid_frozen WITH[] = {
    {0.55, 0, 0},    {0.55, 1e-6, 1e-8}, {0.48, 1e-3, 1e-4},
    {0.609, 1, 0.1}, {0.54, 100, 10},
};
enum { NWITH = sizeof WITH / sizeof *WITH, NSETS = 4 };

/* Takes all sets and frozen numbers. Central differences have the error h^2
 * P'''/6 and the round-off eps P/h; kinks are met by neither. */
START_TEST(slope_is_the_derivative_of_pressure) {
  const struct two_fluid_closure c = closures(_i / NWITH);
  const struct two_fluid_frozen *with = &WITH[_i % NWITH];
  for (double phi = 0.0113; phi < 0.9; phi += 0.00731) {
    const double h = 1e-7;
    double slope;
    const double p = two_fluid_pressure(&c, phi, with, &slope);
    const double up = two_fluid_pressure(&c, phi + h, with, NULL);
    const double down = two_fluid_pressure(&c, phi - h, with, NULL);
    ck_assert_double_eq_tol(slope, (up - down) / (2 * h),
                            1e-5 * slope + 1e-8 * p / h + 1e-12);
  }
}
END_TEST

START_TEST(pressure_is_convex_and_rises_from_zero) {
  const struct two_fluid_closure c = closures(_i / NWITH);
  const struct two_fluid_frozen *with = &WITH[_i % NWITH];
  double p_old, slope_old;
  p_old = two_fluid_pressure(&c, 0, with, &slope_old);
  ck_assert_double_eq(p_old, 0);
  for (double phi = 1e-4; phi < 1.5; phi += 1e-4) {
    double slope;
    const double p = two_fluid_pressure(&c, phi, with, &slope);
    ck_assert(isfinite(p) && isfinite(slope));
    ck_assert_double_ge(p, p_old);
    ck_assert_double_ge(slope, slope_old * (1 - 1e-12));
    p_old = p, slope_old = slope;
  }
}
END_TEST

START_TEST(solid_fraction_inverts_pressure) {
  const struct two_fluid_closure c = closures(_i / NWITH);
  const struct two_fluid_frozen *with = &WITH[_i % NWITH];
  const double low = two_fluid_loosest(&c, with->phi_p);
  for (double p = 1e-6; p < 1e9; p *= 7) {
    /* from a guess above, below and none */
    const double guesses[] = {0.7, low, 0};
    for (int k = 0; k < 3; k++) {
      const double phi = two_fluid_solid_fraction(&c, p, with, 0, guesses[k]);
      double slope;
      const double back = two_fluid_pressure(&c, phi, with, &slope);
      /* phi to 1e-14 */
      ck_assert_double_eq_tol(back, p, 1e-12 * p + 4e-14 * slope * phi);
    }
  }
}
END_TEST

/* The last three are formulas of both contact pressures at round numbers. */
START_TEST(settled_beds_carry_their_load) {
  for (int set = 0; set < NSETS; set++) {
    const struct two_fluid_closure c = closures(set);
    ck_assert_double_eq(two_fluid_settled(&c, 0, 0.55),
                        two_fluid_loosest(&c, 0.55));
    for (double p = 1e-3; p < 2e5; p *= 10) {
      const double phi = two_fluid_settled(&c, p, 0.55);
      ck_assert_double_gt(phi, two_fluid_loosest(&c, 0.55));
      ck_assert_double_lt(phi, two_fluid_densest(&c));
    }
  }
  /* a (phi - 0.53)/(0.63 - phi) = 130 Pa halfway */
  const struct two_fluid_closure rauter = closures(TWO_FLUID_RAUTER);
  EQUAL(two_fluid_settled(&rauter, 130, 0), 0.58, 1e-13);
  /* 100 0.03^3/0.045^5 Pa */
  const struct two_fluid_closure state = closures(TWO_FLUID_CRITICAL_STATE);
  EQUAL(two_fluid_settled(&state, 100 * 2.7e-5 / 1.845281250e-7, 0.55), 0.58,
        1e-13);
  EQUAL(two_fluid_plastic_of(&state, 0.58, 2.7e-3 / 1.845281250e-7), 0.55,
        1e-13);
}
END_TEST

/* Call every function at a state, so that they raise what they do. */
static double all(const struct two_fluid_closure *c, double phi, double gamma,
                  double p, double div) {
  const double eta_f = two_fluid_viscosity(c, gamma);
  const double K = two_fluid_drag(c, phi, gamma, eta_f);
  const double Theta =
      two_fluid_temperature(c, phi, 0.5 * gamma * gamma, div, p > 1 ? K : 0, 1);
  const struct two_fluid_frozen with = {0.54, two_fluid_shear(c, gamma, eta_f),
                                        Theta};
  const struct two_fluid_stress tau =
      two_fluid_stress(c, phi, p, gamma, eta_f, Theta);
  const double rate = two_fluid_plastic_rate(c, phi, p, gamma, eta_f);
  double sum =
      two_fluid_pore_viscosity(c, phi, eta_f) +
      two_fluid_pore_shear_rate(phi, K, gamma, eta_f) +
      two_fluid_capped(&tau, gamma, 0, 1e7) +
      two_fluid_capped(&tau, gamma, 1e-3, 1e7) +
      two_fluid_pressure(c, phi, &with, NULL) + two_fluid_settled(c, p, 0.54) +
      two_fluid_plastic(c, 0.54, rate, 1) + two_fluid_plastic_of(c, phi, p) +
      two_fluid_relaxed_shear(c, 1, gamma, eta_f, phi, 1);
  if (p > 0) sum += two_fluid_solid_fraction(c, p, &with, 0, phi);
  return sum;
}

/* Debug builds trap them. */
START_TEST(no_state_divides_by_zero_or_overflows) {
  const double phis[] = {0, 1e-300, 1e-12, 1e-3, 0.2, 0.5, 0.585, 0.63, 0.99};
  const double rates[] = {0, 1e-300, 1e-12, 1e-3, 1, 1e6};
  const double loads[] = {0, 1e-300, 1e-6, 1, 1e5, 1e12};
  struct two_fluid_closure c = closures(_i % NSETS);
  c.production = (enum two_fluid_production)(_i / NSETS);
  feclearexcept(FE_ALL_EXCEPT);
  for (int k = 0; k < 9 * 6 * 6 * 3; k++) {
    const double gamma = rates[k / 18 % 6];
    const double sum =
        all(&c, phis[k / 108], gamma, loads[k / 3 % 6], (k % 3 - 1) * gamma);
    ck_assert(isfinite(sum));
    ck_assert_int_eq(fetestexcept(FE_DIVBYZERO | FE_INVALID | FE_OVERFLOW), 0);
  }
}
END_TEST

Suite *two_fluid_grains_suite(void) {
  Suite *suite = suite_create("two_fluid_grains");
  TCase *tcase = tcase_create("grains");
  tcase_add_loop_test(tcase, slope_is_the_derivative_of_pressure, 0,
                      NSETS * NWITH);
  tcase_add_loop_test(tcase, pressure_is_convex_and_rises_from_zero, 0,
                      NSETS * NWITH);
  tcase_add_loop_test(tcase, solid_fraction_inverts_pressure, 0, NSETS * NWITH);
  tcase_add_loop_test(tcase, no_state_divides_by_zero_or_overflows, 0,
                      2 * NSETS);
  tcase_add_test(tcase, settled_beds_carry_their_load);
  suite_add_tcase(suite, tcase);
  return suite;
}
