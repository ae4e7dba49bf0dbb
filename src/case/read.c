/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Plain values from the table that a case returns, and what to say when they
 * are wrong. */
#include <lauxlib.h>
#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include "case_file.h"
#include "source.h"
#include "talus/error.h"
#include "talus/spelling.h"

enum { PLACE_LENGTH = 4096 + 32 }; /* path and line */

/* Write "file:line" of a key, or "file" if the line is not known. */
static void place_text(const struct case_file *file, const char *path,
                       size_t size, char *text) {
  int line = source_line(file->text, path);
  if (line > 0)
    snprintf(text, size, "%s:%d", file->path, line);
  else
    snprintf(text, size, "%s", file->path);
}

/* Describe the value on top as the user knows it. */
static void describe(lua_State *L, size_t size, char *text) {
  int type = lua_type(L, -1);
  if (type == LUA_TNUMBER)
    text_number(lua_tonumber(L, -1), size, text);
  else if (type == LUA_TSTRING)
    snprintf(text, size, "\"%.80s\"", lua_tostring(L, -1));
  else if (type == LUA_TBOOLEAN)
    snprintf(text, size, "%s", lua_toboolean(L, -1) ? "true" : "false");
  else if (type == LUA_TTABLE || type == LUA_TFUNCTION)
    snprintf(text, size, "a %s", lua_typename(L, type));
  else
    snprintf(text, size, "%s", lua_typename(L, type));
}

void read_fail(struct case_file *file, const char *path, const char *format,
               ...) {
  char place[PLACE_LENGTH], value[VALUE_LENGTH], message[2048];
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(message, sizeof message, format, arguments);
  va_end(arguments);
  place_text(file, path, sizeof place, place);
  describe(file->L, sizeof value, value);
  USER_ERROR("%s: %s = %s: %s", place, path, value, message);
}

void read_fail_at(struct case_file *file, const char *path, const char *format,
                  ...) {
  char place[PLACE_LENGTH], message[2048];
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(message, sizeof message, format, arguments);
  va_end(arguments);
  place_text(file, path, sizeof place, place);
  if (!file->loading || sandbox_was_late(file->sandbox))
    USER_ERROR_ALONE("%s: %s", place, message);
  USER_ERROR("%s: %s", place, message);
}

void read_suggest(const char *word, int n, const char *const *names,
                  size_t size, char *text) {
  const char *nearest = spelling_nearest(word, n, names);
  const char *before = nearest != NULL ? " Known: " : "; known: ";
  size_t used = 0;
  text[0] = '\0';
  if (nearest != NULL)
    used = (size_t)snprintf(text, size, "; did you mean `%s`?", nearest);
  for (int i = 0; i < n && used < size; i++)
    used += (size_t)snprintf(text + used, size - used, "%s%s",
                             i > 0 ? ", " : before, names[i]);
}

/* Name a model that knows this key; NULL: none does. */
static const char *model_with(const char *path) {
  const struct model_keys *model;
  for (int k = 0; (model = models_keys(k)) != NULL; k++)
    if (keys_find(model, path) != NULL) return model->name;
  return NULL;
}

static _Noreturn void fail_unknown(struct case_file *file, const char *path,
                                   const char *word, int n,
                                   const char *const *names) {
  char inner[PATH_LENGTH], known[1024], value[VALUE_LENGTH];
  path_join(inner, path, word);
  describe(file->L, sizeof value, value);
  const char *other = model_with(inner);
  if (other != NULL)
    read_fail_at(file, inner,
                 "%s = %s is a key of model = \"%s\", and the case is of model "
                 "= \"%s\": take the key out, or the other model",
                 inner, value, other, models_names[file->params.model]);
  const char *meant = *path ? NULL : keys_meant(word);
  if (meant != NULL)
    read_fail_at(file, inner, "unknown key %s = %s; did you mean %s?", inner,
                 value, meant);
  read_suggest(word, n, names, sizeof known, known);
  read_fail_at(file, inner, "unknown key %s = %s%s", inner, value, known);
}

