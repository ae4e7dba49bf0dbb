/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "../../src/rheology/roots.h"

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
  tcase_add_exit_test(tcase, error_of_gsl_ends_the_program, EXIT_SYSTEM);
  suite_add_tcase(suite, tcase);
  return suite;
}
