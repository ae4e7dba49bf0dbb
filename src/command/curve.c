/* SPDX-License-Identifier: GPL-3.0-or-later */
/* talus rheology: the closures, and the curve of one at constant pressure. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "talus/command_line.h"
#include "talus/csv_row.h"
#include "talus/error.h"
#include "talus/memory.h"
#include "talus/rheology.h"
#include "talus/spelling.h"

/* Decades of inertial numbers, and rows to each where limits are known and
 * where not. */
enum { FIRST_DECADE = -4, LAST_DECADE = 1, FINE = 100, COARSE = 12 };

static const char *const STATES[] = {"solid", "quasi-static", "dense",
                                     "inertial", "beyond"};

static void list_key(const struct rheology_key *key) {
  char range[64], initial[32] = "needed";
  snprintf(range, sizeof range, "%g to %g", key->min, key->max);
  if (!isnan(key->initial))
    snprintf(initial, sizeof initial, "%g", key->initial);
  printf("    %-12s %-7s %-16s %-8s %s\n", key->name, key->unit, range, initial,
         key->help);
}

static int list_closures(void) {
  const struct rheology_model *model;
  const struct rheology_key *key;
  printf("%-16s %-7s %-16s %-8s %s\n", "closure, key", "unit", "range",
         "default", "meaning");
  for (int i = 0; (model = rheology_get(i)) != NULL; i++) {
    printf("\n%s: %s\n    [%s]\n", model->name, model->title, model->source);
    for (int k = 0; k < model->nkeys; k++) list_key(&model->keys[k]);
    for (int k = 0; k < model->noutputs; k++)
      printf("    gives %-6s %-7s %s\n", model->outputs[k].name,
             model->outputs[k].unit, model->outputs[k].title);
  }
  printf("\nall of them:\n");
  model = rheology_get(0);
  for (int k = model->nkeys; (key = rheology_key(model, k)) != NULL; k++)
    list_key(key);
  printf("    regularisation:");
  for (int k = 0; rheology_regularisation_name(k) != NULL; k++)
    printf("%s %s", k > 0 ? "," : "", rheology_regularisation_name(k));
  printf(
      "\n\nrho is the density of the phase unless given. For a curve at "
      "pressure p:\n  talus rheology NAME [p=1] [key=value ...] [--csv]\n"
      "The closures of the two-fluid model are\n  talus rheology two_fluid "
      "[closure=ktgf] [p=100] [key=value ...] [--csv]\n");
  return EXIT_DONE;
}

static double read_value(const char *word, const char *text) {
  char *end;
  double value = strtod(text, &end);
  if (end == text || *end != '\0' || !isfinite(value))
    USER_ERROR("%s: a number is needed", word);
  return value;
}

static void refuse_key(const struct rheology *rheology, const char *word,
                       int why) {
  char known[1024] = "";
  size_t used = 0;
  const struct rheology_key *key;
  for (int i = 0; (key = rheology_key(rheology->model, i)) != NULL; i++) {
    size_t n = strlen(key->name);
    if (why == -2 && strncmp(word, key->name, n) == 0 && word[n] == '=')
      USER_ERROR("%s is out of range: from %g to %g is allowed (%s)", word,
                 key->min, key->max, key->help);
    used +=
        (size_t)snprintf(known + used, sizeof known - used, " %s", key->name);
  }
  USER_ERROR("%s: %s has no such key; known: p regularisation%s", word,
             rheology->model->name, known);
}

/* Set one `key=value`. */
static void set_key(struct rheology *rheology, const char *word,
                    double *pressure) {
  char name[64];
  const char *value = strchr(word, '=');
  if (value == NULL)
    USER_ERROR("%s: key=value or --csv is expected here", word);
  snprintf(name, sizeof name, "%.*s", (int)(value - word), word);
  value++;
  if (strcmp(name, "p") == 0) {
    *pressure = read_value(word, value);
    if (*pressure <= 0)
      USER_ERROR(
          "%s: a pressure > 0 is needed, as I = shear rate d/sqrt(p/rho)",
          word);
  } else if (strcmp(name, "regularisation") == 0) {
    if (rheology_set_regularisation(rheology, value) != 0)
      USER_ERROR("%s: clip, papanastasiou, bercovier_engelman or exact", word);
  } else {
    int why = rheology_set(rheology, name, read_value(word, value));
    if (why != 0) refuse_key(rheology, word, why);
  }
}

