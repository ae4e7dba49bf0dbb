/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "keys.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "talus/case.h"

#define AT(member) offsetof(struct params, member)
#define SOME_LEVEL .low = 0, .high = CASE_MAX_LEVEL_2D
/* enum coordinates */
static const char *const COORDINATES[] = {"cartesian", "axisymmetric", NULL};
/* enum criterion_phase */
static const char *const PHASES[] = {"both", "grains", "gas", NULL};

_Static_assert(CASE_MAX_LEVEL_3D == 16 && PARAMS_MAX_TRACERS == 8 &&
                   PARAMS_MAX_CRITERIA == 8 && PARAMS_MAX_TIMES == 256,
               "the help of keys says so");

/* Units are SI; any consistent set will do. clang-format would take three
 * times the lines. */
/* clang-format off */
static const struct key KEYS[] = {
    {"title", KEY_TEXT, KEY_ANY, KEY_OPTIONAL, .unit = "", .offset = AT(title),
     .help = "one line that says what the case is about"},
    {"dimension", KEY_INTEGER, .low = 2, .high = 3, KEY_NEEDED, .unit = "",
     .offset = AT(dimension), .help = "2 or 3"},
    {"coordinates", KEY_CHOICE, KEY_ANY, KEY_DEFAULT "cartesian", .unit = "",
     .offset = AT(coordinates), .choices = COORDINATES,
     .help = "axisymmetric: x is the distance from an axis, y lies along it; "
             "2D, without swirl"},

    {"model", KEY_CHOICE, KEY_ANY, KEY_DEFAULT "two_phase", .unit = "",
     .offset = AT(model), .choices = models_names,
     .help = "what is solved; each model has keys of its own"},

    {"domain", KEY_SECTION, KEY_NEEDED, .help = "the box and its grid"},
    {"domain.size", KEY_NUMBER, KEY_POSITIVE, KEY_NEEDED, .unit = "m",
     .offset = AT(size), .help = "edge of a tree, a square or cube"},
    {"domain.origin", KEY_VECTOR, KEY_ANY, KEY_DEFAULT "0", .unit = "m",
     .offset = AT(origin), .help = "lower corner of the box"},
    {"domain.trees", KEY_INTEGERS, .low = 1, .high = 1000, KEY_DEFAULT "1",
     .unit = "", .offset = AT(trees),
     .help = "trees along each axis, 32767 in all at most"},
    {"domain.level", KEY_LEVEL, .low = 1, .high = CASE_MAX_LEVEL_2D, KEY_NEEDED,
     .unit = "", .offset = AT(level_max),
     .help = "finest grid: size/2^level; at most 16 in 3D"},
    {"domain.level_min", KEY_LEVEL, SOME_LEVEL, KEY_DEFAULT "1", .unit = "",
     .offset = AT(level_min), .help = "coarsest grid: size/2^level_min"},

    {"gravity", KEY_VECTOR, KEY_ANY, KEY_NEEDED, .unit = "m/s^2",
     .offset = AT(gravity), .help = "acceleration"},
    {"grains", KEY_SECTION, KEY_NEEDED, .help = "the granular phase"},
    {"grains.density", KEY_NUMBER, KEY_POSITIVE, KEY_NEEDED, .unit = "kg/m^3",
     .offset = AT(grains.density),
     .help = "bulk density; with model = \"two_fluid\" that of a grain"},
    {"grains.shape", KEY_SHAPE, KEY_OPTIONAL, .unit = "m", .offset = AT(shape),
     .help = "level set at t = 0, positive inside; left out with gas, they "
             "fill the box"},
    {"", KEY_OF_MODEL, .help = ""},
    {"velocity", KEY_VELOCITY, KEY_ANY, KEY_DEFAULT "0", .unit = "m/s",
     .offset = AT(velocity), .help = "at t = 0, of grains and gas"},
    {"tracers", KEY_TRACERS, KEY_OPTIONAL, .unit = "m", .offset = AT(tracer),
     .help = "volumes to be followed, name = shape at t = 0; at most 8"},

    {"boundary", KEY_SECTION, KEY_NEEDED, .help = "what holds on each side"},
    {"boundary.left", KEY_SIDE, KEY_NEEDED, .unit = "", .help = "lower x"},
    {"boundary.right", KEY_SIDE, KEY_NEEDED, .unit = "", .help = "upper x"},
    {"boundary.front", KEY_SIDE, KEY_NEEDED, .unit = "", .help = "lower y, 3D"},
    {"boundary.back", KEY_SIDE, KEY_NEEDED, .unit = "", .help = "upper y, 3D"},
    {"boundary.bottom", KEY_SIDE, KEY_NEEDED, .unit = "",
     .help = "lower y in 2D, lower z in 3D"},
    {"boundary.top", KEY_SIDE, KEY_NEEDED, .unit = "",
     .help = "upper y in 2D, upper z in 3D"},
    {"boundary.patches", KEY_PATCHES, KEY_OPTIONAL, .unit = "",
     .help = "boundaries by name, for sides that are functions"},

    {"adapt", KEY_CRITERIA, KEY_OPTIONAL, .unit = "",
     .help = "list of at most 8 criteria, the finest wins; without it the "
             "grid is uniform"},
    {"adapt.every", KEY_INTEGER, .low = 0, .high = 1e6, KEY_DEFAULT "0",
     .unit = "steps", .offset = AT(adapt_every),
     .help = "steps between adaptations at most; 0: when the flow needs it"},
    {"adapt.opening_level", KEY_LEVEL, SOME_LEVEL, KEY_DEFAULT "domain.level",
     .unit = "", .offset = AT(opening_level),
     .help = "of faces where boundaries meet on a side, and of narrow "
             "inflows and outflows"},
    {"adapt.max_cells", KEY_COUNT, .low = 1, .high = 1e15, KEY_DEFAULT "1e8",
     .unit = "cells", .offset = AT(max_cells),
     .help = "no refinement beyond this number"},

    {"solver", KEY_SECTION, KEY_OPTIONAL, .help = "the numerical method"},
    {"solver.cfl", KEY_NUMBER, .low = 0, .high = 1, .above = true,
     KEY_DEFAULT "0.7", .unit = "", .offset = AT(cfl),
     .help = "bound on sum |u_f| A dt/(2 V)"},
    {"solver.dt_max", KEY_NUMBER, KEY_POSITIVE, KEY_DEFAULT "inf", .unit = "s",
     .offset = AT(dt_max), .help = "longest time step"},
    {"solver.tolerance", KEY_NUMBER, .low = 0, .high = 0.1, .above = true,
     KEY_DEFAULT "1e-4", .unit = "", .offset = AT(tolerance_pressure),
     .help = "of both solvers; 1e-4 collapse, 1e-8 analytic, 1e-12 at rest"},
    {"solver.tolerance_pressure", KEY_NUMBER, .low = 0, .high = 0.1,
     .above = true, KEY_DEFAULT "solver.tolerance", .unit = "",
     .offset = AT(tolerance_pressure), .help = "max |div u| dt"},
    {"solver.tolerance_viscous", KEY_NUMBER, .low = 0, .high = 0.1,
     .above = true, KEY_DEFAULT "solver.tolerance", .unit = "",
     .offset = AT(tolerance_viscous),
     .help = "max |dt r/rho|, relative to the speed"},
    {"solver.max_iterations", KEY_INTEGER, .low = 1, .high = 1e6,
     KEY_DEFAULT "100", .unit = "", .offset = AT(max_iterations),
     .help = "of one linear solve"},

    {"output", KEY_SECTION, KEY_NEEDED, .help = "when to end and what to write"},
    {"output.stop", KEY_NUMBER, KEY_POSITIVE, KEY_NEEDED, .unit = "s",
     .offset = AT(stop), .help = "time of the end"},
    {"output.stop_at_rest", KEY_SECTION, KEY_OPTIONAL,
     .help = "end before that, when the grains have come to rest"},
    {"output.stop_at_rest.speed", KEY_NUMBER, KEY_POSITIVE, KEY_NEEDED, .unit = "m/s",
     .offset = AT(rest_speed),
     .help = "at rest: the fastest leaf more than half full of grains is "
             "slower; above the creep that run.log tells"},
    {"output.stop_at_rest.time", KEY_NUMBER, KEY_POSITIVE, KEY_NEEDED, .unit = "s",
     .offset = AT(rest_time),
     .help = "for this long without a break; longer than they take to set off"},
    {"output.length_scale", KEY_NUMBER, KEY_POSITIVE, KEY_DEFAULT "1", .unit = "m",
     .offset = AT(length_scale),
     .help = "a length of the problem, for reading and pictures only"},
    {"output.profile_times", KEY_TIMES, .low = 0, .high = INFINITY, KEY_OPTIONAL,
     .unit = "s", .help = "times of outlines in profile.csv, at most 256"},
    {"output.front_height", KEY_NUMBER, KEY_NOT_NEGATIVE, KEY_DEFAULT "0",
     .unit = "m", .offset = AT(front_height),
     .help = "of the heap where its front is; 0: half the finest cell, or half "
             "a grain in models that know it; the same for grids to compare"},
    {"output.snapshot_every", KEY_NUMBER, KEY_NOT_NEGATIVE, KEY_DEFAULT "0",
     .unit = "s", .offset = AT(snapshot_every),
     .help = "time between snapshots; 0: the first and the last only"},
    {"output.series_every", KEY_INTEGER, .low = 1, .high = 1e9, KEY_DEFAULT "1",
     .unit = "steps", .offset = AT(series_every),
     .help = "steps between rows of series.csv"},
    {"output.checkpoint_every", KEY_NUMBER, KEY_NOT_NEGATIVE, KEY_DEFAULT "600",
     .unit = "s", .offset = AT(checkpoint_every),
     .help = "wall-clock time between checkpoints; 0: at the end only"},

    {"expect", KEY_EXPECT, KEY_OPTIONAL, .unit = "",
     .help = "for make examples-check: run = \"name=value ...\" and, for "
             "columns of the last row of series.csv, {least, most}"},
};

