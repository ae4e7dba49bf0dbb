/* SPDX-License-Identifier: GPL-3.0-or-later */
/* From the table that a case returns to params: one pass over the keys, then
 * what single keys cannot tell. */
#include <float.h>
#include <math.h>
#include <string.h>

#include "case_file.h"
#include "talus/memory.h"

_Static_assert(sizeof((struct params *)0)->title == VALUE_LENGTH,
               "read.c copies texts of this length");

/* Push the value at `path`, nil if it or a table above it is not there. Of
 * tables that are something else, what holds the section complains. */
static void push_path(struct case_file *file, const char *path) {
  lua_State *L = file->L;
  lua_pushvalue(L, 1);
  while (*path != '\0') {
    size_t n = strcspn(path, ".");
    if (!lua_istable(L, -1)) {
      lua_pop(L, 1);
      lua_pushnil(L);
      return;
    }
    lua_pushlstring(L, path, n);
    lua_rawget(L, -2);
    lua_remove(L, -2);
    path += n + (path[n] == '.');
  }
}

static const struct model_keys *model_of(const struct case_file *file) {
  return models_keys(file->params.model);
}

/* Check that the keys right inside `section` ("" for the case itself) are all
 * that the table on top may hold, after a list of so many. */
static void check_section(struct case_file *file, const char *section,
                          int list) {
  const char *names[CASE_MAX_NAMES];
  const struct key *key;
  size_t length = strlen(section);
  int n = 0;
  for (int i = 0; (key = keys_get(model_of(file), i)) != NULL; i++) {
    const char *inner = key->path;
    if (!keys_takes(model_of(file), inner)) continue;
    if (length > 0) {
      if (strncmp(inner, section, length) != 0 || inner[length] != '.')
        continue;
      inner += length + 1;
    }
    if (strchr(inner, '.') == NULL && n < CASE_MAX_NAMES) names[n++] = inner;
  }
  read_known_only(file, section, n, names, list);
}

static void read_section(struct case_file *file, const struct key *key) {
  lua_State *L = file->L;
  bool given = !lua_isnil(L, -1);
  if (!given && key->fallback == NULL)
    read_fail_at(file, key->path, "%s is missing: %s = { ... } (%s)", key->path,
                 key->path, key->help);
  if (given && !lua_istable(L, -1))
    read_fail(file, key->path, "a table is needed (%s)", key->help);
  if (given) check_section(file, key->path, 0);
  lua_pop(L, 1);
}

/* Read a section that begins with a name, { "name", key = value }, "name" for
 * short, or { key = value } for the last of all names. */
static void read_named(struct case_file *file, const struct key *key,
                       void *base) {
  lua_State *L = file->L;
  struct key name = *key;
  name.type = KEY_CHOICE, name.unit = "";
  if (lua_istable(L, -1)) {
    lua_rawgeti(L, -1, 1);
    const bool named = !lua_isnil(L, -1);
    lua_insert(L, -2);
    check_section(file, key->path, named ? 1 : 0);
    lua_pop(L, 1);
    if (!named) {
      int last = 0;
      while (key->choices[last + 1] != NULL) last++;
      lua_pop(L, 1);
      lua_pushstring(L, key->choices[last]);
    }
  }
  read_value(file, &name, key->path, base);
}

/* Read the value of `key`, which is on top. */
static void read_key(struct case_file *file, const struct key *key,
                     void *base) {
  switch (key->type) {
    case KEY_TIMES:
      output_read_times(file, key);
      break;
    case KEY_SHAPE:
      initial_read_shape(file, key);
      break;
    case KEY_VELOCITY:
      initial_read_velocity(file, key);
      break;
    case KEY_CLOSURE:
      closure_read(file, key);
      break;
    case KEY_SIDE:
      boundary_read_side(file, key);
      break;
    case KEY_PATCHES:
      boundary_read_patches(file);
      break;
    case KEY_PRESSURE:
      pressure_read(file, key);
      break;
    case KEY_TRACERS:
      initial_read_tracers(file, key);
      break;
    case KEY_CRITERIA:
      criteria_read(file, key);
      break;
    case KEY_EXPECT:
      output_read_expect(file, key);
      break;
    default:
      read_value(file, key, key->path, base);
  }
}

/* Give the struct that holds the value of a key. */
static void *base_of(struct case_file *file, const struct key *key) {
  const struct model_keys *model = model_of(file);
  const struct key *own;
  for (int k = 0; (own = model_key(model, k)) != NULL; k++)
    if (own == key && model->own_size > 0) return file->params.own;
  return &file->params;
}

/* Read the model first, since the other keys depend on it. */
static void read_model(struct case_file *file) {
  const struct key *key = keys_find(models_keys(0), "model");
  push_path(file, key->path);
  read_value(file, key, key->path, &file->params);
  const size_t size = model_of(file)->own_size;
  if (size > 0) file->params.own = mem_alloc(1, size);
}

/* Is a key inside an optional section that is not there? Then it is not
 * missing. */
static bool is_absent(struct case_file *file, const struct key *key) {
  char section[PATH_LENGTH];
  const char *dot = strrchr(key->path, '.');
  if (dot == NULL || key->fallback != NULL) return false;
  snprintf(section, sizeof section, "%.*s", (int)(dot - key->path), key->path);
  push_path(file, section);
  bool absent = lua_isnil(file->L, -1);
  lua_pop(file->L, 1);
  return absent;
}

