/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Patches of a case: what they cover, and those that cannot be. */
#include <check.h>
#include <string.h>

#include "talus/case.h"
#include "talus/error.h"
#include "talus/memory.h"
#include "talus/side_map.h"

Suite *patches_suite(void);

/* Load a box of edge 4 with faces of 1/8, its top chosen by `top`. */
static struct case_file *load(const char *top, const char *more) {
  char text[2048];
  snprintf(text, sizeof text,
           "return { dimension = 2, domain = { size = 4, level = 5 },\n"
           "gravity = { 0, -1 },\n"
           "grains = { density = 1, rheology = { 'coulomb', mu_s = 1 },\n"
           "  shape = function(x, y) return 1 - y end },\n"
           "gas = { density = 1e-3, rheology = { 'newtonian', eta = 1 } },\n"
           "boundary = { left = 'slip', right = 'slip', bottom = 'no_slip',\n"
           "  top = function(x, y) return %s end, %s\n"
           "  patches = { jet = { 'inflow', velocity = { 0, -1 } },\n"
           "              open = { 'outflow', pressure = 0 } } },\n"
           "output = { stop = 1 } }",
           top, more);
  return case_load_text("dir/test.lua", text, 0, NULL);
}

START_TEST(case_says_what_its_patches_cover) {
  struct case_file *file = load("x < 0.3 and 'jet' or 'open'", "");
  const struct params *params = case_params(file);
  ck_assert_int_eq(params->ncovers, 2);
  ck_assert_str_eq(params->cover[0],
                   "boundary.patches.jet covers 0.3 m of top, 3 faces of "
                   "0.125 m, those at the ends by their covered part");
  ck_assert_str_eq(params->cover[1],
                   "boundary.patches.open covers 3.7 m of top, 29 faces of "
                   "0.125 m, in all 3.625 m");
  ck_assert_ptr_null(params->side_map[0]);
  ck_assert_ptr_nonnull(params->side_map[3]);
  case_destroy(file);
}
END_TEST

START_TEST(patch_that_no_side_returns_is_named) {
  struct case_file *file = load("'open'", "");
  ck_assert_str_eq(case_params(file)->cover[0],
                   "boundary.patches.jet covers nothing: no side returns it");
  case_destroy(file);
}
END_TEST

START_TEST(inflow_inside_a_face_is_weighted) {
  struct case_file *file = load("x < 0.01 and 'jet' or 'open'", "");
  const double *covered = side_map_covered(case_params(file)->side_map[3]);
  ck_assert_double_eq_tol(covered[6], 0.01, 1e-7);
  case_destroy(file);
}
END_TEST

/* Beside the centres of faces, on points of the raster and between them. */
START_TEST(outflow_inside_a_face_is_refused) {
  static const char *const TOP[] = {
      "x < 0.06 and 'open' or 'no_slip'",
      "x > 2.01 and x < 2.04 and 'open' or 'no_slip'",
      "x > 1.8751 and x < 1.92 and 'open' or 'no_slip'"};
  load(TOP[_i], "");
}
END_TEST

START_TEST(pressure_is_not_set_twice) {
  load("x > 2 and x < 2.13 and 'open' or 'no_slip'", "pressure_level = 1,");
}
END_TEST

START_TEST(outflow_that_is_not_there_leaves_the_level_to_the_case) {
  struct case_file *file = load("'no_slip'", "pressure_level = 1,");
  ck_assert(case_params(file)->pressure_level_given);
  case_destroy(file);
}
END_TEST

Suite *patches_suite(void) {
  Suite *suite = suite_create("patches");
  TCase *tcase = tcase_create("patches");
  tcase_add_test(tcase, case_says_what_its_patches_cover);
  tcase_add_test(tcase, patch_that_no_side_returns_is_named);
  tcase_add_test(tcase, inflow_inside_a_face_is_weighted);
  tcase_add_loop_exit_test(tcase, outflow_inside_a_face_is_refused, EXIT_USER,
                           0, 3);
  tcase_add_exit_test(tcase, pressure_is_not_set_twice, EXIT_USER);
  tcase_add_test(tcase, outflow_that_is_not_there_leaves_the_level_to_the_case);
  suite_add_tcase(suite, tcase);
  return suite;
}
