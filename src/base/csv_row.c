/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/csv_row.h"

#include <stdlib.h>
#include <string.h>

#include "talus/memory.h"

static void add_character(struct csv_text *text, char c) {
  if (text->n == text->room) {
    text->room = 2 * text->room + 256;
    text->v = mem_resize(text->v, text->room, 1);
  }
  text->v[text->n++] = c;
}

static void clear(struct csv_row *row) {
  row->n = 0;
  row->ends = false;
  row->line.n = row->cells.n = 0;
}

static void begin_cell(struct csv_row *row) {
  if (row->n == row->room) {
    row->room = 2 * row->room + 32;
    row->begin = mem_resize(row->begin, (size_t)row->room, sizeof *row->begin);
  }
  row->begin[row->n++] = row->cells.n;
}

/* Take the next character of the line from the file. */
static int take(FILE *f, struct csv_row *row) {
  const int c = getc(f);
  if (c != EOF) add_character(&row->line, (char)c);
  return c;
}

/* Read one cell; returns the character that ends it: ',', '\n' or EOF. */
static int read_cell(FILE *f, struct csv_row *row) {
  bool quoted = false;
  begin_cell(row);
  for (int c; (c = take(f, row)) != EOF;) {
    if (c == '"' && quoted) {
      c = take(f, row);
      if (c != '"') {
        quoted = false;
        if (c == EOF) break;
      }
    } else if (c == '"' && row->cells.n == row->begin[row->n - 1]) {
      quoted = true;
      continue;
    }
    if (!quoted && (c == ',' || c == '\n')) {
      add_character(&row->cells, '\0');
      return c;
    }
    if (quoted || c != '\r') add_character(&row->cells, (char)c);
  }
  add_character(&row->cells, '\0');
  return EOF;
}

bool csv_row_read(FILE *f, struct csv_row *row) {
  int end;
  clear(row);
  while ((end = read_cell(f, row)) == ',') continue;
  row->ends = end == '\n';
  const bool found = row->line.n > 0;
  if (!found) clear(row);
  return found;
}

const char *csv_row_cell(const struct csv_row *row, int k) {
  return k < row->n ? row->cells.v + row->begin[k] : "";
}

bool csv_row_number(const struct csv_row *row, int k, double *value) {
  char *end;
  const char *text = csv_row_cell(row, k);
  const double number = strtod(text, &end);
  if (end == text || *end != '\0') return false;
  *value = number;
  return true;
}

void csv_row_add(struct csv_row *row, const char *text) {
  const bool quoted = strpbrk(text, ",\"\r\n") != NULL;
  if (row->ends) clear(row);
  if (row->n++ > 0) add_character(&row->line, ',');
  if (quoted) add_character(&row->line, '"');
  for (; *text != '\0'; text++) {
    if (*text == '"') add_character(&row->line, '"');
    add_character(&row->line, *text);
  }
  if (quoted) add_character(&row->line, '"');
}

void csv_row_write(struct csv_row *row, FILE *f) {
  add_character(&row->line, '\n');
  row->ends = true;
  fwrite(row->line.v, 1, row->line.n, f);
}

void csv_row_free(struct csv_row *row) {
  mem_free(row->line.v);
  mem_free(row->cells.v);
  mem_free(row->begin);
  *row = (struct csv_row){0};
}
