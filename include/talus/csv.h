/* SPDX-License-Identifier: GPL-3.0-or-later */
/* csv files that grow with the run: a header line, then rows.
 *
 * Rank 0 writes; on the other ranks the functions do nothing. A complete row is
 * on the way to the disk.
 *
 * A checkpoint keeps how far each file had come (struct csv_mark), so that a
 * restart can tell whether all earlier rows are there, to the last character;
 * later rows are repeated. */
#ifndef TALUS_CSV_H
#define TALUS_CSV_H

#include <stdbool.h>
#include <stdint.h>

struct csv;

/* How far a file has come. */
struct csv_mark {
  int64_t rows;     /* after the header */
  int64_t checksum; /* crc32 of these rows, ends of lines and all */
};

/* Contents that csv_check asks of a file. */
struct csv_expected {
  const char *name, *header;
  struct csv_mark mark;
  double last;   /* first column of the last row at most */
  int64_t every; /* the first column is a step, a multiple of this but in the
                    last row; 0: it is something else */
};

/* End the program (USER_ERROR, which says what is missing) unless
 * directory/name has the header and begins with the rows of the mark. Changes
 * nothing. Collective. */
void csv_check(const char *directory, const struct csv_expected *expected);

/* Open directory/name: afresh, or (`kept` != NULL) after the rows of that mark,
 * which csv_check has found; rows after them are dropped. The file is replaced
 * as a whole. Collective; USER_ERROR if it is not to be had. */
struct csv *csv_open(const char *directory, const char *name,
                     const char *header, const struct csv_mark *kept);
/* Bring all rows to the disk; returns how far the file has come, on all ranks.
 * Collective. */
struct csv_mark csv_sync(struct csv *csv);
void csv_close(struct csv *csv);

/* Write a cell of a row, numbers as they read back exactly (csv_real), to 12
 * digits (csv_short) or whole; then the end of the row. Not collective. */
void csv_real(struct csv *csv, double value);
void csv_short(struct csv *csv, double value);
void csv_integer(struct csv *csv, int64_t value);
void csv_end_row(struct csv *csv);

#endif
