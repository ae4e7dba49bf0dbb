/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/capacity.h"

#include <check.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

Suite *capacity_suite(void);

static char root[64];

static void path_in_root(const char *name, char path[256]) {
  snprintf(path, 256, "%s/%s", root, name);
}

static void write_file(const char *name, const char *text) {
  char path[256];
  path_in_root(name, path);
  FILE *f = fopen(path, "w");
  ck_assert_ptr_nonnull(f);
  fputs(text, f);
  fclose(f);
}

/* A tree of groups as the system shows it: a/b of version 2, memory/job of
 * version 1. */
static const char *const FOLDERS[] = {"a", "a/b", "memory", "memory/job"};

static void make_groups(void) {
  char path[256];
  snprintf(root, sizeof root, "/tmp/talus-groups-XXXXXX");
  ck_assert_ptr_nonnull(mkdtemp(root));
  for (int k = 0; k < 4; k++) {
    path_in_root(FOLDERS[k], path);
    ck_assert_int_eq(mkdir(path, 0700), 0);
  }
  write_file("a/memory.max", "3000000000\n");
  write_file("a/b/memory.max", "max\n");
  write_file("memory/memory.limit_in_bytes", "9223372036854771712\n");
  write_file("memory/job/memory.limit_in_bytes", "2000000000\n");
}

static void remove_groups(void) {
  static const char *const files[] = {"list", "a/memory.max", "a/b/memory.max",
                                      "memory/memory.limit_in_bytes",
                                      "memory/job/memory.limit_in_bytes"};
  char path[256];
  for (int k = 0; k < 5; k++) {
    path_in_root(files[k], path);
    unlink(path);
  }
  for (int k = 3; k >= 0; k--) {
    path_in_root(FOLDERS[k], path);
    rmdir(path);
  }
  rmdir(root);
}

static double limit_of(const char *list) {
  char path[256];
  write_file("list", list);
  path_in_root("list", path);
  return capacity_of_groups(path, root);
}

START_TEST(the_tightest_group_counts) {
  ck_assert_double_eq(limit_of("0::/a/b\n"), 3e9);
  ck_assert_double_eq(limit_of("4:cpu,memory:/job\n3:cpu:/a\n"), 2e9);
  ck_assert_double_eq(limit_of("4:memory:/job/x\n0::/a\n"), 2e9);
  ck_assert(isinf(limit_of("4:memory:/\n")));
  ck_assert(isinf(limit_of("0::/elsewhere\nnonsense\n")));
  ck_assert(isinf(capacity_of_groups("/nonexistent", root)));
}
END_TEST

/* Return the bytes of address space in use. */
static double space_used(void) {
  double pages = 0;
  FILE *f = fopen("/proc/self/statm", "r");
  ck_assert_ptr_nonnull(f);
  ck_assert_int_eq(fscanf(f, "%lf", &pages), 1);
  fclose(f);
  return pages * (double)sysconf(_SC_PAGESIZE);
}

START_TEST(the_address_space_counts) {
  const double before = capacity_per_rank();
  struct rlimit limit, narrow;
  ck_assert(isfinite(before) && before > 1e8);
  ck_assert_int_eq(getrlimit(RLIMIT_AS, &limit), 0);
  narrow = limit;
  narrow.rlim_cur = (rlim_t)(space_used() + 3e8);
  ck_assert_int_eq(setrlimit(RLIMIT_AS, &narrow), 0);
  const double after = capacity_per_rank();
  ck_assert_int_eq(setrlimit(RLIMIT_AS, &limit), 0);
  ck_assert(after < before && after > 2e8 && after < 3.1e8);
}
END_TEST

Suite *capacity_suite(void) {
  Suite *suite = suite_create("capacity");
  TCase *tcase = tcase_create("limits");
  tcase_add_checked_fixture(tcase, make_groups, remove_groups);
  tcase_add_test(tcase, the_tightest_group_counts);
  tcase_add_test(tcase, the_address_space_counts);
  suite_add_tcase(suite, tcase);
  return suite;
}
