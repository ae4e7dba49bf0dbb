/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "csv_rows.h"

#include <inttypes.h>
#include <math.h>
#include <string.h>
#include <zlib.h>

/* Read the next row; false at the end of the file, and for a last row that was
 * cut short. */
static bool read_row(FILE *f, struct csv_row *row) {
  return csv_row_read(f, row) && row->ends;
}

bool csv_rows_read_header(FILE *f, const char *header) {
  struct csv_row row = {0};
  const size_t n = strlen(header);
  const bool same = read_row(f, &row) && row.line.n == n + 1 &&
                    memcmp(row.line.v, header, n) == 0;
  csv_row_free(&row);
  return same;
}

void csv_rows_add(struct csv_mark *mark, const struct csv_row *row) {
  mark->rows++;
  mark->checksum = (int64_t)crc32(
      (uLong)mark->checksum, (const Bytef *)row->line.v, (uInt)row->line.n);
}

bool csv_rows_copy(FILE *old, FILE *new, const struct csv_mark *mark) {
  struct csv_row row = {0};
  struct csv_mark found = {0, 0};
  while (found.rows < mark->rows && read_row(old, &row)) {
    csv_rows_add(&found, &row);
    if (new != NULL) fwrite(row.line.v, 1, row.line.n, new);
  }
  csv_row_free(&row);
  return found.rows == mark->rows && found.checksum == mark->checksum;
}

static int count_cells(const char *header) {
  int n = 1;
  for (; *header != '\0'; header++) n += *header == ',';
  return n;
}

/* Read the first column of a row that is whole: as many cells as the header, no
 * characters but text. */
static bool read_first(const struct csv_row *row, int ncells, double *value) {
  return row->n == ncells && memchr(row->line.v, '\0', row->line.n) == NULL &&
         csv_row_number(row, 0, value);
}

/* Steps without a row, as they are found from the first row to the last. */
struct gaps {
  int64_t every, next; /* the step that should come next */
  int64_t missing;     /* rows so far */
  int n;               /* gaps so far */
  char text[256];      /* the first of them, "13 to 97, 105" */
};

/* Add up to a row of this step. */
static void pass(struct gaps *gaps, int64_t step) {
  const int64_t last = (step - 1) / gaps->every * gaps->every;
  if (step > gaps->next) {
    const size_t used = strlen(gaps->text);
    char *to = gaps->text + used;
    const size_t room = sizeof gaps->text - used;
    const char *comma = gaps->n > 0 ? ", " : "";
    if (gaps->n == 4)
      snprintf(to, room, ", ...");
    else if (gaps->n < 4 && last > gaps->next)
      snprintf(to, room, "%s%" PRId64 " to %" PRId64, comma, gaps->next, last);
    else if (gaps->n < 4)
      snprintf(to, room, "%s%" PRId64, comma, last);
    gaps->n++;
    gaps->missing += (last - gaps->next) / gaps->every + 1;
  }
  gaps->next = (step / gaps->every + 1) * gaps->every;
}

void csv_rows_describe(FILE *f, const struct csv_expected *expected,
                       size_t size, char *text) {
  struct csv_row row = {0};
  struct gaps gaps = {.every = expected->every};
  const int ncells = count_cells(expected->header);
  const int64_t written = expected->mark.rows;
  int64_t found = 0;
  double value, previous = -INFINITY;
  while (read_row(f, &row)) {
    if (!read_first(&row, ncells, &value) || value > expected->last) continue;
    if (expected->every > 0 && value <= previous) continue;
    previous = value;
    found++;
    if (gaps.every > 0) pass(&gaps, (int64_t)value);
  }
  csv_row_free(&row);
  if (gaps.every > 0)
    pass(&gaps, (int64_t)expected->last / gaps.every * gaps.every + gaps.every);
  char end[64];
  snprintf(end, sizeof end, "%s %.10g", expected->every > 0 ? "step" : "time",
           expected->last);
  if (found >= written)
    snprintf(text, size, "its %" PRId64 " rows up to %s are not as written",
             written, end);
  else if (gaps.every > 0 && gaps.missing == written - found)
    snprintf(text, size,
             "it lacks %" PRId64 " of the %" PRId64 " rows up to %s: step%s %s",
             written - found, written, end, gaps.missing == 1 ? "" : "s",
             gaps.text);
  else
    snprintf(text, size,
             "it lacks %" PRId64 " of the %" PRId64 " rows up to %s",
             written - found, written, end);
}
