/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/scratch.h"

#include <check.h>

#include "talus/error.h"
#include "talus/memory.h"
#include "talus/poison.h"

Suite *scratch_suite(void);

enum { CELLS = 3, FACES = 2 };

/* A pool over a mesh that is nothing but its lengths. */
struct pool {
  struct mesh lengths, *mesh;
  struct fields fields;
  struct scratch scratch;
};

static void pool_begin(struct pool *pool) {
  *pool = (struct pool){.lengths = {.ncells = 20, .nfaces_all = 50}};
  pool->mesh = &pool->lengths;
  scratch_init(&pool->scratch, &pool->fields, &pool->mesh, CELLS, FACES);
}

static void pool_end(struct pool *pool) { fields_destroy(&pool->fields); }

START_TEST(takers_have_arrays_of_their_own) {
  struct pool pool;
  pool_begin(&pool);
  double *one = scratch_take_one(&pool.scratch, FIELD_CELL, "one"), *two[2];
  scratch_take(&pool.scratch, FIELD_CELL, "two", 2, two);
  ck_assert_ptr_ne(one, two[0]);
  ck_assert_ptr_ne(one, two[1]);
  ck_assert_ptr_ne(two[0], two[1]);
  scratch_give(&pool.scratch, "two");
  scratch_give(&pool.scratch, "one");
  ck_assert_ptr_null(scratch_taker(&pool.scratch));
  pool_end(&pool);
}
END_TEST

START_TEST(all_arrays_of_a_taker_are_given_back) {
  struct pool pool;
  pool_begin(&pool);
  double *v[CELLS];
  for (int round = 0; round < 2; round++) {
    scratch_take(&pool.scratch, FIELD_CELL, "all", CELLS, v);
    scratch_take(&pool.scratch, FIELD_FACE, "all", FACES, v);
    scratch_give(&pool.scratch, "all");
  }
  pool_end(&pool);
}
END_TEST

START_TEST(who_has_not_given_back_is_named) {
  struct pool pool;
  pool_begin(&pool);
  double *v[2];
  scratch_take(&pool.scratch, FIELD_FACE, "late", 2, v);
  ck_assert_str_eq(scratch_taker(&pool.scratch), "late");
  pool_end(&pool);
}
END_TEST

START_TEST(arrays_have_the_length_of_the_mesh) {
  struct pool pool;
  pool_begin(&pool);
  pool.lengths.ncells = 5000, pool.lengths.nfaces_all = 7000;
  fields_reset(&pool.fields, pool.mesh);
  double *cell = scratch_take_one(&pool.scratch, FIELD_CELL, "a");
  double *face = scratch_take_one(&pool.scratch, FIELD_FACE, "a");
  for (int i = 0; i < 5000; i++) cell[i] = 1;
  for (int i = 0; i < 7000; i++) face[i] = 1;
  scratch_give(&pool.scratch, "a");
  pool_end(&pool);
}
END_TEST

START_TEST(a_taken_array_can_be_exchanged) {
  struct pool pool;
  pool_begin(&pool);
  double *state = MEM_NEW(double, pool.lengths.nfaces_all);
  double *v = scratch_take_one(&pool.scratch, FIELD_FACE, "a");
  scratch_exchange(&pool.scratch, v, state);
  scratch_give(&pool.scratch, "a");
  ck_assert_ptr_eq(scratch_take_one(&pool.scratch, FIELD_FACE, "b"), state);
  mem_free(v); /* no longer the pool's */
  pool_end(&pool);
}
END_TEST

START_TEST(debug_builds_poison_scratch) {
  struct pool pool;
  pool_begin(&pool);
  double *v = scratch_take_one(&pool.scratch, FIELD_FACE, "a");
  ck_assert(is_poison(&v[0]) == POISON_ON && is_poison(&v[49]) == POISON_ON);
  v[0] = v[49] = 1;
  scratch_give(&pool.scratch, "a");
  ck_assert(is_poison(&v[0]) == POISON_ON && is_poison(&v[49]) == POISON_ON);
  pool_end(&pool);
}
END_TEST

START_TEST(a_second_take_is_an_error) {
  struct pool pool;
  pool_begin(&pool);
  scratch_take_one(&pool.scratch, FIELD_CELL, "greedy");
  scratch_take_one(&pool.scratch, FIELD_CELL, "greedy");
}
END_TEST

START_TEST(more_than_there_is_is_an_error) {
  struct pool pool;
  double *v[CELLS];
  pool_begin(&pool);
  scratch_take_one(&pool.scratch, FIELD_CELL, "one");
  scratch_take(&pool.scratch, FIELD_CELL, "all", CELLS, v);
}
END_TEST

START_TEST(exchanging_what_is_not_taken_is_an_error) {
  struct pool pool;
  double other[1];
  pool_begin(&pool);
  double *v = scratch_take_one(&pool.scratch, FIELD_CELL, "one");
  scratch_give(&pool.scratch, "one");
  scratch_exchange(&pool.scratch, v, other);
}
END_TEST

START_TEST(giving_what_was_not_taken_is_an_error) {
  struct pool pool;
  pool_begin(&pool);
  scratch_take_one(&pool.scratch, FIELD_CELL, "one");
  scratch_give(&pool.scratch, "other");
}
END_TEST

Suite *scratch_suite(void) {
  Suite *suite = suite_create("scratch");
  TCase *tcase = tcase_create("scratch");
  tcase_add_test(tcase, takers_have_arrays_of_their_own);
  tcase_add_test(tcase, all_arrays_of_a_taker_are_given_back);
  tcase_add_test(tcase, who_has_not_given_back_is_named);
  tcase_add_test(tcase, arrays_have_the_length_of_the_mesh);
  tcase_add_test(tcase, a_taken_array_can_be_exchanged);
  tcase_add_test(tcase, debug_builds_poison_scratch);
  tcase_add_exit_test(tcase, a_second_take_is_an_error, EXIT_SYSTEM);
  tcase_add_exit_test(tcase, more_than_there_is_is_an_error, EXIT_SYSTEM);
  tcase_add_exit_test(tcase, exchanging_what_is_not_taken_is_an_error,
                      EXIT_SYSTEM);
  tcase_add_exit_test(tcase, giving_what_was_not_taken_is_an_error,
                      EXIT_SYSTEM);
  suite_add_tcase(suite, tcase);
  return suite;
}
