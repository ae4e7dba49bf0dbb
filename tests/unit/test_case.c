/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Case files and what they become; tests/case/bad_input.sh has bad ones.
 */
#include "talus/case.h"

#include <check.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "../../src/case/library.h"
#include "../../src/case/sandbox.h"
#include "../../src/case/source.h"
#include "talus/error.h"
#include "talus/memory.h"
#include "talus/spelling.h"

Suite *case_suite(void);

enum { TEXT_LENGTH = 32768 };

/* A sound case in pieces, so that a test can put something else in. */
#define DOMAIN "dimension = 2, domain = { size = 4, level = 5 },\n"
#define GRAVITY "gravity = { 0, -1 },\n"
#define PHASES                                                      \
  "grains = { density = 2, rheology = { 'mu_i', d = 0.05 },\n"      \
  "  shape = function(x, y) return math.min(1 - x, 2 - y) end },\n" \
  "gas = { density = 1e-3, rheology = { 'newtonian', eta = 1e-4 } },\n"
#define SIDES                                                                \
  "boundary = { left = 'symmetry', right = 'no_slip', bottom = 'no_slip',\n" \
  "  top = { 'outflow', pressure = -0.5 } },\n"
#define OUTPUT "output = { stop = 3 },\n"
#define REST DOMAIN GRAVITY PHASES SIDES OUTPUT

static struct case_file *load(const char *text) {
  return case_load_text("dir/test.lua", text, 0, NULL);
}

static struct case_file *load_with(const char *text, const char *override) {
  char word[256];
  strcpy(word, override);
  char *words[] = {word};
  return case_load_text("dir/test.lua", text, 1, words);
}

/* Write what `print` says about a case into `text`. */
static void printed(const struct case_file *file,
                    void (*print)(const struct case_file *, FILE *),
                    char text[TEXT_LENGTH]) {
  FILE *f = tmpfile();
  ck_assert_ptr_nonnull(f);
  print(file, f);
  rewind(f);
  size_t n = fread(text, 1, TEXT_LENGTH - 1, f);
  text[n] = '\0';
  fclose(f);
}

START_TEST(case_fills_params_and_defaults) {
  struct case_file *file = load("return { title = 'A heap',\n" REST "}");
  const struct params *params = case_params(file);
  ck_assert_str_eq(params->name, "test");
  ck_assert_str_eq(params->title, "A heap");
  ck_assert_int_eq(params->dimension, 2);
  ck_assert_double_eq(params->size, 4);
  ck_assert_int_eq(params->level_max, 5);
  ck_assert_int_eq(params->level_min, 1);
  ck_assert_int_eq(params->trees[0], 1);
  ck_assert_double_eq(params->gravity[1], -1);
  ck_assert_double_eq(params->grains.density, 2);
  ck_assert_str_eq(params->grains.rheology.model->name, "mu_i");
  ck_assert(!params->single_phase);
  ck_assert_int_eq(params->boundary[0].type, BOUNDARY_SLIP);
  ck_assert_int_eq(params->boundary[1].type, BOUNDARY_NO_SLIP);
  ck_assert_int_eq(params->boundary[3].type, BOUNDARY_OUTFLOW);
  ck_assert_double_eq(params->boundary[3].pressure, -0.5);
  ck_assert_int_eq(params->nboundaries, 6);
  ck_assert_ptr_null(params->boundary_select);
  ck_assert_ptr_null(params->velocity[0].eval);
  ck_assert_double_eq(params->cfl, 0.7);
  ck_assert_double_eq(params->tolerance_viscous, 1e-4);
  ck_assert(isinf(params->dt_max));
  ck_assert_double_eq(params->theta, 1);
  ck_assert_int_eq(params->limiter, LIMITER_NONE);
  ck_assert_int_eq(params->advection, ADVECTION_ON);
  ck_assert_double_eq(params->stop, 3);
  ck_assert_int_eq(params->ncriteria, 0);
  case_destroy(file);
  ck_assert_int_eq(mem_live_blocks(), 0);
}
END_TEST