static void check_phases(struct case_file *file) {
  struct params *params = &file->params;
  const bool has_gas = keys_find(model_of(file), "gas") != NULL;
  bool shape = params->shape.eval != NULL;
  bool gas = params->gas.rheology.model != NULL;
  params->single_phase = !shape && !gas;
  if (!has_gas) return;
  if (gas && !shape)
    read_fail_at(file, "grains",
                 "grains.shape is missing: there is gas, so say where the "
                 "grains are at t = 0 by a function of position, or take "
                 "`gas` away to fill the box with grains");
  if (!shape || gas) return;
  if (case_finds_gas(file))
    read_fail_at(file, "grains.shape",
                 "gas is missing: grains.shape leaves a part of the box to "
                 "it, so give its density and rheology");
  read_fail_at(file, "grains.shape",
               "gas is missing: grains.shape is positive wherever it was "
               "tried, so leave it out and the grains fill the box, or give "
               "gas its density and rheology");
}

/* Check that cells can be told apart by their coordinates. */
static void check_origin(struct case_file *file) {
  const struct params *params = &file->params;
  const double finest = ldexp(params->size, -params->level_max);
  for (int d = 0; d < params->dimension; d++) {
    const double lower = params->origin[d];
    const double upper = lower + params->size * params->trees[d];
    const double most = fmax(fabs(lower), fabs(upper));
    if (finest > 0x1p8 * DBL_EPSILON * most) continue;
    read_fail_at(file, "domain.origin",
                 "domain: cells of %g cannot be told apart at a coordinate of "
                 "%g: lower domain.level, or put domain.origin nearer to 0",
                 finest, most);
  }
}

/* Choose whether gas passes: friction between grains leaves pores, a liquid
 * keeps its bubbles. */
static void choose_permeable(struct params *params) {
  if (params->grains.rheology.model == NULL) return;
  const enum permeability choice = params->permeability;
  params->permeable = !params->single_phase &&
                      (choice == PERMEABLE_YES ||
                       (choice == PERMEABLE_AUTO &&
                        closure_depends_on_pressure(&params->grains.rheology)));
}

/* Refuse an exact yield stress, which is that of the end of a step, with
 * Crank-Nicolson. */
static void check_yield(struct case_file *file) {
  const struct params *params = &file->params;
  const struct rheology *grains = &params->grains.rheology;
  if (grains->model != NULL && grains->regularisation == RHEOLOGY_EXACT &&
      rheology_yields(grains) && params->theta < 1)
    read_fail_at(file, "solver.theta",
                 "solver.theta = %g: regularisation = \"exact\", the default "
                 "of %s, needs backward Euler, solver.theta = 1; with another "
                 "theta say regularisation = \"clip\"",
                 params->theta, grains->model->name);
}

static void check_walls(struct case_file *file) {
  if (file->params.dimension == 3 && file->params.side_walls.mu > 0)
    read_fail_at(file, "grains.side_walls",
                 "grains.side_walls is for two dimensions, a channel seen in "
                 "its plane: in 3D let boundaries be the walls");
}

static void check_grid(struct case_file *file) {
  const struct params *params = &file->params;
  if (params->level_min > params->level_max)
    read_fail_at(file, "domain.level_min",
                 "domain.level_min = %d is above domain.level = %d",
                 params->level_min, params->level_max);
  if (params->opening_level > params->level_max)
    read_fail_at(file, "adapt.opening_level",
                 "adapt.opening_level = %d is above domain.level = %d",
                 params->opening_level, params->level_max);
  double ntrees = 1;
  for (int d = 0; d < params->dimension; d++) ntrees *= params->trees[d];
  if (ntrees > CASE_MAX_TREES)
    read_fail_at(file, "domain.trees",
                 "domain.trees: %.0f trees in all, %d are allowed: take fewer "
                 "and larger ones, and a higher domain.level",
                 ntrees, CASE_MAX_TREES);
  const double ncells =
      ntrees * ldexp(1, params->dimension * params->level_max);
  if (params->ncriteria == 0 && ncells > (double)params->max_cells)
    read_fail_at(file, "domain.level",
                 "a uniform grid of level %d has %.3g cells, and "
                 "adapt.max_cells is %.3g: lower domain.level, or say in "
                 "`adapt` where it is to be fine",
                 params->level_max, ncells, (double)params->max_cells);
}

static void set_defaults(struct case_file *file) {
  struct params *params = &file->params;
  params->nboundaries = 6;
  for (int side = 0; side < 6; side++)
    params->boundary[side].type = BOUNDARY_SLIP;
  for (int d = 0; d < 3; d++) params->trees[d] = 1;
  snprintf(params->title, sizeof params->title, "%s", params->name);
}

void build_params(struct case_file *file) {
  lua_State *L = file->L;
  const struct key *key;
  set_defaults(file);
  read_model(file);
  lua_pushvalue(L, 1);
  check_section(file, "", 0);
  lua_pop(L, 1);
  for (int i = 0; (key = keys_get(model_of(file), i)) != NULL; i++) {
    if (is_absent(file, key) || strcmp(key->path, "model") == 0) continue;
    if (!keys_takes(model_of(file), key->path)) continue;
    push_path(file, key->path);
    if (key->type == KEY_SECTION && key->choices != NULL)
      read_named(file, key, base_of(file, key));
    else if (key->type == KEY_SECTION)
      read_section(file, key);
    else
      read_key(file, key, base_of(file, key));
  }
  check_phases(file);
  choose_permeable(&file->params);
  check_walls(file);
  check_yield(file);
  check_grid(file);
  check_origin(file);
  coordinates_check(file);
  boundary_check(file);
  if (keys_find(model_of(file), "boundary.pressure_level") != NULL)
    pressure_check(file);
}
