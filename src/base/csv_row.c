/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/csv_row.h"

#include <string.h>

#include "talus/memory.h"

static void add_character(struct csv_row *row, char c) {
  if (row->length == row->room) {
    row->room = 2 * row->room + 256;
    row->text = mem_resize(row->text, row->room, 1);
  }
  row->text[row->length++] = c;
}

static void begin_cell(struct csv_row *row) {
  if (row->n == row->most) {
    row->most = 2 * row->most + 32;
    row->begin = mem_resize(row->begin, (size_t)row->most, sizeof *row->begin);
  }
  row->begin[row->n++] = row->length;
}

/* Reads one cell; returns the character that ends it: ',', '\n' or EOF. */
static int read_cell(FILE *f, struct csv_row *row) {
  bool quoted = false;
  begin_cell(row);
  for (int c; (c = getc(f)) != EOF;) {
    if (c == '"' && quoted) {
      c = getc(f);
      if (c != '"') {
        quoted = false;
        if (c == EOF) break;
      }
    } else if (c == '"' && row->length == row->begin[row->n - 1]) {
      quoted = true;
      continue;
    }
    if (!quoted && (c == ',' || c == '\n')) {
      add_character(row, '\0');
      return c;
    }
    if (quoted || c != '\r') add_character(row, (char)c);
  }
  add_character(row, '\0');
  return EOF;
}

bool csv_row_read(FILE *f, struct csv_row *row) {
  int end;
  row->n = 0;
  row->length = 0;
  while ((end = read_cell(f, row)) == ',') continue;
  row->ends = end == '\n';
  return row->ends || row->n > 1 || row->text[0] != '\0';
}

const char *csv_row_cell(const struct csv_row *row, int k) {
  return k < row->n ? row->text + row->begin[k] : "";
}

void csv_row_free(struct csv_row *row) {
  mem_free(row->text);
  mem_free(row->begin);
  *row = (struct csv_row){0};
}

void csv_row_write_cell(FILE *f, const char *text) {
  if (strpbrk(text, ",\"\r\n") == NULL) {
    fputs(text, f);
    return;
  }
  putc('"', f);
  for (; *text != '\0'; text++) {
    if (*text == '"') putc('"', f);
    putc(*text, f);
  }
  putc('"', f);
}