START_TEST(density_of_phase_is_default_of_rho) {
  struct case_file *file = load("return {" REST "}");
  const struct rheology *rheology = &case_params(file)->grains.rheology;
  double rho = 0;
  for (int i = 0; rheology_key(rheology->model, i) != NULL; i++)
    if (strcmp(rheology_key(rheology->model, i)->name, "rho") == 0)
      rho = rheology_value(rheology, i);
  ck_assert_double_eq(rho, 2);
  case_destroy(file);
}
END_TEST

START_TEST(functions_of_position_are_those_of_the_case) {
  struct case_file *file = load(
      "return { velocity = function(x, y) return x, 2 * y end,\n"
      "tracers = { b = function(x, y) return y end,\n"
      "            a = function(x, y) return x end },\n" REST "}");
  const struct params *params = case_params(file);
  const double x[3] = {0.25, 1.5, 7};
  const struct function *f = &params->shape;
  ck_assert_double_eq(f->eval(f->context, x), 0.5);
  f = &params->velocity[0];
  ck_assert_double_eq(f->eval(f->context, x), 0.25);
  f = &params->velocity[1];
  ck_assert_double_eq(f->eval(f->context, x), 3);
  ck_assert_int_eq(params->ntracers, 2);
  ck_assert_str_eq(params->tracer[0].name, "a"); /* by name on all ranks */
  f = &params->tracer[1].shape;
  ck_assert_double_eq(f->eval(f->context, x), 1.5);
  case_destroy(file);
}
END_TEST

START_TEST(viscosity_may_be_a_function_of_the_case) {
  const double gamma[] = {1, 2, 3}, p[] = {4, -5, 6};
  double eta[3];
  struct case_file *file = load(
      "return { dimension = 2, domain = { size = 4, level = 5 },\n"
      "grains = { density = 1, rheology = { 'user', eta_max = 17,\n"
      "  viscosity = function(g, p, t) return g * p + t end } },\n" GRAVITY
          SIDES OUTPUT "}");
  const struct rheology *rheology = &case_params(file)->grains.rheology;
  rheology_eval(rheology, 0.5, 3, gamma, p, eta);
  ck_assert_double_eq(eta[0], 4.5);
  ck_assert_double_eq(eta[1], 0.5); /* negative pressure counts as 0 */
  ck_assert_double_eq(eta[2], 17);  /* bounds hold */
  case_destroy(file);
}
END_TEST

START_TEST(viscosity_that_fails_during_a_run_ends_it) {
  const double gamma = 1, p = 1;
  double eta;
  struct case_file *file = load(
      "return { dimension = 2, domain = { size = 4, level = 5 },\n"
      "grains = { density = 1, rheology = { 'user',\n"
      "  viscosity = function(g, p, t) return 1 - t end } },\n" GRAVITY SIDES
          OUTPUT "}");
  rheology_eval(&case_params(file)->grains.rheology, 2, 1, &gamma, &p, &eta);
}
END_TEST

START_TEST(table_of_a_closure_is_freed_with_the_case) {
  struct case_file *file = load(
      "return { dimension = 2, domain = { size = 4, level = 5 },\n"
      "grains = { density = 1500, rheology = 'lee_huang' },\n" GRAVITY SIDES
          OUTPUT "}");
  ck_assert_ptr_nonnull(case_params(file)->grains.rheology.table);
  case_destroy(file);
  ck_assert_int_eq(mem_live_blocks(), 0);
}
END_TEST

START_TEST(uniform_velocity_is_a_function) {
  struct case_file *file = load("return { velocity = { 3, 4 }," REST "}");
  const struct function *f = &case_params(file)->velocity[1];
  const double x[3] = {0};
  ck_assert_double_eq(f->eval(f->context, x), 4);
  case_destroy(file);
}
END_TEST

