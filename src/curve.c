/* SPDX-License-Identifier: GPL-3.0-or-later */
/* talus rheology: the closures, and the curve of one at constant pressure. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "talus/command_line.h"
#include "talus/error.h"
#include "talus/rheology.h"

/* Range of inertial numbers, so many to a decade. */
enum { FIRST_DECADE = -4, LAST_DECADE = 1, PER_DECADE = 12 };
enum { NPOINTS = (LAST_DECADE - FIRST_DECADE) * PER_DECADE + 1 };

static int list_closures(void) {
  const struct rheology_model *model;
  for (int i = 0; (model = rheology_get(i)) != NULL; i++) {
    printf("%-12s %s [%s]\n", model->name, model->title, model->source);
    for (int k = 0; k < model->nkeys; k++) {
      const struct rheology_key *key = &model->keys[k];
      printf("    %-10s %s, %s", key->name, key->help, key->unit);
      if (!isnan(key->initial)) printf(", default %g", key->initial);
      printf("\n");
    }
  }
  printf(
      "\nAll take eta_min, eta_max, regularisation and gamma_r. For a curve "
      "at pressure p:\n  talus rheology NAME [p=1] [key=value ...] "
      "[--csv]\n");
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

/* One `key=value`. */
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
    if (*pressure < 0) USER_ERROR("%s: a pressure >= 0 is needed", word);
  } else if (strcmp(name, "regularisation") == 0) {
    if (rheology_set_regularisation(rheology, value) != 0)
      USER_ERROR("%s: clip, papanastasiou or bercovier_engelman", word);
  } else {
    int why = rheology_set(rheology, name, read_value(word, value));
    if (why != 0) refuse_key(rheology, word, why);
  }
}

/* The key `name`, 1 if the closure has none. */
static double value_or_one(const struct rheology *rheology, const char *name) {
  const struct rheology_key *key;
  for (int i = 0; (key = rheology_key(rheology->model, i)) != NULL; i++)
    if (strcmp(key->name, name) == 0) return rheology_value(rheology, i);
  return 1;
}

static void print_curve(const struct rheology *rheology, double pressure,
                        bool csv) {
  double d = value_or_one(rheology, "d"), rho = value_or_one(rheology, "rho");
  double I[NPOINTS], rate[NPOINTS], p[NPOINTS], eta[NPOINTS];
  for (int i = 0; i < NPOINTS; i++) {
    I[i] = pow(10, FIRST_DECADE + (double)i / PER_DECADE);
    /* Without pressure there is no inertial number: take it as a rate. */
    rate[i] = pressure > 0 ? I[i] / d * sqrt(pressure / rho) : I[i];
    p[i] = pressure;
  }
  rheology_eval(rheology, NPOINTS, rate, p, eta);
  printf(csv ? "I,shear_rate,eta,mu,nu,state\n" : "%13s %13s %13s %13s\n", "I",
         "shear_rate", "eta", "mu");
  for (int i = 0; i < NPOINTS; i++) {
    double mu = pressure > 0 ? eta[i] * rate[i] / pressure : NAN;
    /* No closure knows its solid fraction or state yet. */
    printf(csv ? "%.8g,%.8g,%.8g,%.8g,,\n" : "%13.6g %13.6g %13.6g %13.6g\n",
           pressure > 0 ? I[i] : NAN, rate[i], eta[i], mu);
  }
}

int command_rheology(int argc, char *argv[]) {
  if (argc == 0) return list_closures();
  const struct rheology_model *model = rheology_find(argv[0]);
  if (model == NULL)
    USER_ERROR(
        "unknown closure %s; did you mean %s? `talus rheology` lists "
        "them",
        argv[0], rheology_nearest(argv[0]));
  struct rheology rheology;
  double pressure = 1;
  bool csv = false;
  rheology_init(&rheology, model);
  rheology_set(&rheology, "rho", 1);
  rheology_set(&rheology, "d", 1);
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
  print_curve(&rheology, pressure, csv);
  return EXIT_DONE;
}
