/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/four_state_closure.h"

#include <float.h>
#include <math.h>
#include <stdbool.h>
#include <stddef.h>

#include "talus/memory.h"
#include "talus/roots.h"

static const double PI = 3.14159265358979323846;

/* p_D goes on linearly from this far below nu_0. */
static const double POLE_MARGIN = 1e-3;

/* Pieces of the table: a hundred where p_D, a power of nu_0 - nu, is steepest.
 */
enum { PIECES = 1 << 16 };
/* Curves of the first table and of the second, each with its rise over a piece:
 * max(p_K, p_D)/(rho_d T), p_ES; p_K/(rho_d T), elastic energy. */
enum { HOT = 0, PACKING = 2, KINETIC = 4, ELASTIC = 6, WIDTH = 4 };

/* A function of nu with its derivative. */
struct slope {
  double value, slope;
};

/* Holds what the kinetic theory makes of nu. */
struct kinetic {
  struct slope g_0, contact; /* contact: C = (1 + e) nu g_0 */
  struct slope lambda, mu;   /* without the mean free path */
};

static struct kinetic kinetic_at(const double *param, double nu) {
  const double e = param[LEE_HUANG_E_EFF];
  const double q = param[LEE_HUANG_G0_EXPONENT];
  const double nu_max = param[LEE_HUANG_NU_MAX];
  struct kinetic k;
  const double room = 1 - nu / nu_max;
  /* eq. 14 */
  k.g_0.value = (1 - 7. / 16 * nu) / (q == 1 ? room : pow(room, q));
  const double rise = -7. / 16 / (1 - 7. / 16 * nu) + q / (nu_max - nu);
  k.g_0.slope = k.g_0.value * rise;
  k.contact.value = (1 + e) * nu * k.g_0.value;
  k.contact.slope = (1 + e) * (k.g_0.value + nu * k.g_0.slope);
  const double C = k.contact.value, dC = k.contact.slope;
  const double lambda = 4 / (3 * sqrt(PI)); /* eq. 7 */
  k.lambda.value = lambda * nu * C;
  k.lambda.slope = lambda * (C + nu * dC);
  /* eq. 8 */
  const double a = 0.4 * (3 * e - 1), b = 0.8;
  const double few = 5 * sqrt(PI) / (24 * (1 + e) * (3 - e)) / k.g_0.value;
  const double product = (1 + a * C) * (1 + b * C);
  k.mu.value = few * product + 0.6 * k.lambda.value;
  k.mu.slope =
      few * (dC * (a * (1 + b * C) + b * (1 + a * C)) - product * rise) +
      0.6 * k.lambda.slope;
  return k;
}

/* Give p_K/(rho_d T) for nu <= nu_0. */
static struct slope kinetic_ratio(double nu, const struct kinetic *k) {
  return (struct slope){nu * (1 + 2 * k->contact.value),
                        1 + 2 * k->contact.value + 2 * nu * k->contact.slope};
}

/* Give p_D/(rho_d T) for nu <= nu_D. */
static struct slope dilatancy_ratio(const double *param, double nu,
                                    const struct kinetic *k) {
  const double b = 2 / param[LEE_HUANG_DELTA], nu_0 = param[LEE_HUANG_NU_0];
  const double base = param[LEE_HUANG_A] * nu_0 * nu / (nu_0 - nu);
  if (nu <= 0) return (struct slope){0, 0};
  const double value = 9 * (1 - param[LEE_HUANG_E_EFF]) * k->lambda.value /
                       k->mu.value * pow(base, b);
  return (struct slope){
      value, value * (k->lambda.slope / k->lambda.value -
                      k->mu.slope / k->mu.value + b / nu + b / (nu_0 - nu))};
}

