/* SPDX-License-Identifier: GPL-3.0-or-later */
/* string.find, match, gmatch and gsub with their steps counted: the ones of Lua
 * may take years over a pattern such as ("a-"):rep(30) .. "b", and no hook is
 * reached meanwhile. Algorithm, errors and answers are those of lstrlib.c in
 * Lua 5.4 [Copyright 1994-2024 Lua.org, PUC-Rio, MIT licence]. */
#include <ctype.h>
#include <lauxlib.h>
#include <stdbool.h>
#include <stddef.h>
#include <string.h>

#include "library.h"
#include "sandbox.h"

enum { MOST_CAPTURES = 32, DEEPEST = 200, STEPS = 1024, ESCAPE = '%' };
/* Lengths of captures that have none. */
enum { UNFINISHED = -1, POSITION = -2 };

struct capture {
  const char *begin;
  ptrdiff_t length;
};

struct match {
  lua_State *L;
  const char *begin, *end; /* of the text */
  const char *pattern_end;
  int steps, depth, ncaptures;
  struct capture capture[MOST_CAPTURES];
};

static void count(struct match *m, size_t steps) {
  m->steps += steps < STEPS ? (int)steps : STEPS;
  if (m->steps < STEPS) return;
  sandbox_charge(m->L, steps < STEPS ? m->steps : (double)steps);
  m->steps = 0;
}

static const char *match(struct match *m, const char *s, const char *p);

/* Single characters */

/* Return the place behind the class that begins at p. */
static const char *class_end(struct match *m, const char *p) {
  if (*p == ESCAPE) {
    if (p + 1 == m->pattern_end)
      luaL_error(m->L, "malformed pattern (ends with '%%')");
    return p + 2;
  }
  if (*p++ != '[') return p;
  if (*p == '^') p++;
  do { /* a ] in the first place does not end the set */
    if (p == m->pattern_end)
      luaL_error(m->L, "malformed pattern (missing ']')");
    if (*p++ == ESCAPE && p < m->pattern_end) p++;
  } while (*p != ']');
  return p + 1;
}

static bool is_in_class(int c, int class) {
  bool in;
  switch (tolower(class)) {
    case 'a':
      in = isalpha(c) != 0;
      break;
    case 'c':
      in = iscntrl(c) != 0;
      break;
    case 'd':
      in = isdigit(c) != 0;
      break;
    case 'g':
      in = isgraph(c) != 0;
      break;
    case 'l':
      in = islower(c) != 0;
      break;
    case 'p':
      in = ispunct(c) != 0;
      break;
    case 's':
      in = isspace(c) != 0;
      break;
    case 'u':
      in = isupper(c) != 0;
      break;
    case 'w':
      in = isalnum(c) != 0;
      break;
    case 'x':
      in = isxdigit(c) != 0;
      break;
    case 'z': /* not in the manual any more */
      in = c == 0;
      break;
    default:
      return class == c;
  }
  return in != (isupper(class) != 0);
}

/* Is a letter in a set? p is at its [, last at its ]. */
static bool is_in_set(int c, const char *p, const char *last) {
  const bool in = p[1] != '^';
  if (!in) p++;
  while (++p < last) {
    const unsigned char first = (unsigned char)*p;
    if (first == ESCAPE) {
      if (is_in_class(c, (unsigned char)*++p)) return in;
    } else if (p[1] == '-' && p + 2 < last) {
      p += 2;
      if (first <= c && c <= (unsigned char)*p) return in;
    } else if (first == c) {
      return in;
    }
  }
  return !in;
}

/* Does the character at s belong to the class from p to p_end? */
static bool is_one(struct match *m, const char *s, const char *p,
                   const char *p_end) {
  count(m, 1);
  if (s >= m->end) return false;
  const unsigned char c = (unsigned char)*s;
  if (*p == '.') return true;
  if (*p == ESCAPE) return is_in_class(c, (unsigned char)p[1]);
  if (*p == '[') {
    count(m, (size_t)(p_end - p));
    return is_in_set(c, p, p_end - 1);
  }
  return (unsigned char)*p == c;
}

/* Items of a pattern. Each returns where the match of it and of what follows
 * ends, or NULL, but for those that say otherwise. */

static const char *match_most(struct match *m, const char *s, const char *p,
                              const char *p_end) {
  ptrdiff_t n = 0;
  while (is_one(m, s + n, p, p_end)) n++;
  for (; n >= 0; n--) {
    const char *end = match(m, s + n, p_end + 1);
    if (end != NULL) return end;
  }
  return NULL;
}

