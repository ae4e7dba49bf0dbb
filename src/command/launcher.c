/* SPDX-License-Identifier: GPL-3.0-or-later */
/* talus: starts talus2d or talus3d, whichever the case asks for.
 *
 * Under mpirun every rank does so by itself, and MPI begins in the program
 * that follows. What is wrong with a case or a command line is for that program
 * to say, once. */
#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "talus/case.h"
#include "talus/command_line.h"
#include "talus/error.h"
#include "talus/program.h"
#include "talus/signals.h"

static int dimension_of(int argc, char *argv[]) {
  if (argc < 2) return 2;
  if (strcmp(argv[1], "run") != 0 && strcmp(argv[1], "check") != 0) return 2;
  struct command_line line;
  command_line_find_case(argc - 2, argv + 2, &line);
  if (line.case_path == NULL) return 2;
  return case_dimension(line.case_path, line.noverrides, line.overrides);
}

int main(int argc, char *argv[]) {
  enum { LENGTH = 4096 };
  char directory[LENGTH], program[LENGTH + 16];
  if (argc > 1 && strcmp(argv[1], "run") == 0) signals_catch();
  const char *name = dimension_of(argc, argv) == 3 ? "talus3d" : "talus2d";
  if (command_own_directory(directory, LENGTH)) {
    snprintf(program, sizeof program, "%s/%s", directory, name);
    execv(program, argv);
  } else {
    snprintf(program, sizeof program, "%s", name);
    execvp(program, argv);
  }
  const int error = errno;
  if (base_take_rank() == 0)
    fprintf(stderr,
            "talus: error: cannot start %s: %s; type `make` to build it\n",
            program, strerror(error));
  return EXIT_SYSTEM;
}
