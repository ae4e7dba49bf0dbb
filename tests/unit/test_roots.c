/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/roots.h"

#include <check.h>
#include <math.h>

#include "talus/error.h"
#include "talus/rheology.h"

Suite *roots_suite(void);

static double cubic(double x, void *context) {
  return x * x * x - *(const double *)context;
}

static double broken_inside(double x, void *context) {
  (void)context;
  return fabs(x) < 1 ? NAN : x;
}

START_TEST(root_is_found_to_the_last_bits) {
  for (double c = -8; c <= 8; c += 16) {
    ck_assert_double_eq_tol(root_between(cubic, &c, -3, 5), cbrt(c), 1e-15);
  }
}
END_TEST

START_TEST(end_nearer_to_a_root_stands_for_one_that_is_not_there) {
  double c = 8;
  ck_assert_double_eq(root_between(cubic, &c, 3, 5), 3);
  ck_assert_double_eq(root_between(cubic, &c, -3, 1), 1);
  ck_assert_double_eq(root_between(cubic, &c, 2, 5), 2);
}
END_TEST

/* Gives 0 up to 1, then a pole of fifth order at 2 of which the line that
 * touches at 1.999 is left. */
static double kinked(double x, double *slope, const void *context) {
  (void)context;
  const double at = fmin(x, 1.999), room = 2 - at;
  *slope = x > 1 ? (1 + 5 * (at - 1) / room) / pow(room, 5) : 0;
  const double f = x > 1 ? (at - 1) / pow(room, 5) : 0;
  return f + fmax(x - 1.999, 0) * *slope;
}

/* From guesses below the kink, above it and beyond the pole. */
START_TEST(rising_function_is_inverted_over_kinks_and_near_poles) {
  const double guesses[] = {0, 0.5, 1.5, 7};
  for (double target = 1e-9; target < 1e20; target *= 10)
    for (int k = 0; k < 4; k++) {
      double slope;
      const double x = root_of_rising(kinked, NULL, target, 0, guesses[k]);
      ck_assert_double_eq_tol(kinked(x, &slope, NULL), target,
                              1e-12 * target + 1e-13 * slope);
    }
}
END_TEST

START_TEST(error_of_gsl_ends_the_program) {
  rheology_begin();
  root_between(broken_inside, NULL, -2, 3);
}
END_TEST

Suite *roots_suite(void) {
  Suite *suite = suite_create("roots");
  TCase *tcase = tcase_create("roots");
  tcase_add_test(tcase, root_is_found_to_the_last_bits);
  tcase_add_test(tcase, end_nearer_to_a_root_stands_for_one_that_is_not_there);
  tcase_add_test(tcase, rising_function_is_inverted_over_kinks_and_near_poles);
  tcase_add_exit_test(tcase, error_of_gsl_ends_the_program, EXIT_SYSTEM);
  suite_add_tcase(suite, tcase);
  return suite;
}
