/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Columns of series.csv, written down once: the file, `talus help output` and
 * the sums of a model all read the same table. */
#ifndef TALUS_COLUMNS_H
#define TALUS_COLUMNS_H

enum column_format {
  COLUMN_INTEGER, /* whole */
  COLUMN_REAL,    /* reads back exactly */
  COLUMN_SHORT    /* 12 digits */
};

struct column {
  const char *name;
  enum column_format format;
  const char *unit; /* "" for a pure number */
  const char *help;
};

#endif
