/* SPDX-License-Identifier: GPL-3.0-or-later */
/* csv files that grow with the run: a header line, then rows.
 *
 * Rank 0 writes; on the other ranks the functions do nothing. Every row is on
 * its way to the disk when it is complete. */
#ifndef TALUS_CSV_H
#define TALUS_CSV_H

#include <stdbool.h>
#include <stdint.h>

struct csv;

/* Open directory/name. Afresh, or (`keep`) after the rows that are there, of
 * which only those are kept whose first column is at most `last`: a run that
 * goes on from a checkpoint repeats what came after it. The file is replaced
 * as a whole, and only if its header is the one we would write; else
 * USER_ERROR. Collective. */
struct csv *csv_open(const char *directory, const char *name,
                     const char *header, bool keep, double last);
void csv_close(struct csv *csv);

/* Cells of a row: numbers as they read back exactly (csv_real), to 12 digits
 * (csv_short) or whole; then the end of the row. Not collective. */
void csv_real(struct csv *csv, double value);
void csv_short(struct csv *csv, double value);
void csv_integer(struct csv *csv, int64_t value);
void csv_end_row(struct csv *csv);

#endif