static const char *match_least(struct match *m, const char *s, const char *p,
                               const char *p_end) {
  for (;; s++) {
    const char *end = match(m, s, p_end + 1);
    if (end != NULL || !is_one(m, s, p, p_end)) return end;
  }
}

static const char *begin_capture(struct match *m, const char *s,
                                 const char *p) {
  const bool position = p[1] == ')';
  if (m->ncaptures == MOST_CAPTURES) luaL_error(m->L, "too many captures");
  m->capture[m->ncaptures++] =
      (struct capture){s, position ? POSITION : UNFINISHED};
  const char *end = match(m, s, position ? p + 2 : p + 1);
  if (end == NULL) m->ncaptures--;
  return end;
}

static const char *end_capture(struct match *m, const char *s, const char *p) {
  int k = m->ncaptures - 1;
  while (k >= 0 && m->capture[k].length != UNFINISHED) k--;
  if (k < 0) luaL_error(m->L, "invalid pattern capture");
  m->capture[k].length = s - m->capture[k].begin;
  const char *end = match(m, s, p + 1);
  if (end == NULL) m->capture[k].length = UNFINISHED;
  return end;
}

/* Match %b() at p; returns where the balanced text ends. */
static const char *match_balance(struct match *m, const char *s,
                                 const char *p) {
  if (p + 3 >= m->pattern_end)
    luaL_error(m->L, "malformed pattern (missing arguments to '%%b')");
  if (s >= m->end || *s != p[2]) return NULL;
  for (int depth = 1; ++s < m->end;) {
    count(m, 1);
    if (*s == p[3]) {
      if (--depth == 0) return s + 1;
    } else if (*s == p[2]) {
      depth++;
    }
  }
  return NULL;
}

/* Match %1 at p; returns where the repeated capture ends. */
static const char *match_again(struct match *m, const char *s, const char *p) {
  const int k = p[1] - '1';
  if (k < 0 || k >= m->ncaptures || m->capture[k].length == UNFINISHED)
    luaL_error(m->L, "invalid capture index %%%d", k + 1);
  const ptrdiff_t n = m->capture[k].length;
  if (n < 0 || m->end - s < n) return NULL;
  count(m, 1 + (size_t)n / 8);
  return memcmp(m->capture[k].begin, s, (size_t)n) == 0 ? s + n : NULL;
}

/* Match %f[set] at p; returns where the pattern goes on. */
static const char *match_frontier(struct match *m, const char *s,
                                  const char *p) {
  if (p[2] != '[') luaL_error(m->L, "missing '[' after '%%f' in pattern");
  const char *p_end = class_end(m, p + 2);
  const int before = s == m->begin ? '\0' : (unsigned char)s[-1];
  const int here = s == m->end ? '\0' : (unsigned char)*s;
  count(m, (size_t)(p_end - p));
  return !is_in_set(before, p + 2, p_end - 1) &&
                 is_in_set(here, p + 2, p_end - 1)
             ? p_end
             : NULL;
}

/* Match the class at *p and the sign behind it. Returns true, and in *s and *p
 * where to go on, or false, and in *s the end or NULL. */
static bool match_class(struct match *m, const char **s, const char **p) {
  const char *class = *p, *p_end = class_end(m, class);
  const char sign = p_end < m->pattern_end ? *p_end : '\0';
  if (sign == '*' || sign == '-') {
    *s = sign == '*' ? match_most(m, *s, class, p_end)
                     : match_least(m, *s, class, p_end);
    return false;
  }
  const bool one = is_one(m, *s, class, p_end);
  if (sign == '?') {
    const char *end = one ? match(m, *s + 1, p_end + 1) : NULL;
    if (end != NULL) *s = end;
    *p = p_end + 1;
    return end == NULL;
  }
  if (!one || sign == '+') {
    *s = one ? match_most(m, *s + 1, class, p_end) : NULL;
    return false;
  }
  ++*s;
  *p = p_end;
  return true;
}

/* Match one item of the pattern; returns as match_class. */
static bool match_item(struct match *m, const char **s, const char **p) {
  const char *at = *p;
  if (*at == '(' || *at == ')') {
    *s = *at == '(' ? begin_capture(m, *s, at) : end_capture(m, *s, at);
    return false;
  }
  if (*at == '$' && at + 1 == m->pattern_end) {
    *s = *s == m->end ? *s : NULL;
    return false;
  }
  const char kind = *at == ESCAPE && at + 1 < m->pattern_end ? at[1] : '\0';
  if (kind == 'f') {
    *p = match_frontier(m, *s, at);
    if (*p == NULL) *s = NULL;
  } else if (kind == 'b') {
    *s = match_balance(m, *s, at);
    *p = at + 4;
  } else if (isdigit((unsigned char)kind)) {
    *s = match_again(m, *s, at);
    *p = at + 2;
  } else {
    return match_class(m, s, p);
  }
  return *s != NULL;
}

