/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Runs the suites of tests/mesh on all ranks at once. The list of suites is
 * made by the Makefile from the names of the files.
 *
 * Ranks wait for each other at every fill, most of all in long runs, which say
 * no more of ranks than a few steps do: test cases that have the tag "one_rank"
 * are left out on more ranks.
 *
 * Tests run in this process, as MPI does not survive a fork, and a failed
 * assertion jumps out of a test: reduce the verdict over ranks before any
 * ck_assert, or the others wait for ever in their next collective call. */
#include <check.h>
#include <mpi.h>
#include <stdio.h>
#include <stdlib.h>

#include "talus/error.h"
#include "talus/program.h"

#define SUITE(name) Suite *name##_suite(void);
#include "mesh_suites.inc"
#undef SUITE

int main(int argc, char **argv) {
  base_begin(&argc, &argv);
  SRunner *runner = srunner_create(NULL);
#define SUITE(name) srunner_add_suite(runner, name##_suite());
#include "mesh_suites.inc"
#undef SUITE
  srunner_set_fork_status(runner, CK_NOFORK);
  srunner_run_tagged(runner, NULL, NULL, NULL,
                     base_size() > 1 ? "one_rank" : NULL,
                     base_rank() == 0 ? CK_NORMAL : CK_SILENT);
  int failed = srunner_ntests_failed(runner), most = 0;
  MPI_CHECK(MPI_Allreduce(&failed, &most, 1, MPI_INT, MPI_MAX, MPI_COMM_WORLD));
  if (failed == 0 && most > 0 && base_rank() == 0)
    printf("%d tests failed, but not on rank 0: reduce their verdict\n", most);
  srunner_free(runner);
  base_end();
  return most == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}
