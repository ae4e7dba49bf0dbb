/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/run_end.h"

#include <stdbool.h>
#include <stdio.h>
#include <string.h>

enum run_end {
  RUN_END_UNKNOWN,  /* no run, or one of an older version */
  RUN_END_OPEN,     /* it has begun: it runs, or was killed */
  RUN_END_FINISHED, /* at output.stop, or at rest */
  RUN_END_STOPPED,  /* before, by a signal or a bound on steps or seconds */
  RUN_END_FAILED    /* by an error */
};

enum { LENGTH = 1024 };

static bool begins(const char *line, const char *word) {
  return strncmp(line, word, strlen(word)) == 0;
}

/* Give the state after a line of the log. */
static enum run_end next_state(enum run_end state, const char *line) {
  if (begins(line, "talus ") && strstr(line, "-dimensional, "))
    return RUN_END_OPEN;
  if (state != RUN_END_OPEN) return state;
  if (begins(line, "error: ") || begins(line, "fatal: ")) return RUN_END_FAILED;
  if (begins(line, "end: stopped ")) return RUN_END_STOPPED;
  return begins(line, "end: ") ? RUN_END_FINISHED : state;
}

/* Return how the last run ended, and in `text` the line that says so, "" if
 * there is none. */
static enum run_end read_end(const char *directory, char text[LENGTH]) {
  char line[LENGTH];
  enum run_end state = RUN_END_UNKNOWN;
  text[0] = '\0';
  snprintf(line, sizeof line, "%s/run.log", directory);
  FILE *f = fopen(line, "r");
  if (f == NULL) return state;
  while (fgets(line, sizeof line, f) != NULL) {
    line[strcspn(line, "\n")] = '\0';
    enum run_end next = next_state(state, line);
    if (next == RUN_END_OPEN) text[0] = '\0';
    if (next != state && next != RUN_END_OPEN)
      snprintf(text, LENGTH, "%s", strchr(line, ' ') + 1);
    state = next;
  }
  fclose(f);
  return state;
}

void run_end_print(const char *directory) {
  static const char *const words[] = {
      [RUN_END_UNKNOWN] = "unknown: no run.log of this version",
      [RUN_END_OPEN] = "not ended: it still runs, or was killed",
      [RUN_END_FINISHED] = "finished",
      [RUN_END_STOPPED] = "stopped before its end, --restart goes on",
      [RUN_END_FAILED] = "failed"};
  char text[LENGTH];
  enum run_end state = read_end(directory, text);
  printf("state: %s%s%s\n", words[state], *text ? ": " : "", text);
}
