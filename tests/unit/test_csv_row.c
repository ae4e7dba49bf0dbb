/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <check.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "talus/csv_row.h"

Suite *csv_row_suite(void);

static FILE *open_text(char *text) { return fmemopen(text, strlen(text), "r"); }

START_TEST(cells_may_hold_commas_quotes_and_lines) {
  char text[] = "a,\"b, \"\"c\"\"\",,\"x\ny\"\r\nd\n\ncut,sho";
  FILE *f = open_text(text);
  struct csv_row row = {0};
  ck_assert(csv_row_read(f, &row) && row.ends);
  ck_assert_int_eq(row.n, 4);
  ck_assert_str_eq(csv_row_cell(&row, 0), "a");
  ck_assert_str_eq(csv_row_cell(&row, 1), "b, \"c\"");
  ck_assert_str_eq(csv_row_cell(&row, 2), "");
  ck_assert_str_eq(csv_row_cell(&row, 3), "x\ny");
  ck_assert_str_eq(csv_row_cell(&row, 4), "");
  ck_assert(csv_row_read(f, &row) && row.ends && row.n == 1);
  ck_assert(csv_row_read(f, &row) && row.ends && row.n == 1);
  ck_assert_str_eq(csv_row_cell(&row, 0), "");
  ck_assert(csv_row_read(f, &row) && !row.ends && row.n == 2);
  ck_assert_str_eq(csv_row_cell(&row, 1), "sho");
  ck_assert(!csv_row_read(f, &row));
  csv_row_free(&row);
  fclose(f);
}
END_TEST

START_TEST(what_is_written_is_read_back) {
  static const char *const words[] = {"plain",    "",          "a,b",
                                      "\"",       "say \"x\"", "two\nlines",
                                      "cr\r\nlf", " ,\"\","};
  enum { N = sizeof words / sizeof *words };
  char *text = NULL;
  size_t size = 0;
  FILE *f = open_memstream(&text, &size);
  struct csv_row row = {0};
  for (int k = 0; k < N; k++) csv_row_add(&row, words[k]);
  csv_row_write(&row, f);
  csv_row_add(&row, "next");
  csv_row_write(&row, f);
  csv_row_free(&row);
  fclose(f);
  f = open_text(text);
  ck_assert(csv_row_read(f, &row) && row.ends);
  ck_assert_int_eq(row.n, N);
  for (int k = 0; k < N; k++) ck_assert_str_eq(csv_row_cell(&row, k), words[k]);
  ck_assert(csv_row_read(f, &row) && row.ends && row.n == 1);
  ck_assert_str_eq(csv_row_cell(&row, 0), "next");
  csv_row_free(&row);
  fclose(f);
  free(text);
}
END_TEST

/* Text that a checksum is made of, and a copy. */
START_TEST(lines_are_kept_as_they_stand) {
  static const char *const lines[] = {"1,\"a\"\"\nb\",\r\n", "\n", "cut, \"sh"};
  char text[64] = "";
  for (int k = 0; k < 3; k++) strcat(text, lines[k]);
  FILE *f = open_text(text);
  struct csv_row row = {0};
  for (int k = 0; k < 3; k++) {
    ck_assert(csv_row_read(f, &row));
    ck_assert_uint_eq(row.line.n, strlen(lines[k]));
    ck_assert_mem_eq(row.line.v, lines[k], row.line.n);
    ck_assert_int_eq(row.ends, k < 2);
  }
  ck_assert(!csv_row_read(f, &row));
  csv_row_add(&row, "a b"), csv_row_add(&row, "c\"");
  FILE *null = fopen("/dev/null", "w");
  csv_row_write(&row, null);
  fclose(null);
  ck_assert_uint_eq(row.line.n, 10);
  ck_assert_mem_eq(row.line.v, "a b,\"c\"\"\"\n", 10);
  csv_row_free(&row);
  fclose(f);
}
END_TEST

START_TEST(numbers_are_whole_cells) {
  char text[] = "12,-1.5e3,\" 7\",,1.5m,time,0x10\n";
  const double exact[] = {12, -1500, 7, 99, 99, 99, 16, 99};
  FILE *f = open_text(text);
  struct csv_row row = {0};
  ck_assert(csv_row_read(f, &row));
  for (int k = 0; k < 8; k++) {
    double value = 99;
    ck_assert_int_eq(csv_row_number(&row, k, &value), exact[k] != 99);
    ck_assert_double_eq(value, exact[k]);
  }
  csv_row_free(&row);
  fclose(f);
}
END_TEST

/* A cell longer than any buffer. */
START_TEST(cells_of_any_length_are_whole) {
  enum { LONG = 100000 };
  char *text = calloc(LONG + 1, 1);
  memset(text, 'x', LONG);
  text[LONG - 1] = '\n';
  FILE *f = open_text(text);
  struct csv_row row = {0};
  ck_assert(csv_row_read(f, &row));
  ck_assert_uint_eq(strlen(csv_row_cell(&row, 0)), LONG - 1);
  csv_row_free(&row);
  fclose(f);
  free(text);
}
END_TEST

Suite *csv_row_suite(void) {
  Suite *suite = suite_create("csv_row");
  TCase *tcase = tcase_create("text");
  tcase_add_test(tcase, cells_may_hold_commas_quotes_and_lines);
  tcase_add_test(tcase, what_is_written_is_read_back);
  tcase_add_test(tcase, lines_are_kept_as_they_stand);
  tcase_add_test(tcase, numbers_are_whole_cells);
  tcase_add_test(tcase, cells_of_any_length_are_whole);
  suite_add_tcase(suite, tcase);
  return suite;
}