/* Return the key `name`, else `other`, 1 if the closure has neither. */
static double value_or_one(const struct rheology *rheology, const char *name,
                           const char *other) {
  const struct rheology_key *key;
  for (int i = 0; (key = rheology_key(rheology->model, i)) != NULL; i++)
    if (strcmp(key->name, name) == 0 || strcmp(key->name, other) == 0)
      return rheology_value(rheology, i);
  return 1;
}

/* The rows of a curve, of length n. */
struct curve {
  int n;
  double *I, *rate, *p, *eta, *nu, *state; /* owned; nu, state may be NULL */
};

/* Make the rows of a curve: inertial numbers even in the logarithm, and both
 * limits where known. */
static struct curve curve_new(const struct rheology *rheology) {
  struct curve curve = {0};
  double limit[2] = {INFINITY, pow(10, LAST_DECADE)};
  const int per_decade = rheology->model->limits != NULL ? FINE : COARSE;
  if (rheology->model->limits != NULL) rheology->model->limits(rheology, limit);
  const int steps = (int)ceil((log10(limit[1]) - FIRST_DECADE) * per_decade);
  const size_t room = (size_t)(steps > 0 ? steps : 0) + 2;
  curve.I = MEM_NEW(double, room);
  for (int i = 0; i < steps; i++) {
    const double I = pow(10, FIRST_DECADE + (double)i / per_decade);
    if (curve.n > 0 && curve.I[curve.n - 1] < limit[0] && limit[0] < I)
      curve.I[curve.n++] = limit[0];
    curve.I[curve.n++] = I;
  }
  curve.I[curve.n++] = limit[1];
  curve.rate = MEM_NEW(double, curve.n);
  curve.p = MEM_NEW(double, curve.n);
  curve.eta = MEM_NEW(double, curve.n);
  return curve;
}

static void curve_destroy(struct curve *curve) {
  mem_free(curve->I), mem_free(curve->rate), mem_free(curve->p);
  mem_free(curve->eta), mem_free(curve->nu), mem_free(curve->state);
}

static double *quantity(const struct rheology *rheology, const char *name,
                        const struct curve *curve) {
  for (int k = 0; k < rheology->model->noutputs; k++) {
    if (strcmp(rheology->model->outputs[k].name, name) != 0) continue;
    double *out = MEM_NEW(double, curve->n);
    rheology_output(rheology, k, curve->n, curve->rate, curve->p, out);
    return out;
  }
  return NULL;
}

/* Add entry i of a column to a row; nothing if there is no such column. */
static void add_number(struct csv_row *row, const double *column, int i) {
  char text[32] = "";
  if (column != NULL) snprintf(text, sizeof text, "%.10g", column[i]);
  csv_row_add(row, text);
}

static void print_csv(const struct curve *curve) {
  struct csv_row row = {0};
  printf("I,shear_rate,eta,mu,nu,state\n");
  for (int i = 0; i < curve->n; i++) {
    const double mu = curve->eta[i] * curve->rate[i] / curve->p[i];
    add_number(&row, curve->I, i);
    add_number(&row, curve->rate, i);
    add_number(&row, curve->eta, i);
    add_number(&row, &mu, 0);
    add_number(&row, curve->nu, i);
    add_number(&row, curve->state, i);
    csv_row_write(&row, stdout);
  }
  csv_row_free(&row);
}

static void print_columns(const struct curve *curve) {
  printf("%13s %13s %13s %13s", "I", "shear_rate", "eta", "mu");
  if (curve->nu != NULL) printf(" %13s", "nu");
  printf(curve->state != NULL ? "  state\n" : "\n");
  for (int i = 0; i < curve->n; i++) {
    const double p = curve->p[i];
    printf("%13.6g %13.6g %13.6g %13.6g", curve->I[i], curve->rate[i],
           curve->eta[i], curve->eta[i] * curve->rate[i] / p);
    if (curve->nu != NULL) printf(" %13.6g", curve->nu[i]);
    if (curve->state != NULL) printf("  %s", STATES[(int)curve->state[i]]);
    printf("\n");
  }
}

/* Print what holds for the curve as a whole. `scale` is the shear rate of I =
 * 1. */
static void print_summary(const struct rheology *rheology, double pressure,
                          double scale) {
  double I[2], rate, eta;
  printf("p = %g, d = %g, rho = %g\n", pressure,
         value_or_one(rheology, "d", "d"),
         value_or_one(rheology, "rho", "rho_d"));
  if (rheology->model->limits != NULL) {
    rheology->model->limits(rheology, I);
    rate = I[0] * scale;
    rheology_eval(rheology, 0, 1, &rate, &pressure, &eta);
    printf("I_tran = %.6g, mu_tran = %.6g, I_max = %.6g\n", I[0],
           eta * rate / pressure, I[1]);
  }
  if (!rheology->model->mu_of_i) return;
  if (rheology_window(rheology, I))
    printf("well posed for %.5g < I < %.5g, before bounds and cohesion\n", I[0],
           I[1]);
  else
    printf("ill posed for all I, before bounds and cohesion\n");
}