/* Give p_ES for nu <= nu_max, Pa. */
static struct slope packing(const double *param, double nu) {
  const double x = nu - param[LEE_HUANG_NU_MIN], chi = param[LEE_HUANG_CHI];
  const double range = param[LEE_HUANG_NU_MAX] - param[LEE_HUANG_NU_MIN];
  if (x <= 0) return (struct slope){0, 0};
  /* 1 + sin(y - pi/2) of eq. 20 is 2 sin^2(y/2), without cancellation */
  const double angle = 0.5 * PI * x / range, sine = sin(angle);
  const double power = 2 * param[LEE_HUANG_K] * pow(x, chi);
  return (struct slope){
      power * nu * sine * sine,
      power * sine *
          (sine * (1 + nu * chi / x) + nu * PI / range * cos(angle))};
}

/* Go on linearly from `end`, whose value and slope are given. */
static struct slope beyond(const double at_end[2], double end, double nu) {
  return (struct slope){at_end[0] + at_end[1] * (nu - end), at_end[1]};
}

static struct slope packing_of(const struct four_state_closure *c, double nu) {
  const double end = c->param[LEE_HUANG_NU_MAX];
  return nu > end ? beyond(c->p_ES, end, nu) : packing(c->param, nu);
}

/* Give max(p_K, p_D)/(rho_d T), and p_K/(rho_d T) alone. */
static struct slope hot_of(const struct four_state_closure *c, double nu,
                           struct slope *kinetic_part) {
  const double end = c->param[LEE_HUANG_NU_0];
  const struct kinetic k = kinetic_at(c->param, fmin(nu, end));
  const struct slope p_K =
      nu > end ? beyond(c->p_K, end, nu) : kinetic_ratio(nu, &k);
  const struct slope p_D = nu > c->nu_D ? beyond(c->p_D, c->nu_D, nu)
                                        : dilatancy_ratio(c->param, nu, &k);
  *kinetic_part = p_K;
  return p_D.value > p_K.value ? p_D : p_K;
}

/* Return the integral of p_ES/nu^2 from nu_min. */
static double elastic_of(const struct four_state_closure *c, double nu) {
  /* Gauss-Legendre of five points over [nu_min, nu]: 1e-6 up to nu_max */
  static const double x[] = {0, 0.5384693101056831, 0.9061798459386640};
  static const double w[] = {0.5688888888888889, 0.4786286704993665,
                             0.2369268850561891};
  const double low = c->param[LEE_HUANG_NU_MIN];
  const double half = 0.5 * (nu - low), centre = 0.5 * (nu + low);
  double sum = 0;
  if (half <= 0) return 0;
  for (int k = -2; k <= 2; k++) {
    const int j = k < 0 ? -k : k;
    const double at = centre + (k < 0 ? -half : half) * x[j];
    sum += w[j] * packing_of(c, at).value / (at * at);
  }
  return half * sum;
}

/* Return curve `curve` of node k. */
static inline double *at_node(const struct four_state_closure *c, int k,
                              int curve) {
  return c->table[curve / WIDTH][k] + curve % WIDTH;
}

static void put(struct four_state_closure *c, int k, int curve,
                struct slope of) {
  double *node = at_node(c, k, curve);
  node[0] = of.value, node[1] = of.slope / c->per_nu;
}

static void make_tables(struct four_state_closure *c) {
  for (int t = 0; t < 2; t++)
    c->table[t] = mem_alloc(PIECES + 1, sizeof *c->table[t]);
  for (int k = 0; k <= PIECES; k++) {
    const double nu = k / c->per_nu;
    struct slope p_K;
    const struct slope hot = hot_of(c, nu, &p_K), p_ES = packing_of(c, nu);
    const struct slope elastic = {elastic_of(c, nu),
                                  nu > 0 ? p_ES.value / (nu * nu) : 0};
    put(c, k, HOT, hot), put(c, k, KINETIC, p_K);
    put(c, k, PACKING, p_ES), put(c, k, ELASTIC, elastic);
  }
}

