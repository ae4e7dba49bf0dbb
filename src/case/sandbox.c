/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "sandbox.h"

#include <lauxlib.h>
#include <lualib.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

#include "talus/error.h"
#include "talus/memory.h"

enum { HOOK_STEP = 1000, MESSAGE_LENGTH = 2048 };

static const size_t MEMORY_LIMIT = (size_t)SANDBOX_MEGABYTES << 20;

struct sandbox {
  lua_State *L;
  char *path;
  size_t used;    /* bytes */
  bool limited;   /* code of the case is running */
  int64_t budget; /* instructions left to it */
  bool loud;
  char message[MESSAGE_LENGTH];
};

/* What a case may use of Lua's base library. */
static const char *const BASE[] = {"assert",   "error",  "ipairs", "math",
                                   "select",   "string", "table",  "tonumber",
                                   "tostring", "type",   "utf8"};

/* What it may look for in vain. */
static const char *const LEFT_OUT[] = {
    "os",      "io",           "debug",        "package",
    "require", "coroutine",    "load",         "loadfile",
    "dofile",  "pcall",        "xpcall",       "collectgarbage",
    "next",    "setmetatable", "getmetatable", "rawset",
    "rawget",  "rawequal",     "rawlen",       "warn",
    "_G",      "_VERSION"};

/* pairs in a fixed order: Lua's own depends on addresses, and ranks and
 * restarts must see the same case. */
static const char PAIRS[] =
    "local next, type, error, sort = next, type, error, table.sort\n"
    "local function before(a, b)\n"
    "  local ta, tb = type(a), type(b)\n"
    "  if ta ~= tb then return ta < tb end\n"
    "  return (ta == 'number' or ta == 'string') and a < b\n"
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

static struct sandbox *sandbox_of(lua_State *L) {
  return *(struct sandbox **)lua_getextraspace(L);
}

static void *allocate(void *context, void *p, size_t old, size_t new) {
  struct sandbox *sandbox = (struct sandbox *)context;
  if (p == NULL) old = 0; /* Lua passes the kind of object instead */
  if (new == 0) {
    mem_free(p);
    sandbox->used -= old;
    return NULL;
  }
  if (sandbox->limited && new > old &&
      sandbox->used + (new - old) > MEMORY_LIMIT)
    return NULL;
  sandbox->used = sandbox->used - old + new;
  return mem_resize(p, new, 1);
}

static void count_instructions(lua_State *L, lua_Debug *activation) {
  struct sandbox *sandbox = sandbox_of(L);
  sandbox->budget -= HOOK_STEP;
  if (sandbox->budget > 0) return;
  lua_getinfo(L, "Sl", activation);
  lua_pushfstring(L,
                  "%s:%d: the case is still running after %d million "
                  "instructions: is there a loop that does not end?",
                  activation->short_src, activation->currentline,
                  SANDBOX_INSTRUCTIONS / 1000000);
  lua_error(L);
}

/* __index of the globals: a name that means nothing is an error, not nil. */
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

static int print(lua_State *L) {
  int n = lua_gettop(L);
  for (int i = 1; i <= n; i++) {
    const char *text = luaL_tolstring(L, i, NULL);
    if (sandbox_of(L)->loud && base_rank() == 0)
      fprintf(stderr, "%s%s", text, i < n ? "\t" : "\n");
    lua_pop(L, 1);
  }
  return 0;
}

static int give_up(lua_State *L) {
  const char *message = lua_tostring(L, -1);
  FATAL("Lua fails outside a case: %s", message ? message : "no message");
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

/* The same numbers from math.random on every rank and every day. */
static void fix_random(lua_State *L) {
  lua_getglobal(L, "math");
  lua_getfield(L, -1, "randomseed");
  lua_pushinteger(L, 1);
  lua_call(L, 1, 0);
  lua_pushnil(L);
  lua_setfield(L, -2, "randomseed");
  lua_pop(L, 1);
}

/* A table of what a case may use takes the place of Lua's globals. */
static void fence_globals(lua_State *L) {
  lua_newtable(L);
  for (size_t i = 0; i < sizeof BASE / sizeof *BASE; i++) {
    lua_getglobal(L, BASE[i]);
    lua_setfield(L, -2, BASE[i]);
  }
  if (luaL_loadstring(L, PAIRS) != LUA_OK) give_up(L);
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

struct sandbox *sandbox_new(const char *path) {
  struct sandbox *sandbox = MEM_NEW(struct sandbox, 1);
  size_t size = strlen(path) + 1;
  sandbox->path = MEM_NEW(char, size);
  memcpy(sandbox->path, path, size);
  lua_State *L = lua_newstate(allocate, sandbox);
  if (L == NULL) FATAL("no memory for Lua");
  sandbox->L = L;
  *(struct sandbox **)lua_getextraspace(L) = sandbox;
  lua_atpanic(L, give_up);
  open_libraries(L);
  fix_random(L);
  fence_globals(L);
  lua_sethook(L, count_instructions, LUA_MASKCOUNT, HOOK_STEP);
  return sandbox;
}

void sandbox_destroy(struct sandbox *sandbox) {
  if (sandbox == NULL) return;
  lua_close(sandbox->L);
  mem_free(sandbox->path);
  mem_free(sandbox);
}

lua_State *sandbox_state(const struct sandbox *sandbox) { return sandbox->L; }

void sandbox_set_loud(struct sandbox *sandbox, int loud) {
  sandbox->loud = loud != 0;
}

/* Turn what was thrown into text. */
static const char *message_of(struct sandbox *sandbox, int status) {
  lua_State *L = sandbox->L;
  const char *text = lua_tostring(L, -1);
  if (status == LUA_ERRMEM)
    snprintf(sandbox->message, MESSAGE_LENGTH,
             "%s: the case needs more than %d MB of memory", sandbox->path,
             SANDBOX_MEGABYTES);
  else if (text == NULL)
    snprintf(sandbox->message, MESSAGE_LENGTH,
             "%s: error() was given a %s, not a message", sandbox->path,
             luaL_typename(L, -1));
  else
    snprintf(sandbox->message, MESSAGE_LENGTH, "%s", text);
  lua_pop(L, 1);
  return sandbox->message;
}

const char *sandbox_call(struct sandbox *sandbox, int narguments,
                         int nresults) {
  /* Debug builds trap 1/0, which Lua code may well write. */
  const bool trapping = base_trap_floating_point(false);
  sandbox->budget = SANDBOX_INSTRUCTIONS;
  sandbox->limited = true;
  int status = lua_pcall(sandbox->L, narguments, nresults, 0);
  sandbox->limited = false;
  base_trap_floating_point(trapping);
  return status == LUA_OK ? NULL : message_of(sandbox, status);
}

const char *sandbox_run(struct sandbox *sandbox, const char *text) {
  lua_State *L = sandbox->L;
  /* A first line for the shell is not Lua; its newline keeps the count. */
  if (text[0] == '#') text += strcspn(text, "\n");
  lua_pushfstring(L, "@%s", sandbox->path);
  int status =
      luaL_loadbufferx(L, text, strlen(text), lua_tostring(L, -1), "t");
  lua_remove(L, -2);
  if (status != LUA_OK) return message_of(sandbox, status);
  return sandbox_call(sandbox, 0, 1);
}
