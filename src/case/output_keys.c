/* SPDX-License-Identifier: GPL-3.0-or-later */
/* When to write, and what to expect. */
#include <math.h>
#include <stdlib.h>

#include "case_file.h"

static int compare_times(const void *a, const void *b) {
  double s = *(const double *)a, t = *(const double *)b;
  return (s > t) - (s < t);
}

/* Read a list of times and sort it. Those beyond the end are dropped with a
 * word, as a case is often run for a shorter time than its list was made for.
 */
void output_read_times(struct case_file *file, const struct key *key) {
  lua_State *L = file->L;
  struct params *params = &file->params;
  if (lua_isnil(L, -1)) {
    lua_pop(L, 1);
    return;
  }
  if (!lua_istable(L, -1)) read_fail(file, key->path, "a list is needed");
  read_known_only(file, key->path, 0, NULL, PARAMS_MAX_TIMES);
  int n = (int)lua_rawlen(L, -1), kept = 0;
  for (int i = 0; i < n; i++) {
    char path[PATH_LENGTH];
    snprintf(path, sizeof path, "%s[%d]", key->path, i + 1);
    lua_rawgeti(L, -1, i + 1);
    double time = read_number(file,
                              &(struct key){.high = INFINITY,
                                            .type = KEY_NUMBER,
                                            .unit = key->unit,
                                            .help = key->help},
                              path);
    if (time <= params->stop) params->profile_times[kept++] = time;
  }
  params->nprofile_times = kept;
  qsort(params->profile_times, (size_t)kept, sizeof(double), compare_times);
  if (kept < n)
    snprintf(file->note, sizeof file->note,
             "%s: %d of %d times are beyond output.stop = %g and are left out",
             key->path, n - kept, n, params->stop);
  char text[PARAMS_MAX_TIMES * 26] = "";
  size_t used = 0;
  for (int i = 0; i < kept; i++) {
    char number[32];
    text_number(params->profile_times[i], sizeof number, number);
    used += (size_t)snprintf(text + used, sizeof text - used, "%s%s",
                             i > 0 ? "," : "", number);
  }
  rows_add(file, key->path, text, key->unit, key->help, "case");
  lua_pop(L, 1);
}

static void expect_text(struct case_file *file, const char *path, char *text) {
  lua_State *L = file->L;
  double bound[2];
  char number[2][32];
  if (lua_type(L, -1) == LUA_TSTRING) {
    if (lua_rawlen(L, -1) >= VALUE_LENGTH)
      read_fail(file, path, "a text of at most %d characters is needed",
                VALUE_LENGTH - 1);
    snprintf(text, VALUE_LENGTH, "%s", lua_tostring(L, -1));
    return;
  }
  if (!lua_istable(L, -1) || lua_rawlen(L, -1) != 2)
    read_fail(file, path, "{least, most} is needed");
  for (int i = 0; i < 2; i++) {
    lua_rawgeti(L, -1, i + 1);
    bound[i] = read_number(file,
                           &(struct key){.type = KEY_NUMBER,
                                         .low = -INFINITY,
                                         .high = INFINITY,
                                         .help = "least, most"},
                           path);
    text_number(bound[i], sizeof number[i], number[i]);
  }
  if (bound[0] > bound[1]) read_fail(file, path, "the least is above the most");
  snprintf(text, VALUE_LENGTH, "%s,%s", number[0], number[1]);
}

void output_read_expect(struct case_file *file, const struct key *key) {
  lua_State *L = file->L;
  const char *names[CASE_MAX_NAMES];
  int n = 0;
  if (!lua_isnil(L, -1)) n = read_names(file, key->path, CASE_MAX_NAMES, names);
  for (int i = 0; i < n; i++) {
    char path[PATH_LENGTH], text[VALUE_LENGTH];
    path_join(path, key->path, names[i]);
    lua_getfield(L, -1, names[i]);
    expect_text(file, path, text);
    rows_add(file, path, text, "", "checked by make examples-check", "case");
    lua_pop(L, 1);
  }
  lua_pop(L, 1);
}
