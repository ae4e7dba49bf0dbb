/* SPDX-License-Identifier: GPL-3.0-or-later */
/* `talus help case`, printed from the same tables that check a case. */
#include <string.h>

#include "case_file.h"
#include "talus/wrap.h"

static const char INTRODUCTION[] =
    "A case is a Lua 5.4 file that returns one table:\n"
    "\n"
    "  local a = param(\"a\", 2, \"aspect ratio\")  -- `a=3` on the command\n"
    "                                           -- line overrides it\n"
    "  return {\n"
    "    dimension = 2,\n"
    "    domain = { size = 8, level = 7 },\n"
    "    gravity = { 0, -1 },\n"
    "    grains = {\n"
    "      density = 1,\n"
    "      rheology = { \"mu_i\", mu_s = 0.32, d = 0.02 },\n"
    "      shape = function(x, y) return math.min(1 - x, a - y) end,\n"
    "    },\n"
    "    gas = { density = 1e-3, rheology = { \"newtonian\", eta = 1e-4 } },\n"
    "    boundary = {\n"
    "      left = \"symmetry\", right = \"no_slip\", bottom = \"no_slip\",\n"
    "      top = { \"outflow\", pressure = 0 },\n"
    "    },\n"
    "    adapt = { { \"interface\", width = 3 }, { \"inside\" } },\n"
    "    output = { stop = 4, profile_times = { 1, 2 } },\n"
    "  }\n"
    "\n"
    "It may use math, string, table, utf8 and plain Lua, but no files, "
    "programs or\n"
    "modules; print() goes to the terminal. Units are SI here, but any "
    "consistent set\n"
    "will do. A thing with options is { \"name\", option = value }; without "
    "options the\n"
    "name is enough. Functions of position take x, y and, in 3D, z, and depend "
    "on them\n"
    "alone: ranks and steps ask in any order. The value that param() gives may "
    "be a\n"
    "number, a text, true or false, or a list of numbers.\n";

static void print_wrapped(FILE *f, int indent, const char *text) {
  fprintf(f, "%*s", indent, "");
  wrap_print(f, indent, text);
}

/* Write what a key asks for: "a number > 0, m, needed". */
static void conditions(const struct key *key, size_t size, char *text) {
  char allowed[VALUE_LENGTH], end[VALUE_LENGTH] = "optional";
  keys_allowed(key, 0, sizeof allowed, allowed);
  if (key->type == KEY_SIDE)
    snprintf(allowed, sizeof allowed, "a boundary or a function of position");
  if (key->fallback == NULL)
    snprintf(end, sizeof end, "needed");
  else if (strcmp(key->fallback, "inf") == 0)
    snprintf(end, sizeof end, "default none");
  else if (*key->fallback != '\0')
    snprintf(end, sizeof end, "default %s", key->fallback);
  bool unit = key->unit != NULL && *key->unit != '\0';
  snprintf(text, size, "%.100s%s%.20s, %.100s", allowed, unit ? ", " : "",
           unit ? key->unit : "", end);
}

static void print_key(FILE *f, int indent, const struct key *key) {
  char text[VALUE_LENGTH], line[2 * VALUE_LENGTH];
  conditions(key, sizeof text, text);
  snprintf(line, sizeof line, "%-26s %s", key->path, text);
  print_wrapped(f, indent, line);
  print_wrapped(f, indent + 4, key->help);
}

static void print_options(FILE *f, const char *name, const char *help,
                          const char *const options[3]) {
  char line[2 * VALUE_LENGTH];
  size_t used = (size_t)snprintf(line, sizeof line, "%-12s %.200s", name, help);
  for (int k = 0; k < 3 && options[k] != NULL; k++)
    used += (size_t)snprintf(line + used, sizeof line - used, "%s%.40s",
                             k > 0 ? ", " : "; takes ", options[k]);
  print_wrapped(f, 2, line);
}

static void print_boundaries(FILE *f) {
  const struct boundary_kind *kind;
  const struct key *option;
  fprintf(f, "\nTypes of boundary\n");
  for (int i = 0; (kind = keys_boundary_kind(i)) != NULL; i++)
    print_options(f, kind->name, kind->help, kind->options);
  for (int i = 0; (option = keys_boundary_option(i)) != NULL; i++)
    print_key(f, 4, option);
  fprintf(
      f,
      "  A side may be a function of position that returns \"no_slip\", "
      "\"slip\" or a name\n"
      "  of boundary.patches, as an outlet in a floor:\n"
      "    bottom = function(x, y) return x < 1 and \"outlet\" or "
      "\"no_slip\" end,\n"
      "    patches = { outlet = { \"outflow\", pressure = 0 } },\n"
      "  The grid is fine where patches meet and at narrow inflows and "
      "outflows\n"
      "  (adapt.opening_level). What flows in is that of the patch as it is; "
      "an outlet\n"
      "  has the faces with their centre in it. `talus check` says what each "
      "covers.\n");
}

