/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/lee_huang.h"

#include <float.h>
#include <string.h>

#include "models.h"
#include "talus/memory.h"

/* The values of table I of [lee_huang_chiew_2015]. */
static const struct rheology_key KEYS[] = {
    {"rho_d", "kg/m^3", 1e-12, 1e12, 2500., "density of a grain"},
    {"d", "m", 1e-12, 1e6, 1.15e-3, "grain diameter"},
    {"e_eff", "1", 0.01, 0.99, 0.58, "effective coefficient of restitution"},
    {"eta_S", "1", 0., 100., 0.42, "friction coefficient at rest"},
    {"nu_max", "1", 0.1, 1., 0.63, "solid fraction, densest"},
    {"nu_min", "1", 0.1, 1., 0.57, "solid fraction, random loose packing"},
    {"nu_0", "1", 0.1, 1., 0.6, "solid fraction of slow shear"},
    {"a", "1", 1e-3, 100., 0.28, "dilatancy 1/nu = 1/nu_0 + a I^delta"},
    {"delta", "1", 0.2, 2., 0.58, "its exponent"},
    {"K", "Pa", 1e-6, 1e15, 1e8, "stiffness of the packing"},
    {"chi", "1", 0.1, 10., 1.5, "exponent of its pressure"},
    {"n", "s", 1e-6, 1e12, 1e5,
     "regularisation 1 - exp(-n gamma/2); exact: of `state` only"},
    {"g0_exponent", "1", 0.5, 3., 1.,
     "of 1 - nu/nu_max in g_0; see the source"},
};
_Static_assert(NKEYS(KEYS) == LEE_HUANG_NKEYS, "keys and their names");

/* Steps of the tables. */
enum { NINERTIAL = 1024, NKINETIC = 1024 };
static const double STEP = 0.2; /* of the logarithms */
/* Margins of nu where the logarithms end, and of nu_0 - nu at the slowest
 * shear, which is smaller as its effect is magnified where p is close to
 * p_ES(nu_0). */
static const double ERROR = 1e-7, SLOW_ERROR = 1e-9;
/* Pressures below count as this, Pa, so that p_ES/p is finite. */
static const double LEAST_P = 1e-280;

/* A uniform axis. */
struct axis {
  double first, per_step; /* node i at first + i/per_step */
  int last;               /* node */
};

/* nu over log(I^2/(I_m^2 - I^2)) and a logarithm of the pressure. */
struct packed {
  struct axis I, p;
  double *nu; /* [p.last + 1][I.last + 1], in the block */
};

struct table {
  struct lee_huang_marks marks;
  double p_0;  /* p_ES(nu_0), Pa */
  double rate; /* d sqrt(rho_d): I sqrt(p)/gamma */
  double I_m2, I_tran2, I_max2;
  struct packed hard, soft; /* p < p_0, p > p_0 */
  struct axis inertial;     /* acosh(I_max/I) */
  double nu[NINERTIAL + 1];
  struct axis kinetic; /* nu */
  double pressure_stress[NKINETIC + 1][2];
  double nodes[]; /* of hard and soft */
};

static struct axis axis_of(double first, double last, int steps) {
  return (struct axis){first, steps / (last - first), steps};
}

static double node(const struct axis *axis, int i) {
  return axis->first + i / axis->per_step;
}

/* Return the first of the four nodes around x; also gives their weights.
 * Outside, the value is that of the end; NaN gets node 0 and NaN weights. */
static inline int four_nodes(const struct axis *axis, double x, double w[4]) {
  double t = (x - axis->first) * axis->per_step;
  t = at_most(at_least(t, 0), axis->last);
  int i = t >= 1 ? (int)t - 1 : 0;
  if (i > axis->last - 3) i = axis->last - 3;
  const double b = t - i - 1, a = b + 1, c = b - 1, d = b - 2;
  w[0] = -b * c * d * (1. / 6);
  w[1] = a * c * d * 0.5;
  w[2] = -a * b * d * 0.5;
  w[3] = a * b * c * (1. / 6);
  return i;
}

/* Return ln x of a normal x > 0 to 1e-9, enough for a coordinate, and
 * vectorised as log is not: x = 2^k m, 1/sqrt(2) <= m < sqrt(2), and the series
 * of ln m = 2 artanh(t). */
