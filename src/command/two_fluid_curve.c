/* SPDX-License-Identifier: GPL-3.0-or-later */
/* talus rheology two_fluid: plane shear of the closures of the two-fluid model
 * at constant pressure of the grains. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "talus/command_line.h"
#include "talus/csv_row.h"
#include "talus/error.h"
#include "talus/spelling.h"
#include "talus/two_fluid_drag.h"
#include "talus/two_fluid_grains.h"
#include "talus/two_fluid_ktgf.h"

/* Decades of shear rates over sqrt(p/rho_s)/d, and rows to each. */
enum { FIRST_DECADE = -6, LAST_DECADE = 1, PER_DECADE = 12 };

/* Holds what the words of the command ask for. */
struct request {
  struct two_fluid_closure c;
  double p, phi_p; /* phi_p: of critical_state; NAN: that of steady shear */
  bool csv;
};

/* Tells where a choice is kept and what its names are. */
struct choice {
  const char *name;
  const char *const *names;
};
static const struct choice CHOICES[] = {
    {"closure", two_fluid_set_names},
    {"fluid", two_fluid_fluid_names},
    {"drag", two_fluid_drag_names},
    {"frictional_pressure", two_fluid_frictional_names},
    {"friction", two_fluid_friction_names},
    {"production", two_fluid_production_names}};
enum { CLOSURE, FLUID, DRAG, FRICTIONAL, FRICTION, NCHOICES = 6 };

static int count(const char *const *names) {
  int n = 0;
  while (names[n] != NULL) n++;
  return n;
}

/* Return the value of `name=` if the word is that, else NULL. */
static const char *value_of(const char *word, const char *name) {
  const size_t n = strlen(name);
  return strncmp(word, name, n) == 0 && word[n] == '=' ? word + n + 1 : NULL;
}

static int read_choice(const char *word, const struct choice *choice,
                       const char *value) {
  char known[256] = "";
  size_t used = 0;
  for (int k = 0; choice->names[k] != NULL; k++) {
    if (strcmp(choice->names[k], value) == 0) return k;
    used += (size_t)snprintf(known + used, sizeof known - used, " %s",
                             choice->names[k]);
  }
  const char *near = spelling_nearest(value, count(choice->names),
                                      (const char **)choice->names);
  USER_ERROR("%s: no such %s%s%s; known:%s", word, choice->name,
             near != NULL ? "; did you mean " : "", near != NULL ? near : "",
             known);
}

/* Set a choice if the word is one. */
static bool set_choice(struct request *request, const char *word) {
  for (int k = 0; k < NCHOICES; k++) {
    const char *value = value_of(word, CHOICES[k].name);
    if (value == NULL) continue;
    const int i = read_choice(word, &CHOICES[k], value);
    struct two_fluid_closure *c = &request->c;
    switch (k) {
      case CLOSURE:
        c->set = (enum two_fluid_set)i;
        break;
      case FLUID:
        if (i != TWO_FLUID_OWN)
          two_fluid_take_fluid(c, (enum two_fluid_fluid)i);
        break;
      case DRAG:
        c->drag = (enum two_fluid_drag)i;
        break;
      case FRICTIONAL:
        c->frictional_pressure = (enum two_fluid_frictional)i;
        break;
      case FRICTION:
        c->friction = (enum two_fluid_friction)i;
        break;
      default:
        c->production = (enum two_fluid_production)i;
    }
    return true;
  }
  return false;
}

/* Return whether a number is for another set of closures. */
static bool foreign(const struct request *request, int k) {
  const char *path = two_fluid_numbers[k].path;
  for (int set = 0; two_fluid_set_names[set] != NULL; set++) {
    const size_t n = strlen(two_fluid_set_names[set]);
    if (strncmp(path, two_fluid_set_names[set], n) == 0 && path[n] == '.')
      return set != (int)request->c.set;
  }
  return false;
}

/* Return the index of a number; the word is `name=...` of the set's own or of
 * grains, fluid or drag, or `section.name=...`. */
static int find_number(const struct request *request, const char *word) {
  const char *own = two_fluid_set_names[request->c.set];
  const char *const sections[] = {own, "grains", "fluid", "drag"};
  char name[64];
  snprintf(name, sizeof name, "%.*s", (int)strcspn(word, "="), word);
  char *dot = strchr(name, '.');
  if (dot != NULL) {
    *dot = '\0';
    return two_fluid_find_number(name, dot + 1);
  }
  int k = -1;
  for (int i = 0; i < 4 && k < 0; i++)
    k = two_fluid_find_number(sections[i], name);
  return k;
}

