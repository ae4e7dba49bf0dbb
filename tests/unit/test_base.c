/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <check.h>
#include <errno.h>
#include <mpi.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "talus/error.h"
#include "talus/log.h"
#include "talus/memory.h"
#include "talus/program.h"

Suite *base_suite(void);

enum { TEXT_LENGTH = 8192 };

/* Run f in a child process and return its exit status, -1 if a signal ended
 * it; `words` [TEXT_LENGTH] is what it wrote on stderr. */
static int run_in_child(void (*f)(void), char *words) {
  int ends[2];
  ck_assert_int_eq(pipe(ends), 0);
  fflush(NULL);
  pid_t child = fork();
  ck_assert_int_ge(child, 0);
  if (child == 0) {
    dup2(ends[1], STDERR_FILENO);
    close(ends[0]);
    close(ends[1]);
    f();
    exit(EXIT_DONE);
  }
  close(ends[1]);
  size_t length = 0;
  ssize_t got;
  while ((got = read(ends[0], words + length, TEXT_LENGTH - 1 - length)) > 0)
    length += (size_t)got;
  words[length] = '\0';
  close(ends[0]);
  int status;
  ck_assert_int_eq(waitpid(child, &status, 0), child);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

static void assert_contains(const char *words, const char *part) {
  ck_assert_msg(strstr(words, part) != NULL, "no '%s' in: %s", part, words);
}

/* Errors */

static void raise_user_error(void) {
  USER_ERROR("case.lua:%d: unknown key '%s'", 7, "levle");
}

static void raise_user_error_in_mpi(void) {
  base_begin(NULL, NULL);
  raise_user_error();
}

START_TEST(user_error_says_one_line_and_ends_with_2) {
  char words[TEXT_LENGTH];
  ck_assert_int_eq(run_in_child(raise_user_error, words), EXIT_USER);
  ck_assert_str_eq(words, "talus: error: case.lua:7: unknown key 'levle'\n");
}
END_TEST

static void raise_user_error_alone(void) {
  base_begin(NULL, NULL);
  USER_ERROR_ALONE("shape(%g) returned nil", 0.5);
}

START_TEST(user_error_of_one_rank_ends_with_2) {
  char words[TEXT_LENGTH];
  ck_assert_int_eq(run_in_child(raise_user_error_alone, words), EXIT_USER);
  assert_contains(words, "talus: error: shape(0.5) returned nil\n");
}
END_TEST

START_TEST(user_error_finalizes_mpi_and_ends_with_2) {
  char words[TEXT_LENGTH];
  ck_assert_int_eq(run_in_child(raise_user_error_in_mpi, words), EXIT_USER);
  /* MPI may have remarks of its own on a strange machine. */
  assert_contains(words, "talus: error: case.lua:7: unknown key 'levle'\n");
}
END_TEST

static void raise_fatal(void) { FATAL("disk is full, %d bytes missing", 12); }

static void raise_fatal_in_mpi(void) {
  base_begin(NULL, NULL);
  raise_fatal();
}

START_TEST(fatal_says_where_and_ends_with_4) {
  char words[TEXT_LENGTH];
  ck_assert_int_eq(run_in_child(raise_fatal, words), EXIT_SYSTEM);
  assert_contains(words, "talus: fatal: disk is full, 12 bytes missing\n");
  assert_contains(words, "rank 0");
  assert_contains(words, "test_base.c:");
  assert_contains(words, "raise_fatal");
}
END_TEST

START_TEST(fatal_in_mpi_aborts_with_4) {
  char words[TEXT_LENGTH];
  ck_assert_int_eq(run_in_child(raise_fatal_in_mpi, words), EXIT_SYSTEM);
  assert_contains(words, "disk is full");
}
END_TEST

static void break_contract(void) {
  int revision = 3;
  CHECK(revision == 3, "never said");
  CHECK(revision == 4, "array is of mesh %d, make it again", revision);
}

START_TEST(check_names_condition_and_place) {
  char words[TEXT_LENGTH];
  ck_assert_int_eq(run_in_child(break_contract, words), EXIT_SYSTEM);
  assert_contains(words, "array is of mesh 3, make it again");
  assert_contains(words, "revision == 4 is false");
  assert_contains(words, "break_contract");
  ck_assert_ptr_null(strstr(words, "never said"));
}
END_TEST

static void send_to_nobody(void) {
  base_begin(NULL, NULL);
  int value = 0;
  MPI_CHECK(MPI_Send(&value, 1, MPI_INT, 99, 0, MPI_COMM_WORLD));
}

START_TEST(mpi_check_ends_with_the_words_of_mpi) {
  char words[TEXT_LENGTH];
  ck_assert_int_eq(run_in_child(send_to_nobody, words), EXIT_SYSTEM);
  assert_contains(words, "MPI_ERR_RANK");
  assert_contains(words, "send_to_nobody");
}
END_TEST

static void warn_three_times(void) {
  for (int i = 0; i < 3; i++) WARN_ONCE("cell count capped at %d", 100 + i);
}

START_TEST(warn_once_warns_once) {
  char words[TEXT_LENGTH];
  ck_assert_int_eq(run_in_child(warn_three_times, words), EXIT_DONE);
  assert_contains(words, "talus: warning: cell count capped at 100\n");
  ck_assert_ptr_null(strstr(words, "101"));
}
END_TEST

static int evaluations;

static bool evaluate(bool value) {
  evaluations++;
  return value;
}

static void assert_falsehood(void) { ASSERT(evaluate(false)); }

START_TEST(assert_ends_debug_builds_and_costs_others_nothing) {
  char words[TEXT_LENGTH];
  ASSERT(evaluate(true));
#ifdef NDEBUG
  ck_assert_int_eq(run_in_child(assert_falsehood, words), EXIT_DONE);
  ck_assert_int_eq(evaluations, 0);
#else
  ck_assert_int_eq(run_in_child(assert_falsehood, words), EXIT_SYSTEM);
  assert_contains(words, "evaluate(false)");
  ck_assert_int_eq(evaluations, 1);
#endif
}
END_TEST

START_TEST(without_mpi_this_is_rank_0_of_1) {
  ck_assert_int_eq(base_rank(), 0);
  ck_assert_int_eq(base_size(), 1);
  base_end(); /* nothing to end */
}
END_TEST

static void begin_and_forget(void) {
  base_begin(NULL, NULL);
  ck_assert_ptr_nonnull(mem_alloc(1, 1));
  base_end();
}

START_TEST(end_reports_leaks_in_debug_builds) {
  char words[TEXT_LENGTH];
  ck_assert_int_eq(run_in_child(begin_and_forget, words), EXIT_DONE);
#ifdef NDEBUG
  ck_assert_ptr_null(strstr(words, "talus"));
#else
  assert_contains(words, "rank 0: 1 blocks of memory not freed");
#endif
}
END_TEST

static void divide(void) {
  volatile double zero = 0, one = 1;
  zero = one / zero;
}

static void divide_in_good_faith(void) {
  base_begin(NULL, NULL);
  bool before = base_trap_floating_point(false);
  divide();
  base_trap_floating_point(before);
}

static void divide_by_mistake(void) {
  divide_in_good_faith();
  divide();
}

START_TEST(debug_builds_trap_division_by_zero) {
  char words[TEXT_LENGTH];
  ck_assert_int_eq(run_in_child(divide_in_good_faith, words), EXIT_DONE);
#ifdef NDEBUG
  ck_assert_int_eq(run_in_child(divide_by_mistake, words), EXIT_DONE);
#else
  ck_assert_int_ne(run_in_child(divide_by_mistake, words), EXIT_DONE);
#endif
}
END_TEST

/* Memory */

START_TEST(memory_is_zeroed_and_aligned) {
  const size_t counts[] = {1, 7, 127, 128, 1000, 100000};
  for (size_t i = 0; i < sizeof counts / sizeof counts[0]; i++) {
    double *a = MEM_NEW(double, counts[i]);
    for (size_t j = 0; j < counts[i]; j++) ck_assert(a[j] == 0);
    if (counts[i] * sizeof *a >= MEM_LARGE)
      ck_assert_uint_eq((uintptr_t)a % MEM_ALIGNMENT, 0);
    mem_free(a);
  }
}
END_TEST

START_TEST(memory_of_no_elements_has_an_address) {
  void *a = mem_alloc(0, 8), *b = mem_alloc(8, 0);
  ck_assert_ptr_nonnull(a);
  ck_assert_ptr_nonnull(b);
  ck_assert_ptr_ne(a, b);
  mem_free(a);
  mem_free(b);
  mem_free(NULL);
}
END_TEST

START_TEST(memory_resize_keeps_contents_and_alignment) {
  int32_t n = 3;
  int32_t *a = mem_resize(NULL, (size_t)n, sizeof *a);
  for (int32_t i = 0; i < n; i++) a[i] = i;
  for (; n < 200000; n *= 3) {
    a = mem_resize(a, (size_t)n * 3, sizeof *a);
    for (int32_t i = 0; i < n; i++) ck_assert_int_eq(a[i], i);
    for (int32_t i = n; i < 3 * n; i++) a[i] = i;
    if ((size_t)n * 3 * sizeof *a >= MEM_LARGE)
      ck_assert_uint_eq((uintptr_t)a % MEM_ALIGNMENT, 0);
  }
  a = mem_resize(a, 2, sizeof *a);
  ck_assert_int_eq(a[1], 1);
  a = mem_resize(a, 0, sizeof *a);
  ck_assert_ptr_nonnull(a);
  mem_free(a);
}
END_TEST

/* Eight lines of a page at one place are as many as a cache holds. */
START_TEST(memory_starts_on_lines_in_turn) {
  enum { NARRAYS = 32, LINES = 4096 / MEM_ALIGNMENT };
  double *a[NARRAYS];
  int starts[LINES] = {0};
  for (int k = 0; k < NARRAYS; k++) {
    a[k] = MEM_NEW(double, 1 << 18);
    const size_t line = (uintptr_t)a[k] / MEM_ALIGNMENT % LINES;
    ck_assert_int_lt(starts[line]++, 2);
  }
  for (int k = 0; k < NARRAYS; k++) mem_free(a[k]);
}
END_TEST

START_TEST(memory_counts_live_blocks) {
  int64_t before = mem_live_blocks();
  void *a = mem_alloc(10, 1), *b = mem_alloc(100000, 1);
  ck_assert_int_eq(mem_live_blocks() - before, 2);
  b = mem_resize(b, 10, 1);
  ck_assert_int_eq(mem_live_blocks() - before, 2);
  mem_free(a);
  mem_free(b);
  mem_free(NULL);
  ck_assert_int_eq(mem_live_blocks(), before);
}
END_TEST

static void ask_for_too_much(void) { mem_free(mem_alloc(SIZE_MAX / 4, 8)); }

START_TEST(memory_overflow_ends_with_4) {
  char words[TEXT_LENGTH];
  ck_assert_int_eq(run_in_child(ask_for_too_much, words), EXIT_SYSTEM);
  assert_contains(words, "elements of 8 bytes");
}
END_TEST

/* Log */

static char log_path[] = "/tmp/talus-log-XXXXXX";

static void make_log(void) {
  int file = mkstemp(log_path);
  ck_assert_int_ge(file, 0);
  close(file);
  ck_assert(log_open(log_path));
}

static void remove_log(void) {
  log_close();
  unlink(log_path);
}

static void assert_log_is(const char *expected) {
  char words[TEXT_LENGTH] = "";
  FILE *file = fopen(log_path, "r");
  ck_assert_ptr_nonnull(file);
  words[fread(words, 1, sizeof words - 1, file)] = '\0';
  fclose(file);
  ck_assert_str_eq(words, expected);
}

START_TEST(log_flushes_each_line) {
  log_info("step %d", 1);
  assert_log_is("step 1\n");
  log_info("step %d", 2);
  assert_log_is("step 1\nstep 2\n");
}
END_TEST

START_TEST(log_continues_an_existing_file) {
  log_info("first");
  log_close();
  log_info("lost");
  ck_assert(log_open(log_path));
  log_info("second");
  assert_log_is("first\nsecond\n");
}
END_TEST

static void raise_user_error_in_program(void) {
  base_begin(NULL, NULL);
  raise_user_error();
}

START_TEST(log_keeps_last_words) {
  char words[TEXT_LENGTH];
  run_in_child(raise_user_error_in_program, words);
  assert_log_is("error: case.lua:7: unknown key 'levle'\n");
}
END_TEST

START_TEST(log_says_when_it_cannot_be_opened) {
  ck_assert(!log_open("/nonexistent/directory/run.log"));
  ck_assert_int_eq(errno, ENOENT);
}
END_TEST

static TCase *error_case(void) {
  TCase *tcase = tcase_create("error");
  tcase_add_test(tcase, user_error_says_one_line_and_ends_with_2);
  tcase_add_test(tcase, user_error_finalizes_mpi_and_ends_with_2);
  tcase_add_test(tcase, user_error_of_one_rank_ends_with_2);
  tcase_add_test(tcase, fatal_says_where_and_ends_with_4);
  tcase_add_test(tcase, fatal_in_mpi_aborts_with_4);
  tcase_add_test(tcase, check_names_condition_and_place);
  tcase_add_test(tcase, mpi_check_ends_with_the_words_of_mpi);
  tcase_add_test(tcase, warn_once_warns_once);
  tcase_add_test(tcase, assert_ends_debug_builds_and_costs_others_nothing);
  tcase_add_test(tcase, without_mpi_this_is_rank_0_of_1);
  tcase_add_test(tcase, end_reports_leaks_in_debug_builds);
  tcase_add_test(tcase, debug_builds_trap_division_by_zero);
  return tcase;
}

static TCase *memory_case(void) {
  TCase *tcase = tcase_create("memory");
  tcase_add_test(tcase, memory_is_zeroed_and_aligned);
  tcase_add_test(tcase, memory_of_no_elements_has_an_address);
  tcase_add_test(tcase, memory_resize_keeps_contents_and_alignment);
  tcase_add_test(tcase, memory_starts_on_lines_in_turn);
  tcase_add_test(tcase, memory_counts_live_blocks);
  tcase_add_test(tcase, memory_overflow_ends_with_4);
  return tcase;
}

static TCase *log_case(void) {
  TCase *tcase = tcase_create("log");
  tcase_add_checked_fixture(tcase, make_log, remove_log);
  tcase_add_test(tcase, log_flushes_each_line);
  tcase_add_test(tcase, log_continues_an_existing_file);
  tcase_add_test(tcase, log_keeps_last_words);
  tcase_add_test(tcase, log_says_when_it_cannot_be_opened);
  return tcase;
}

Suite *base_suite(void) {
  Suite *suite = suite_create("base");
  suite_add_tcase(suite, error_case());
  suite_add_tcase(suite, memory_case());
  suite_add_tcase(suite, log_case());
  return suite;
}