void read_known_only(struct case_file *file, const char *path, int n,
                     const char *const *names, int npositions) {
  lua_State *L = file->L;
  for (lua_pushnil(L); lua_next(L, -2); lua_pop(L, 1)) {
    if (lua_type(L, -2) == LUA_TSTRING) {
      const char *word = lua_tostring(L, -2);
      bool known = false;
      for (int i = 0; i < n; i++) known = known || strcmp(word, names[i]) == 0;
      if (!known) fail_unknown(file, path, word, n, names);
      continue;
    }
    const bool place = lua_isinteger(L, -2) && lua_tointeger(L, -2) >= 1;
    if (place && lua_tointeger(L, -2) <= npositions) continue;
    if (place && npositions > 1)
      read_fail_at(file, path, "%s has %lld elements, at most %d are allowed",
                   path, (long long)lua_rawlen(L, -3), npositions);
    char value[VALUE_LENGTH], index[VALUE_LENGTH];
    describe(L, sizeof value, value);
    lua_pushvalue(L, -2);
    describe(L, sizeof index, index);
    read_fail_at(file, path,
                 "%s has an element [%s] = %s without a name; write key = "
                 "value",
                 *path ? path : "the case", index, value);
  }
}

static int compare_names(const void *a, const void *b) {
  return strcmp(*(const char *const *)a, *(const char *const *)b);
}

int read_names(struct case_file *file, const char *path, int max,
               const char **names) {
  lua_State *L = file->L;
  int n = 0;
  if (!lua_istable(L, -1))
    read_fail(file, path, "a table of name = value is needed");
  for (lua_pushnil(L); lua_next(L, -2); lua_pop(L, 1)) {
    if (lua_type(L, -2) != LUA_TSTRING)
      read_fail(file, path, "an element without a name; write name = value");
    if (!is_name(lua_tostring(L, -2)))
      read_fail_at(file, path,
                   "%s: \"%.80s\" is no name: letters, digits and _, at most "
                   "%d of them",
                   path, lua_tostring(L, -2), PARAMS_NAME_LENGTH - 1);
    if (n == max)
      read_fail_at(file, path, "%s holds more than %d names", path, max);
    names[n++] = lua_tostring(L, -2);
  }
  qsort(names, (size_t)n, sizeof *names, compare_names);
  return n;
}

static _Noreturn void fail_value(struct case_file *file, const struct key *key,
                                 const char *path) {
  char allowed[VALUE_LENGTH];
  keys_allowed(key, file->params.dimension, sizeof allowed, allowed);
  read_fail(file, path, "%s is needed (%s)", allowed, key->help);
}

static _Noreturn void fail_missing(struct case_file *file,
                                   const struct key *key, const char *path) {
  char allowed[VALUE_LENGTH];
  keys_allowed(key, file->params.dimension, sizeof allowed, allowed);
  read_fail_at(file, path, "%s is missing: %s (%s)", path, allowed, key->help);
}

/* Return the number on top, which stays; a message shows the whole value, which
 * is below the number if that is an element of a list. */
static double number_within(struct case_file *file, const struct key *key,
                            const char *path) {
  lua_State *L = file->L;
  if (lua_type(L, -1) != LUA_TNUMBER) fail_value(file, key, path);
  double value = lua_tonumber(L, -1);
  if (!isfinite(value)) fail_value(file, key, path);
  const bool is_time = key->unit != NULL && strcmp(key->unit, "s") == 0;
  const double size = fabs(value);
  if (!is_time && value != 0 &&
      (size > CASE_LARGEST || size < 1 / CASE_LARGEST))
    read_fail(file, path,
              "0 or a number from %g to %g, by size, is needed: choose other "
              "units (%s)",
              1 / CASE_LARGEST, CASE_LARGEST, key->help);
  bool low_enough = value <= key->high;
  bool high_enough = key->above ? value > key->low : value >= key->low;
  if (!low_enough || !high_enough) fail_value(file, key, path);
  return value;
}

double read_number(struct case_file *file, const struct key *key,
                   const char *path) {
  double value = number_within(file, key, path);
  lua_pop(file->L, 1);
  return value;
}

static int64_t integer_within(struct case_file *file, const struct key *key,
                              const char *path) {
  double value = number_within(file, key, path);
  if (value != floor(value)) fail_value(file, key, path);
  return (int64_t)value;
}

/* Push element `d` of the list on top. */
static void push_element(struct case_file *file, const struct key *key,
                         const char *path, int d) {
  lua_State *L = file->L;
  int n = file->params.dimension;
  if (!lua_istable(L, -1)) fail_value(file, key, path);
  const int length = (int)lua_rawlen(L, -1);
  if (d == 0) read_known_only(file, path, 0, NULL, length);
  if (length != n)
    read_fail_at(file, path, "%s: %d %s are needed, %d given (%s)", path, n,
                 key->type == KEY_INTEGERS ? "integers" : "numbers", length,
                 key->help);
  lua_rawgeti(L, -1, d + 1);
}

