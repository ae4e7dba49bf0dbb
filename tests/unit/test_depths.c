/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/depths.h"

#include <check.h>
#include <math.h>

#include "talus/params.h"

Suite *depths_suite(void);

/* Grains in two layers, the upper one 0.25 high along the axis that *context
 * names and over a quarter of the box only, the lower one 0.125 high. */
static double layers(void *context, const double x[3]) {
  const int axis = *(const int *)context;
  const double z = x[axis], across = x[(axis + 1) % 2];
  const double upper = fmin(fmin(z - 0.5, 0.75 - z), 1.25 - across);
  return fmax(upper, 0.125 - z);
}

START_TEST(the_highest_column_is_found) {
  int axis = _i % 2;
  struct params params = {.dimension = 2 + _i / 2,
                          .size = 1,
                          .origin = {1, 1, 1},
                          .trees = {1, 1, 1},
                          .shape = {layers, &axis}};
  params.origin[axis] = 0;
  ck_assert_double_eq_tol(depths_deepest(&params, axis), 0.25, 1. / 256);
  params.shape.eval = NULL;
  ck_assert_double_eq_tol(depths_deepest(&params, axis), 1, 1e-12);
}
END_TEST

Suite *depths_suite(void) {
  Suite *suite = suite_create("depths");
  TCase *tcase = tcase_create("depths");
  tcase_add_loop_test(tcase, the_highest_column_is_found, 0, 4);
  suite_add_tcase(suite, tcase);
  return suite;
}