START_TEST(function_of_a_side_chooses_a_patch) {
  struct case_file *file =
      load("return {" DOMAIN GRAVITY PHASES OUTPUT
           "boundary = { left = 'symmetry', right = 'no_slip', top = 'slip',\n"
           "bottom = function(x, y)\n"
           "  if x < 1 then return 'outlet' end\n"
           "  return x < 2 and 'slip' or 'no_slip' end,\n"
           "patches = { outlet = { 'outflow', pressure = 1 } } } }");
  const struct params *params = case_params(file);
  const double x[3][3] = {{0.5, 0, 0}, {1.5, 0, 0}, {3, 0, 0}};
  int chosen[3];
  for (int i = 0; i < 3; i++)
    chosen[i] = params->boundary_select(params->boundary_context, 2, x[i]);
  ck_assert_int_ge(chosen[0], 6);
  ck_assert_int_eq(params->boundary[chosen[0]].type, BOUNDARY_OUTFLOW);
  ck_assert_double_eq(params->boundary[chosen[0]].pressure, 1);
  ck_assert_int_ge(chosen[1], 6);
  ck_assert_int_eq(params->boundary[chosen[1]].type, BOUNDARY_SLIP);
  ck_assert_int_eq(chosen[2], 2);
  ck_assert_int_eq(params->boundary[2].type, BOUNDARY_NO_SLIP);
  ck_assert_int_eq(params->boundary_select(params->boundary_context, 1, x[0]),
                   1);
  case_destroy(file);
}
END_TEST

START_TEST(bottom_is_lower_z_in_three_dimensions) {
  struct case_file *file = load(
      "return { dimension = 3, domain = { size = 1, level = 3,\n"
      "  trees = { 1, 2, 3 } }, gravity = { 0, 0, -1 },\n"
      "grains = { density = 1, rheology = { 'newtonian', eta = 1 } },\n"
      "boundary = { left = 'periodic', right = 'periodic',\n"
      "  front = 'slip', back = { 'navier_slip', slip_length = 0.1 },\n"
      "  bottom = 'no_slip', top = { 'no_slip', velocity = { 1, 2, 0 } } },\n"
      "output = { stop = 1 } }");
  const struct params *params = case_params(file);
  const enum boundary_type types[6] = {BOUNDARY_PERIODIC, BOUNDARY_PERIODIC,
                                       BOUNDARY_SLIP,     BOUNDARY_NAVIER,
                                       BOUNDARY_NO_SLIP,  BOUNDARY_NO_SLIP};
  for (int side = 0; side < 6; side++)
    ck_assert_int_eq(params->boundary[side].type, types[side]);
  ck_assert_double_eq(params->boundary[3].slip_length, 0.1);
  ck_assert_double_eq(params->boundary[5].velocity[1], 2);
  ck_assert_int_eq(params->trees[2], 3);
  ck_assert(params->single_phase);
  ck_assert(!params->pressure_level_given);
  case_destroy(file);
}
END_TEST

static const char *const LIMITER_NAME[] = {"none", "minmod",
                                           "generalised_minmod"};
START_TEST(limiter_is_read_by_name) {
  char text[1024], printed_text[TEXT_LENGTH], row[64];
  snprintf(text, sizeof text,
           "return { solver = { limiter = '%s' },\n" REST "}",
           LIMITER_NAME[_i]);
  struct case_file *file = load(text);
  ck_assert_int_eq(case_params(file)->limiter, _i);
  printed(file, case_write_parameters, printed_text);
  snprintf(row, sizeof row, "\nsolver.limiter,%s,,case\n", LIMITER_NAME[_i]);
  ck_assert_ptr_nonnull(strstr(printed_text, row));
  case_destroy(file);
}
END_TEST

START_TEST(advection_may_be_switched_off) {
  struct case_file *file =
      load("return { solver = { advection = 'off' },\n" REST "}");
  ck_assert_int_eq(case_params(file)->advection, ADVECTION_OFF);
  case_destroy(file);
}
END_TEST

START_TEST(other_limiters_are_refused) {
  load(_i ? "return { solver = { limiter = 'Minmod' },\n" REST "}"
          : "return { solver = { limiter = 1 },\n" REST "}");
}
END_TEST

/* Closed boxes ask for a pressure level when friction needs the pressure. */
START_TEST(friction_without_pressure_level_is_refused) {
  load("return { dimension = 2, domain = { size = 1, level = 3 },\n" GRAVITY
       "grains = { density = 1, rheology = { 'coulomb', mu_s = 1 } },\n"
       "boundary = { left = 'slip', right = 'slip', bottom = 'no_slip',\n"
       "  top = 'slip' }, output = { stop = 1 } }");
}
END_TEST

