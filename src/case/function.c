/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Functions of position, and of the shear, that a case defines and the solver
 * calls. */
#include <lauxlib.h>
#include <math.h>
#include <stdarg.h>
#include <string.h>

#include "case_file.h"
#include "talus/error.h"

struct case_function *function_keep(struct case_file *file, const char *path,
                                    const char *unit, const char *help,
                                    int nresults) {
  lua_State *L = file->L;
  if (file->nfunctions == CASE_MAX_FUNCTIONS)
    read_fail(file, path, "a case may hold %d functions", CASE_MAX_FUNCTIONS);
  struct case_function *function = &file->functions[file->nfunctions++];
  lua_Debug where;
  lua_pushvalue(L, -1);
  lua_getinfo(L, ">S", &where);
  char text[VALUE_LENGTH];
  snprintf(text, sizeof text, "function at line %d", where.linedefined);
  *function = (struct case_function){
      .file = file, .nresults = nresults, .most = INFINITY};
  snprintf(function->path, sizeof function->path, "%s", path);
  function->reference = luaL_ref(L, LUA_REGISTRYINDEX);
  rows_add(file, path, text, unit, help, "case");
  return function;
}

static int narguments(const struct case_function *function) {
  return function->is_viscosity ? 3 : function->file->params.dimension;
}

static void call_text(const struct case_function *function, const double x[3],
                      size_t size, char *text) {
  size_t used = (size_t)snprintf(text, size, "%s(", function->path);
  for (int d = 0; d < narguments(function) && used < size; d++)
    used += (size_t)snprintf(text + used, size - used, "%s%.6g",
                             d > 0 ? ", " : "", x[d]);
  if (used < size) snprintf(text + used, size - used, ")");
}

void function_fail(struct case_function *function, const double x[3],
                   const char *format, ...) {
  struct case_file *file = function->file;
  char call[VALUE_LENGTH], message[1024];
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(message, sizeof message, format, arguments);
  va_end(arguments);
  call_text(function, x, sizeof call, call);
  read_fail_at(file, function->path, "%s %s", call, message);
}

/* Count a result in the checksum while all ranks do the same. */
static void add_result(struct case_function *function, const void *result,
                       size_t n) {
  if (function->file->loading)
    function->checksum = checksum_add(function->checksum, result, n);
}

/* Call a function, which leaves nresults values on the stack. */
static void call(struct case_function *function, const double x[3]) {
  struct case_file *file = function->file;
  lua_State *L = file->L;
  int n = narguments(function);
  lua_rawgeti(L, LUA_REGISTRYINDEX, function->reference);
  for (int d = 0; d < n; d++) lua_pushnumber(L, x[d]);
  const char *error = sandbox_call(file->sandbox, n, function->nresults);
  if (error != NULL) function_fail(function, x, "fails: %s", error);
}

/* Refuse a function that depends on more than its arguments: other ranks, which
 * ask at other points, would have another function. */
static void check_again(struct case_function *function, const double x[3],
                        double first, double second) {
  if (first == second) return;
  function_fail(function, x,
                "returned %.17g and %.17g: it must depend on its arguments "
                "alone, not on math.random or on what it did before",
                fmin(first, second), fmax(first, second));
}

static double eval(void *context, const double x[3]) {
  struct case_function *function = (struct case_function *)context;
  lua_State *L = function->file->L;
  call(function, x);
  int index = function->result - function->nresults;
  if (lua_type(L, index) != LUA_TNUMBER)
    function_fail(function, x, "returned %s, a finite number is needed",
                  luaL_typename(L, index));
  double value = lua_tonumber(L, index);
  if (!isfinite(value))
    function_fail(function, x, "returned %g, a finite number is needed", value);
  if (fabs(value) > function->most)
    function_fail(function, x, "returned %g, a number of size <= %g is needed",
                  value, function->most);
  lua_pop(L, function->nresults);
  add_result(function, &value, sizeof value);
  return value;
}

struct function function_result(struct case_file *file,
                                struct case_function *function, int result) {
  struct case_function *one = function;
  if (result > 0) {
    CHECK(file->nfunctions < CASE_MAX_FUNCTIONS, "too many functions");
    one = &file->functions[file->nfunctions++];
    *one = *function;
  }
  one->result = result;
  return (struct function){.eval = eval, .context = one};
}

/* Return the viscosity of a function of the user; infinity is allowed, as at
 * rest: eta_max cuts it. */
