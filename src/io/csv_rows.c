/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "csv_rows.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <zlib.h>

#include "talus/memory.h"

/* A line of any length, with its end; {0} before the first. */
struct line {
  char *text;
  size_t length, room;
};

/* Reads the next line; false at the end of the file, and for a last line that
 * was cut short. */
static bool read_line(FILE *f, struct line *line) {
  line->length = 0;
  for (int c; (c = getc(f)) != EOF;) {
    if (line->length + 2 > line->room) {
      line->room = 2 * line->room + 256;
      line->text = mem_resize(line->text, line->room, 1);
    }
    line->text[line->length++] = (char)c;
    line->text[line->length] = '\0';
    if (c == '\n') return true;
  }
  return false;
}

bool csv_rows_read_header(FILE *f, const char *header) {
  struct line line = {0};
  const size_t n = strlen(header);
  const bool same = read_line(f, &line) && line.length == n + 1 &&
                    memcmp(line.text, header, n) == 0;
  mem_free(line.text);
  return same;
}

void csv_rows_add(struct csv_mark *mark, const char *row, size_t length) {
  mark->rows++;
  mark->checksum =
      (int64_t)crc32((uLong)mark->checksum, (const Bytef *)row, (uInt)length);
}

bool csv_rows_copy(FILE *old, FILE *new, const struct csv_mark *mark) {
  struct line line = {0};
  struct csv_mark found = {0, 0};
  while (found.rows < mark->rows && read_line(old, &line)) {
    csv_rows_add(&found, line.text, line.length);
    if (new != NULL) fwrite(line.text, 1, line.length, new);
  }
  mem_free(line.text);
  return found.rows == mark->rows && found.checksum == mark->checksum;
}

static int count_cells(const char *text) {
  int n = 1;
  for (; *text != '\0'; text++) n += *text == ',';
  return n;
}

/* Reads the first column of a row that is whole: as many cells as the header,
 * no characters but text. */
static bool read_first(const struct line *line, int ncells, double *value) {
  char *end;
  if (strlen(line->text) != line->length || count_cells(line->text) != ncells)
    return false;
  *value = strtod(line->text, &end);
  return end != line->text && *end == ',';
}

/* Steps without a row, as they are found from the first row to the last. */
struct gaps {
  int64_t every, next; /* the step that should come next */
  int64_t missing;     /* rows so far */
  int n;               /* gaps so far */
  char text[256];      /* the first of them, "13 to 97, 105" */
};

/* Adds up to a row of this step. */
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
  struct line line = {0};
  struct gaps gaps = {.every = expected->every};
  const int ncells = count_cells(expected->header);
  const int64_t written = expected->mark.rows;
  int64_t found = 0;
  double value, previous = -INFINITY;
  while (read_line(f, &line)) {
    if (!read_first(&line, ncells, &value) || value > expected->last) continue;
    if (expected->every > 0 && value <= previous) continue;
    previous = value;
    found++;
    if (gaps.every > 0) pass(&gaps, (int64_t)value);
  }
  mem_free(line.text);
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
