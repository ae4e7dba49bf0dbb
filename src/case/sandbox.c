/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "sandbox.h"

#include <lauxlib.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>
#include <time.h>

#include "talus/error.h"
#include "talus/memory.h"

enum { HOOK_STEP = 1000, MESSAGE_LENGTH = 2048 };

static const size_t MEMORY_LIMIT = (size_t)SANDBOX_MEGABYTES << 20;

struct sandbox {
  lua_State *L;
  char *path;
  size_t used;       /* bytes */
  bool limited;      /* code of the case is running */
  double budget;     /* instructions left to it */
  double unseen;     /* instructions since the clock was last looked at */
  double begin;      /* s, when that was first done in this call, or 0 */
  double begin_used; /* s of the processor, when it was late; 0: it was not */
  bool late, loud;
  char message[MESSAGE_LENGTH];
};

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

static double seconds(clockid_t clock) {
  struct timespec now;
  clock_gettime(clock, &now);
  return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* Push "case.lua:3: ", the line that runs or has called what runs. */
static void push_place(lua_State *L) {
  lua_Debug activation;
  for (int level = 0; lua_getstack(L, level, &activation); level++) {
    lua_getinfo(L, "Sl", &activation);
    if (activation.currentline <= 0) continue;
    lua_pushfstring(L, "%s:%d: ", activation.short_src, activation.currentline);
    return;
  }
  lua_pushfstring(L, "%s: ", sandbox_of(L)->path);
}

/* Push " in 'find'" if a C function runs that has a name. */
static void push_function(lua_State *L) {
  lua_Debug activation;
  lua_getstack(L, 0, &activation);
  lua_getinfo(L, "Sn", &activation);
  if (*activation.what == 'C' && activation.name != NULL)
    lua_pushfstring(L, " in '%s'", activation.name);
  else
    lua_pushliteral(L, "");
}

static void give_up_after(lua_State *L, int most, const char *unit) {
  push_place(L);
  lua_pushfstring(L, "the case is still running after %d %s", most, unit);
  push_function(L);
  lua_pushliteral(L,
                  ": is there a loop that does not end, or a pattern, a list "
                  "or a text that is too long?");
  lua_concat(L, 4);
  lua_error(L);
}

/* Check the time: ask for that of the processor once the clock is late, which
 * takes longer but does not count what others do. */
static void check_time(lua_State *L) {
  struct sandbox *sandbox = sandbox_of(L);
  const double now = seconds(CLOCK_MONOTONIC);
  if (sandbox->begin == 0) sandbox->begin = now;
  if (now - sandbox->begin < 1) return;
  const double used = seconds(CLOCK_THREAD_CPUTIME_ID);
  if (sandbox->begin_used == 0) sandbox->begin_used = used;
  if (used - sandbox->begin_used < SANDBOX_SECONDS) return;
  sandbox->late = true;
  give_up_after(L, SANDBOX_SECONDS, "seconds");
}

void sandbox_charge(lua_State *L, double instructions) {
  struct sandbox *sandbox = sandbox_of(L);
  if (!sandbox->limited) return;
  sandbox->budget -= instructions;
  sandbox->unseen += instructions;
  if (sandbox->budget < 0)
    give_up_after(L, SANDBOX_INSTRUCTIONS / 1000000, "million instructions");
  if (sandbox->unseen < HOOK_STEP) return;
  sandbox->unseen = 0;
  check_time(L);
}

static void count_instructions(lua_State *L, lua_Debug *activation) {
  (void)activation;
  sandbox_charge(L, HOOK_STEP);
}

bool sandbox_is_loud(lua_State *L) { return sandbox_of(L)->loud; }

bool sandbox_was_late(const struct sandbox *sandbox) { return sandbox->late; }

static int give_up(lua_State *L) {
  const char *message = lua_tostring(L, -1);
  FATAL("Lua fails outside a case: %s", message ? message : "no message");
}

struct sandbox *sandbox_new(const char *path, void (*open)(lua_State *)) {
  struct sandbox *sandbox = MEM_NEW(struct sandbox, 1);
  size_t size = strlen(path) + 1;
  sandbox->path = MEM_NEW(char, size);
  memcpy(sandbox->path, path, size);
  lua_State *L = lua_newstate(allocate, sandbox);
  if (L == NULL) FATAL("no memory for Lua");
  sandbox->L = L;
  *(struct sandbox **)lua_getextraspace(L) = sandbox;
  lua_atpanic(L, give_up);
  open(L);
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
  sandbox->begin = sandbox->begin_used = 0;
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
