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

/* A text that grows. */
struct csv_text {
  char *v;
  size_t n, room;
};

/* A row that has been read, or is being written; {0} before the first, freed by
 * csv_row_free. */
struct csv_row {
  int n;                /* cells */
  bool ends;            /* with an end of line: it was not cut short */
  struct csv_text line; /* as it stands in the file, end of line and all */
  struct csv_text cells;
  size_t *begin; /* [n], of each cell in `cells` */
  int room;
};

/*
 * Read the next row. Not collective.
 *   f    open to read; fmemopen makes one of a text
 *   row  in/out: replaced
 * returns  false at the end of the file, where the row is empty
 */
bool csv_row_read(FILE *f, struct csv_row *row);

/* Returns the text of cell k, without its quotes; "" if the row has no cell k.
 * It lasts until the next csv_row_read. */
const char *csv_row_cell(const struct csv_row *row, int k);

/* Read cell k as a number, all characters of the cell; returns false, *value as
 * it was, if the cell is no number. */
bool csv_row_number(const struct csv_row *row, int k, double *value);

/* Add a cell to the row that is being written; the first one after the end of a
 * row begins the next. */
void csv_row_add(struct csv_row *row, const char *text);

/* End the row, whose `line` lasts until the next csv_row_add, and write it.
 * Not collective. */
void csv_row_write(struct csv_row *row, FILE *f);

/* Free what the functions above have allocated. */
void csv_row_free(struct csv_row *row);

#endif
