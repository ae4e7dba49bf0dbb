/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Rows missing in a table that is to be continued, in words. */
#include "../../src/io/csv_rows.h"

#include <check.h>
#include <string.h>

Suite *csv_rows_suite(void);

/* Write the table of some steps and describe it, as one of every `every`th step
 * from 0 to 12 in so many rows. */
static void describe(const int *steps, int n, int64_t every, int64_t rows,
                     char text[256]) {
  const struct csv_expected expected = {.header = "step,time",
                                        .mark = {.rows = rows},
                                        .last = 12,
                                        .every = every};
  char table[512] = "step,time\n";
  for (int k = 0; k < n; k++) {
    char row[32];
    snprintf(row, sizeof row, "%d,%g\n", steps[k], 0.1 * steps[k]);
    strcat(table, row);
  }
  FILE *f = fmemopen(table, strlen(table), "r");
  ck_assert(csv_rows_read_header(f, expected.header));
  csv_rows_describe(f, &expected, 256, text);
  fclose(f);
}

START_TEST(missing_steps_are_named) {
  const int some[] = {0, 1, 2, 5, 6, 7, 9, 10, 11};
  char text[256];
  describe(some, 9, 1, 13, text);
  ck_assert_str_eq(text,
                   "it lacks 4 of the 13 rows up to step 12: steps 3 to 4, 8, "
                   "12");
}
END_TEST

START_TEST(one_missing_step_is_one_step) {
  const int some[] = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 11, 12};
  char text[256];
  describe(some, 12, 1, 13, text);
  ck_assert_str_eq(text, "it lacks 1 of the 13 rows up to step 12: step 10");
}
END_TEST

START_TEST(more_than_four_gaps_are_cut_short) {
  const int some[] = {0, 2, 4, 6, 8, 10, 12};
  char text[256];
  describe(some, 7, 1, 13, text);
  ck_assert_str_eq(
      text, "it lacks 6 of the 13 rows up to step 12: steps 1, 3, 5, 7, ...");
}
END_TEST

/* Rows of every fifth step: 0, 5, 10, and none between. */
START_TEST(steps_that_were_not_to_be_written_are_not_missed) {
  const int some[] = {0, 10};
  char text[256];
  describe(some, 2, 5, 3, text);
  ck_assert_str_eq(text, "it lacks 1 of the 3 rows up to step 12: step 5");
}
END_TEST

/* All rows are there: their numbers are others. */
START_TEST(changed_rows_are_not_as_written) {
  const int all[] = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12};
  char text[256];
  describe(all, 13, 1, 13, text);
  ck_assert_str_eq(text, "its 13 rows up to step 12 are not as written");
}
END_TEST

/* Rows with too few cells, of which one is no number, or after the last. */
START_TEST(broken_rows_do_not_count) {
  char table[] = "step,time\n0,0\n1,0.1\n2\nx,0.3\n4,0.4\n13,1.3\n5,0.";
  const struct csv_expected expected = {
      .header = "step,time", .mark = {.rows = 6}, .last = 5, .every = 1};
  FILE *f = fmemopen(table, strlen(table), "r");
  char text[256];
  ck_assert(csv_rows_read_header(f, expected.header));
  csv_rows_describe(f, &expected, sizeof text, text);
  fclose(f);
  ck_assert_str_eq(text,
                   "it lacks 3 of the 6 rows up to step 5: steps 2 to 3, 5");
}
END_TEST

Suite *csv_rows_suite(void) {
  Suite *suite = suite_create("csv_rows");
  TCase *tcase = tcase_create("words");
  tcase_add_test(tcase, missing_steps_are_named);
  tcase_add_test(tcase, one_missing_step_is_one_step);
  tcase_add_test(tcase, more_than_four_gaps_are_cut_short);
  tcase_add_test(tcase, steps_that_were_not_to_be_written_are_not_missed);
  tcase_add_test(tcase, changed_rows_are_not_as_written);
  tcase_add_test(tcase, broken_rows_do_not_count);
  suite_add_tcase(suite, tcase);
  return suite;
}
