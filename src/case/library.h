/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * A case may call Lua's base functions that compute, math, string, table
 * and utf8, changed in two ways.
 *
 * Every rank and every run sees the same: no address shows in a text, pairs
 * goes through keys in their order, sort is the same sort each time,
 * math.random begins with the same seed.
 *
 * No call takes long: what C functions do is charged to the instructions that
 * a case may use (sandbox_charge).
 */
#ifndef TALUS_CASE_LIBRARY_H
#define TALUS_CASE_LIBRARY_H

#include <lua.h>

/* Put the table of what a case may use in the place of Lua's globals. Errors
 * are Lua errors. */
void library_open(lua_State *L);

/* Serve as string.find, match, gmatch and gsub (pattern.c). */
int pattern_find(lua_State *L);
int pattern_match(lua_State *L);
int pattern_gmatch(lua_State *L);
int pattern_gsub(lua_State *L);

#endif