const char *four_state_closure_init(struct four_state_closure *c,
                                    const double *param, double knudsen) {
  struct lee_huang_marks marks;
  const char *wrong = lee_huang_find(param, &marks);
  if (wrong != NULL) return wrong;
  for (int k = 0; k < LEE_HUANG_NKEYS; k++) c->param[k] = param[k];
  const double nu_0 = param[LEE_HUANG_NU_0];
  c->knudsen = knudsen;
  c->nu_D = nu_0 - POLE_MARGIN;
  const struct kinetic k_D = kinetic_at(param, c->nu_D);
  const struct kinetic k_0 = kinetic_at(param, nu_0);
  const struct slope p_D = dilatancy_ratio(param, c->nu_D, &k_D);
  const struct slope p_K = kinetic_ratio(nu_0, &k_0);
  const struct slope p_ES = packing(param, param[LEE_HUANG_NU_MAX]);
  c->p_D[0] = p_D.value, c->p_D[1] = p_D.slope;
  c->p_K[0] = p_K.value, c->p_K[1] = p_K.slope;
  c->p_ES[0] = p_ES.value, c->p_ES[1] = p_ES.slope;
  c->per_nu = PIECES / param[LEE_HUANG_NU_MAX];
  make_tables(c);
  return NULL;
}

void four_state_closure_release(struct four_state_closure *c) {
  for (int t = 0; t < 2; t++) {
    mem_free(c->table[t]);
    c->table[t] = NULL;
  }
}

/* Look one curve up; nu < nu_max. A cubic between two nodes. */
static inline struct slope look_up(const struct four_state_closure *c,
                                   double nu, int curve) {
  const double at = nu * c->per_nu;
  const int k = (int)at;
  const double *here = at_node(c, k, curve), *next = at_node(c, k + 1, curve);
  const double rise = next[0] - here[0], m0 = here[1], m1 = next[1];
  const double t = at - k, c2 = 3 * rise - 2 * m0 - m1, c3 = m0 + m1 - 2 * rise;
  return (struct slope){here[0] + t * (m0 + t * (c2 + t * c3)),
                        c->per_nu * (m0 + t * (2 * c2 + 3 * t * c3))};
}

static inline bool is_in_table(const struct four_state_closure *c, double nu) {
  return nu * c->per_nu < PIECES;
}

double four_state_pressure(const struct four_state_closure *c, double nu,
                           double T, double *slope) {
  const double rho_T = c->param[LEE_HUANG_RHO_D] * T;
  struct slope hot = {0, 0}, p_ES = {0, 0};
  if (is_in_table(c, nu)) {
    if (T > 0) hot = look_up(c, nu, HOT);
    if (nu > c->param[LEE_HUANG_NU_MIN]) p_ES = look_up(c, nu, PACKING);
  } else {
    struct slope unused;
    hot = hot_of(c, nu, &unused);
    p_ES = packing_of(c, nu);
  }
  if (slope != NULL) *slope = p_ES.slope + rho_T * hot.slope;
  return fmax(p_ES.value, 0) + rho_T * hot.value;
}

double four_state_kinetic_pressure(const struct four_state_closure *c,
                                   double nu, double T) {
  struct slope p_K;
  if (is_in_table(c, nu))
    p_K = look_up(c, nu, KINETIC);
  else
    hot_of(c, nu, &p_K);
  return c->param[LEE_HUANG_RHO_D] * T * p_K.value;
}

double four_state_elastic(const struct four_state_closure *c, double nu) {
  if (nu <= c->param[LEE_HUANG_NU_MIN]) return 0;
  return is_in_table(c, nu) ? look_up(c, nu, ELASTIC).value : elastic_of(c, nu);
}

/* Holds what p(nu) is taken with, for root_of_rising. */
struct question {
  const struct four_state_closure *c;
  double T;
};

static double pressure_of(double nu, double *slope, const void *context) {
  const struct question *of = context;
  return four_state_pressure(of->c, nu, of->T, slope);
}

double four_state_solid_fraction(const struct four_state_closure *c, double p,
                                 double T, double from, double guess) {
  const struct question of = {c, T};
  return root_of_rising(pressure_of, &of, p, from, guess);
}