static _Noreturn void refuse_key(const struct request *request,
                                 const char *word) {
  char known[2048] = "";
  size_t used = 0;
  for (int k = 0; k < TWO_FLUID_NKEYS; k++)
    if (!foreign(request, k))
      used += (size_t)snprintf(known + used, sizeof known - used, " %s",
                               two_fluid_numbers[k].path);
  USER_ERROR(
      "%s: two_fluid with closure=%s has no such key; known: p phi_p closure "
      "fluid drag frictional_pressure friction production%s",
      word, two_fluid_set_names[request->c.set], known);
}

static double read_number(const char *word, const char *text, double min,
                          double max, const char *help) {
  char *end;
  const double value = strtod(text, &end);
  if (end == text || *end != '\0' || !isfinite(value))
    USER_ERROR("%s: a number is needed", word);
  if (value < min || value > max)
    USER_ERROR("%s is out of range: from %g to %g is allowed (%s)", word, min,
               max, help);
  return value;
}

static void set_number(struct request *request, const char *word) {
  const char *text;
  if ((text = value_of(word, "p")) != NULL) {
    request->p = read_number(word, text, 1e-9, 1e12, "pressure of the grains");
    return;
  }
  if ((text = value_of(word, "phi_p")) != NULL) {
    request->phi_p = read_number(word, text, 0, 0.7, "plastic packing");
    return;
  }
  const int k = strchr(word, '=') != NULL ? find_number(request, word) : -1;
  if (k < 0 || foreign(request, k)) refuse_key(request, word);
  const struct key *key = &two_fluid_numbers[k];
  request->c.param[k] =
      read_number(word, strchr(word, '=') + 1, key->low, key->high, key->help);
}

/* Read choices before numbers, as these depend on the set and the fluid. */
static struct request read_request(int argc, char *argv[]) {
  struct request request = {.p = 100, .phi_p = NAN};
  two_fluid_closure_init(&request.c, TWO_FLUID_CRITICAL_STATE);
  command_line_refuse_twice(argc, argv);
  for (int i = 0; i < argc; i++) set_choice(&request, argv[i]);
  struct request chosen = request;
  for (int i = 0; i < argc; i++) {
    if (strcmp(argv[i], "--csv") == 0)
      request.csv = true;
    else if (!set_choice(&chosen, argv[i]))
      set_number(&request, argv[i]);
  }
  const char *wrong = two_fluid_prepare(&request.c);
  if (wrong != NULL)
    USER_ERROR("two_fluid, %s: %s", two_fluid_set_names[request.c.set], wrong);
  return request;
}

/* One row of the curve. */
struct row {
  double I, J, gamma, eta, mu, mu_both, phi, Theta;
};

/* Return phi of steady shear: the critical one where phi_p is free. */
static double steady_phi(const struct request *request, double gamma,
                         double eta_f) {
  const struct two_fluid_closure *c = &request->c;
  const double X = two_fluid_shear(c, gamma, eta_f);
  if (c->set == TWO_FLUID_CRITICAL_STATE && isnan(request->phi_p))
    return c->param[TWO_FLUID_CS_PHI_C] / (1 + sqrt(X / request->p));
  const struct two_fluid_frozen with = {.phi_p = request->phi_p, .X = X};
  return two_fluid_solid_fraction(c, request->p, &with, 0,
                                  two_fluid_densest(c));
}

/* Return Theta of plane shear without drag. */
static double shear_temperature(const struct two_fluid_closure *c, double phi,
                                double gamma) {
  return two_fluid_temperature(c, phi, 0.5 * gamma * gamma, 0, 0, INFINITY);
}

/* Find the shear rate at which grains of ktgf at phi have the pressure, by
 * halves in the logarithm; NAN if p_f is more than it. */
static double rate_of(const struct request *request, double phi) {
  const struct two_fluid_closure *c = &request->c;
  struct two_fluid_frozen with = {.Theta = 0};
  double low = log(1e-12), high = log(1e12);
  if (two_fluid_pressure(c, phi, &with, NULL) >= request->p) return NAN;
  for (int k = 0; k < 100; k++) {
    const double half = 0.5 * (low + high);
    with.Theta = shear_temperature(c, phi, exp(half));
    if (two_fluid_pressure(c, phi, &with, NULL) > request->p)
      high = half;
    else
      low = half;
  }
  return exp(low);
}