static const struct boundary_kind BOUNDARY_KINDS[] = {
    {"no_slip", BOUNDARY_NO_SLIP, {"velocity"}, NULL,
     "wall, at rest or moving tangentially"},
    {"slip", BOUNDARY_SLIP, {NULL}, NULL, "wall without friction"},
    {"symmetry", BOUNDARY_SLIP, {NULL}, NULL, "mirror, the same as slip"},
    {"navier_slip", BOUNDARY_NAVIER, {"slip_length"}, "slip_length",
     "wall, u = slip_length du/dn"},
    {"slip_strip", BOUNDARY_STRIP, {"length"}, "length",
     "wall at rest, but for `length` ahead of the grains without friction for "
     "the gas"},
    {"outflow", BOUNDARY_OUTFLOW, {"pressure"}, NULL,
     "open, with this pressure; what flows in is gas"},
    {"inflow", BOUNDARY_INFLOW, {"velocity", "fraction"}, "velocity",
     "open, with this velocity"},
    {"periodic", BOUNDARY_PERIODIC, {NULL}, NULL,
     "joined with the opposite side, which must say so too"},
};

#undef AT
#define AT(member) offsetof(struct boundary, member)
static const struct key BOUNDARY_OPTIONS[] = {
    {"velocity", KEY_VECTOR, KEY_ANY, KEY_DEFAULT "0", .unit = "m/s",
     .offset = AT(velocity), .help = "velocity at the boundary"},
    {"pressure", KEY_NUMBER, KEY_ANY, KEY_DEFAULT "0", .unit = "Pa",
     .offset = AT(pressure), .help = "pressure at the boundary"},
    {"slip_length", KEY_NUMBER, KEY_NOT_NEGATIVE, KEY_NEEDED, .unit = "m",
     .offset = AT(slip_length), .help = "depth at which u would vanish"},
    {"length", KEY_NUMBER, KEY_NOT_NEGATIVE, KEY_NEEDED, .unit = "m",
     .offset = AT(strip), .help = "of the smooth strip ahead of the grains, a "
     "few of their diameters"},
    {"fraction", KEY_NUMBER, .low = 0, .high = 1, KEY_DEFAULT "0", .unit = "",
     .offset = AT(fraction), .help = "volume fraction of grains carried in"},
};

