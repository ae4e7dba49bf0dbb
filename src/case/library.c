/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "library.h"

#include <lauxlib.h>
#include <lualib.h>
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

#include "sandbox.h"
#include "talus/error.h"

/* Names of Lua's base library that a case may use. */
static const char *const BASE[] = {"assert",   "error",  "ipairs", "math",
                                   "select",   "string", "table",  "tonumber",
                                   "tostring", "type",   "utf8"};

/* Names that it may look for in vain. */
static const char *const LEFT_OUT[] = {
    "os",      "io",           "debug",        "package",
    "require", "coroutine",    "load",         "loadfile",
    "dofile",  "pcall",        "xpcall",       "collectgarbage",
    "next",    "setmetatable", "getmetatable", "rawset",
    "rawget",  "rawequal",     "rawlen",       "warn",
    "_G",      "_VERSION"};

/* pairs in a fixed order: Lua's own depends on addresses. Keys that have no
 * order are refused if there are two of a kind. */
static const char PAIRS[] =
    "local next, type, error, sort = next, type, error, table.sort\n"
    "local number = { [false] = 0, [true] = 1 }\n"
    "local function before(a, b)\n"
    "  local ta, tb = type(a), type(b)\n"
    "  if ta ~= tb then return ta < tb end\n"
    "  if ta == 'number' or ta == 'string' then return a < b end\n"
    "  if ta == 'boolean' then return number[a] < number[b] end\n"
    "  error('pairs: two keys are ' .. ta .. 's, which have no order that ' "
    "..\n"
    "        'is the same on each rank: use numbers or texts as keys', 4)\n"
    "end\n"
    "return function(t)\n"
    "  if type(t) ~= 'table' then\n"
    "    error(\"bad argument #1 to 'pairs' (table expected, got \" ..\n"
    "          type(t) .. ')', 2)\n"
    "  end\n"
    "  local keys, i = {}, 0\n"
    "  for k in next, t do keys[#keys + 1] = k end\n"
    "  sort(keys, before)\n"
    "  return function()\n"
    "    repeat i = i + 1 until keys[i] == nil or t[keys[i]] ~= nil\n"
    "    return keys[i], t[keys[i]]\n"
    "  end\n"
    "end\n";

/* Texts without addresses */

/* Replace a table, a function or the like at i by the name of its type. */
static void hide_address(lua_State *L, int i) {
  const int type = lua_type(L, i);
  if (type == LUA_TNONE || type == LUA_TNIL || type == LUA_TBOOLEAN ||
      type == LUA_TNUMBER || type == LUA_TSTRING)
    return;
  lua_pushstring(L, lua_typename(L, type));
  lua_replace(L, i);
}

static int to_string(lua_State *L) {
  luaL_checkany(L, 1);
  hide_address(L, 1);
  luaL_tolstring(L, 1, NULL);
  return 1;
}

static int print(lua_State *L) {
  int n = lua_gettop(L);
  for (int i = 1; i <= n; i++) {
    hide_address(L, i);
    const char *text = luaL_tolstring(L, i, NULL);
    if (sandbox_is_loud(L) && base_rank() == 0)
      fprintf(stderr, "%s%s", text, i < n ? "\t" : "\n");
    lua_pop(L, 1);
  }
  return 0;
}

/* Prepare string.format: %p becomes %s, and either shows a table or a function
 * as the name of its type. */
static double prepare_format(lua_State *L) {
  const int top = lua_gettop(L);
  size_t n;
  const char *format = luaL_checklstring(L, 1, &n);
  luaL_Buffer buffer;
  char *at = luaL_buffinitsize(L, &buffer, n + 1), *end = at + n;
  memcpy(at, format, n + 1);
  for (int i = 2; (at = memchr(at, '%', (size_t)(end - at))) != NULL; at++) {
    if (*++at == '%') continue;
    at += strspn(at, "-+ #0123456789.");
    if (at == end) break;
    if (*at == 'p') *at = 's';
    if (*at == 's' && i <= top) hide_address(L, i);
    i++;
  }
  luaL_pushresultsize(&buffer, n);
  lua_replace(L, 1);
  return 0;
}

/* C functions that may have much to do: each is charged for before it begins,
 * and for the texts that it returns. */

enum { BYTES = 8 }; /* copied or compared while Lua does one instruction */

static double length(lua_State *L, int i) {
  return lua_istable(L, i) || lua_type(L, i) == LUA_TSTRING
             ? (double)lua_rawlen(L, i)
             : 0;
}

/* Return how many elements from argument `from` to argument `to`, which are all
 * of table 1 if they are not given. */