static inline double quick_log(double x) {
  const uint64_t root = 0x3fe6a09e667f3bcd; /* 1/sqrt(2) */
  uint64_t bits;
  double m;
  memcpy(&bits, &x, sizeof bits);
  const int64_t k = (int64_t)(bits - root) >> 52;
  bits -= (uint64_t)k << 52;
  memcpy(&m, &bits, sizeof m);
  const double t = (m - 1) / (m + 1), s = t * t;
  const double series =
      1 + s * (1. / 3 + s * (1. / 5 + s * (1. / 7 + s * (1. / 9))));
  return (double)k * 0.693147180559945309 + 2 * t * series;
}

/* Steady shear of a block of cells, n infinite. */
struct states {
  double I[RHEOLOGY_BLOCK];   /* not more than 2 I_max */
  double I_2[RHEOLOGY_BLOCK]; /* its square, not more than I_max^2 */
  double x[RHEOLOGY_BLOCK], y[RHEOLOGY_BLOCK]; /* in the packed tables */
  double nu[RHEOLOGY_BLOCK];
  double pE_over_p[RHEOLOGY_BLOCK];
  double stress[RHEOLOGY_BLOCK]; /* tau_K/(p I^2) */
};

static void set_coordinates(const struct table *table, int32_t n,
                            const double *restrict gamma,
                            const double *restrict p,
                            struct states *restrict s) {
  const double rate = table->rate, p_0 = table->p_0, I_m2 = table->I_m2;
  const double I_max2 = table->I_max2, most = 2 * table->marks.I_max;
  for (int32_t i = 0; i < n; i++) {
    const double p_i = at_least(p[i], LEAST_P);
    const double I = at_most(gamma[i] * rate / sqrt(p_i), most);
    const double I_2 = at_most(I * I, I_max2);
    s->I[i] = I, s->I_2[i] = I_2;
    s->x[i] = quick_log(at_least(I_2, DBL_MIN) / at_least(I_m2 - I_2, 1e-30));
    /* hard: p_0/p - 1; soft: 1/(p/p_0 - 1) */
    const double far = at_least(fabs(p_0 - p_i), DBL_MIN) / p_i;
    s->y[i] = quick_log(p_i < p_0 ? far : p_0 / p_i / at_least(far, DBL_MIN));
  }
}

static double packed_nu(const struct packed *packed, double x, double y) {
  double wx[4], wy[4], sum = 0;
  const int i = four_nodes(&packed->I, x, wx);
  const int j = four_nodes(&packed->p, y, wy);
  const double *row = packed->nu + j * (packed->I.last + 1) + i;
  for (int k = 0; k < 4; k++, row += packed->I.last + 1)
    sum += wy[k] *
           (wx[0] * row[0] + wx[1] * row[1] + wx[2] * row[2] + wx[3] * row[3]);
  return sum;
}

static double inertial_nu(const struct table *table, double I_2) {
  double w[4];
  const double ratio = table->I_max2 / I_2;
  const double t = log(sqrt(ratio) + sqrt(ratio - 1));
  const double *nu = table->nu + four_nodes(&table->inertial, t, w);
  return w[0] * nu[0] + w[1] * nu[1] + w[2] * nu[2] + w[3] * nu[3];
}

static void set_kinetic(const struct table *table, int32_t n,
                        struct states *restrict s) {
  for (int32_t i = 0; i < n; i++) {
    double w[4], pressure = 0, stress = 0;
    const int first = four_nodes(&table->kinetic, s->nu[i], w);
    for (int k = 0; k < 4; k++) {
      pressure += w[k] * table->pressure_stress[first + k][0];
      stress += w[k] * table->pressure_stress[first + k][1];
    }
    s->stress[i] = stress;
    s->pE_over_p[i] = s->I_2[i] < table->I_tran2 ? 1 - pressure * s->I_2[i] : 0;
  }
}

/* Find the states of a block in several passes, as one cell is a long chain of
 * dependent steps. */
static void find_states(const struct rheology *r, int32_t n,
                        const double *gamma, const double *p,
                        struct states *s) {
  const struct table *table = (const struct table *)r->table;
  const double slowest = 1 / r->param[LEE_HUANG_NU_0];
  const double a = r->param[LEE_HUANG_A];
  const double half_delta = 0.5 * r->param[LEE_HUANG_DELTA];
  set_coordinates(table, n, gamma, p, s);
  for (int32_t i = 0; i < n; i++) {
    const double I_2 = s->I_2[i];
    if (I_2 < table->I_m2)
      s->nu[i] = packed_nu(p[i] < table->p_0 ? &table->hard : &table->soft,
                           s->x[i], s->y[i]);
    else if (I_2 < table->I_tran2)
      s->nu[i] = 1 / (slowest + a * pow(I_2, half_delta)); /* eq. 23 */
    else
      s->nu[i] = inertial_nu(table, I_2);
  }
  set_kinetic(table, n, s);
}