static const struct criterion_kind CRITERION_KINDS[] = {
    {"interface", CRITERION_INTERFACE, {"width", "level", "only"},
     "the surface of the grains and cells around it"},
    {"inside", CRITERION_INSIDE, {"level"}, "all of the grains"},
    {"velocity", CRITERION_ESTIMATE, {"threshold", "level", "only"},
     "where the wavelet estimate of the velocity's error is large"},
    {"position", CRITERION_FUNCTION, {"level", "only"},
     "level = function of position, constant in time"},
};

#undef AT
#define AT(member) offsetof(struct criterion, member)
static const struct key CRITERION_OPTIONS[] = {
    {"width", KEY_NUMBER, .low = 0, .high = 1000, .above = true, KEY_DEFAULT "3",
     .unit = "cells", .offset = AT(width),
     .help = "cells on either side of the surface"},
    {"threshold", KEY_NUMBER, KEY_POSITIVE, KEY_NEEDED, .unit = "m/s",
     .offset = AT(threshold), .help = "largest error left alone"},
    {"level", KEY_LEVEL, SOME_LEVEL, KEY_DEFAULT "domain.level", .unit = "",
     .offset = AT(level), .help = "finest level asked for"},
    {"only", KEY_CHOICE, KEY_ANY, KEY_DEFAULT "both", .unit = "", .offset = AT(only),
     .choices = PHASES,
     .help = "where it applies: in leaves that hold some of this phase and "
             "those beside them"},
};
/* clang-format on */

