/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "source.h"

#include <ctype.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

enum { WORD_LENGTH = 64 };

/* A word, a number, or one character of anything else; '=' for the sign of
 * assignment only, 's' for a string, 0 at the end. */
struct token {
  char kind; /* 'w', 's', a character, or 0 */
  char word[WORD_LENGTH];
  int line;
};

struct scanner {
  const char *at;
  int line;
};

static void step(struct scanner *s) {
  if (*s->at == '\n') s->line++;
  if (*s->at != '\0') s->at++;
}

/* Skip [[...]] or [=[...]=] if one begins here. */
static bool skip_long_bracket(struct scanner *s) {
  size_t level = s->at[0] == '[' ? strspn(s->at + 1, "=") : 0;
  if (s->at[0] != '[' || s->at[level + 1] != '[') return false;
  while (*s->at != '\0') {
    step(s);
    if (*s->at == ']' && strspn(s->at + 1, "=") == level &&
        s->at[level + 1] == ']') {
      s->at += level + 2;
      return true;
    }
  }
  return true;
}

static void skip_string(struct scanner *s) {
  char quote = *s->at;
  step(s);
  while (*s->at != '\0' && *s->at != quote && *s->at != '\n') {
    if (*s->at == '\\') step(s);
    step(s);
  }
  step(s);
}

static void skip_blanks(struct scanner *s) {
  for (;;) {
    if (isspace((unsigned char)*s->at)) {
      step(s);
    } else if (strncmp(s->at, "--", 2) == 0) {
      s->at += 2;
      if (!skip_long_bracket(s)) s->at += strcspn(s->at, "\n");
    } else {
      return;
    }
  }
}

static void read_word(struct scanner *s, struct token *token) {
  size_t n = 0;
  token->kind = 'w';
  while (isalnum((unsigned char)*s->at) || *s->at == '_') {
    if (n + 1 < WORD_LENGTH) token->word[n++] = *s->at;
    s->at++;
  }
  token->word[n] = '\0';
}

static struct token next_token(struct scanner *s) {
  skip_blanks(s);
  struct token token = {.kind = *s->at, .line = s->line};
  if (isalnum((unsigned char)*s->at) || *s->at == '_') {
    read_word(s, &token);
  } else if (*s->at == '"' || *s->at == '\'') {
    token.kind = 's';
    skip_string(s);
  } else if (*s->at == '[' && skip_long_bracket(s)) {
    token.kind = 's';
  } else if (*s->at != '\0' && strchr("=~<>", *s->at) && s->at[1] == '=') {
    token.kind = '?'; /* a comparison */
    s->at += 2;
  } else {
    step(s);
  }
  return token;
}

/* Find `name =`. With `inside` only between here and the brace that closes this
 * table, not in tables within it; a `local` of that name does not count there.
 * Leaves the scanner behind the sign. Returns the line, 0 if not found. */
static int find_key(struct scanner *s, const char *name, bool inside) {
  struct token before = {.kind = 0}, token;
  int depth = 0;
  while ((token = next_token(s)).kind != 0) {
    if (token.kind == '{') depth++;
    if (token.kind == '}' && --depth < 0 && inside) return 0;
    bool local = before.kind == 'w' && strcmp(before.word, "local") == 0;
    if (token.kind == 'w' && strcmp(token.word, name) == 0 &&
        !(inside && (depth > 0 || local))) {
      struct scanner ahead = *s;
      if (next_token(&ahead).kind == '=') {
        *s = ahead;
        return token.line;
      }
    }
    before = token;
  }
  return 0;
}

/* Move into the table that begins here; false if there is none. */
static bool enter_table(struct scanner *s) {
  struct scanner ahead = *s;
  if (next_token(&ahead).kind != '{') return false;
  *s = ahead;
  return true;
}

/* Move into the table of the last `return {`. Returns the line of the last
 * `return` of any kind, 0 if there is none. */
static int find_return(struct scanner *s, bool *table) {
  struct scanner at = *s;
  struct token token;
  int line = 0;
  *table = false;
  while ((token = next_token(&at)).kind != 0) {
    if (token.kind != 'w' || strcmp(token.word, "return") != 0) continue;
    struct scanner after = at;
    bool here = enter_table(&after);
    if (*table && !here) continue;
    *s = after;
    *table = here;
    line = token.line;
  }
  return line;
}

/* Take the next component of a path into `name`; indices as in adapt[2] are
 * left out. */
static const char *split(const char *path, char *name) {
  size_t n = strcspn(path, ".["), rest = strcspn(path, ".");
  snprintf(name, WORD_LENGTH, "%.*s", (int)n, path);
  return path[rest] == '.' ? path + rest + 1 : path + rest;
}

int source_line(const char *text, const char *path) {
  char name[WORD_LENGTH];
  struct scanner s = {.at = text, .line = 1};
  bool inside;
  int line = find_return(&s, &inside);
  while (*path != '\0') {
    bool indexed = path[strcspn(path, ".[")] == '[';
    path = split(path, name);
    struct scanner from = s;
    int found = find_key(&s, name, inside);
    if (found == 0) {
      /* Perhaps a variable of that name holds it. */
      s = inside ? (struct scanner){.at = text, .line = 1} : from;
      found = find_key(&s, name, false);
    }
    if (found == 0) return line;
    line = found;
    /* Elements of a list are tables in it: search those too. */
    inside = enter_table(&s) && !indexed;
  }
  return line;
}