static double span(lua_State *L, int from, int to) {
  const double first = lua_isnoneornil(L, from) ? 1 : lua_tonumber(L, from);
  const double last =
      lua_isnoneornil(L, to) ? length(L, 1) : lua_tonumber(L, to);
  return last >= first ? last - first + 1 : 0;
}

static double nothing(lua_State *L) {
  (void)L;
  return 0;
}

/* Prepare string.rep: without letters it would do nothing, n times. */
static double prepare_rep(lua_State *L) {
  if (length(L, 1) + length(L, 3) == 0 && lua_type(L, 1) == LUA_TSTRING) {
    lua_settop(L, 1);
    lua_pushinteger(L, 0);
  }
  return 0;
}

static double read_text(lua_State *L) { return length(L, 1) / BYTES; }

/* Prepare table.concat, which ends at the first element that is not there; a
 * number becomes text. */
static double concat(lua_State *L) {
  return 10 * fmin(span(L, 3, 4), length(L, 1) + 1);
}

/* Count the elements behind the place that argument 2 names, where there is a
 * third, or without it at the end. */
static double insert(lua_State *L) {
  return lua_gettop(L) < 3 ? 1 : fmax(length(L, 1) - lua_tonumber(L, 2), 0);
}

static double take_out(lua_State *L) {
  return lua_gettop(L) < 2 ? 1 : fmax(length(L, 1) - lua_tonumber(L, 2), 0);
}

static double move(lua_State *L) { return span(L, 2, 3); }

/* Prepare table.unpack: more than a million do not fit on the stack, which is
 * said at once. */
static double unpack(lua_State *L) { return fmin(span(L, 2, 3), 1e6); }

static const struct guarded {
  const char *library, *name;
  double (*work)(lua_State *L); /* in instructions */
} GUARDED[] = {
    {"string", "char", nothing},        {"string", "format", prepare_format},
    {"string", "lower", nothing},       {"string", "pack", nothing},
    {"string", "rep", prepare_rep},     {"string", "reverse", nothing},
    {"string", "sub", nothing},         {"string", "unpack", nothing},
    {"string", "upper", nothing},       {"table", "concat", concat},
    {"table", "insert", insert},        {"table", "move", move},
    {"table", "remove", take_out},      {"table", "unpack", unpack},
    {"utf8", "char", nothing},          {"utf8", "codepoint", read_text},
    {"utf8", "len", read_text},         {"utf8", "offset", read_text},
    {LUA_GNAME, "tonumber", read_text},
};

/* Stand for the C function that is the first upvalue, and do its work in the
 * frame of the guard, so that messages name it. */
static int guard(lua_State *L) {
  const struct guarded *guarded =
      (const struct guarded *)lua_touserdata(L, lua_upvalueindex(2));
  sandbox_charge(L, guarded->work(L));
  const int n = lua_tocfunction(L, lua_upvalueindex(1))(L);
  double bytes = 0;
  for (int i = 1; i <= n; i++)
    if (lua_type(L, -i) == LUA_TSTRING) bytes += length(L, -i);
  sandbox_charge(L, bytes / BYTES);
  return n;
}

static void guard_functions(lua_State *L) {
  for (size_t i = 0; i < sizeof GUARDED / sizeof *GUARDED; i++) {
    lua_getglobal(L, GUARDED[i].library);
    lua_getfield(L, -1, GUARDED[i].name);
    lua_pushlightuserdata(L, (void *)&GUARDED[i]);
    lua_pushcclosure(L, guard, 2);
    lua_setfield(L, -2, GUARDED[i].name);
    lua_pop(L, 1);
  }
}

/* table.sort, by heaps: the one of Lua asks the clock when it is slow, and
 * what it does with a function that gives no order depends on that. */

/* Is the value at a before the one at b, both counted from the top? */
static bool is_before(lua_State *L, int a, int b) {
  sandbox_charge(L, 1 + fmin(length(L, a), length(L, b)) / BYTES);
  if (lua_isnil(L, 2)) return lua_compare(L, a, b, LUA_OPLT);
  lua_pushvalue(L, 2);
  lua_pushvalue(L, a - 1);
  lua_pushvalue(L, b - 2);
  lua_call(L, 2, 1);
  const bool before = lua_toboolean(L, -1);
  lua_pop(L, 1);
  return before;
}

