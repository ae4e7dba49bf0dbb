/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Rows of csv files of a run that goes on: are they all there, and which are
 * not? Nothing here is collective. */
#ifndef TALUS_CSV_ROWS_H
#define TALUS_CSV_ROWS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

#include "talus/csv.h"
#include "talus/csv_row.h"

/* Read the header, which must be this one. */
bool csv_rows_read_header(FILE *f, const char *header);

/* Copy the rows of the mark from `old`, which is past its header, to `new`,
 * which may be NULL; returns false unless the mark was made of these rows. */
bool csv_rows_copy(FILE *old, FILE *new, const struct csv_mark *mark);

/* Add a row to a mark. */
void csv_rows_add(struct csv_mark *mark, const struct csv_row *row);

/* Say how the rows of `f`, which is past its header, differ from the expected
 * ones; part of a sentence, in `text` [size]. */
void csv_rows_describe(FILE *f, const struct csv_expected *expected,
                       size_t size, char *text);

#endif