#define GET(array, i)                                                      \
  ((i) >= 0 && (size_t)(i) < sizeof(array) / sizeof *(array) ? &(array)[i] \
                                                             : NULL)

const struct key *keys_get(const struct model_keys *model, int i) {
  int mark = 0;
  while (KEYS[mark].type != KEY_OF_MODEL) mark++;
  if (i < mark) return &KEYS[i];
  const struct key *own = model_key(model, i - mark);
  return own != NULL ? own : GET(KEYS, i - model->nkeys - model->nmore + 1);
}

bool keys_takes(const struct model_keys *model, const char *path) {
  for (int k = 0; model->refused != NULL && model->refused[k] != NULL; k++) {
    const size_t n = strlen(model->refused[k]);
    const bool same = strncmp(path, model->refused[k], n) == 0;
    if (same && (path[n] == '\0' || path[n] == '.')) return false;
  }
  return true;
}

const char *keys_meant(const char *word) {
  static const struct {
    const char *word, *key;
  } MEANT[] = {{"axisymmetric", "coordinates = \"axisymmetric\""},
               {"axisymmetry", "coordinates = \"axisymmetric\""},
               {"axi", "coordinates = \"axisymmetric\""},
               {"cylindrical", "coordinates = \"axisymmetric\""}};
  for (size_t k = 0; k < sizeof MEANT / sizeof *MEANT; k++)
    if (strcmp(MEANT[k].word, word) == 0) return MEANT[k].key;
  return NULL;
}

const struct key *keys_find(const struct model_keys *model, const char *path) {
  const struct key *key;
  if (!keys_takes(model, path)) return NULL;
  for (int i = 0; (key = keys_get(model, i)) != NULL; i++)
    if (strcmp(key->path, path) == 0) return key;
  return NULL;
}

