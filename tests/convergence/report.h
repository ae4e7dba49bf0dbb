/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Report: what a convergence case measured, row by row, against its bars.
 *
 * A case is a file test_NAME.c with one `const struct convergence_case
 * NAME_case`; the Makefile finds it. Its rows become the columns
 * case,grid,norm,level,value,order,bar,verdict of report.csv: `grid` says
 * which variant ("uniform", "adapted", "slope 0.43"), `norm` what is measured
 * ("L2 of u", "iterations"), `level` is log2 of the cells along an edge of
 * the box, or along the length the case names. A row without a bar passes;
 * a value that is not a number fails.
 */
#ifndef TALUS_TESTS_REPORT_H
#define TALUS_TESTS_REPORT_H

#include <stdbool.h>
#include <stdio.h>

struct report;

struct convergence_case {
  const char *name;  /* of the file test_NAME.c */
  const char *title; /* one line: what it shows */
  int dimension;     /* 2 or 3: the program that runs it */
  bool in_short;     /* part of the short set, which CI runs */
  void (*run)(struct report *report);
};

/* Begin the rows of a case, written to `csv` and to the terminal as they come.
 */
struct report *report_new(const char *name, FILE *csv);
/* End the report; returns the number of rows that failed. */
int report_end(struct report *report);

/* Report one value: as it is, or with the bar that it must not pass. */
void report_value(struct report *report, const char *grid, const char *norm,
                  int level, double value);
void report_at_most(struct report *report, const char *grid, const char *norm,
                    int level, double value, double bar);
void report_at_least(struct report *report, const char *grid, const char *norm,
                     int level, double value, double bar);

/* Report errors on n levels from `first` on, each half the cell of the one
 * before, with the orders log2(error[k-1]/error[k]). bars [n]: what each error
 * must not pass, NULL: nothing; order: what the last one must reach, 0:
 * nothing. */
void report_errors(struct report *report, const char *grid, const char *norm,
                   int first, int n, const double error[], const double bars[],
                   double order);
/* Report counts (of iterations) on n levels: each at most `most`, and all
 * within `spread` of the middle of their range; 0: no such bar. */
void report_counts(struct report *report, const char *grid, const char *norm,
                   int first, int n, const int count[], int most, int spread);

#endif
