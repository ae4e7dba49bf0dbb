/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/parameter_changes.h"

#include <stdbool.h>
#include <stdio.h>
#include <string.h>

#include "talus/log.h"

enum { FIELD = 1024, LINE = 4 * FIELD };

/* key,value,unit,origin */
struct row {
  char field[4][FIELD];
};

/* One field, without its quotes; returns where the next begins. */
static const char *read_field(const char *at, char field[FIELD]) {
  const bool quoted = *at == '"';
  size_t n = 0;
  if (quoted) at++;
  for (; *at != '\0' && *at != '\n'; at++) {
    if (quoted && *at == '"' && *++at != '"') break;
    if (!quoted && *at == ',') break;
    if (n < FIELD - 1) field[n++] = *at;
  }
  field[n] = '\0';
  return *at == ',' ? at + 1 : at;
}

/* The row that begins at `at`; returns where the next one does. */
static const char *read_row(const char *at, struct row *row) {
  for (int k = 0; k < 4; k++) at = read_field(at, row->field[k]);
  return at + strcspn(at, "\n") + (at[strcspn(at, "\n")] == '\n');
}

static bool find_row(const char *text, const char *key, struct row *row) {
  while (*text != '\0') {
    text = read_row(text, row);
    if (strcmp(row->field[0], key) == 0) return true;
  }
  return false;
}

static bool is_set(const struct row *row) {
  return strcmp(row->field[3], "command line") == 0;
}

/* One pass over the rows before, with `only_set` those that the user set.
 * Returns how many changes were said. */
static int say(FILE *before, const char *now, bool only_set, FILE *to) {
  char line[LINE];
  int n = 0;
  rewind(before);
  while (fgets(line, sizeof line, before) != NULL) {
    struct row was, is;
    read_row(line, &was);
    if (!find_row(now, was.field[0], &is)) continue;
    if (strcmp(was.field[1], is.field[1]) == 0) continue;
    if (only_set && !is_set(&was) && !is_set(&is)) continue;
    n++;
    if (to != NULL)
      fprintf(to, "talus: restart with %s = %s (was %s)\n", is.field[0],
              is.field[1], was.field[1]);
    else
      log_info("restart with %s = %s (was %s)", is.field[0], is.field[1],
               was.field[1]);
  }
  return n;
}

void parameter_changes_say(const char *path, const char *now) {
  FILE *before = fopen(path, "r");
  if (before == NULL) return;
  say(before, now, false, NULL);
  if (say(before, now, true, stderr) == 0) say(before, now, false, stderr);
  fclose(before);
}
