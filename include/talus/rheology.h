/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Viscosity of grains from their shear rate and pressure. Pure: arrays in,
 * arrays out, no mesh, no MPI, no state.
 *
 * The deviatoric stress is tau = 2 eta D, with D the strain rate tensor. All
 * closures use the one norm
 *
 *   gamma = sqrt(2 D:D)                                                  (1)
 *
 * (|du/dy| in plane shear), so that |tau| = sqrt(tau:tau/2) = eta gamma. Units
 * are SI below, but any consistent set will do. A closure gives a plastic
 * viscosity eta_f(gamma, p) and, if it has a yield stress, tau_y(gamma, p);
 * the layer they share adds the key `cohesion` to tau_y and forms
 *
 *   eta = eta_f + tau_y/gamma                                            (2)
 *   eta = eta_f + tau_y (1 - exp(-gamma/gamma_r))/gamma                  (3)
 *   eta = eta_f + tau_y/sqrt(gamma^2 + gamma_r^2)                        (4)
 *
 * for "clip" (2), "papanastasiou" (3) and "bercovier_engelman" (4), and cuts
 * the result to [eta_min, eta_max]; "exact" caps nothing, and the stress is
 * made of both parts by the model (yield.h). (2) is [valette_2019,
 * eq. 3], (4) with eta_min the viscosity of air is [valette_2019, eq. 7], and
 * gamma_r is the key gamma_r; 1/gamma_r is Papanastasiou's time m. The cap of
 * [lagree_staron_popinet_2011] is (2) with eta_max = 250 rho sqrt(g H^3).
 *
 * Negative pressure counts as 0. Results are finite and >= 0 for gamma and p
 * from 0 to 1e12, denormals included; NaN in gives NaN out, so that it is seen.
 * At rest a yielded closure with p > 0 gives eta_max (2), or a finite value
 * proportional to 1/gamma_r (3, 4).
 *
 * `talus rheology` lists the closures, with their sources; `user` is a function
 * of the case. To add one: a file in src/rheology/ and a line in
 * src/rheology/models.h (README.md). Nothing else needs to know.
 *
 * A closure of mu(I), mu = tau/p a function of I = gamma d/sqrt(p/rho) alone,
 * is well posed where
 *
 *   C(I) = 4 r^2 - 4 r + mu^2 (1 - r/2)^2 <= 0,  r = I mu'/mu           (5)
 *
 * [barker_2015]; elsewhere short waves grow without bound.
 *
 * Sources:
 *  [lagree_staron_popinet_2011] J. Fluid Mech. 686 (2011) 378,
 *    doi:10.1017/jfm.2011.335.
 *  [valette_2019] Comput. Fluids 191 (2019) 104260,
 *    doi:10.1016/j.compfluid.2019.104260.
 *  [barker_2015] J. Fluid Mech. 779 (2015) 794, doi:10.1017/jfm.2015.412.
 *  [papanastasiou_1987] J. Rheol. 31 (1987) 385, doi:10.1122/1.549926.
 *  [bercovier_engelman_1980] J. Comput. Phys. 36 (1980) 313,
 *    doi:10.1016/0021-9991(80)90163-1.
 */
#ifndef TALUS_RHEOLOGY_H
#define TALUS_RHEOLOGY_H

#include <stdbool.h>
#include <stdint.h>

enum { RHEOLOGY_MAX_KEYS = 16 };

/* One parameter, as the case file, the log and the manual see it. */
struct rheology_key {
  const char *name;
  const char *unit; /* "1" for a pure number */
  double min, max;  /* allowed, both included */
  double initial;   /* default; NAN: the user must give a value */
  const char *help; /* half a line */
};

struct rheology;

/*
 * Fill out[i], i < n, from shear rate (>= 0) and pressure (>= 0); r->param is
 * in the order of the model's keys. No array overlaps another.
 */
typedef void rheology_function(const struct rheology *r, int32_t n,
                               const double *restrict shear_rate,
                               const double *restrict pressure,
                               double *restrict out);

/* Fill the plastic viscosity eta[i] and the yield stress tau_y[i] as a
 * rheology_function does one of them. */
typedef void rheology_parts_function(const struct rheology *r, int32_t n,
                                     const double *restrict shear_rate,
                                     const double *restrict pressure,
                                     double *restrict eta,
                                     double *restrict tau_y);

/* Compute viscosity as rheology_function, by a function of the user that may
 * look at the time, s. */
typedef void rheology_user_function(void *context, double time, int32_t n,
                                    const double *shear_rate,
                                    const double *pressure, double *eta);

/* Something a closure knows besides the viscosity. */
struct rheology_quantity {
  const char *name, *unit, *title;
  rheology_function *eval;
};

/* Values of the quantity "state" of a closure. */
enum rheology_state {
  RHEOLOGY_SOLID,        /* at rest: its yield stress is not reached */
  RHEOLOGY_QUASI_STATIC, /* more than 99 % of p by enduring contact */
  RHEOLOGY_DENSE,
  RHEOLOGY_INERTIAL, /* less than 1 % */
  RHEOLOGY_BEYOND    /* no steady shear at such an inertial number */
};

