/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/series.h"

#include <string.h>

#include "talus/csv.h"
#include "talus/memory.h"

struct series {
  struct csv *csv;
  int ncolumns;
  const struct column *columns;
};

static const char name[] = "series.csv";

/* Join the names of the columns by commas; the caller frees the text. */
static char *header(int ncolumns, const struct column *columns) {
  size_t length = 1;
  for (int k = 0; k < ncolumns; k++) length += strlen(columns[k].name) + 1;
  char *text = MEM_NEW(char, length);
  for (int k = 0; k < ncolumns; k++) {
    if (k > 0) strcat(text, ",");
    strcat(text, columns[k].name);
  }
  return text;
}

void series_check(const char *directory, int ncolumns,
                  const struct column *columns, const struct csv_mark *mark,
                  int64_t last_step, int every) {
  char *names = header(ncolumns, columns);
  const struct csv_expected expected = {.name = name,
                                        .header = names,
                                        .mark = *mark,
                                        .last = (double)last_step,
                                        .every = every > 1 ? every : 1};
  csv_check(directory, &expected);
  mem_free(names);
}

struct series *series_open(const char *directory, int ncolumns,
                           const struct column *columns,
                           const struct csv_mark *kept) {
  struct series *series = MEM_NEW(struct series, 1);
  char *names = header(ncolumns, columns);
  series->csv = csv_open(directory, name, names, kept);
  series->ncolumns = ncolumns;
  series->columns = columns;
  mem_free(names);
  return series;
}

struct csv_mark series_sync(struct series *series) {
  return csv_sync(series->csv);
}

void series_write(struct series *series, const double value[]) {
  struct csv *csv = series->csv;
  for (int k = 0; k < series->ncolumns; k++) {
    switch (series->columns[k].format) {
      case COLUMN_INTEGER:
        csv_integer(csv, (int64_t)value[k]);
        break;
      case COLUMN_REAL:
        csv_real(csv, value[k]);
        break;
      case COLUMN_SHORT:
        csv_short(csv, value[k]);
        break;
    }
  }
  csv_end_row(csv);
}

void series_close(struct series *series) {
  csv_close(series->csv);
  mem_free(series);
}