static void print_criteria(FILE *f) {
  const struct criterion_kind *kind;
  const struct key *option;
  fprintf(f, "\nCriteria of adaptation\n");
  for (int i = 0; (kind = keys_criterion_kind(i)) != NULL; i++)
    print_options(f, kind->name, kind->help, kind->options);
  for (int i = 0; (option = keys_criterion_option(i)) != NULL; i++)
    print_key(f, 4, option);
}

static void print_closure_key(FILE *f, const struct rheology_key *key) {
  fprintf(f, "      %-16s %s, %s\n", key->name, key->help, key->unit);
}

static const char CREEP[] =
    "  regularisation = \"exact\" is the default of grains with a yield stress "
    "at\n"
    "  rest, cohesion included: where it is not reached they come to rest, "
    "and\n"
    "  run.log and the end of the run say when. It caps nothing, so eta_max "
    "and\n"
    "  gamma_r are refused. mu_i_well_posed has no such stress: its friction "
    "falls\n"
    "  to 0 with the shear rate.\n"
    "  regularisation = \"clip\" cuts the viscosity at eta_max, as most papers "
    "do.\n"
    "  eta_max lets grains that should rest creep at up to\n"
    "    rho g sin(alpha) H^2/(2 eta_max), tan(alpha) = mu_s,\n"
    "  H their height at the start. 5000 rho sin(alpha) sqrt(g H^3) keeps "
    "that\n"
    "  below 1e-4 sqrt(g H). Besides, a skin of a quarter of a cell settles\n"
    "  whatever the cap, as friction vanishes with the pressure at a surface:\n"
    "  the top of a slope of 0.2 (mu_s = 0.38) sinks by that until t = 50\n"
    "  sqrt(H/g) on cells of H/8 and H/16, eta_max = 1e3 and 1e4.\n"
    "  \"papanastasiou\" and \"bercovier_engelman\" are smooth at gamma_r.\n";

static void print_closures(FILE *f) {
  const struct rheology_model *model;
  const struct rheology_key *key;
  fprintf(f,
          "\nClosures (talus rheology lists them with ranges and defaults, "
          "talus rheology\nNAME prints the curve of one)\n");
  for (int i = 0; (model = rheology_get(i)) != NULL; i++) {
    fprintf(f, "  %-12s %s\n", model->name, model->title);
    for (int k = 0; k < model->nkeys; k++)
      print_closure_key(f, &model->keys[k]);
  }
  fprintf(
      f,
      "  user takes a function of the case, called for every face and "
      "step:\n"
      "    rheology = { \"user\", eta_max = 5000, viscosity =\n"
      "      function(shear_rate, pressure, time)\n"
      "        return 0.3 * pressure / math.max(shear_rate, 1e-6) end },\n");
  fprintf(f, "  All of them take\n");
  model = rheology_get(0);
  for (int k = model->nkeys; (key = rheology_key(model, k)) != NULL; k++)
    print_closure_key(f, key);
  fprintf(f, "      %-16s", "regularisation");
  for (int k = 0; rheology_regularisation_name(k) != NULL; k++)
    fprintf(f, "%s%s", k > 0 ? ", " : " ", rheology_regularisation_name(k));
  fprintf(f, "\n  rho is the density of the phase unless given.\n");
  fputs(CREEP, f);
}

static void print_line(FILE *f, const struct key *key) {
  const bool inner = strchr(key->path, '.') != NULL;
  if (!inner) fputs("\n", f);
  if (key->type == KEY_SECTION)
    fprintf(f, "%s: %s%s\n", key->path, key->help,
            key->fallback == NULL ? "" : " (optional)");
  else
    print_key(f, inner ? 2 : 0, key);
}

/* Print the keys that a model has instead of those of the first one. */
static void print_model(FILE *f, const struct model_keys *model) {
  const struct key *key;
  fprintf(f, "\nKeys of model = \"%s\" (%s)", model->name, model->title);
  fprintf(f, " instead of\nthose of \"%s\"", models_keys(0)->name);
  for (int k = 0; k < models_keys(0)->nkeys; k++)
    fprintf(f, "%s%s", k == 0 ? ", " : " ", models_keys(0)->keys[k].path);
  fputs("\n", f);
  for (int k = 0; (key = model_key(model, k)) != NULL; k++) print_line(f, key);
}

void case_help(FILE *f) {
  const struct key *key;
  const struct model_keys *model;
  fputs(INTRODUCTION, f);
  for (int i = 0; (key = keys_get(models_keys(0), i)) != NULL; i++)
    print_line(f, key);
  for (int k = 1; (model = models_keys(k)) != NULL; k++) print_model(f, model);
  print_closures(f);
  print_boundaries(f);
  print_criteria(f);
}
