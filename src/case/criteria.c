/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Criteria of adaptation: {{"interface", width = 3}, "inside", every = 8}. */
#include <string.h>

#include "case_file.h"

/* Return the name of the criterion on top, a string or a table's first element.
 */
static const struct criterion_kind *read_kind(struct case_file *file,
                                              const char *path) {
  lua_State *L = file->L;
  const char *names[CASE_MAX_NAMES];
  const struct criterion_kind *kind, *found = NULL;
  int n = 0;
  if (lua_istable(L, -1))
    lua_rawgeti(L, -1, 1);
  else
    lua_pushvalue(L, -1);
  bool named = lua_type(L, -1) == LUA_TSTRING;
  for (; n < CASE_MAX_NAMES && (kind = keys_criterion_kind(n)) != NULL; n++) {
    names[n] = kind->name;
    if (named && strcmp(kind->name, lua_tostring(L, -1)) == 0) found = kind;
  }
  if (found == NULL) {
    char known[VALUE_LENGTH];
    read_suggest(named ? lua_tostring(L, -1) : "", n, names, sizeof known,
                 known);
    read_fail(file, path, "a criterion is needed%s", known);
  }
  lua_pop(L, 1);
  return found;
}

static void read_level_function(struct case_file *file, const char *path,
                                const struct key *option,
                                struct criterion *criterion) {
  if (!lua_isfunction(file->L, -1))
    read_fail(file, path, "a function of position is needed (%s)",
              option->help);
  struct case_function *function =
      function_keep(file, path, option->unit, option->help, 1);
  criterion->function = function_result(file, function, 0);
  criterion->level = file->params.level_max;
}

static void read_options(struct case_file *file, const char *path,
                         const struct criterion_kind *kind,
                         struct criterion *criterion) {
  lua_State *L = file->L;
  int nknown = 0;
  while (nknown < 3 && kind->options[nknown] != NULL) nknown++;
  if (lua_istable(L, -1)) read_known_only(file, path, nknown, kind->options, 1);
  const struct key *option;
  for (int i = 0; (option = keys_criterion_option(i)) != NULL; i++) {
    bool taken = false;
    for (int k = 0; k < nknown; k++)
      taken = taken || strcmp(kind->options[k], option->path) == 0;
    if (!taken) continue;
    char inner[PATH_LENGTH];
    path_join(inner, path, option->path);
    if (lua_istable(L, -1))
      lua_getfield(L, -1, option->path);
    else
      lua_pushnil(L);
    if (kind->type == CRITERION_FUNCTION && option->type == KEY_LEVEL)
      read_level_function(file, inner, option, criterion);
    else
      read_value(file, option, inner, criterion);
  }
}

/* Read a criterion and take its value off the stack. */
static void read_criterion(struct case_file *file, const char *path) {
  struct params *params = &file->params;
  struct criterion *criterion = &params->criterion[params->ncriteria++];
  const struct criterion_kind *kind = read_kind(file, path);
  criterion->type = kind->type;
  rows_add(file, path, kind->name, "", kind->help, "case");
  read_options(file, path, kind, criterion);
  if (criterion->level > params->level_max)
    read_fail_at(file, path, "%s: level = %d is above domain.level = %d", path,
                 criterion->level, params->level_max);
  if (criterion->only == CRITERION_GAS && params->gas.rheology.model == NULL)
    read_fail_at(file, path,
                 "%s: only = \"gas\", but the case has no gas: leave `only` "
                 "out, or give `gas`",
                 path);
  lua_pop(file->L, 1);
}

void criteria_read(struct case_file *file, const struct key *key) {
  static const char *const NAMES[] = {"every", "max_cells", "opening_level"};
  lua_State *L = file->L;
  if (lua_isnil(L, -1)) {
    lua_pop(L, 1);
    return;
  }
  if (!lua_istable(L, -1))
    read_fail(file, key->path,
              "a list of criteria is needed, as in {{\"interface\", width = "
              "3}, {\"inside\"}}");
  read_known_only(file, key->path, 3, NAMES, PARAMS_MAX_CRITERIA);
  int n = (int)lua_rawlen(L, -1);
  for (int i = 0; i < n; i++) {
    char path[PATH_LENGTH];
    snprintf(path, sizeof path, "%s[%d]", key->path, i + 1);
    lua_rawgeti(L, -1, i + 1);
    read_criterion(file, path);
  }
  lua_pop(L, 1);
}
