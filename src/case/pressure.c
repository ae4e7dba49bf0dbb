/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The pressure of a box without an opening: pressure_level = 0,
 * {0, at = "gas"} or {0, at = {x, y}}. */
#include <math.h>
#include <string.h>

#include "case_file.h"

static const char *const PLACES[] = {"box", "gas"}; /* enum pressure_at */

static bool has_gas(const struct params *params) {
  return params->gas.rheology.model != NULL || params->shape.eval != NULL;
}

/* Read the point on top, which is taken off and must lie in the box. */
static void read_point(struct case_file *file, const char *path) {
  struct params *params = &file->params;
  const struct key point = {
      .type = KEY_VECTOR,
      .low = -INFINITY,
      .high = INFINITY,
      .fallback = NULL,
      .unit = "m",
      .offset = offsetof(struct params, pressure_point),
      .help =
          "where the pressure is pressure_level: \"gas\", \"box\" or a "
          "point"};
  read_value(file, &point, path, params);
  params->pressure_at = PRESSURE_AT_POINT;
  for (int d = 0; d < params->dimension; d++) {
    const double x = params->pressure_point[d], low = params->origin[d];
    const double high = low + params->size * params->trees[d];
    if (x >= low && x <= high) continue;
    read_fail_at(file, path,
                 "%s: the point lies outside the box: its %c is %g, allowed "
                 "is %g to %g",
                 path, "xyz"[d], x, low, high);
  }
}

static void add_place(struct case_file *file, const char *path,
                      const char *origin) {
  const enum pressure_at at = file->params.pressure_at;
  rows_add(file, path, PLACES[at], "",
           at == PRESSURE_AT_BOX
               ? "mean over the box, with the weight of the grains in it"
               : "mean over the gas, less its own weight",
           origin);
}

/* Read the value of `at`, which is on top, and take it off. */
static void read_place(struct case_file *file, const char *path) {
  lua_State *L = file->L;
  int at = 0;
  if (lua_istable(L, -1)) {
    read_point(file, path);
    return;
  }
  const char *name = lua_type(L, -1) == LUA_TSTRING ? lua_tostring(L, -1) : "";
  while (at < 2 && strcmp(name, PLACES[at]) != 0) at++;
  if (at == 2)
    read_fail(file, path, "\"gas\", \"box\" or a point of the box is needed");
  if (at == PRESSURE_AT_GAS && !has_gas(&file->params))
    read_fail(file, path,
              "grains fill the box, there is no gas: give a point, at = "
              "{...}, or \"box\"");
  file->params.pressure_at = (enum pressure_at)at;
  add_place(file, path, "case");
  lua_pop(L, 1);
}

static void read_given(struct case_file *file, const struct key *key) {
  static const char *const NAMES[] = {"at"};
  lua_State *L = file->L;
  char inner[PATH_LENGTH];
  struct key number = *key;
  number.type = KEY_NUMBER, number.fallback = NULL;
  number.help = "pressure when no boundary sets it";
  path_join(inner, key->path, "at");
  file->params.pressure_at = PRESSURE_AT_BOX;
  file->params.pressure_level_given = true;
  if (!lua_istable(L, -1) && lua_type(L, -1) != LUA_TNUMBER) {
    char allowed[VALUE_LENGTH];
    keys_allowed(key, file->params.dimension, sizeof allowed, allowed);
    read_fail(file, key->path, "%s is needed", allowed);
  }
  if (!lua_istable(L, -1)) {
    read_value(file, &number, key->path, &file->params);
    add_place(file, inner, "case");
    return;
  }
  read_known_only(file, key->path, 1, NAMES, 1);
  lua_rawgeti(L, -1, 1);
  read_value(file, &number, key->path, &file->params);
  lua_getfield(L, -1, "at");
  if (lua_isnil(L, -1))
    read_fail(file, inner,
              "say where the pressure is %g: at = \"gas\", \"box\" or a point",
              file->params.pressure_level);
  read_place(file, inner);
  lua_pop(L, 1);
}

void pressure_read(struct case_file *file, const struct key *key) {
  if (!lua_isnil(file->L, -1)) {
    read_given(file, key);
    return;
  }
  lua_pop(file->L, 1);
  if (has_gas(&file->params)) file->params.pressure_at = PRESSURE_AT_GAS;
}

/* Check that the pressure has a level: closures need p itself, not only its
 * gradient. */
void pressure_check(struct case_file *file) {
  const struct params *params = &file->params;
  char path[PATH_LENGTH];
  if (params->pressure_level_given || patches_find_outflow(file, path)) return;
  if (has_gas(params)) {
    rows_add(file, "boundary.pressure_level", "0", "Pa",
             "pressure of a closed box", "default");
    add_place(file, "boundary.pressure_level.at", "default");
    return;
  }
  if (!closure_depends_on_pressure(&params->grains.rheology)) return;
  read_fail_at(file, "boundary",
               "no boundary sets the pressure, and the viscosity depends on "
               "it: add boundary.pressure_level = {0, at = {...}}, the "
               "pressure at a point, or make a side {\"outflow\", pressure = "
               "...}");
}
