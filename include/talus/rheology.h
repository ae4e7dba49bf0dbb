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
 * the layer they share forms
 *
 *   eta = eta_f + tau_y/gamma                                            (2)
 *   eta = eta_f + tau_y (1 - exp(-gamma/gamma_r))/gamma                  (3)
 *   eta = eta_f + tau_y/sqrt(gamma^2 + gamma_r^2)                        (4)
 *
 * for "clip" (2), "papanastasiou" (3) and "bercovier_engelman" (4), and cuts
 * the result to [eta_min, eta_max]. (2) is [valette_2019, eq. 3], (4) with
 * eta_min the viscosity of air is [valette_2019, eq. 7], and gamma_r is the key
 * gamma_r; 1/gamma_r is Papanastasiou's time m. The cap of
 * [lagree_staron_popinet_2011] is (2) with eta_max = 250 rho sqrt(g H^3).
 *
 * Negative pressure counts as 0. Results are finite and >= 0 for gamma and p
 * from 0 to 1e12, denormals included; NaN in gives NaN out, so that it is seen.
 * At rest a yielded closure with p > 0 gives eta_max (2), or a finite value
 * proportional to 1/gamma_r (3, 4).
 *
 * Closures (sources in their files): newtonian, bingham, bagnold, coulomb,
 * mu_i. To add one: a file in src/rheology/ and a line in
 * src/rheology/models.h. Nothing else needs to know.
 *
 * Sources:
 *  [lagree_staron_popinet_2011] J. Fluid Mech. 686 (2011) 378,
 *    doi:10.1017/jfm.2011.335.
 *  [valette_2019] Comput. Fluids 191 (2019) 104260,
 *    doi:10.1016/j.compfluid.2019.104260.
 *  [papanastasiou_1987] J. Rheol. 31 (1987) 385, doi:10.1122/1.549926.
 *  [bercovier_engelman_1980] J. Comput. Phys. 36 (1980) 313,
 *    doi:10.1016/0021-9991(80)90163-1.
 */
#ifndef TALUS_RHEOLOGY_H
#define TALUS_RHEOLOGY_H

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

/*
 * Fills out[i], i < n, from param (in the order of the model's keys), shear
 * rate (>= 0) and pressure (>= 0). No array overlaps another.
 */
typedef void rheology_function(const double *param, int32_t n,
                               const double *restrict shear_rate,
                               const double *restrict pressure,
                               double *restrict out);

/* One closure. Everything in it is constant. */
struct rheology_model {
  const char *name;                /* in case files: lower case, no blanks */
  const char *title;               /* one line for people */
  const char *source;              /* key of the paper and equation */
  const struct rheology_key *keys; /* [nkeys] */
  int nkeys;
  rheology_function *eval;  /* plastic viscosity eta_f, Pa s */
  rheology_function *yield; /* yield stress tau_y, Pa; NULL: none */
};

enum rheology_regularisation {
  RHEOLOGY_CLIP,
  RHEOLOGY_PAPANASTASIOU,
  RHEOLOGY_BERCOVIER_ENGELMAN
};

/* A closure with its parameters: what a phase of a case holds. */
struct rheology {
  const struct rheology_model *model; /* borrowed, static */
  double param[RHEOLOGY_MAX_KEYS];    /* [model->nkeys] */
  enum rheology_regularisation regularisation;
  double eta_min, eta_max; /* Pa s; eta_max wins if they cross */
  double gamma_r;          /* 1/s, of (3) and (4) */
};

/* The closure of this name, NULL if there is none. */
const struct rheology_model *rheology_find(const char *name);

/* How many closures there are, and closure i; NULL if i is out of range. */
int rheology_count(void);
const struct rheology_model *rheology_get(int i);

/* The known name that looks most like `name`, for error messages. */
const char *rheology_nearest(const char *name);

/*
 * Key i of a model: its own, then those all models share (eta_min, eta_max,
 * gamma_r); NULL past the last. This is the list to loop over for help and logs
 * and to find a key's range; rheology_value gives its value in r.
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

/* The first key without a value, NULL if r is complete. */
const struct rheology_key *rheology_missing(const struct rheology *r);

/* Choose (2), (3) or (4) by name; returns 0, or -1 for an unknown name. The
 * second gives name i, NULL past the last; i is the enum. */
int rheology_set_regularisation(struct rheology *r, const char *name);
const char *rheology_regularisation_name(int i);

/*
 * Viscosity eta[i], Pa s, from shear_rate[i] >= 0, 1/s, equation (1), and
 * pressure[i], Pa. All [n]; eta overlaps neither of the others. Works on blocks
 * that fit the cache and allocates nothing.
 */
void rheology_eval(const struct rheology *r, int32_t n,
                   const double *shear_rate, const double *pressure,
                   double *eta);

#endif
