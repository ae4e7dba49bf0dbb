/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Runs the suites of tests/unit, each test in a process of its own. The list
 * of suites is made by the Makefile from the names of the files. */
#include <check.h>
#include <stdlib.h>

#define SUITE(name) Suite *name##_suite(void);
#include "unit_suites.inc"
#undef SUITE

int main(void) {
  SRunner *runner = srunner_create(NULL);
#define SUITE(name) srunner_add_suite(runner, name##_suite());
#include "unit_suites.inc"
#undef SUITE
  srunner_run_all(runner, CK_NORMAL);
  int failed = srunner_ntests_failed(runner);
  srunner_free(runner);
  return failed == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}