/* Return (1 - exp(-n gamma/2))/gamma, eq. 18 */
static inline double regularised(double n, double gamma) {
  const double x = at_least(0.5 * n * gamma, DBL_MIN);
  return x > 40 ? 1 / gamma : 0.5 * n * (-expm1(-x) / x);
}

static void eval(const struct rheology *r, int32_t n,
                 const double *restrict shear_rate,
                 const double *restrict pressure, double *restrict eta) {
  struct states s;
  const double eta_S = r->param[LEE_HUANG_ETA_S];
  find_states(r, n, shear_rate, pressure, &s);
  for (int32_t i = 0; i < n; i++) {
    const double tau_K = s.stress[i] * s.I_2[i] * pressure[i];
    const double tau_E = eta_S * s.pE_over_p[i] * pressure[i];
    eta[i] = tau_K / at_least(shear_rate[i], DBL_MIN) +
             tau_E * regularised(r->param[LEE_HUANG_N], shear_rate[i]);
  }
}

/* Fill the viscosity of collisions, and the stress of enduring contact, eq. 17,
 * that grains keep at rest: without the regularisation of eq. 18. */
static void parts(const struct rheology *r, int32_t n,
                  const double *restrict shear_rate,
                  const double *restrict pressure, double *restrict eta,
                  double *restrict tau_y) {
  struct states s;
  const double eta_S = r->param[LEE_HUANG_ETA_S];
  find_states(r, n, shear_rate, pressure, &s);
  for (int32_t i = 0; i < n; i++) {
    const double tau_K = s.stress[i] * s.I_2[i] * pressure[i];
    eta[i] = tau_K / at_least(shear_rate[i], DBL_MIN);
    tau_y[i] = eta_S * s.pE_over_p[i] * pressure[i];
  }
}

static void eval_nu(const struct rheology *r, int32_t n,
                    const double *restrict shear_rate,
                    const double *restrict pressure, double *restrict out) {
  struct states s;
  find_states(r, n, shear_rate, pressure, &s);
  for (int32_t i = 0; i < n; i++) out[i] = s.nu[i];
}

static void eval_temperature(const struct rheology *r, int32_t n,
                             const double *restrict shear_rate,
                             const double *restrict pressure,
                             double *restrict out) {
  struct states s;
  find_states(r, n, shear_rate, pressure, &s);
  for (int32_t i = 0; i < n; i++) {
    const double speed = r->param[LEE_HUANG_D] * shear_rate[i];
    out[i] = lee_huang_kinetic(r->param, s.nu[i]).f4_2 * speed * speed;
  }
}

static void eval_contact(const struct rheology *r, int32_t n,
                         const double *restrict shear_rate,
                         const double *restrict pressure,
                         double *restrict out) {
  struct states s;
  find_states(r, n, shear_rate, pressure, &s);
  for (int32_t i = 0; i < n; i++) out[i] = s.pE_over_p[i];
}

/* Find the state [lee_huang_chiew_2015, section V C 4], the limits the right
 * way round; solid where eq. 18 gives less than 99 % of the yield stress. */
static void eval_state(const struct rheology *r, int32_t n,
                       const double *restrict shear_rate,
                       const double *restrict pressure, double *restrict out) {
  const struct table *table = (const struct table *)r->table;
  struct states s;
  find_states(r, n, shear_rate, pressure, &s);
  for (int32_t i = 0; i < n; i++) {
    const double x = 0.5 * r->param[LEE_HUANG_N] * shear_rate[i];
    /* The last state itself is not beyond for being rounded. */
    if (s.I[i] > table->marks.I_max * (1 + 1e-12))
      out[i] = RHEOLOGY_BEYOND;
    else if (s.pE_over_p[i] < 0.01)
      out[i] = RHEOLOGY_INERTIAL;
    else if (s.pE_over_p[i] <= 0.99)
      out[i] = RHEOLOGY_DENSE;
    else
      out[i] = x < log(100) ? RHEOLOGY_SOLID : RHEOLOGY_QUASI_STATIC;
  }
}

static const struct rheology_quantity OUTPUTS[] = {
    {"nu", "1", "solid fraction", eval_nu},
    {"T", "m^2/s^2", "granular temperature", eval_temperature},
    {"pE_over_p", "1", "part of the pressure by enduring contact",
     eval_contact},
    {"state", "1", "0 solid 1 quasi-static 2 dense 3 inertial 4 beyond",
     eval_state},
};

/* Set the axes of the packed tables, which end where nu is within ERROR of its
 * limit. */