START_TEST(pressure_level_is_enough) {
  struct case_file *file =
      load("return { dimension = 2, domain = { size = 1, level = 3 },\n" GRAVITY
           "grains = { density = 1, rheology = { 'coulomb', mu_s = 1 } },\n"
           "boundary = { left = 'slip', right = 'slip', bottom = 'no_slip',\n"
           "  top = 'slip', pressure_level = 5 }, output = { stop = 1 } }");
  ck_assert(case_params(file)->pressure_level_given);
  ck_assert_double_eq(case_params(file)->pressure_level, 5);
  case_destroy(file);
}
END_TEST

/* Words after the box, where the level then holds, and its value. */
static const struct {
  const char *text;
  enum pressure_at at;
  double level;
} PRESSURES[] = {
    {"", PRESSURE_AT_GAS, 0},
    {", pressure_level = 5", PRESSURE_AT_BOX, 5},
    {", pressure_level = { 5, at = 'box' }", PRESSURE_AT_BOX, 5},
    {", pressure_level = { 5, at = 'gas' }", PRESSURE_AT_GAS, 5},
    {", pressure_level = { -2, at = { 4, 0.5 } }", PRESSURE_AT_POINT, -2}};
START_TEST(closed_box_takes_its_pressure_somewhere) {
  char text[2048], printed_text[TEXT_LENGTH];
  snprintf(text, sizeof text,
           "return { " DOMAIN GRAVITY PHASES OUTPUT
           "boundary = { left = 'slip', right = 'slip', bottom = 'no_slip',\n"
           "  top = 'slip'%s } }",
           PRESSURES[_i].text);
  struct case_file *file = load(text);
  const struct params *params = case_params(file);
  ck_assert_int_eq(params->pressure_at, PRESSURES[_i].at);
  ck_assert_double_eq(params->pressure_level, PRESSURES[_i].level);
  ck_assert_int_eq(params->pressure_level_given, _i > 0);
  if (params->pressure_at == PRESSURE_AT_POINT) {
    ck_assert_double_eq(params->pressure_point[0], 4);
    ck_assert_double_eq(params->pressure_point[1], 0.5);
  }
  printed(file, case_write_parameters, printed_text);
  ck_assert_ptr_nonnull(strstr(printed_text, "boundary.pressure_level.at,"));
  case_destroy(file);
}
END_TEST

START_TEST(criteria_take_level_of_domain_by_default) {
  struct case_file *file = load(
      "param('both', 3) -- named like the default of a choice\n"
      "return { adapt = { { 'interface', width = 2.5 }, 'inside',\n"
      "  { 'velocity', threshold = 0.1, level = 4 },\n"
      "  { 'position', only = 'gas', level = function(x, y) return 3 + x end "
      "},\n"
      "  every = 7, max_cells = 1e4 },\n" REST "}");
  const struct params *params = case_params(file);
  const double x[3] = {1, 0, 0};
  ck_assert_int_eq(params->ncriteria, 4);
  ck_assert_int_eq(params->criterion[0].type, CRITERION_INTERFACE);
  ck_assert_double_eq(params->criterion[0].width, 2.5);
  ck_assert_int_eq(params->criterion[0].level, 5);
  ck_assert_int_eq(params->criterion[1].type, CRITERION_INSIDE);
  ck_assert_int_eq(params->criterion[2].level, 4);
  ck_assert_int_eq(params->criterion[2].only, CRITERION_BOTH);
  ck_assert_int_eq(params->criterion[3].only, CRITERION_GAS);
  const struct function *f = &params->criterion[3].function;
  ck_assert_double_eq(f->eval(f->context, x), 4);
  ck_assert_int_eq(params->adapt_every, 7);
  ck_assert_int_eq(params->max_cells, 10000);
  case_destroy(file);
}
END_TEST

START_TEST(times_are_sorted_and_end_with_the_run) {
  struct case_file *file =
      load("return {" DOMAIN GRAVITY PHASES SIDES
           "output = { stop = 3, profile_times = { 3, 0.5, 9, 1 } } }");
  const struct params *params = case_params(file);
  ck_assert_int_eq(params->nprofile_times, 3);
  ck_assert_double_eq(params->profile_times[0], 0.5);
  ck_assert_double_eq(params->profile_times[2], 3);
  ck_assert_ptr_nonnull(case_note(file));
  case_destroy(file);
}
END_TEST