static void read_list(struct case_file *file, const struct key *key,
                      const char *path, void *target, char *text) {
  size_t used = 0;
  for (int d = 0; d < file->params.dimension; d++) {
    char element[PATH_LENGTH];
    snprintf(element, sizeof element, "%s[%d]", path, d + 1);
    push_element(file, key, path, d);
    double value;
    if (key->type == KEY_INTEGERS) {
      value = (double)integer_within(file, key, element);
      ((int *)target)[d] = (int)value;
    } else {
      value = number_within(file, key, element);
      ((double *)target)[d] = value;
    }
    char number[32];
    text_number(value, sizeof number, number);
    used += (size_t)snprintf(text + used, VALUE_LENGTH - used, "%s%s",
                             d > 0 ? "," : "", number);
    lua_pop(file->L, 1);
  }
}

/* Put the default of `key` on the stack; false if there is none. A default that
 * is the path of another key takes what stands in the rows. */
static bool push_default(struct case_file *file, const struct key *key) {
  lua_State *L = file->L;
  const char *text = key->fallback;
  if (*text == '\0') return false;
  if (key->type == KEY_CHOICE) { /* a parameter may have that very name */
    lua_pushstring(L, text);
    return true;
  }
  for (int i = 0; i < file->nrows; i++)
    if (strcmp(file->rows[i].key, text) == 0) text = file->rows[i].value;
  double value = strtod(text, NULL);
  if (key->type != KEY_VECTOR && key->type != KEY_INTEGERS) {
    lua_pushnumber(L, value);
    return true;
  }
  lua_newtable(L);
  for (int d = 0; d < file->params.dimension; d++) {
    lua_pushnumber(L, value);
    lua_rawseti(L, -2, d + 1);
  }
  return true;
}

/* Return the name on top as a value of the enum. */
static int choice_within(struct case_file *file, const struct key *key,
                         const char *path) {
  if (lua_type(file->L, -1) != LUA_TSTRING) fail_value(file, key, path);
  const char *name = lua_tostring(file->L, -1);
  for (int k = 0; key->choices[k] != NULL; k++) {
    if (strcmp(name, key->choices[k]) == 0) return k;
  }
  fail_value(file, key, path);
}

static void store(struct case_file *file, const struct key *key,
                  const char *path, void *target, char *text) {
  lua_State *L = file->L;
  switch (key->type) {
    case KEY_VECTOR:
    case KEY_INTEGERS:
      read_list(file, key, path, target, text);
      return;
    case KEY_TEXT:
      if (lua_type(L, -1) != LUA_TSTRING) fail_value(file, key, path);
      if (lua_rawlen(L, -1) >= VALUE_LENGTH)
        read_fail(file, path, "a text of at most %d characters is needed (%s)",
                  VALUE_LENGTH - 1, key->help);
      snprintf(text, VALUE_LENGTH, "%s", lua_tostring(L, -1));
      memcpy(target, text, VALUE_LENGTH);
      return;
    case KEY_CHOICE:
      *(int *)target = choice_within(file, key, path);
      snprintf(text, VALUE_LENGTH, "%s", lua_tostring(L, -1));
      return;
    case KEY_INTEGER:
    case KEY_LEVEL:
      *(int *)target = (int)integer_within(file, key, path);
      break;
    case KEY_COUNT:
      *(int64_t *)target = integer_within(file, key, path);
      break;
    default:
      *(double *)target = number_within(file, key, path);
  }
  text_number(lua_tonumber(L, -1), VALUE_LENGTH, text);
}

bool read_value(struct case_file *file, const struct key *key, const char *path,
                void *base) {
  lua_State *L = file->L;
  void *target = (char *)base + key->offset;
  char text[VALUE_LENGTH] = "";
  bool given = !lua_isnil(L, -1);
  struct key local = *key;
  if (key->type == KEY_LEVEL && file->params.dimension == 3)
    local.high = CASE_MAX_LEVEL_3D;
  if (!given) {
    if (key->fallback == NULL) fail_missing(file, &local, path);
    lua_pop(L, 1);
    if (!push_default(file, key)) return false;
  }
  if (!given && isinf(lua_tonumber(L, -1))) { /* no bound: beyond any check */
    *(double *)target = INFINITY;
    snprintf(text, sizeof text, "none");
  } else {
    store(file, &local, path, target, text);
  }
  lua_pop(L, 1);
  rows_add(file, path, text, key->unit, key->help, given ? "case" : "default");
  return given;
}
