/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The initial state: level sets and velocities, functions of position. */
#include <string.h>

#include "case_file.h"

void initial_read_shape(struct case_file *file, const struct key *key) {
  lua_State *L = file->L;
  if (lua_isnil(L, -1)) {
    lua_pop(L, 1);
    return;
  }
  if (!lua_isfunction(L, -1))
    read_fail(file, key->path, "a function of position is needed (%s)",
              key->help);
  struct case_function *function =
      function_keep(file, key->path, key->unit, key->help, 1);
  file->params.shape = function_result(file, function, 0);
}

static double constant(void *context, const double x[3]) {
  (void)x;
  return *(const double *)context;
}

void initial_read_velocity(struct case_file *file, const struct key *key) {
  struct function *velocity = file->params.velocity;
  int n = file->params.dimension;
  if (lua_isnil(file->L, -1)) { /* at rest */
    rows_add(file, key->path, "0", key->unit, key->help, "default");
    lua_pop(file->L, 1);
    return;
  }
  if (lua_isfunction(file->L, -1)) {
    struct case_function *function =
        function_keep(file, key->path, key->unit, key->help, n);
    function->most = CASE_LARGEST;
    for (int d = 0; d < n; d++)
      velocity[d] = function_result(file, function, d);
    return;
  }
  struct key vector = *key;
  vector.type = KEY_VECTOR;
  vector.offset = 0;
  read_value(file, &vector, key->path, file->velocity);
  for (int d = 0; d < n; d++)
    velocity[d] = (struct function){constant, &file->velocity[d]};
}

void initial_read_tracers(struct case_file *file, const struct key *key) {
  lua_State *L = file->L;
  struct params *params = &file->params;
  if (lua_isnil(L, -1)) {
    lua_pop(L, 1);
    return;
  }
  const char *names[PARAMS_MAX_TRACERS];
  int n = read_names(file, key->path, PARAMS_MAX_TRACERS, names);
  for (int i = 0; i < n; i++) {
    char path[PATH_LENGTH];
    path_join(path, key->path, names[i]);
    if (case_name_is_taken(names[i]))
      read_fail_at(file, path,
                   "%s: this name is taken by a field of the program, choose "
                   "another",
                   path);
    lua_getfield(L, -1, names[i]);
    if (!lua_isfunction(L, -1))
      read_fail(file, path, "a function of position is needed (%s)", key->help);
    struct tracer *tracer = &params->tracer[params->ntracers++];
    snprintf(tracer->name, sizeof tracer->name, "%s", names[i]);
    tracer->shape = function_result(
        file, function_keep(file, path, key->unit, key->help, 1), 0);
  }
  lua_pop(L, 1);
}