static double viscosity(struct case_function *function, const double at[3]) {
  lua_State *L = function->file->L;
  call(function, at);
  if (lua_type(L, -1) != LUA_TNUMBER)
    function_fail(function, at, "returned %s, a viscosity >= 0 is needed",
                  luaL_typename(L, -1));
  const double eta = lua_tonumber(L, -1);
  if (!(eta >= 0))
    function_fail(function, at, "returned %g, a viscosity >= 0 is needed", eta);
  lua_pop(L, 1);
  add_result(function, &eta, sizeof eta);
  return eta;
}

static void eval_viscosity(void *context, double time, int32_t n,
                           const double *shear_rate, const double *pressure,
                           double *eta) {
  struct case_function *function = (struct case_function *)context;
  for (int32_t i = 0; i < n; i++) {
    const double at[3] = {shear_rate[i], pressure[i], time};
    eta[i] = viscosity(function, at);
    if (function->file->loading)
      check_again(function, at, eta[i], viscosity(function, at));
  }
}

void function_set_viscosity(struct case_function *function,
                            struct rheology *rheology) {
  function->is_viscosity = true;
  rheology->user = eval_viscosity;
  rheology->context = function;
}

const char *function_name(struct case_function *function, const double x[3]) {
  lua_State *L = function->file->L;
  call(function, x);
  if (lua_type(L, -1) != LUA_TSTRING)
    function_fail(function, x,
                  "returned %s, the name of a boundary is needed (no_slip, "
                  "slip, symmetry, or one of boundary.patches)",
                  luaL_typename(L, -1));
  if (lua_rawlen(L, -1) >= sizeof function->name)
    function_fail(function, x, "returned a text of %zu letters, a name has %d",
                  (size_t)lua_rawlen(L, -1), PARAMS_NAME_LENGTH - 1);
  snprintf(function->name, sizeof function->name, "%s", lua_tostring(L, -1));
  lua_pop(L, 1);
  add_result(function, function->name, strlen(function->name));
  return function->name;
}

enum { TRIES = 9 }; /* along each axis */

/* Try point i of a lattice over the box, n along each axis, corners included.
 */
static void try_point(const struct params *params, int i, int n, double x[3]) {
  for (int d = 0; d < 3; d++, i /= n)
    x[d] = d < params->dimension
               ? params->origin[d] +
                     params->size * params->trees[d] * (i % n) / (n - 1)
               : 0;
}

static void try_sides(struct case_file *file, const double x[3], int i) {
  const struct params *params = &file->params;
  for (int side = 0; side < 2 * params->dimension; side++) {
    int on_axis = i;
    for (int d = 0; d < side / 2; d++) on_axis /= TRIES;
    if (on_axis % TRIES != (side % 2 ? TRIES - 1 : 0)) continue;
    const int first = params->boundary_select(file, side, x);
    if (first != params->boundary_select(file, side, x))
      function_fail(
          file->side_function[side], x,
          "returned two names, one after the other: it must depend on "
          "the position alone");
  }
}

static bool chooses_boundary(const struct case_file *file,
                             const struct case_function *function) {
  for (int side = 0; side < 6; side++)
    if (file->side_function[side] == function) return true;
  return false;
}

void function_try_all(struct case_file *file) {
  int npoints =
      file->params.dimension == 2 ? TRIES * TRIES : TRIES * TRIES * TRIES;
  for (int i = 0; i < npoints; i++) {
    double x[3] = {0};
    try_point(&file->params, i, TRIES, x);
    if (file->params.boundary_select != NULL) try_sides(file, x, i);
    for (int k = 0; k < file->nfunctions; k++)
      if (!chooses_boundary(file, &file->functions[k]) &&
          !file->functions[k].is_viscosity)
        check_again(&file->functions[k], x, eval(&file->functions[k], x),
                    eval(&file->functions[k], x));
  }
}

/* Is the shape positive, or not, at a point inside the box? */
static bool finds(const struct case_file *file, bool grains) {
  const struct params *params = &file->params;
  const int n = params->dimension == 2 ? 257 : 41;
  const int npoints = params->dimension == 2 ? n * n : n * n * n;
  for (int i = 0; i < npoints; i++) {
    double x[3] = {0};
    try_point(params, i, n, x);
    for (int d = 0; d < params->dimension; d++) {
      const double width = params->size * params->trees[d];
      x[d] += 1e-3 * (params->origin[d] + 0.5 * width - x[d]);
    }
    if ((eval(params->shape.context, x) > 0) == grains) return true;
  }
  return false;
}

bool case_finds_grains(const struct case_file *file) {
  return file->params.shape.eval == NULL ||
         params_bring_grains(&file->params) || finds(file, true);
}

bool case_finds_gas(const struct case_file *file) {
  return file->params.shape.eval != NULL && finds(file, false);
}
