/* SPDX-License-Identifier: GPL-3.0-or-later */
/* series.csv: one row of numbers per logged step. */
#ifndef TALUS_SERIES_H
#define TALUS_SERIES_H

#include <stdint.h>

#include "talus/columns.h"
#include "talus/csv.h"

struct series;

/* End the program (USER_ERROR) unless directory/series.csv has these columns
 * and the rows of the mark, which was made after `last_step`; the message needs
 * `every`, series_every of params.h. Collective.
 */
void series_check(const char *directory, int ncolumns,
                  const struct column *columns, const struct csv_mark *mark,
                  int64_t last_step, int every);
/* Open directory/series.csv with these columns, borrowed: afresh, or after the
 * rows of `kept`, if not NULL. Collective. */
struct series *series_open(const char *directory, int ncolumns,
                           const struct column *columns,
                           const struct csv_mark *kept);
/* Bring all rows to the disk (csv_sync). */
struct csv_mark series_sync(struct series *series);
/* Add a row, value [ncolumns]; the values of rank 0 count. */
void series_write(struct series *series, const double value[]);
void series_close(struct series *series);

#endif
