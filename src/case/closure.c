/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Closures: {"mu_i", mu_s = 0.32, ...}, checked against the keys of the model;
 * {"user", viscosity = function(shear_rate, pressure, time) ... end}. */
#include <math.h>
#include <string.h>

#include "case_file.h"
#include "talus/rheology.h"

enum { REGULARISATIONS = 4 };

static const struct rheology_model *read_model(struct case_file *file,
                                               const struct key *key) {
  lua_State *L = file->L;
  if (lua_istable(L, -1))
    lua_rawgeti(L, -1, 1);
  else
    lua_pushvalue(L, -1);
  const char *names[CASE_MAX_NAMES];
  int n = 0;
  for (; n < CASE_MAX_NAMES && rheology_get(n) != NULL; n++)
    names[n] = rheology_get(n)->name;
  char known[1024];
  read_suggest(lua_type(L, -1) == LUA_TSTRING ? lua_tostring(L, -1) : "", n,
               names, sizeof known, known);
  if (lua_type(L, -1) != LUA_TSTRING)
    read_fail(file, key->path,
              "the first element must name a closure, as in {\"mu_i\", d = "
              "0.01}%s",
              known);
  const struct rheology_model *model = rheology_find(lua_tostring(L, -1));
  if (model == NULL) read_fail(file, key->path, "no such closure%s", known);
  lua_pop(L, 1);
  return model;
}

/* Check that the table of a closure holds only the keys of its model,
 * `regularisation` and, if it is the user's, `viscosity`. */
static void check_names(struct case_file *file, const struct key *key,
                        const struct rheology_model *model) {
  const char *names[CASE_MAX_NAMES];
  const struct rheology_key *known;
  int n = 0;
  while (n < CASE_MAX_NAMES - 2 && (known = rheology_key(model, n)) != NULL)
    names[n++] = known->name;
  names[n++] = "regularisation";
  if (model->eval == NULL) names[n++] = "viscosity";
  if (lua_istable(file->L, -1)) read_known_only(file, key->path, n, names, 1);
}

/* Push the option `name` of the closure on top, nil if it is a bare name. */
static void push_option(lua_State *L, const char *name) {
  if (lua_istable(L, -1))
    lua_getfield(L, -1, name);
  else
    lua_pushnil(L);
}

/* Does the table of the closure on top give a cohesion? */
static bool is_cohesive(lua_State *L) {
  push_option(L, "cohesion");
  const bool given = !lua_isnil(L, -1);
  const bool none = lua_type(L, -1) == LUA_TNUMBER && lua_tonumber(L, -1) == 0;
  lua_pop(L, 1);
  return given && !none;
}

/* Refuse a regularisation of a yield stress that is not there. */
static void check_regularisation(struct case_file *file, const char *closure,
                                 const struct rheology *rheology, bool yields) {
  const char *name = rheology_regularisation_name(rheology->regularisation);
  if (yields || rheology->regularisation == RHEOLOGY_CLIP ||
      rheology->regularisation == RHEOLOGY_EXACT) /* its words come later */
    return;
  read_fail_at(file, closure,
               "%s: regularisation = \"%s\" has no meaning, as %s has no yield "
               "stress that it could regularise: take it out, or give cohesion",
               closure, name, rheology->model->name);
}

/* Read the regularisation. Grains that hold a stress at rest have an exact one
 * unless the case says otherwise. */
static void read_regularisation(struct case_file *file, const char *closure,
                                bool grains, struct rheology *rheology) {
  lua_State *L = file->L;
  char path[PATH_LENGTH];
  path_join(path, closure, "regularisation");
  const bool cohesive = is_cohesive(L);
  if (grains && (rheology->model->holds || cohesive))
    rheology->regularisation = RHEOLOGY_EXACT;
  push_option(L, "regularisation");
  bool given = !lua_isnil(L, -1);
  if (given && (lua_type(L, -1) != LUA_TSTRING ||
                rheology_set_regularisation(rheology, lua_tostring(L, -1)))) {
    const char *names[REGULARISATIONS];
    int n = 0;
    for (; n < REGULARISATIONS && rheology_regularisation_name(n); n++)
      names[n] = rheology_regularisation_name(n);
    char known[VALUE_LENGTH];
    read_suggest(lua_type(L, -1) == LUA_TSTRING ? lua_tostring(L, -1) : "", n,
                 names, sizeof known, known);
    read_fail(file, path, "no such regularisation%s", known);
  }
  lua_pop(L, 1);
  const bool yields = rheology->model->yield != NULL || cohesive;
  check_regularisation(file, closure, rheology, yields);
  if (!given && !yields && !rheology->model->holds) return;
  rows_add(file, path, rheology_regularisation_name(rheology->regularisation),
           "", "how a yield stress becomes a viscosity at small shear rates",
           given ? "case" : "default");
}

/* Read the function of the closure `user`. */
static void read_viscosity(struct case_file *file, const char *closure,
                           struct rheology *rheology) {
  lua_State *L = file->L;
  char path[PATH_LENGTH];
  path_join(path, closure, "viscosity");
  push_option(L, "viscosity");
  if (lua_isnil(L, -1))
    read_fail_at(file, closure,
                 "%s is missing: a function(shear_rate, pressure, time)", path);
  if (!lua_isfunction(L, -1))
    read_fail(file, path,
              "a function(shear_rate, pressure, time) is needed (Pa s)");
  function_set_viscosity(
      function_keep(file, path, "Pa s", "viscosity, a function of the case", 1),
      rheology);
}

/* Call it where most of what can go wrong does so: at rest, without pressure,
 * and at extremes of both. */