/* Return where the match of pattern p at s ends; NULL: there is none. */
static const char *match(struct match *m, const char *s, const char *p) {
  if (m->depth++ == DEEPEST) luaL_error(m->L, "pattern too complex");
  count(m, 1);
  while (p != m->pattern_end && match_item(m, &s, &p)) count(m, 1);
  m->depth--;
  return s;
}

/* From Lua and back */

/* Take text and pattern from arguments 1 and 2; returns the pattern. */
static const char *begin_match(lua_State *L, struct match *m) {
  size_t ntext, npattern;
  const char *text = luaL_checklstring(L, 1, &ntext);
  const char *pattern = luaL_checklstring(L, 2, &npattern);
  *m = (struct match){.L = L,
                      .begin = text,
                      .end = text + ntext,
                      .pattern_end = pattern + npattern};
  return pattern;
}

static const char *match_at(struct match *m, const char *s, const char *p) {
  m->depth = m->ncaptures = 0;
  return match(m, s, p);
}

/* Return argument i as a place in the text, which may be counted from its end;
 * NULL beyond the end. */
static const char *place_of(const struct match *m, int i) {
  const lua_Integer n = (lua_Integer)(m->end - m->begin);
  lua_Integer at = luaL_optinteger(m->L, i, 1);
  if (at < 0) at = at < -n ? 1 : n + at + 1;
  if (at == 0) at = 1;
  return at > n + 1 ? NULL : m->begin + (at - 1);
}

/* Push capture k of the match from s to end, which is its own when there are
 * none.
 */
static void push_capture(struct match *m, int k, const char *s,
                         const char *end) {
  if (k >= m->ncaptures) {
    if (k != 0) luaL_error(m->L, "invalid capture index %%%d", k + 1);
    lua_pushlstring(m->L, s, (size_t)(end - s));
    return;
  }
  const struct capture *capture = &m->capture[k];
  if (capture->length == UNFINISHED) luaL_error(m->L, "unfinished capture");
  if (capture->length == POSITION)
    lua_pushinteger(m->L, capture->begin - m->begin + 1);
  else
    lua_pushlstring(m->L, capture->begin, (size_t)capture->length);
}

/* Returns how many. */
static int push_captures(struct match *m, const char *s, const char *end) {
  const int n = m->ncaptures == 0 && s != NULL ? 1 : m->ncaptures;
  luaL_checkstack(m->L, n, "too many captures");
  for (int k = 0; k < n; k++) push_capture(m, k, s, end);
  return n;
}

/* Return the first place at or after s that holds the pattern letter by letter.
 */
static const char *find_plain(struct match *m, const char *s, const char *p) {
  const size_t n = (size_t)(m->pattern_end - p);
  while (s != NULL && (size_t)(m->end - s) >= n) {
    size_t k = 0;
    if (n == 0) return s;
    const char *at = memchr(s, *p, (size_t)(m->end - s) - n + 1);
    count(m, 1 + (size_t)((at != NULL ? at : m->end) - s) / 8);
    if (at == NULL) return NULL;
    while (k < n && at[k] == p[k]) k++;
    count(m, 1 + k);
    if (k == n) return at;
    s = at + 1;
  }
  return NULL;
}

static bool is_plain(const char *p, const char *p_end) {
  for (; p < p_end; p++)
    if (strchr("^$*+?.([%-", *p) != NULL && *p != '\0') return false;
  return true;
}

static int find_or_match(lua_State *L, bool finding) {
  struct match m;
  const char *p = begin_match(L, &m), *s = place_of(&m, 3), *end = NULL;
  const bool anchored = *p == '^' && p < m.pattern_end;
  if (finding && (lua_toboolean(L, 4) || is_plain(p, m.pattern_end))) {
    s = find_plain(&m, s, p);
    if (s != NULL) end = s + (m.pattern_end - p);
  } else if (s != NULL) {
    if (anchored) p++;
    while ((end = match_at(&m, s, p)) == NULL && !anchored && s < m.end) s++;
  }
  if (end == NULL) {
    lua_pushnil(L);
    return 1;
  }
  if (!finding) return push_captures(&m, s, end);
  lua_pushinteger(L, s - m.begin + 1);
  lua_pushinteger(L, end - m.begin);
  return 2 + push_captures(&m, NULL, NULL);
}