double four_state_packed(const struct four_state_closure *c, double p) {
  const double low = c->param[LEE_HUANG_NU_MIN];
  if (!(p > 0)) return low;
  return four_state_solid_fraction(c, p, 0, low, c->param[LEE_HUANG_NU_0]);
}

struct four_state_numbers four_state_numbers(const struct four_state_closure *c,
                                             double nu) {
  const double *param = c->param, e = param[LEE_HUANG_E_EFF];
  nu = fmin(fmax(nu, 1e-12), param[LEE_HUANG_NU_0]);
  const struct kinetic k = kinetic_at(param, nu);
  const double g = k.g_0.value, C = k.contact.value;
  const double path = 1 / (6 * sqrt(2) * nu * g); /* over d */
  const double rare = 1 / (1 + path / c->knudsen);
  struct four_state_numbers n = {k.lambda.value, k.mu.value, 0, 0};
  n.kappa = 25 * sqrt(PI) / (4 * g * (1 + e) * (49 - 33 * e)) *
                (1 + 0.6 * (1 + e) * (2 * e - 1) * C) * (1 + 1.2 * C) +
            1.5 * n.lambda; /* eq. 11 */
  n.delta = 15 * e * (1 - e) * sqrt(PI) / (4 * (49 - 33 * e)) *
            (2 * nu + nu * nu * k.g_0.slope / g) / nu *
            (1 + 1.2 * C); /* eq. 12: d(nu^2 g_0)/dnu over nu g_0 */
  n.mu *= rare, n.kappa *= rare, n.delta *= rare;
  return n;
}

double four_state_contact_viscosity(const struct four_state_closure *c,
                                    double p_E, double gamma) {
  const double n = c->param[LEE_HUANG_N];
  const double x = fmax(0.5 * n * gamma, DBL_MIN);
  const double factor = x > 40 ? 1 / gamma : 0.5 * n * (-expm1(-x) / x);
  return p_E * c->param[LEE_HUANG_ETA_S] * factor; /* eq. 18 */
}

/* Return s after a time, 3 rho_d nu of it as unit, by ds/dt = A - B s^2. */
static double fluctuate(double A, double B, double s, double time) {
  const double end = sqrt(A / B), reach = tanh(sqrt(A * B) * time);
  const double fall = end > 0 ? reach / end : B * time;
  return (s + end * reach) / (1 + s * fall);
}

double four_state_temperature(const struct four_state_closure *c, double nu,
                              double T, const struct four_state_rates *rates,
                              double dt, double *damping) {
  const double rho = c->param[LEE_HUANG_RHO_D], d = c->param[LEE_HUANG_D];
  const struct four_state_numbers k = four_state_numbers(c, nu);
  const double div2 = rates->div * rates->div;
  double A = fmax(
      rho * d * (2 * k.mu * rates->DD + (k.lambda - 2. / 3 * k.mu) * div2), 0);
  const double B = 9 * (1 - c->param[LEE_HUANG_E_EFF]) * k.lambda * rho / d;
  const double time = dt / (3 * rho * nu), s = sqrt(T);
  double s_new = fluctuate(A, B, s, time);
  const double power = 0.5 * A * (s + s_new);
  if (power > rates->most) {
    A *= rates->most / power;
    s_new = fluctuate(A, B, s, time);
  }
  if (damping != NULL)
    *damping = s > 0 ? (3 * B * s - A / s) / (3 * rho * nu) : 0;
  return s_new * s_new;
}

int four_state_name(const struct four_state_closure *c, double pE_over_p,
                    double gamma) {
  if (pE_over_p < 0.01) return RHEOLOGY_INERTIAL;
  if (pE_over_p <= 0.99) return RHEOLOGY_DENSE;
  return 0.5 * c->param[LEE_HUANG_N] * gamma < log(100) ? RHEOLOGY_SOLID
                                                        : RHEOLOGY_QUASI_STATIC;
}
