/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/count.h"

#include <check.h>

#include "../../tree/builder.h"
#include "talus/error.h"

Suite *count_suite(void);

START_TEST(counts_that_fit_pass) {
  ck_assert_int_eq(count_index(INT32_MAX, "leaves"), INT32_MAX);
  ck_assert_int_eq(count_check(7, 7, "leaves"), 7);
  const int32_t node = node_name(KIND_VIRTUAL, KIND_MOST);
  ck_assert_int_eq(node_kind(node), KIND_VIRTUAL);
  ck_assert_int_eq(node_number(node), KIND_MOST);
}
END_TEST

START_TEST(an_index_of_32_bits_is_checked) {
  count_index((int64_t)INT32_MAX + 1, "leaves");
}
END_TEST

START_TEST(a_name_of_28_bits_is_checked) {
  node_name(KIND_VIRTUAL, (int64_t)KIND_MOST + 1);
}
END_TEST

Suite *count_suite(void) {
  Suite *suite = suite_create("count");
  TCase *tcase = tcase_create("limits");
  tcase_add_test(tcase, counts_that_fit_pass);
  tcase_add_exit_test(tcase, an_index_of_32_bits_is_checked, EXIT_SYSTEM);
  tcase_add_exit_test(tcase, a_name_of_28_bits_is_checked, EXIT_SYSTEM);
  suite_add_tcase(suite, tcase);
  return suite;
}
