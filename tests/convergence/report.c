/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "report.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "talus/csv_row.h"
#include "talus/memory.h"

struct report {
  const char *name;
  FILE *csv;
  struct csv_row row;
  int failed;
};

/* Add a row; order: NAN if there is none; bar: text, "" if there is none. */
static void add_row(struct report *report, const char *grid, const char *norm,
                    int level, double value, double order, const char *bar,
                    bool good) {
  const char *verdict = good && isfinite(value) ? "pass" : "fail";
  char numbers[3][32] = {"", "", ""};
  snprintf(numbers[0], sizeof numbers[0], "%d", level);
  snprintf(numbers[1], sizeof numbers[1], "%.6g", value);
  if (!isnan(order)) snprintf(numbers[2], sizeof numbers[2], "%.2f", order);
  const char *const cells[] = {report->name, grid,       norm, numbers[0],
                               numbers[1],   numbers[2], bar,  verdict};
  for (int k = 0; k < 8; k++) csv_row_add(&report->row, cells[k]);
  csv_row_write(&report->row, report->csv);
  fflush(report->csv);
  report->failed += verdict[0] == 'f';
}

struct report *report_new(const char *name, FILE *csv) {
  struct report *report = MEM_NEW(struct report, 1);
  report->name = name;
  report->csv = csv;
  fprintf(csv, "case,grid,norm,level,value,order,bar,verdict\n");
  return report;
}

int report_end(struct report *report) {
  const int failed = report->failed;
  csv_row_free(&report->row);
  mem_free(report);
  return failed;
}

void report_value(struct report *report, const char *grid, const char *norm,
                  int level, double value) {
  add_row(report, grid, norm, level, value, NAN, "", true);
}

void report_at_most(struct report *report, const char *grid, const char *norm,
                    int level, double value, double bar) {
  char text[64];
  snprintf(text, sizeof text, "<= %g", bar);
  add_row(report, grid, norm, level, value, NAN, text, value <= bar);
}

void report_at_least(struct report *report, const char *grid, const char *norm,
                     int level, double value, double bar) {
  char text[64];
  snprintf(text, sizeof text, ">= %g", bar);
  add_row(report, grid, norm, level, value, NAN, text, value >= bar);
}

void report_errors(struct report *report, const char *grid, const char *norm,
                   int first, int n, const double error[], const double bars[],
                   double order) {
  for (int k = 0; k < n; k++) {
    const double seen = k > 0 ? log2(error[k - 1] / error[k]) : NAN;
    const bool last = k == n - 1 && order > 0;
    char text[2][64] = {"", ""};
    bool good = true;
    if (bars) {
      snprintf(text[0], sizeof text[0], "<= %g%s", bars[k], last ? "; " : "");
      good = error[k] <= bars[k];
    }
    if (last) {
      snprintf(text[1], sizeof text[1], "order >= %g", order);
      good = good && seen >= order;
    }
    char bar[128];
    snprintf(bar, sizeof bar, "%s%s", text[0], text[1]);
    add_row(report, grid, norm, first + k, error[k], seen, bar, good);
  }
}

void report_counts(struct report *report, const char *grid, const char *norm,
                   int first, int n, const int count[], int most, int spread) {
  int low = count[0], high = count[0];
  for (int k = 1; k < n; k++) {
    low = count[k] < low ? count[k] : low;
    high = count[k] > high ? count[k] : high;
  }
  for (int k = 0; k < n; k++) {
    const bool last = k == n - 1 && spread > 0;
    char text[2][64] = {"", ""};
    if (most > 0) {
      snprintf(text[0], sizeof text[0], "<= %d%s", most, last ? "; " : "");
    }
    if (last) snprintf(text[1], sizeof text[1], "flat +-%d", spread);
    char bar[128];
    snprintf(bar, sizeof bar, "%s%s", text[0], text[1]);
    add_row(
        report, grid, norm, first + k, count[k], NAN, bar,
        (most == 0 || count[k] <= most) && (!last || high - low <= 2 * spread));
  }
}
