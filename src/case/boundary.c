/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Boundaries: "no_slip", {"outflow", pressure = 0}, or a function of position
 * that returns the name of a patch. */
#include <string.h>

#include "case_file.h"
#include "talus/error.h"

static const struct boundary_kind *find_kind(const char *name) {
  const struct boundary_kind *kind;
  for (int i = 0; (kind = keys_boundary_kind(i)) != NULL; i++)
    if (strcmp(kind->name, name) == 0) return kind;
  return NULL;
}

/* Return the type named by the string, or the first element, on top. */
static const struct boundary_kind *read_kind(struct case_file *file,
                                             const char *path) {
  lua_State *L = file->L;
  const char *names[CASE_MAX_NAMES];
  int n = 0;
  for (; n < CASE_MAX_NAMES && keys_boundary_kind(n) != NULL; n++)
    names[n] = keys_boundary_kind(n)->name;
  if (lua_istable(L, -1))
    lua_rawgeti(L, -1, 1);
  else
    lua_pushvalue(L, -1);
  bool named = lua_type(L, -1) == LUA_TSTRING;
  const struct boundary_kind *kind =
      named ? find_kind(lua_tostring(L, -1)) : NULL;
  if (kind == NULL) {
    char known[1024];
    read_suggest(named ? lua_tostring(L, -1) : "", n, names, sizeof known,
                 known);
    read_fail(file, path, "a type of boundary is needed%s", known);
  }
  lua_pop(L, 1);
  return kind;
}

static bool takes(const struct boundary_kind *kind, const char *option) {
  for (int i = 0; i < 3 && kind->options[i] != NULL; i++)
    if (strcmp(kind->options[i], option) == 0) return true;
  return false;
}

static void read_options(struct case_file *file, const char *path,
                         const struct boundary_kind *kind,
                         struct boundary *boundary) {
  lua_State *L = file->L;
  int nknown = 0;
  while (nknown < 3 && kind->options[nknown] != NULL) nknown++;
  if (lua_istable(L, -1)) read_known_only(file, path, nknown, kind->options, 1);
  const struct key *option;
  for (int i = 0; (option = keys_boundary_option(i)) != NULL; i++) {
    if (!takes(kind, option->path)) continue;
    char inner[PATH_LENGTH];
    path_join(inner, path, option->path);
    struct key needed = *option;
    if (kind->needs != NULL && strcmp(kind->needs, option->path) == 0)
      needed.fallback = NULL;
    if (lua_istable(L, -1))
      lua_getfield(L, -1, option->path);
    else
      lua_pushnil(L);
    read_value(file, &needed, inner, boundary);
  }
}

/* Read a boundary and take its value off the stack. */
static void read_boundary(struct case_file *file, const char *path,
                          const char *help, struct boundary *boundary) {
  const struct boundary_kind *kind = read_kind(file, path);
  boundary->type = kind->type;
  rows_add(file, path, kind->name, "", *help ? help : kind->help, "case");
  read_options(file, path, kind, boundary);
  lua_pop(file->L, 1);
}

static int find_side(int dimension, const char *name) {
  for (int side = 0; side < 2 * dimension; side++)
    if (strcmp(keys_side_name(dimension, side), name) == 0) return side;
  return -1;
}

void boundary_read_side(struct case_file *file, const struct key *key) {
  lua_State *L = file->L;
  int dimension = file->params.dimension;
  int side = find_side(dimension, strchr(key->path, '.') + 1);
  if (side < 0) { /* of 3D only */
    if (!lua_isnil(L, -1))
      read_fail(file, key->path, "a case of dimension 2 has no such side");
    lua_pop(L, 1);
    return;
  }
  struct boundary *boundary = &file->params.boundary[side];
  if (lua_isnil(L, -1)) {
    char allowed[VALUE_LENGTH];
    keys_allowed(key, dimension, sizeof allowed, allowed);
    read_fail_at(file, key->path, "%s is missing: %s (%s)", key->path, allowed,
                 key->help);
  }
  if (lua_isfunction(L, -1)) {
    boundary->type = BOUNDARY_NO_SLIP;
    file->side_function[side] =
        function_keep(file, key->path, "", key->help, 1);
    return;
  }
  read_boundary(file, key->path, "", boundary);
  double across = boundary->velocity[side / 2];
  if (boundary->type == BOUNDARY_NO_SLIP && across != 0)
    read_fail_at(file, key->path,
                 "%s: a wall moves along itself, but its velocity has %g "
                 "across; for a flow through it use \"inflow\"",
                 key->path, across);
}

static struct boundary *new_patch(struct case_file *file, const char *name) {
  struct params *params = &file->params;
  struct boundary *boundary = &params->boundary[params->nboundaries++];
  snprintf(file->patch[file->npatches++], PARAMS_NAME_LENGTH, "%s", name);
  snprintf(boundary->name, sizeof boundary->name, "%s", name);
  return boundary;
}

/* Return the largest number of patches: the solver needs one per axis, as slip
 * depends on the normal. */