/* Let element `at` of the heap of n in table 1 sink to its place. */
static void sink(lua_State *L, lua_Integer at, lua_Integer n) {
  lua_rawgeti(L, 1, at);
  for (lua_Integer child; (child = 2 * at) <= n; at = child) {
    lua_rawgeti(L, 1, child);
    if (child < n) {
      lua_rawgeti(L, 1, child + 1);
      const bool next = is_before(L, -2, -1);
      if (next) child++;
      lua_remove(L, next ? -2 : -1);
    }
    if (!is_before(L, -2, -1)) {
      lua_pop(L, 1);
      break;
    }
    lua_rawseti(L, 1, at);
  }
  lua_rawseti(L, 1, at);
}

static int sort(lua_State *L) {
  luaL_checktype(L, 1, LUA_TTABLE);
  if (!lua_isnoneornil(L, 2)) luaL_checktype(L, 2, LUA_TFUNCTION);
  lua_settop(L, 2);
  lua_Integer n = (lua_Integer)lua_rawlen(L, 1);
  for (lua_Integer at = n / 2; at >= 1; at--) sink(L, at, n);
  for (; n > 1; n--) {
    lua_rawgeti(L, 1, 1);
    lua_rawgeti(L, 1, n);
    lua_rawseti(L, 1, 1);
    lua_rawseti(L, 1, n);
    sink(L, 1, n - 1);
  }
  return 0;
}

/* The globals */

/* Serve as __index of the globals: a name that means nothing is an error, not
 * nil. */
static int complain_of_name(lua_State *L) {
  const char *name = lua_tostring(L, 2);
  if (name == NULL) name = "?";
  for (size_t i = 0; i < sizeof LEFT_OUT / sizeof *LEFT_OUT; i++)
    if (strcmp(name, LEFT_OUT[i]) == 0)
      return luaL_error(L,
                        "'%s' is not available: a case file can compute "
                        "(math, string, table, utf8, pairs, ipairs, ...) but "
                        "not reach files, programs or other code",
                        name);
  return luaL_error(L, "'%s' is not defined", name);
}

static void open_libraries(lua_State *L) {
  static const luaL_Reg LIBRARIES[] = {{LUA_GNAME, luaopen_base},
                                       {LUA_MATHLIBNAME, luaopen_math},
                                       {LUA_STRLIBNAME, luaopen_string},
                                       {LUA_TABLIBNAME, luaopen_table},
                                       {LUA_UTF8LIBNAME, luaopen_utf8}};
  for (size_t i = 0; i < sizeof LIBRARIES / sizeof *LIBRARIES; i++) {
    luaL_requiref(L, LIBRARIES[i].name, LIBRARIES[i].func, 1);
    lua_pop(L, 1);
  }
}

/* Put functions of ours in the place of theirs, and take out string.dump, which
 * gives code. */
static void replace_functions(lua_State *L) {
  static const luaL_Reg TEXTS[] = {{"find", pattern_find},
                                   {"match", pattern_match},
                                   {"gmatch", pattern_gmatch},
                                   {"gsub", pattern_gsub},
                                   {NULL, NULL}};
  lua_getglobal(L, LUA_STRLIBNAME);
  luaL_setfuncs(L, TEXTS, 0);
  lua_pushnil(L);
  lua_setfield(L, -2, "dump");
  lua_getglobal(L, LUA_TABLIBNAME);
  lua_pushcfunction(L, sort);
  lua_setfield(L, -2, "sort");
  lua_pop(L, 2);
  lua_register(L, "tostring", to_string);
}

/* Give math.random the same numbers on every rank and every day. */
static void fix_random(lua_State *L) {
  lua_getglobal(L, LUA_MATHLIBNAME);
  lua_getfield(L, -1, "randomseed");
  lua_pushinteger(L, 1);
  lua_call(L, 1, 0);
  lua_pushnil(L);
  lua_setfield(L, -2, "randomseed");
  lua_pop(L, 1);
}

void library_open(lua_State *L) {
  open_libraries(L);
  guard_functions(L);
  replace_functions(L);
  fix_random(L);
  lua_newtable(L);
  for (size_t i = 0; i < sizeof BASE / sizeof *BASE; i++) {
    lua_getglobal(L, BASE[i]);
    lua_setfield(L, -2, BASE[i]);
  }
  if (luaL_loadstring(L, PAIRS) != LUA_OK) lua_error(L);
  lua_call(L, 0, 1);
  lua_setfield(L, -2, "pairs");
  lua_pushcfunction(L, print);
  lua_setfield(L, -2, "print");
  lua_newtable(L);
  lua_pushcfunction(L, complain_of_name);
  lua_setfield(L, -2, "__index");
  lua_setmetatable(L, -2);
  lua_rawseti(L, LUA_REGISTRYINDEX, LUA_RIDX_GLOBALS);
}
