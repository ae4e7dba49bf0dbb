/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/command_line.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "talus/error.h"
#include "talus/spelling.h"

/* Options of `run`. */
static const struct option {
  const char *name;
  const char *value; /* NULL: takes none */
} OPTIONS[] = {{"-o", "DIR"},        {"--restart", NULL},
               {"--max-steps", "N"}, {"--max-walltime", "SECONDS"},
               {"--quiet", NULL},    {"--timing", NULL}};

enum { NOPTIONS = sizeof OPTIONS / sizeof *OPTIONS };

/* Return the option that a word is, with or without "=value"; -1 if none. */
static int find_option(const char *word) {
  for (int i = 0; i < NOPTIONS; i++) {
    size_t n = strlen(OPTIONS[i].name);
    if (strncmp(word, OPTIONS[i].name, n) != 0) continue;
    if (word[n] == '\0' || (word[n] == '=' && n > 2)) return i;
  }
  return -1;
}

static _Noreturn void refuse_option(const char *word) {
  const char *names[NOPTIONS];
  for (int i = 0; i < NOPTIONS; i++) names[i] = OPTIONS[i].name;
  const char *nearest = spelling_nearest(word, NOPTIONS, names);
  USER_ERROR("unknown option %s%s%s; `talus help run` lists the options", word,
             nearest ? "; did you mean " : "", nearest ? nearest : "");
}

static int64_t read_steps(const char *text) {
  char *end;
  long long n = strtoll(text, &end, 10);
  if (end == text || *end != '\0' || n < 0)
    USER_ERROR("--max-steps %s: a number of steps >= 0 is needed", text);
  return n;
}

static double read_seconds(const char *text) {
  char *end;
  double seconds = strtod(text, &end);
  if (end == text || *end != '\0' || !isfinite(seconds) || seconds <= 0)
    USER_ERROR("--max-walltime %s: a number of seconds > 0 is needed", text);
  return seconds;
}

static void set_directory(struct command_line *line, const char *value) {
  if (*value == '-')
    USER_ERROR("-o %s: a directory is needed; if it has this name say ./%s",
               value, value);
  line->directory = value;
}

static void set_option(struct command_line *line, const char *name,
                       const char *value) {
  if (strcmp(name, "-o") == 0) set_directory(line, value);
  if (strcmp(name, "--restart") == 0) line->restart = true;
  if (strcmp(name, "--quiet") == 0) line->quiet = true;
  if (strcmp(name, "--timing") == 0) line->timing = true;
  if (strcmp(name, "--max-steps") == 0) line->max_steps = read_steps(value);
  if (strcmp(name, "--max-walltime") == 0)
    line->max_walltime = read_seconds(value);
}

/* Take argv[i] and perhaps its value; returns the last index taken. `given` has
 * the values of options that came before. */
static int read_option(int argc, char *argv[], int i,
                       const char *given[NOPTIONS], struct command_line *line) {
  int k = find_option(argv[i]);
  if (k < 0) refuse_option(argv[i]);
  const char *name = OPTIONS[k].name, *value = strchr(argv[i], '=');
  if (OPTIONS[k].value == NULL) {
    if (value != NULL) USER_ERROR("%s: %s takes no value", argv[i], name);
  } else if (value != NULL) {
    value++;
  } else if (i + 1 < argc && find_option(argv[i + 1]) < 0) {
    value = argv[++i];
  } else {
    USER_ERROR("%s needs a value: %s %s", name, name, OPTIONS[k].value);
  }
  if (value != NULL && *value == '\0')
    USER_ERROR("%s needs a value: %s %s", name, name, OPTIONS[k].value);
  if (value == NULL) value = "";
  if (given[k] != NULL && strcmp(given[k], value) != 0)
    USER_ERROR("%s %s and %s %s: give one of them", name, given[k], name,
               value);
  given[k] = value;
  set_option(line, name, value);
  return i;
}

void command_line_refuse_twice(int n, char *const words[]) {
  for (int i = 0; i < n; i++) {
    const size_t length = strcspn(words[i], "=");
    if (words[i][length] == '\0') continue;
    for (int k = 0; k < i; k++) {
      if (strncmp(words[i], words[k], length + 1) == 0 &&
          strcmp(words[i], words[k]) != 0)
        USER_ERROR("%s and %s on the command line: give one of them", words[k],
                   words[i]);
    }
  }
}

static void add_override(char *word, struct command_line *line) {
  if (word[strcspn(word, "=")] == '\0')
    USER_ERROR(
        "%s: after the case, %s, only name=value and options may "
        "follow; the case comes first",
        word, line->case_path);
  if (line->noverrides == COMMAND_LINE_MAX_OVERRIDES)
    USER_ERROR("more than %d overrides on the command line",
               COMMAND_LINE_MAX_OVERRIDES);
  line->overrides[line->noverrides++] = word;
}

void command_line_read(int argc, char *argv[], bool running,
                       struct command_line *line) {
  const char *given[NOPTIONS] = {NULL};
  *line = (struct command_line){.max_steps = -1};
  for (int i = 0; i < argc; i++) {
    if (argv[i][0] != '-') {
      if (line->case_path == NULL)
        line->case_path = argv[i];
      else
        add_override(argv[i], line);
    } else if (!running) {
      USER_ERROR("%s: `talus check` takes a case and name=value only", argv[i]);
    } else {
      i = read_option(argc, argv, i, given, line);
    }
  }
  command_line_refuse_twice(line->noverrides, line->overrides);
  if (line->case_path == NULL)
    USER_ERROR("which case? Say: talus %s CASE.lua [name=value ...]",
               running ? "run" : "check");
}

void command_line_find_case(int argc, char *argv[], struct command_line *line) {
  *line = (struct command_line){.max_steps = -1};
  for (int i = 0; i < argc; i++) {
    int k = find_option(argv[i]);
    if (k >= 0 && OPTIONS[k].value != NULL && strchr(argv[i], '=') == NULL) i++;
    if (k >= 0 || argv[i][0] == '-') continue;
    if (line->case_path == NULL)
      line->case_path = argv[i];
    else if (line->noverrides < COMMAND_LINE_MAX_OVERRIDES)
      line->overrides[line->noverrides++] = argv[i];
  }
}

bool command_own_directory(char *directory, int size) {
  ssize_t n = readlink("/proc/self/exe", directory, (size_t)size - 1);
  if (n <= 0) return false;
  directory[n] = '\0';
  char *slash = strrchr(directory, '/');
  if (slash == NULL) return false;
  *slash = '\0';
  return true;
}
