/* SPDX-License-Identifier: GPL-3.0-or-later */
/* param(name, default, help): what the command line may override. */
#include <lauxlib.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "case_file.h"
#include "talus/error.h"
#include "talus/spelling.h"

/* Return the text behind `name=` on the command line. */
static const char *override_of(const struct case_file *file, const char *name) {
  size_t n = strlen(name);
  for (int i = 0; i < file->noverrides; i++) {
    const char *text = file->overrides[i];
    if (strncmp(text, name, n) == 0 && text[n] == '=') return text + n + 1;
  }
  return NULL;
}

/* Say what the command line should have said, given the default at index 2. */
static int complain_of_override(lua_State *L, const char *name,
                                const char *text, const char *wanted) {
  return luaL_error(L, "%s=%s on the command line: %s is needed", name, text,
                    wanted);
}

/* Push a number. Lua takes hexadecimal integers modulo 2^64, which strtod does
 * not. */
static bool push_number(lua_State *L, const char *text) {
  if (lua_stringtonumber(L, text) == 0) return false;
  const double value = lua_tonumber(L, -1);
  if (isfinite(value) && value == strtod(text, NULL)) return true;
  lua_pop(L, 1);
  return false;
}

/* Push a list of what the default holds: texts if its first element is one. */
static bool push_list(lua_State *L, const char *text) {
  bool texts = lua_rawgeti(L, 2, 1) == LUA_TSTRING;
  lua_pop(L, 1);
  lua_newtable(L);
  for (int i = 1; *text != '\0'; i++) {
    size_t n = strcspn(text, ",");
    const char *item = lua_pushlstring(L, text, n);
    if (!texts) {
      if (!push_number(L, item)) return false;
      lua_remove(L, -2);
    }
    lua_rawseti(L, -2, i);
    text += n;
    if (*text == ',' && *++text == '\0') return false;
  }
  return true;
}

static int push_override(lua_State *L, const char *name, const char *text) {
  switch (lua_type(L, 2)) {
    case LUA_TNUMBER:
      if (push_number(L, text)) return 1;
      return complain_of_override(
          L, name, text,
          lua_stringtonumber(L, text) ? "a finite decimal number" : "a number");
    case LUA_TBOOLEAN:
      if (strcmp(text, "true") != 0 && strcmp(text, "false") != 0)
        return complain_of_override(L, name, text, "true or false");
      lua_pushboolean(L, strcmp(text, "true") == 0);
      return 1;
    case LUA_TSTRING:
      lua_pushstring(L, text);
      return 1;
    default:
      if (push_list(L, text)) return 1;
      return complain_of_override(L, name, text,
                                  "a list of numbers such as 0.5,1,2");
  }
}

/* Replace the value on top by a text as the command line would say it. */
static void value_to_text(lua_State *L) {
  if (!lua_istable(L, -1)) {
    char number[32];
    if (lua_type(L, -1) == LUA_TNUMBER) {
      text_number(lua_tonumber(L, -1), sizeof number, number);
      lua_pushstring(L, number);
    } else {
      luaL_tolstring(L, -1, NULL);
    }
    lua_remove(L, -2);
    return;
  }
  int list = lua_gettop(L);
  lua_pushliteral(L, "");
  for (int i = 1; lua_rawgeti(L, list, i) != LUA_TNIL; i++) {
    const int type = lua_type(L, -1);
    if (type != LUA_TNUMBER && type != LUA_TSTRING && type != LUA_TBOOLEAN)
      luaL_error(L,
                 "param: a list holds a %s: numbers, texts, true and false "
                 "are what it may hold",
                 luaL_typename(L, -1));
    value_to_text(L);
    lua_pushstring(L, i > 1 ? "," : "");
    lua_insert(L, -2);
    lua_concat(L, 3);
  }
  lua_pop(L, 1);
  lua_remove(L, list);
}

static void check_arguments(lua_State *L, const struct case_file *file) {
  luaL_checktype(L, 1, LUA_TSTRING);
  const char *name = lua_tostring(L, 1);
  if (!is_name(name))
    luaL_error(L, "param(\"%s\"): a name is letters, digits and _", name);
  for (int i = 0; i < file->ndeclared; i++)
    if (strcmp(file->declared[i].name, name) == 0)
      luaL_error(L, "param(\"%s\") was declared before", name);
  if (file->ndeclared == CASE_MAX_PARAMETERS)
    luaL_error(L, "more than %d parameters", CASE_MAX_PARAMETERS);
  int type = lua_type(L, 2);
  if (type != LUA_TNUMBER && type != LUA_TSTRING && type != LUA_TBOOLEAN &&
      type != LUA_TTABLE)
    luaL_error(L,
               "param(\"%s\") has no default: give a number, a text, true or "
               "false, or a list as second argument",
               name);
  luaL_optstring(L, 3, "");
}

static int declare(lua_State *L) {
  struct case_file *file =
      (struct case_file *)lua_touserdata(L, lua_upvalueindex(1));
  check_arguments(L, file);
  const char *name = lua_tostring(L, 1);
  const char *help = luaL_optstring(L, 3, "");
  const char *text = override_of(file, name);
  if (text != NULL)
    push_override(L, name, text);
  else
    lua_pushvalue(L, 2);
  snprintf(file->declared[file->ndeclared++].name, PARAMS_NAME_LENGTH, "%s",
           name);
  lua_pushvalue(L, -1);
  value_to_text(L);
  rows_add(file, name, lua_tostring(L, -1), "", help,
           text != NULL ? "command line" : "default");
  lua_pop(L, 1);
  return 1;
}

void param_install(struct case_file *file) {
  lua_State *L = file->L;
  lua_pushlightuserdata(L, file);
  lua_pushcclosure(L, declare, 1);
  lua_setglobal(L, "param");
}

void param_check_overrides(struct case_file *file) {
  const char *names[CASE_MAX_PARAMETERS];
  for (int i = 0; i < file->ndeclared; i++) names[i] = file->declared[i].name;
  for (int i = 0; i < file->noverrides; i++) {
    const char *text = file->overrides[i];
    const size_t n = strcspn(text, "=");
    char word[PARAMS_NAME_LENGTH], suggestion[2048];
    bool known = false;
    for (int k = 0; k < file->ndeclared; k++)
      known =
          known || (strlen(names[k]) == n && memcmp(text, names[k], n) == 0);
    if (known) continue;
    snprintf(word, sizeof word, "%.*s", (int)n, text);
    read_suggest(word, file->ndeclared, names, sizeof suggestion, suggestion);
    USER_ERROR("%s on the command line: %s declares no parameter `%s`%s", text,
               file->path, word, suggestion);
  }
}