int pattern_find(lua_State *L) { return find_or_match(L, true); }

int pattern_match(lua_State *L) { return find_or_match(L, false); }

/* Find the next match of a gmatch, whose upvalues are text, pattern, where to
 * go on and where the last match ended, counted from the begin of the text. */
static int find_next(lua_State *L) {
  struct match m;
  lua_settop(L, 0);
  lua_pushvalue(L, lua_upvalueindex(1));
  lua_pushvalue(L, lua_upvalueindex(2));
  const char *p = begin_match(L, &m);
  const lua_Integer last = lua_tointeger(L, lua_upvalueindex(4));
  const char *s = m.begin + lua_tointeger(L, lua_upvalueindex(3));
  for (; s <= m.end; s++) {
    const char *end = match_at(&m, s, p);
    if (end == NULL || end - m.begin == last) continue;
    lua_pushinteger(L, end - m.begin);
    lua_copy(L, -1, lua_upvalueindex(3));
    lua_copy(L, -1, lua_upvalueindex(4));
    return push_captures(&m, s, end);
  }
  return 0;
}

int pattern_gmatch(lua_State *L) {
  struct match m;
  begin_match(L, &m);
  const char *s = place_of(&m, 3);
  lua_settop(L, 2);
  lua_pushinteger(L, (s != NULL ? s : m.end + 1) - m.begin);
  lua_pushinteger(L, -1);
  lua_pushcclosure(L, find_next, 4);
  return 1;
}

/* Add the text that takes the place of a match, %1 and the like filled in. */
static void add_text(struct match *m, luaL_Buffer *b, const char *s,
                     const char *end) {
  size_t n;
  const char *text = lua_tolstring(m->L, 3, &n), *text_end = text + n;
  count(m, n / 8);
  for (; text < text_end; text++) {
    if (*text != ESCAPE) {
      luaL_addchar(b, *text);
      continue;
    }
    const char c = ++text < text_end ? *text : '\0';
    if (c == ESCAPE) {
      luaL_addchar(b, c);
    } else if (c == '0') {
      luaL_addlstring(b, s, (size_t)(end - s));
    } else if (isdigit((unsigned char)c)) {
      push_capture(m, c - '1', s, end);
      luaL_tolstring(m->L, -1, NULL);
      lua_remove(m->L, -2);
      luaL_addvalue(b);
    } else {
      luaL_error(m->L, "invalid use of '%%' in replacement string");
    }
  }
}

/* Add the text that replaces a match, from argument 3. */
static void add_value(struct match *m, luaL_Buffer *b, const char *s,
                      const char *end) {
  lua_State *L = m->L;
  const int type = lua_type(L, 3);
  if (type == LUA_TFUNCTION) {
    lua_pushvalue(L, 3);
    lua_call(L, push_captures(m, s, end), 1);
  } else if (type == LUA_TTABLE) {
    push_capture(m, 0, s, end);
    lua_gettable(L, 3);
  } else {
    add_text(m, b, s, end);
    return;
  }
  if (!lua_toboolean(L, -1)) {
    lua_pop(L, 1);
    luaL_addlstring(b, s, (size_t)(end - s));
  } else if (!lua_isstring(L, -1)) {
    luaL_error(L, "invalid replacement value (a %s)", luaL_typename(L, -1));
  } else {
    luaL_addvalue(b);
  }
}

int pattern_gsub(lua_State *L) {
  struct match m;
  luaL_Buffer b;
  const char *p = begin_match(L, &m), *s = m.begin, *last = NULL;
  const bool anchored = *p == '^' && p < m.pattern_end;
  const int type = lua_type(L, 3);
  const lua_Integer most = luaL_optinteger(L, 4, m.end - m.begin + 1);
  lua_Integer n = 0;
  luaL_argexpected(L,
                   type == LUA_TNUMBER || type == LUA_TSTRING ||
                       type == LUA_TFUNCTION || type == LUA_TTABLE,
                   3, "string/function/table");
  if (anchored) p++;
  luaL_buffinit(L, &b);
  while (n < most) {
    const char *end = match_at(&m, s, p);
    if (end != NULL && end != last) {
      n++;
      add_value(&m, &b, s, end);
      s = last = end;
    } else if (s < m.end) {
      luaL_addchar(&b, *s++);
    } else {
      break;
    }
    if (anchored) break;
  }
  luaL_addlstring(&b, s, (size_t)(m.end - s));
  luaL_pushresult(&b);
  lua_pushinteger(L, n);
  return 2;
}
