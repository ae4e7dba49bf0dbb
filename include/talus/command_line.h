/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The command line of talus2d and talus3d. Each command gets the words that
 * follow it and returns an exit status (error.h). */
#ifndef TALUS_COMMAND_LINE_H
#define TALUS_COMMAND_LINE_H

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

enum { COMMAND_LINE_MAX_OVERRIDES = 64 };

/* Holds the words behind `run` or `check`. Texts are borrowed from argv. */
struct command_line {
  const char *case_path; /* NULL: none given */
  int noverrides;
  char *overrides[COMMAND_LINE_MAX_OVERRIDES];
  const char *directory; /* NULL: not given */
  bool restart, quiet, timing;
  int64_t max_steps;   /* -1: no bound */
  double max_walltime; /* s, 0: no bound */
};

/* Read the words behind a command: the first that is no option is the case,
 * with or without `=` in it, the others are overrides. Collective; whatever is
 * wrong is a USER_ERROR. `running` allows the options of `run`. */
void command_line_read(int argc, char *argv[], bool running,
                       struct command_line *line);

/* End the program (USER_ERROR) if two of the words name=value give one name
 * different values. */
void command_line_refuse_twice(int n, char *const words[]);

/* Find the case file among the words behind `run` or `check`, and the
 * overrides, as command_line_read would find them; never fails. */
void command_line_find_case(int argc, char *argv[], struct command_line *line);

/* Find the directory of the running program, into `directory` [size]; returns
 * false if it is unknown. */
bool command_own_directory(char *directory, int size);

int command_info(int argc, char *argv[]);
int command_plot(int argc, char *argv[]);
int command_rheology(int argc, char *argv[]);
/* Take the words behind `rheology two_fluid`. */
int command_two_fluid(int argc, char *argv[]);
int command_help(int argc, char *argv[]);

/* Print the commands, one a line. */
void command_usage(FILE *f);
/* Tell whether one of the words behind a command is --help or -h. */
bool command_asks_help(int argc, char *argv[]);

#endif