/* The value of param(), of each kind, seen through the title. */
#define DECLARE(default) \
  "local v = param('v', " default ", 'help')\n" \
  "if type(v) == 'table' then v = table.concat(v, '+') end\n" \
  "return { title = tostring(v),\n" REST "}"

static void title_is(const char *text, const char *override,
                     const char *title) {
  struct case_file *file =
      override != NULL ? load_with(text, override) : load(text);
  ck_assert_str_eq(case_params(file)->title, title);
  case_destroy(file);
}

START_TEST(command_line_overrides_each_kind) {
  title_is(DECLARE("10"), NULL, "10");
  title_is(DECLARE("10"), "v=-2.5e0", "-2.5");
  title_is(DECLARE("10"), "v=8", "8");
  title_is(DECLARE("'sand'"), "v=a=b", "a=b");
  title_is(DECLARE("false"), "v=true", "true");
  title_is(DECLARE("{ 1, 2 }"), NULL, "1+2");
  title_is(DECLARE("{ 1, 2 }"), "v=0.5,3,4", "0.5+3+4");
  title_is(DECLARE("{ 'a' }"), "v=b,c", "b+c");
  title_is(DECLARE("{ 1 }"), "v=", "");
}
END_TEST

static const char *const BAD_OVERRIDES[] = {"v=x", "v=", "w=1", "v=nan",
                                            "v=1e999"};

START_TEST(bad_overrides_are_refused) {
  load_with(DECLARE("10"), BAD_OVERRIDES[_i]);
}
END_TEST

START_TEST(printed_rows_say_where_values_come_from) {
  char text[TEXT_LENGTH];
  struct case_file *file = load_with(
      "local n = param('n', 3, 'a number, \"quoted\"')\n"
      "local gravity = param('gravity', 1, '')\n"
      "return { title = 'a, \"b\"'," REST "}",
      "n=4");
  printed(file, case_print, text);
  ck_assert_ptr_nonnull(strstr(text, "a number, \"quoted\" [command line]"));
  ck_assert_ptr_nonnull(strstr(text, "solver.cfl                 = 0.7 "));
  printed(file, case_write_parameters, text);
  ck_assert_int_eq(strncmp(text, "key,value,unit,origin\n", 22), 0);
  ck_assert_ptr_nonnull(strstr(text, "\nn,4,,command line\n"));
  ck_assert_ptr_nonnull(strstr(text, "\ntitle,\"a, \"\"b\"\"\",,case\n"));
  ck_assert_ptr_nonnull(strstr(text, "\ndomain.size,4,m,case\n"));
  ck_assert_ptr_nonnull(strstr(text, "\nsolver.cfl,0.7,,default\n"));
  /* names are unique: they become attributes of HDF5 files */
  ck_assert_ptr_nonnull(strstr(text, "\nparam.gravity,1,,default\n"));
  ck_assert_ptr_nonnull(strstr(text, "\ngravity,\"0,-1\",m/s^2,case\n"));
  case_destroy(file);
}
END_TEST

START_TEST(help_names_every_section) {
  static const char *const WORDS[] = {
      "domain.level_min", "grains.rheology", "mu_i",
      "navier_slip",      "interface",       "profile_times"};
  char text[TEXT_LENGTH];
  FILE *f = tmpfile();
  case_help(f);
  rewind(f);
  text[fread(text, 1, TEXT_LENGTH - 1, f)] = '\0';
  fclose(f);
  for (size_t i = 0; i < sizeof WORDS / sizeof *WORDS; i++)
    ck_assert_msg(strstr(text, WORDS[i]) != NULL, "no %s", WORDS[i]);
}
END_TEST

/* The sandbox */

/* Return the outcome of a piece of code: NULL or a message, copied. */
static const char *outcome(const char *code) {
  static char message[2048];
  struct sandbox *sandbox = sandbox_new("x.lua", library_open);
  const char *error = sandbox_run(sandbox, code);
  if (error != NULL) strcpy(message, error);
  sandbox_destroy(sandbox);
  return error != NULL ? message : NULL;
}

