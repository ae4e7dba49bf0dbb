/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Runs one convergence case of this dimension, or names them.
 *
 *   convergence list [short]      a name per line
 *   convergence NAME FILE.csv     measures, writes the rows of report.h;
 *                                 status 1 if a bar is missed
 *
 * One rank. The list of cases is made by the Makefile from the files. */
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "report.h"
#include "talus/error.h"
#include "talus/program.h"

#define SUITE(name) extern const struct convergence_case name##_case;
#include "convergence_suites.inc"
#undef SUITE

static const struct convergence_case *const CASES[] = {
#define SUITE(name) &name##_case,
#include "convergence_suites.inc"
#undef SUITE
};
enum { NCASES = sizeof CASES / sizeof *CASES };

static void list_cases(bool only_short) {
  for (int k = 0; k < NCASES; k++) {
    if (CASES[k]->dimension != DIM) continue;
    if (!only_short || CASES[k]->in_short) printf("%s\n", CASES[k]->name);
  }
}

static int run_one(const struct convergence_case *item, const char *path) {
  FILE *csv = fopen(path, "w");
  if (!csv) USER_ERROR("cannot write %s", path);
  struct report *report = report_new(item->name, csv);
  item->run(report);
  const int failed = report_end(report);
  if (fclose(csv) != 0) FATAL("cannot write %s", path);
  return failed > 0;
}

int main(int argc, char **argv) {
  int status = EXIT_USER;
  base_begin(&argc, &argv);
  CHECK(base_size() == 1, "convergence cases run on one rank");
  if (argc >= 2 && strcmp(argv[1], "list") == 0) {
    list_cases(argc == 3 && strcmp(argv[2], "short") == 0);
    status = EXIT_DONE;
  }
  for (int k = 0; k < NCASES && argc == 3; k++) {
    if (CASES[k]->dimension == DIM && strcmp(argv[1], CASES[k]->name) == 0) {
      status = run_one(CASES[k], argv[2]);
    }
  }
  base_end();
  return status;
}