static void print_curve(const struct rheology *rheology, double pressure,
                        bool csv) {
  const double d = value_or_one(rheology, "d", "d");
  const double rho = value_or_one(rheology, "rho", "rho_d");
  const double scale = sqrt(pressure / rho) / d;
  struct curve curve = curve_new(rheology);
  for (int i = 0; i < curve.n; i++) {
    curve.rate[i] = curve.I[i] * scale;
    curve.p[i] = pressure;
  }
  rheology_eval(rheology, 0, curve.n, curve.rate, curve.p, curve.eta);
  curve.nu = quantity(rheology, "nu", &curve);
  curve.state = quantity(rheology, "state", &curve);
  if (!csv) print_summary(rheology, pressure, scale);
  csv ? print_csv(&curve) : print_columns(&curve);
  curve_destroy(&curve);
}

/* Give grains unit size and density where the closure has no other. */
static void set_units(struct rheology *rheology) {
  const struct rheology_key *key;
  for (int i = 0; (key = rheology_key(rheology->model, i)) != NULL; i++)
    if (isnan(key->initial) &&
        (strcmp(key->name, "d") == 0 || strcmp(key->name, "rho") == 0))
      rheology_set(rheology, key->name, 1);
}

static _Noreturn void refuse_closure(const char *word) {
  enum { MOST = 64 };
  const char *names[MOST], *nearest;
  char known[1024] = "";
  size_t used = 0;
  int n = 0;
  for (; n < MOST && rheology_get(n) != NULL; n++) {
    names[n] = rheology_get(n)->name;
    if (used < sizeof known)
      used +=
          (size_t)snprintf(known + used, sizeof known - used, " %s", names[n]);
  }
  nearest = spelling_nearest(word, n, names);
  USER_ERROR("unknown closure %s%s%s; known:%s", word,
             nearest ? "; did you mean " : "", nearest ? nearest : "", known);
}

/* Find a closure; plane shear of the model four_state is what lee_huang has in
 * local balance, with the same keys. */
static const struct rheology_model *find_closure(const char *name) {
  return rheology_find(strcmp(name, "four_state") == 0 ? "lee_huang" : name);
}

/* Refuse keys that the regularisation ignores. */
static void check_regularisation(const struct rheology *rheology) {
  struct rheology plain;
  rheology_init(&plain, rheology->model);
  const enum rheology_regularisation is = rheology->regularisation;
  const char *name = rheology_regularisation_name((int)is);
  const bool exact = is == RHEOLOGY_EXACT;
  if (exact && !rheology_yields(rheology))
    USER_ERROR("regularisation=exact: %s holds no stress at rest",
               rheology->model->name);
  if (exact && rheology->eta_max != plain.eta_max)
    USER_ERROR(
        "eta_max has no meaning with regularisation=exact, which caps "
        "nothing: say regularisation=clip");
  if ((exact || is == RHEOLOGY_CLIP) && rheology->gamma_r != plain.gamma_r)
    USER_ERROR(
        "gamma_r has no meaning with regularisation=%s: say "
        "regularisation=papanastasiou or bercovier_engelman",
        name);
}

int command_rheology(int argc, char *argv[]) {
  if (argc == 0) return list_closures();
  if (strcmp(argv[0], "two_fluid") == 0)
    return command_two_fluid(argc - 1, argv + 1);
  const struct rheology_model *model = find_closure(argv[0]);
  if (model == NULL) refuse_closure(argv[0]);
  struct rheology rheology;
  double pressure = 1;
  bool csv = false;
  rheology_init(&rheology, model);
  set_units(&rheology);
  command_line_refuse_twice(argc - 1, argv + 1);
  for (int i = 1; i < argc; i++) {
    if (strcmp(argv[i], "--csv") == 0)
      csv = true;
    else
      set_key(&rheology, argv[i], &pressure);
  }
  const struct rheology_key *missing = rheology_missing(&rheology);
  if (missing != NULL)
    USER_ERROR("%s needs %s=value (%s, %s)", model->name, missing->name,
               missing->help, missing->unit);
  check_regularisation(&rheology);
  const char *wrong = rheology_prepare(&rheology);
  if (wrong != NULL) USER_ERROR("%s: %s", model->name, wrong);
  print_curve(&rheology, pressure, csv);
  rheology_release(&rheology);
  return EXIT_DONE;
}