static struct row row_at(const struct request *request, double gamma,
                         double phi) {
  const struct two_fluid_closure *c = &request->c;
  const double p = request->p, eta_f = two_fluid_viscosity(c, gamma);
  const double rho = c->param[TWO_FLUID_GRAINS_DENSITY];
  struct row row = {.gamma = gamma, .phi = phi};
  row.I = gamma * c->param[TWO_FLUID_GRAINS_D] * sqrt(rho / p);
  row.J = eta_f * gamma / p;
  row.Theta = shear_temperature(c, phi, gamma);
  const struct two_fluid_stress tau =
      two_fluid_stress(c, phi, p, gamma, eta_f, row.Theta);
  row.eta = tau.eta + tau.tau_y / gamma;
  row.mu = row.eta * gamma / p;
  row.mu_both =
      row.mu + (1 - phi) * two_fluid_pore_viscosity(c, phi, eta_f) * gamma / p;
  return row;
}

/* Give row k of the curve; false past the last. Rows of ktgf are even in phi,
 * as two phi may have one pressure at one shear rate. */
static bool row_of(const struct request *request, int k, struct row *row) {
  const struct two_fluid_closure *c = &request->c;
  if (c->set == TWO_FLUID_KTGF) {
    const double phi = 0.05 + 0.005 * k, gamma = rate_of(request, phi);
    if (phi > two_fluid_densest(c) || isnan(gamma)) return false;
    *row = row_at(request, gamma, phi);
    return true;
  }
  if (k > (LAST_DECADE - FIRST_DECADE) * PER_DECADE) return false;
  const double rho = c->param[TWO_FLUID_GRAINS_DENSITY];
  const double gamma = pow(10, FIRST_DECADE + (double)k / PER_DECADE) *
                       sqrt(request->p / rho) / c->param[TWO_FLUID_GRAINS_D];
  const double eta_f = two_fluid_viscosity(c, gamma);
  *row = row_at(request, gamma, steady_phi(request, gamma, eta_f));
  return true;
}

static void print_summary(const struct request *request) {
  const struct two_fluid_closure *c = &request->c;
  const double phi_p = isnan(request->phi_p) ? 0.54 : request->phi_p;
  printf("%s, p = %g Pa, St = %.4g, r = %.4g (at 9.81 m/s^2)\n",
         two_fluid_set_names[c->set], request->p,
         two_fluid_stokes_number(c, 9.81), two_fluid_density_ratio(c));
  printf("at rest phi = %.5g", two_fluid_settled(c, request->p, phi_p));
  if (c->set == TWO_FLUID_CRITICAL_STATE) printf(" with phi_p = %g", phi_p);
  printf(", drag there K = %.4g kg/(m^3 s)\n",
         two_fluid_drag(c, two_fluid_settled(c, request->p, phi_p), 0,
                        two_fluid_viscosity(c, 0)));
}

static void print_csv_row(const struct row *row) {
  const double numbers[] = {row->I,   row->gamma, row->eta, row->mu,
                            row->phi, NAN,        row->J,   row->mu_both};
  struct csv_row cells = {0};
  for (size_t k = 0; k < sizeof numbers / sizeof *numbers; k++) {
    char text[32] = "";
    if (!isnan(numbers[k])) snprintf(text, sizeof text, "%.10g", numbers[k]);
    csv_row_add(&cells, text);
  }
  csv_row_write(&cells, stdout);
  csv_row_free(&cells);
}

int command_two_fluid(int argc, char *argv[]) {
  const struct request request = read_request(argc, argv);
  struct row row;
  if (request.csv)
    printf("I,shear_rate,eta,mu,nu,state,J,mu_both\n");
  else
    print_summary(&request);
  if (!request.csv)
    printf("%12s %12s %12s %12s %12s %12s %12s\n", "I", "J", "shear_rate",
           "eta", "mu", "mu_both", "phi");
  for (int k = 0; row_of(&request, k, &row); k++) {
    if (request.csv)
      print_csv_row(&row);
    else
      printf("%12.5g %12.5g %12.5g %12.5g %12.5g %12.5g %12.6g\n", row.I, row.J,
             row.gamma, row.eta, row.mu, row.mu_both, row.phi);
  }
  return EXIT_DONE;
}