static void set_axes(struct table *table, const double *param) {
  const double nu_0 = param[LEE_HUANG_NU_0], nu_min = param[LEE_HUANG_NU_MIN];
  const double I_least =
      pow(SLOW_ERROR / (param[LEE_HUANG_A] * nu_0), 1 / param[LEE_HUANG_DELTA]);
  const double low_I = 2 * log(fmin(I_least / table->marks.I_m, 1e-3));
  const double high_p = log(lee_huang_packing(param, nu_0) /
                            lee_huang_packing(param, nu_min * (1 + ERROR)));
  const double end = -log(ERROR);
  const int nI = (int)ceil((end - low_I) / STEP);
  table->hard.I = table->soft.I = axis_of(low_I, end, nI);
  table->hard.p = axis_of(-end, high_p, (int)ceil((high_p + end) / STEP));
  table->soft.p = axis_of(-end, end, (int)ceil(2 * end / STEP));
}

static void fill_packed(struct table *table, struct packed *packed,
                        const double *param) {
  const bool hard = packed == &table->hard;
  for (int j = 0; j <= packed->p.last; j++) {
    const double s = exp(node(&packed->p, j));
    const double p = table->p_0 / (hard ? 1 + s : s / (1 + s));
    for (int i = 0; i <= packed->I.last; i++) {
      const double q = exp(node(&packed->I, i));
      const double I = table->marks.I_m * sqrt(q / (1 + q));
      packed->nu[j * (packed->I.last + 1) + i] =
          lee_huang_direct(param, &table->marks, I, param[LEE_HUANG_K] / p).nu;
    }
  }
}

static void fill_lines(struct table *table, const double *param) {
  const struct lee_huang_marks *marks = &table->marks;
  const double end = acosh(marks->I_max / marks->I_tran);
  table->inertial = axis_of(0, fmax(end, 1e-6), NINERTIAL);
  for (int i = 0; i <= NINERTIAL; i++) {
    const double I = marks->I_max / cosh(node(&table->inertial, i));
    table->nu[i] = lee_huang_direct(param, marks, I, 0).nu;
  }
  table->nu[0] = marks->nu_last;
  table->nu[NINERTIAL] = marks->nu_tran;
  table->kinetic = axis_of(marks->nu_last, param[LEE_HUANG_NU_0], NKINETIC);
  for (int i = 0; i <= NKINETIC; i++) {
    const struct lee_huang_kinetic kinetic =
        lee_huang_kinetic(param, node(&table->kinetic, i));
    table->pressure_stress[i][0] = kinetic.pressure;
    table->pressure_stress[i][1] = kinetic.stress;
  }
}

static const char *prepare(const struct rheology *r, void **block) {
  const double *param = r->param;
  struct table head = {.rate =
                           param[LEE_HUANG_D] * sqrt(param[LEE_HUANG_RHO_D])};
  const char *wrong = lee_huang_find(param, &head.marks);
  if (wrong != NULL) return wrong;
  set_axes(&head, param);
  const size_t row = (size_t)head.hard.I.last + 1;
  const size_t nhard = row * (size_t)(head.hard.p.last + 1);
  const size_t nsoft = row * (size_t)(head.soft.p.last + 1);
  struct table *table = (struct table *)mem_alloc(
      1, sizeof head + (nhard + nsoft) * sizeof(double));
  *table = head;
  table->hard.nu = table->nodes;
  table->soft.nu = table->nodes + nhard;
  table->p_0 =
      param[LEE_HUANG_K] * lee_huang_packing(param, param[LEE_HUANG_NU_0]);
  table->I_m2 = head.marks.I_m * head.marks.I_m;
  table->I_tran2 = head.marks.I_tran * head.marks.I_tran;
  table->I_max2 = head.marks.I_max * head.marks.I_max;
  fill_packed(table, &table->hard, param);
  fill_packed(table, &table->soft, param);
  fill_lines(table, param);
  *block = table;
  return NULL;
}

static void limits(const struct rheology *r, double I[2]) {
  const struct table *table = (const struct table *)r->table;
  I[0] = table->marks.I_tran;
  I[1] = table->marks.I_max;
}

const struct rheology_model rheology_lee_huang = {
    .name = "lee_huang",
    .title = "kinetic and enduring-contact stress in local balance",
    .source = "lee_huang_chiew_2015, eqs. 6-9, 14, 17-24, A2-A6",
    .keys = KEYS,
    .nkeys = NKEYS(KEYS),
    .eval = eval,
    .holds = true,
    .parts = parts,
    .outputs = OUTPUTS,
    .noutputs = NKEYS(OUTPUTS),
    .prepare = prepare,
    .limits = limits,
};