static void try_viscosity(const struct rheology *rheology) {
  static const double TRIED[] = {0, 1e-300, 1e-9, 1e-3, 1, 1e3, 1e9};
  enum { N = sizeof TRIED / sizeof *TRIED };
  double p[N], eta[N];
  for (int k = 0; k < N; k++) {
    for (int i = 0; i < N; i++) p[i] = TRIED[k];
    rheology_eval(rheology, 0, N, TRIED, p, eta);
  }
}

static void read_key(struct case_file *file, const char *closure,
                     struct phase *phase, int i) {
  const struct rheology_key *known = rheology_key(phase->rheology.model, i);
  lua_State *L = file->L;
  char path[PATH_LENGTH], number[32];
  path_join(path, closure, known->name);
  const char *unit = strcmp(known->unit, "1") == 0 ? "" : known->unit;
  struct key key = {.path = path,
                    .type = KEY_NUMBER,
                    .low = known->min,
                    .high = known->max,
                    .help = known->help};
  push_option(L, known->name);
  bool given = !lua_isnil(L, -1);
  double value = known->initial;
  /* The bulk density is that of the phase unless the case says otherwise. */
  if (strcmp(known->name, "rho") == 0) value = phase->density;
  if (given) value = read_number(file, &key, path);
  if (!given) lua_pop(L, 1);
  if (isnan(value)) {
    char allowed[VALUE_LENGTH];
    keys_allowed(&key, file->params.dimension, sizeof allowed, allowed);
    read_fail_at(file, path, "%s is missing: %s (%s)", path, allowed,
                 known->help);
  }
  const bool exact = phase->rheology.regularisation == RHEOLOGY_EXACT;
  const bool clip = phase->rheology.regularisation == RHEOLOGY_CLIP;
  const bool rate = strcmp(known->name, "gamma_r") == 0;
  if (exact && (rate || strcmp(known->name, "eta_max") == 0)) {
    if (given)
      read_fail_at(
          file, path,
          "%s = %g has no meaning with regularisation = \"exact\", the "
          "default of %s, which caps nothing: take it out, or say "
          "regularisation = \"%s\"",
          path, value, phase->rheology.model->name,
          rate ? "papanastasiou" : "clip");
    return;
  }
  if (clip && rate && given)
    read_fail_at(file, path,
                 "%s = %g has no meaning with regularisation = \"clip\": take "
                 "it out, or take \"papanastasiou\" or "
                 "\"bercovier_engelman\"",
                 path, value);
  if (rheology_set(&phase->rheology, known->name, value) != 0)
    read_fail_at(file, path,
                 "%s.density = %g: %s, which it is unless the case gives "
                 "another, must be from %g to %g: take other units, or give it",
                 phase == &file->params.gas ? "gas" : "grains", value, path,
                 known->min, known->max);
  if (!given && strcmp(known->name, "cohesion") == 0) return;
  /* Nothing depends on the shear rate of a regularisation that is not used. */
  if (rate && clip) return;
  text_number(value, sizeof number, number);
  rows_add(file, path, number, unit, known->help, given ? "case" : "default");
}

void closure_read(struct case_file *file, const struct key *key) {
  lua_State *L = file->L;
  struct phase *phase = (struct phase *)((char *)&file->params + key->offset);
  const struct rheology_model *model = read_model(file, key);
  rheology_init(&phase->rheology, model);
  check_names(file, key, model);
  rows_add(file, key->path, model->name, "", model->title, "case");
  if (model->eval == NULL) read_viscosity(file, key->path, &phase->rheology);
  read_regularisation(file, key->path, phase == &file->params.grains,
                      &phase->rheology);
  for (int i = 0; rheology_key(model, i) != NULL; i++)
    read_key(file, key->path, phase, i);
  if (phase->rheology.regularisation == RHEOLOGY_EXACT &&
      phase == &file->params.gas)
    read_fail_at(file, key->path,
                 "%s: regularisation = \"exact\" is for the grains; take "
                 "\"clip\" for the gas",
                 key->path);
  if (phase->rheology.regularisation == RHEOLOGY_EXACT &&
      !rheology_yields(&phase->rheology))
    read_fail_at(
        file, key->path,
        "%s: regularisation = \"exact\" needs a stress that holds grains at "
        "rest, and %s has none: take \"clip\", another closure, or give "
        "cohesion",
        key->path, model->name);
  if (phase->rheology.eta_min > phase->rheology.eta_max)
    read_fail_at(file, key->path, "%s: eta_min = %g is above eta_max = %g",
                 key->path, phase->rheology.eta_min, phase->rheology.eta_max);
  const char *wrong = rheology_prepare(&phase->rheology);
  if (wrong != NULL) read_fail_at(file, key->path, "%s: %s", key->path, wrong);
  if (model->eval == NULL) try_viscosity(&phase->rheology);
  lua_pop(L, 1);
}

bool closure_depends_on_pressure(const struct rheology *rheology) {
  static const double PRESSURES[] = {0, 1e-6, 1e-3, 1, 1e3, 1e6};
  enum { N = sizeof PRESSURES / sizeof *PRESSURES };
  struct rheology open = *rheology; /* without bounds that could hide it */
  open.eta_min = 0;
  open.eta_max = 1e30;
  double rate[N], eta[N];
  for (int i = 0; i < N; i++) rate[i] = 1;
  rheology_eval(&open, 0, N, rate, PRESSURES, eta);
  for (int i = 1; i < N; i++)
    if (eta[i] != eta[0]) return true;
  return false;
}