/* One closure. Everything in it is constant. */
struct rheology_model {
  const char *name;                /* in case files: lower case, no blanks */
  const char *title;               /* one line for people */
  const char *source;              /* key of the paper and equation */
  const struct rheology_key *keys; /* [nkeys] */
  int nkeys;
  rheology_function *eval;  /* plastic viscosity eta_f, Pa s; NULL: r->user */
  rheology_function *yield; /* yield stress tau_y, Pa; NULL: none */
  bool holds; /* at rest tau_y > 0 where p > 0, so that "exact" has a meaning */
  /* Fills both for "exact"; NULL: eval and yield do. */
  rheology_parts_function *parts;
  const struct rheology_quantity *outputs; /* [noutputs] */
  int noutputs;
  bool mu_of_i; /* tau/p depends on I alone; has keys d and rho */
  /* Makes *table, one block of memory.h, from complete parameters. Returns what
   * is wrong with them, NULL if nothing is. NULL: needs no table. */
  const char *(*prepare)(const struct rheology *r, void **table);
  /* I[0]: where a branch ends in a kink, I[1]: the largest of steady shear.
   * NULL: neither. After prepare. */
  void (*limits)(const struct rheology *r, double I[2]);
};

enum rheology_regularisation {
  RHEOLOGY_CLIP,
  RHEOLOGY_PAPANASTASIOU,
  RHEOLOGY_BERCOVIER_ENGELMAN,
  RHEOLOGY_EXACT /* rheology_eval takes it as clip; rheology_parts does not */
};

/* A closure with its parameters: what a phase of a case holds. Copies share
 * the table; who called rheology_prepare frees it. */
struct rheology {
  const struct rheology_model *model; /* borrowed, static */
  double param[RHEOLOGY_MAX_KEYS];    /* [model->nkeys] */
  enum rheology_regularisation regularisation;
  double eta_min, eta_max;      /* Pa s; eta_max wins if they cross */
  double gamma_r;               /* 1/s, of (3) and (4) */
  double cohesion;              /* Pa, added to tau_y */
  void *table;                  /* by rheology_prepare; NULL: none */
  rheology_user_function *user; /* of the closure `user` */
  void *context;                /* borrowed */
};

/* Let errors of GSL, by which closures find roots, end the program as FATAL
 * does. Call once at the start; without it they end in abort(). */
void rheology_begin(void);

/* Return the closure of this name, NULL if there is none. */
const struct rheology_model *rheology_find(const char *name);

/* Return closure i of the list, NULL if i is out of range. */
const struct rheology_model *rheology_get(int i);

/*
 * Return key i of a model: its own, then those all models share (eta_min,
 * eta_max, gamma_r, cohesion); NULL past the last. This is the list to loop
 * over for help and logs and to find a key's range; rheology_value gives its
 * value in r.
 */
const struct rheology_key *rheology_key(const struct rheology_model *model,
                                        int i);
double rheology_value(const struct rheology *r, int i);

/* Set r to a model with the defaults of all keys, regularisation "clip". */
void rheology_init(struct rheology *r, const struct rheology_model *model);

/*
 * Set a key, the model's own or a shared one. Returns 0, or -1 for an unknown
 * key, -2 for a value out of its range or NaN; r is then unchanged.
 */
int rheology_set(struct rheology *r, const char *key, double value);

/* Return the first key without a value, NULL if r is complete. */
const struct rheology_key *rheology_missing(const struct rheology *r);

/* Choose (2), (3) or (4) by name; returns 0, or -1 for an unknown name. The
 * second gives name i, NULL past the last; i is the enum. */
int rheology_set_regularisation(struct rheology *r, const char *name);
const char *rheology_regularisation_name(int i);

/*
 * Make what r->model needs before rheology_eval, once all keys have a value:
 * owned by the caller and freed by rheology_release, which leaves copies of r
 * without it. Needed for all closures, cheap for most. Returns NULL, or what is
 * wrong with the keys taken together; then there is nothing to release.
 */
const char *rheology_prepare(struct rheology *r);
void rheology_release(struct rheology *r);

/*
 * Compute the viscosity eta[i], Pa s, from shear_rate[i] >= 0, 1/s, equation
 * (1), and pressure[i], Pa, at a time, s, that only a function of the user
 * looks at. All [n]; eta overlaps neither of the others. Works on blocks that
 * fit the cache and allocates nothing.
 */
void rheology_eval(const struct rheology *r, double time, int32_t n,
                   const double *shear_rate, const double *pressure,
                   double *eta);

/*
 * Compute the two parts of (2), of which a model that keeps the yield stress as
 * a field makes the stress: eta[i] the plastic viscosity, more where the stress
 * would be below eta_min gamma, and tau_y[i] the yield stress with cohesion,
 * Pa. All [n].
 */
void rheology_parts(const struct rheology *r, double time, int32_t n,
                    const double *shear_rate, const double *pressure,
                    double *eta, double *tau_y);

/* Does the closure have a yield stress at rest, so that "exact" may be asked
 * for? */
bool rheology_yields(const struct rheology *r);

/* Compute quantity k < r->model->noutputs as rheology_eval does the viscosity;
 * all [n]. */
void rheology_output(const struct rheology *r, int k, int32_t n,
                     const double *shear_rate, const double *pressure,
                     double *out);

/* Find the first window of inertial numbers between 1e-8 and 1e8 in which (5)
 * holds; 0 or INFINITY where it reaches an end. False if there is none or the
 * closure is not one of mu(I). Bounds, regularisation and cohesion are left
 * out. */
bool rheology_window(const struct rheology *r, double window[2]);

#endif
