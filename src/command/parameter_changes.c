/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/parameter_changes.h"

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include "talus/csv_row.h"
#include "talus/log.h"

enum { KEY, VALUE, UNIT, ORIGIN }; /* cells of a row of parameters.csv */

static bool find_row(const char *text, const char *key, struct csv_row *row) {
  bool found = false;
  FILE *f = fmemopen((char *)(uintptr_t)text, strlen(text), "r");
  while (f != NULL && !found && csv_row_read(f, row))
    found = strcmp(csv_row_cell(row, KEY), key) == 0;
  if (f != NULL) fclose(f);
  return found;
}

static bool is_set(const struct csv_row *row) {
  return strcmp(csv_row_cell(row, ORIGIN), "command line") == 0;
}

static void say_change(FILE *to, const char *key, const char *is,
                       const char *was) {
  if (to != NULL)
    fprintf(to, "talus: restart with %s = %s (was %s)\n", key, is, was);
  else
    log_info("restart with %s = %s (was %s)", key, is, was);
}

/* Go once over the rows before, with `only_set` those that the user set.
 * Returns how many changes were said. */
static int say(FILE *before, const char *now, bool only_set, FILE *to) {
  struct csv_row was = {0}, is = {0};
  int n = 0;
  rewind(before);
  while (csv_row_read(before, &was)) {
    const char *key = csv_row_cell(&was, KEY);
    if (!find_row(now, key, &is)) continue;
    if (strcmp(csv_row_cell(&was, VALUE), csv_row_cell(&is, VALUE)) == 0)
      continue;
    if (only_set && !is_set(&was) && !is_set(&is)) continue;
    n++;
    say_change(to, key, csv_row_cell(&is, VALUE), csv_row_cell(&was, VALUE));
  }
  csv_row_free(&was);
  csv_row_free(&is);
  return n;
}

void parameter_changes_say(const char *path, const char *now) {
  FILE *before = fopen(path, "r");
  if (before == NULL) return;
  say(before, now, false, NULL);
  if (say(before, now, true, stderr) == 0) say(before, now, false, stderr);
  fclose(before);
}
