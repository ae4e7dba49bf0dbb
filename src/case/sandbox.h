/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * A Lua state that can compute and do nothing else.
 *
 * Left out: os, io, debug, package, require, coroutine, everything that loads
 * code, and pcall and metatables, with which code could outlive the bound on
 * instructions (a handler that goes on, a finaliser that never ends). C
 * functions of Lua's library are charged for what they do (library.h). As the
 * cost of an instruction has no bound (texts of 100 MB that are joined or
 * compared) the time is bounded too.
 */
#ifndef TALUS_CASE_SANDBOX_H
#define TALUS_CASE_SANDBOX_H

#include <lua.h>
#include <stdbool.h>

enum {
  SANDBOX_INSTRUCTIONS = 100000000, /* of one call: a second or two */
  SANDBOX_SECONDS = 10,             /* of the processor, for one call */
  SANDBOX_MEGABYTES = 256
};

struct sandbox;

/* Make a sandbox with the library that `open` gives it (library.h). `path`
 * names the code in messages, copied. */
struct sandbox *sandbox_new(const char *path, void (*open)(lua_State *));
void sandbox_destroy(struct sandbox *sandbox);
lua_State *sandbox_state(const struct sandbox *sandbox);

/* Let print() be heard on stderr, or not; off at the start. */
void sandbox_set_loud(struct sandbox *sandbox, int loud);

bool sandbox_is_loud(lua_State *L);

/* Count work that C code does for the case as so many instructions. Ends in a
 * Lua error if the case has used up its instructions or its time. */
void sandbox_charge(lua_State *L, double instructions);
/* Tell if a call has used up its time, which other ranks may not have. */
bool sandbox_was_late(const struct sandbox *sandbox);

/* Run `text`, leave what it returns, cut or filled up to one value, on the
 * stack. Returns NULL, or what went wrong, as file:line: message, owned by the
 * sandbox and valid until the next call; then nothing is left. */
const char *sandbox_run(struct sandbox *sandbox, const char *text);

/* Call the function below its `narguments` on the stack and leave `nresults`
 * values there. Returns as sandbox_run does. */
const char *sandbox_call(struct sandbox *sandbox, int narguments, int nresults);

#endif