static const char *const FORBIDDEN[] = {"os.execute('true')",
                                        "io.open('x')",
                                        "require('os')",
                                        "load('return 1')",
                                        "dofile('x')",
                                        "debug.getinfo(1)",
                                        "coroutine.create(print)",
                                        "collectgarbage('stop')",
                                        "setmetatable({}, {})",
                                        "_G.x = 1",
                                        "pcall(error)",
                                        "string.dump(print)",
                                        "math.randomseed()"};

START_TEST(sandbox_has_no_way_out) {
  const char *message = outcome(FORBIDDEN[_i]);
  if (strncmp(FORBIDDEN[_i], "string.dump", 11) == 0) {
    ck_assert_ptr_nonnull(message); /* a C function cannot be dumped */
    return;
  }
  ck_assert_msg(message != NULL, "%s works", FORBIDDEN[_i]);
  ck_assert_msg(strncmp(message, "x.lua:1: ", 9) == 0, "%s", message);
}
END_TEST

START_TEST(sandbox_refuses_bytecode) {
  ck_assert_ptr_nonnull(outcome("\x1bLua"));
}
END_TEST

START_TEST(sandbox_ends_endless_code) {
  const char *message = outcome("local i = 0\nwhile true do i = i + 1 end");
  ck_assert_ptr_nonnull(message);
  ck_assert_ptr_nonnull(strstr(message, "x.lua:2: "));
}
END_TEST

START_TEST(sandbox_bounds_memory) {
  ck_assert_ptr_nonnull(strstr(outcome("local s = ('x'):rep(1e9)"), "memory"));
  ck_assert_ptr_nonnull(strstr(
      outcome("local t = {} for i = 1, 1e9 do t[i] = {} end"), "memory"));
}
END_TEST

/* Every rank and every restart must see the same. */
START_TEST(sandbox_is_reproducible) {
  static const char *const CODE =
      "local s = ''\n"
      "for k in pairs({ one = 1, two = 2, three = 3, [2] = 4, [1] = 5 }) do\n"
      "  s = s .. k .. ' ' end\n"
      "error(s .. math.random(1000000), 0)";
  char first[2048];
  strcpy(first, outcome(CODE));
  ck_assert_int_eq(strncmp(first, "1 2 one three two ", 18), 0);
  ck_assert_str_eq(outcome(CODE), first);
}
END_TEST

START_TEST(floating_point_traps_spare_the_case) {
  ck_assert_ptr_null(outcome("local x, y = 1 / 0, 0 / 0\nreturn x == y"));
}
END_TEST

/* Helpers */

START_TEST(line_of_key_is_found) {
  static const char TEXT[] =
      "-- size = 1\n"
      "local size = 4 --[[ level = 3\n"
      "]] local gas = { density = 1,\n"
      "  rheology = { 'newtonian', eta = 2 } }\n"
      "return {\n"
      "  title = 'size = 3 {',\n"
      "  domain = { size = size,\n"
      "    level = 5 },\n"
      "  grains = { density = 1, shape = function(x, y)\n"
      "    local level = 3\n"
      "    return x == y and 1 or 0 end,\n"
      "    rheology = { 'mu_i', d = 1 } },\n"
      "  gas = gas,\n"
      "  adapt = { { 'interface', width = 3 } },\n"
      "}\n";
  ck_assert_int_eq(source_line(TEXT, "domain.size"), 7);
  ck_assert_int_eq(source_line(TEXT, "domain.level"), 8);
  ck_assert_int_eq(source_line(TEXT, "grains.rheology.d"), 12);
  ck_assert_int_eq(source_line(TEXT, "grains.shape"), 9);
  ck_assert_int_eq(source_line(TEXT, "adapt[1].width"), 14);
  ck_assert_int_eq(source_line(TEXT, "domain.origin[2]"), 7); /* its table */
  ck_assert_int_eq(source_line(TEXT, "nonsense"), 5);         /* the return */
  ck_assert_int_eq(source_line("x = 1", "nonsense"), 0);
}
END_TEST

