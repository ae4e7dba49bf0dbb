/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Rows of csv text, as RFC 4180 has them: cells are separated by commas; a cell
 * with a comma, a quote or an end of line in it stands in quotes, and a quote
 * in it is doubled. The one place that knows how a text becomes a cell and
 * back.
 */
#ifndef TALUS_CSV_ROW_H
#define TALUS_CSV_ROW_H

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

/* A row taken apart; {0} before the first, freed by csv_row_free. */
struct csv_row {
  int n;     /* cells */
  bool ends; /* with an end of line: it was not cut short */
  char *text;
  size_t length, room;
  size_t *begin; /* [n], of each cell in text */
  int most;
};

/*
 * Reads the next row. Not collective.
 *   f    open to read; fmemopen makes one of a text
 *   row  in/out: replaced
 * returns  false at the end of the file
 */
bool csv_row_read(FILE *f, struct csv_row *row);

/* Returns the text of cell k, without its quotes; "" if the row has no cell k.
 * It lasts until the next csv_row_read. */
const char *csv_row_cell(const struct csv_row *row, int k);

/* Frees what csv_row_read has allocated. */
void csv_row_free(struct csv_row *row);

/* Writes a text as one cell, in quotes where it needs them. */
void csv_row_write_cell(FILE *f, const char *text);

#endif
