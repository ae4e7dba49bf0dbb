/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * A Lua state that can compute and do nothing else.
 *
 * Left out: os, io, debug, package, require, coroutine, everything that loads
 * code, and pcall and metatables, with which code could outlive the bound on
 * instructions (a handler that goes on, a finaliser that never ends). What C
 * functions of Lua's library do in one call is not counted.
 */
#ifndef TALUS_CASE_SANDBOX_H
#define TALUS_CASE_SANDBOX_H

#include <lua.h>
#include <stdint.h>

enum {
  SANDBOX_INSTRUCTIONS = 100000000, /* of a whole case: a second or two */
  SANDBOX_MEGABYTES = 256
};

struct sandbox;

/* `path` names the code in messages, copied. */
struct sandbox *sandbox_new(const char *path);
void sandbox_destroy(struct sandbox *sandbox);
lua_State *sandbox_state(const struct sandbox *sandbox);

/* Whether print() is heard, on stderr. Off at the start. */
void sandbox_set_loud(struct sandbox *sandbox, int loud);

/* Run `text`, leave what it returns, cut or filled up to one value, on the
 * stack. Returns NULL, or what went wrong, as file:line: message, owned by the
 * sandbox and valid until the next call; then nothing is left. */
const char *sandbox_run(struct sandbox *sandbox, const char *text);

/* Call the function below its `narguments` on the stack and leave `nresults`
 * values there. Returns as sandbox_run does. */
const char *sandbox_call(struct sandbox *sandbox, int narguments, int nresults);

#endif