static int most_patches(const struct case_file *file) {
  return CASE_MAX_PATCHES / file->params.dimension;
}

void boundary_read_patches(struct case_file *file) {
  lua_State *L = file->L;
  const char *section = "boundary.patches";
  if (lua_isnil(L, -1)) {
    lua_pop(L, 1);
    return;
  }
  const char *names[CASE_MAX_PATCHES];
  int n = read_names(file, section, most_patches(file), names);
  for (int i = 0; i < n; i++) {
    char path[PATH_LENGTH];
    path_join(path, section, names[i]);
    if (find_kind(names[i]) != NULL)
      read_fail_at(file, path, "%s: choose a name that is no type of boundary",
                   path);
    lua_getfield(L, -1, names[i]);
    struct boundary *boundary = new_patch(file, names[i]);
    read_boundary(file, path, "", boundary);
    if (boundary->type == BOUNDARY_PERIODIC)
      read_fail_at(file, path, "%s: a patch cannot be periodic", path);
    if (boundary->type == BOUNDARY_STRIP)
      read_fail_at(file, path,
                   "%s: a patch cannot be a slip_strip, which is divided by "
                   "the grains: let a whole side be one",
                   path);
  }
  lua_pop(L, 1);
}

/* Return which boundary: the side itself for "no_slip", else a patch. */
static int select_boundary(void *context, int side, const double x[3]) {
  struct case_file *file = (struct case_file *)context;
  if (file->side_function[side] == NULL) return side;
  const char *name = function_name(file->side_function[side], x);
  if (strcmp(name, "no_slip") == 0) return side;
  if (strcmp(name, "symmetry") == 0) name = "slip";
  for (int i = 0; i < file->npatches; i++)
    if (strcmp(file->patch[i], name) == 0) return 6 + i;
  const char *names[CASE_MAX_PATCHES + 1];
  char known[1024];
  for (int i = 0; i < file->npatches; i++) names[i] = file->patch[i];
  names[file->npatches] = "no_slip";
  read_suggest(name, file->npatches + 1, names, sizeof known, known);
  function_fail(file->side_function[side], x,
                "returned \"%s\", which boundary.patches does not hold%s", name,
                known);
}

static void check_periodic(struct case_file *file) {
  const struct params *params = &file->params;
  for (int side = 0; side < 2 * params->dimension; side++) {
    const char *name = keys_side_name(params->dimension, side);
    const char *other = keys_side_name(params->dimension, side ^ 1);
    char path[PATH_LENGTH];
    path_join(path, "boundary", other);
    if (params->boundary[side].type == BOUNDARY_PERIODIC &&
        params->boundary[side ^ 1].type != BOUNDARY_PERIODIC)
      read_fail_at(file, path,
                   "boundary.%s is periodic, so %s must be \"periodic\" too",
                   name, path);
  }
}

/* Refuse a second pressure: a box has that of its outflows, or its level where
 * there are none. */
static void check_pressure_twice(struct case_file *file) {
  char path[PATH_LENGTH];
  if (!file->params.pressure_level_given) return;
  if (!patches_find_outflow(file, path)) return;
  read_fail_at(file, "boundary.pressure_level",
               "boundary.pressure_level = %g is for a box in which no boundary "
               "sets the pressure, but %s is an outflow and does: take one of "
               "the two away",
               file->params.pressure_level, path);
}

/* Make room for the slip of strips, which need grains and gas that the model
 * follows. */
static void check_strips(struct case_file *file) {
  struct params *params = &file->params;
  for (int side = 0; side < 2 * params->dimension; side++) {
    char path[PATH_LENGTH];
    path_join(path, "boundary", keys_side_name(params->dimension, side));
    if (params->boundary[side].type != BOUNDARY_STRIP) continue;
    if (!models_keys(params->model)->strips)
      read_fail_at(file, path,
                   "%s = \"slip_strip\" is not known to model = \"%s\": take "
                   "\"no_slip\", or \"navier_slip\"",
                   path, models_names[params->model]);
    if (params->single_phase)
      read_fail_at(file, path,
                   "%s = \"slip_strip\" has gas beside the grains, and they "
                   "fill the box: take \"no_slip\", or give gas",
                   path);
    if (params->smooth > 0) continue;
    if (file->npatches >= most_patches(file))
      read_fail_at(file, path,
                   "%s = \"slip_strip\" needs a patch of its own, and there "
                   "are %d already: take one away",
                   path, file->npatches);
    params->smooth = params->nboundaries;
    new_patch(file, "slip of strips")->type = BOUNDARY_SLIP;
  }
}

void boundary_check(struct case_file *file) {
  struct params *params = &file->params;
  bool chosen = false;
  check_strips(file);
  for (int side = 0; side < 6; side++)
    chosen = chosen || file->side_function[side] != NULL;
  if (chosen) {
    if (file->npatches < most_patches(file))
      new_patch(file, "slip")->type = BOUNDARY_SLIP;
    params->boundary_select = select_boundary;
    params->boundary_context = file;
  }
  check_periodic(file);
  patches_map(file);
  check_pressure_twice(file);
}