START_TEST(nearest_word_is_found) {
  static const char *const WORDS[] = {"level", "level_min", "size", NULL};
  ck_assert_str_eq(spelling_nearest("levle", 4, WORDS), "level");
  ck_assert_str_eq(spelling_nearest("levelmin", 4, WORDS), "level_min");
  ck_assert_str_eq(spelling_nearest("sise", 4, WORDS), "size");
  ck_assert_str_eq(spelling_nearest("SIZE", 4, WORDS), "size");
  ck_assert_ptr_null(spelling_nearest("sine", 2, WORDS));
  ck_assert_ptr_null(spelling_nearest("lathe", 4, WORDS));
  ck_assert_ptr_null(spelling_nearest("gravity", 4, WORDS));
  ck_assert_ptr_null(spelling_nearest("", 4, WORDS));
}
END_TEST

START_TEST(dimension_is_read_or_unknown) {
  char path[] = "/tmp/talus-case-XXXXXX", word[] = "n=3";
  char *const overrides[] = {word};
  int descriptor = mkstemp(path);
  FILE *f = fdopen(descriptor, "w");
  fputs("local n = param('n', 2) print('unheard') return { dimension = n }", f);
  fclose(f);
  ck_assert_int_eq(case_dimension(path, 0, NULL), 2);
  ck_assert_int_eq(case_dimension(path, 1, overrides), 3);
  unlink(path);
  ck_assert_int_eq(case_dimension(path, 0, NULL), 0);
}
END_TEST

#define COUNT(array) ((int)(sizeof(array) / sizeof *(array)))

static TCase *files(void) {
  TCase *tcase = tcase_create("files");
  tcase_add_test(tcase, case_fills_params_and_defaults);
  tcase_add_test(tcase, density_of_phase_is_default_of_rho);
  tcase_add_test(tcase, functions_of_position_are_those_of_the_case);
  tcase_add_test(tcase, viscosity_may_be_a_function_of_the_case);
  tcase_add_exit_test(tcase, viscosity_that_fails_during_a_run_ends_it,
                      EXIT_USER);
  tcase_add_test(tcase, table_of_a_closure_is_freed_with_the_case);
  tcase_add_test(tcase, uniform_velocity_is_a_function);
  tcase_add_test(tcase, function_of_a_side_chooses_a_patch);
  tcase_add_test(tcase, bottom_is_lower_z_in_three_dimensions);
  tcase_add_exit_test(tcase, friction_without_pressure_level_is_refused,
                      EXIT_USER);
  tcase_add_test(tcase, pressure_level_is_enough);
  tcase_add_loop_test(tcase, closed_box_takes_its_pressure_somewhere, 0,
                      COUNT(PRESSURES));
  tcase_add_loop_test(tcase, limiter_is_read_by_name, 0, 3);
  tcase_add_test(tcase, advection_may_be_switched_off);
  tcase_add_loop_exit_test(tcase, other_limiters_are_refused, EXIT_USER, 0, 2);
  tcase_add_test(tcase, criteria_take_level_of_domain_by_default);
  tcase_add_test(tcase, times_are_sorted_and_end_with_the_run);
  tcase_add_test(tcase, command_line_overrides_each_kind);
  tcase_add_loop_exit_test(tcase, bad_overrides_are_refused, EXIT_USER, 0,
                           COUNT(BAD_OVERRIDES));
  tcase_add_test(tcase, printed_rows_say_where_values_come_from);
  tcase_add_test(tcase, help_names_every_section);
  tcase_add_test(tcase, dimension_is_read_or_unknown);
  return tcase;
}

static TCase *sandbox(void) {
  TCase *tcase = tcase_create("sandbox");
  tcase_add_loop_test(tcase, sandbox_has_no_way_out, 0, COUNT(FORBIDDEN));
  tcase_add_test(tcase, sandbox_refuses_bytecode);
  tcase_add_test(tcase, sandbox_ends_endless_code);
  tcase_add_test(tcase, sandbox_bounds_memory);
  tcase_add_test(tcase, sandbox_is_reproducible);
  tcase_add_test(tcase, floating_point_traps_spare_the_case);
  tcase_add_test(tcase, line_of_key_is_found);
  tcase_add_test(tcase, nearest_word_is_found);
  return tcase;
}

Suite *case_suite(void) {
  Suite *suite = suite_create("case");
  suite_add_tcase(suite, files());
  suite_add_tcase(suite, sandbox());
  return suite;
}