const struct boundary_kind *keys_boundary_kind(int i) {
  return GET(BOUNDARY_KINDS, i);
}

const struct key *keys_boundary_option(int i) {
  return GET(BOUNDARY_OPTIONS, i);
}

const struct criterion_kind *keys_criterion_kind(int i) {
  return GET(CRITERION_KINDS, i);
}

const struct key *keys_criterion_option(int i) {
  return GET(CRITERION_OPTIONS, i);
}

const char *keys_side_name(int dimension, int side) {
  static const char *const NAMES[2][6] = {
      {"left", "right", "bottom", "top", NULL, NULL},
      {"left", "right", "front", "back", "bottom", "top"}};
  return side >= 0 && side < 6 ? NAMES[dimension == 3][side] : NULL;
}

/* Write a range: " > 0", " from 1 to 24". */
static void range_text(const struct key *key, size_t size, char *text) {
  const char *above = key->above ? ">" : ">=";
  if (isfinite(key->high) && isfinite(key->low) && !key->above)
    snprintf(text, size, " from %g to %g", key->low, key->high);
  else if (isfinite(key->high) && isfinite(key->low))
    snprintf(text, size, " > %g and <= %g", key->low, key->high);
  else if (isfinite(key->low))
    snprintf(text, size, " %s %g", above, key->low);
  else
    snprintf(text, size, "%s", "");
}

static void choices_text(const char *const *choices, size_t size, char *text) {
  size_t used = 0;
  for (int k = 0; choices[k] != NULL && used < size; k++) {
    const char *before = k == 0 ? "" : choices[k + 1] ? ", " : " or ";
    used += (size_t)snprintf(text + used, size - used, "%s\"%s\"", before,
                             choices[k]);
  }
}

void keys_allowed(const struct key *key, int dimension, size_t size,
                  char *text) {
  char range[64];
  range_text(key, sizeof range, range);
  const char *axes = dimension == 2 ? "2 " : dimension == 3 ? "3 " : "";
  const char *at = dimension == 3 ? "x, y, z" : "x, y";
  switch (key->type) {
    case KEY_NUMBER:
      snprintf(text, size, "a number%s", range);
      break;
    case KEY_INTEGER:
    case KEY_COUNT:
    case KEY_LEVEL:
      snprintf(text, size, "an integer%s", range);
      break;
    case KEY_VECTOR:
      snprintf(text, size, "a list of %snumbers", axes);
      break;
    case KEY_INTEGERS:
      snprintf(text, size, "a list of %sintegers%s", axes, range);
      break;
    case KEY_TEXT:
      snprintf(text, size, "a text");
      break;
    case KEY_CHOICE:
      choices_text(key->choices, size, text);
      break;
    case KEY_TIMES:
      snprintf(text, size, "a list of times >= 0");
      break;
    case KEY_SHAPE:
      snprintf(text, size, "a function(%s)", at);
      break;
    case KEY_VELOCITY:
      snprintf(text, size, "%snumbers or a function(%s)", axes, at);
      break;
    case KEY_CLOSURE:
      snprintf(text, size, "{\"closure\", key = value, ...}");
      break;
    case KEY_SIDE:
      snprintf(text, size,
               "\"type\", {\"type\", option = value} or a function(%s)", at);
      break;
    case KEY_PRESSURE:
      snprintf(text, size,
               "a number, {number, at = \"gas\"} or {number, at = {%s}}", at);
      break;
    case KEY_CRITERIA:
      snprintf(text, size, "a list of {\"criterion\", option = value}");
      break;
    case KEY_TRACERS:
    case KEY_PATCHES:
    case KEY_EXPECT:
    case KEY_SECTION:
    case KEY_OF_MODEL:
      snprintf(text, size, "a table");
      break;
  }
}
