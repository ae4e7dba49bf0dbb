/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Balances of the two-fluid model that need no mesh: the closures, integrated
 * or solved, against numbers of an independent program. */
#include <check.h>
#include <math.h>

#include "talus/two_fluid_drag.h"
#include "talus/two_fluid_grains.h"

Suite *two_fluid_balance_suite(void);

#define EQUAL(a, b, relative) \
  ck_assert_double_eq_tol(a, b, (relative)*fabs(1. * (b)) + 1e-300)

static const double G = 9.81, PI = 3.14159265358979323846;

static struct two_fluid_closure closures(enum two_fluid_set set,
                                         enum two_fluid_fluid fluid, double d) {
  struct two_fluid_closure c;
  two_fluid_closure_init(&c, set);
  two_fluid_take_fluid(&c, fluid);
  c.param[TWO_FLUID_GRAINS_D] = d;
  ck_assert_ptr_null(two_fluid_prepare(&c));
  return c;
}

/* Return (rho_s - rho_f) g. */
static double weight(const struct two_fluid_closure *c) {
  return (c->param[TWO_FLUID_GRAINS_DENSITY] -
          c->param[TWO_FLUID_FLUID_DENSITY]) *
         G;
}

/* A function that has one root between two numbers. */
struct question {
  const struct two_fluid_closure *c;
  double number;
};
typedef double question_function(const struct question *q, double x);

static double bisect(question_function *f, const struct question *q, double low,
                     double high) {
  const bool rises = f(q, high) > 0;
  for (int k = 0; k < 200; k++) {
    const double x = 0.5 * (low + high);
    if ((f(q, x) > 0) == rises)
      high = x;
    else
      low = x;
  }
  return 0.5 * (low + high);
}

/* Return p_s at a depth by Runge and Kutta's method of order 4. */
static double bed_pressure(const struct two_fluid_closure *c, double depth,
                           double phi_p) {
  enum { STEPS = 1000 };
  const double h = depth / STEPS * weight(c);
  double p = 0;
  for (int k = 0; k < STEPS; k++) {
    const double k_1 = two_fluid_settled(c, p, phi_p);
    const double k_2 = two_fluid_settled(c, p + 0.5 * h * k_1, phi_p);
    const double k_3 = two_fluid_settled(c, p + 0.5 * h * k_2, phi_p);
    const double k_4 = two_fluid_settled(c, p + h * k_3, phi_p);
    p += h / 6 * (k_1 + 2 * k_2 + 2 * k_3 + k_4);
  }
  return p;
}

/* Depth, p_s, alpha of a bed in water, set A. */
static const double BED[][3] = {
    {0.006, 49.9322, 0.552626}, {0.03, 256.789, 0.568158},
    {0.06, 519.577, 0.574378},  {0.12, 1050.67, 0.580205},
    {0.18, 1585.7, 0.583415},   {0.24, 2123.14, 0.5856},
    {0.3, 2662.33, 0.587241},
};
enum { NBED = sizeof BED / sizeof *BED };

/* To the six digits of the reference. */
START_TEST(bed_at_rest_in_water) {
  const struct two_fluid_closure c =
      closures(TWO_FLUID_KTGF, TWO_FLUID_WATER, 1e-3);
  const double p = bed_pressure(&c, BED[_i][0], 0);
  EQUAL(p, BED[_i][1], 5e-6);
  ck_assert_double_eq_tol(two_fluid_settled(&c, p, 0), BED[_i][2], 1e-6);
}
END_TEST

/* Fluid, height, m, of grains of 1 mm that were laid at 0.55 and settle: their
 * fraction at the bottom and the speed of sound there, m/s. */
static const double SETTLED[][4] = {
    {TWO_FLUID_AIR, 0.1, 0.5824, 8.347}, {TWO_FLUID_AIR, 1, 0.5978, 30.78},
    {TWO_FLUID_AIR, 10, 0.6088, 117.1},  {TWO_FLUID_WATER, 0.1, 0.5784, 6.349},
    {TWO_FLUID_WATER, 1, 0.5949, 23.2},
};
enum { NSETTLED = sizeof SETTLED / sizeof *SETTLED };

/* c = sqrt(p_s'/rho_s), to the printed digits. */
START_TEST(bottom_of_a_settled_bed) {
  const double *row = SETTLED[_i];
  const struct two_fluid_closure c =
      closures(TWO_FLUID_KTGF, (enum two_fluid_fluid)row[0], 1e-3);
  const struct two_fluid_frozen rest = {0};
  const double phi = two_fluid_settled(&c, 0.55 * row[1] * weight(&c), 0);
  double slope;
  two_fluid_pressure(&c, phi, &rest, &slope);
  ck_assert_double_eq_tol(phi, row[2], 5.1e-5);
  EQUAL(sqrt(slope / 2560), row[3], 5e-4);
}
END_TEST

/* Return what drag on grains that fall with `velocity` through a fluid that
 * makes room takes, less their weight: K u_r = alpha alpha_f (rho_s - rho_f) g,
 * u_s = alpha_f u_r, with q->number alpha; both over alpha. */
static double fall(const struct question *q, double velocity) {
  const double a = 1 - q->number, u_r = velocity / a;
  return u_r * two_fluid_drag_per_phi(q->c, q->number, u_r,
                                      two_fluid_viscosity(q->c, 0)) -
         a * weight(q->c);
}

static double falling(const struct two_fluid_closure *c, double alpha) {
  const struct question q = {c, alpha};
  return bisect(fall, &q, 0, 1e4);
}

/* Fluid, d, m, terminal velocity, m/s. */
static const double TERMINAL[][3] = {
    {TWO_FLUID_AIR, 1e-4, 0.5647},    {TWO_FLUID_AIR, 1e-3, 6.893},
    {TWO_FLUID_AIR, 1e-2, 24.92},     {TWO_FLUID_WATER, 1e-4, 0.007562},
    {TWO_FLUID_WATER, 1e-3, 0.1498},  {TWO_FLUID_WATER, 1e-2, 0.6821},
    {TWO_FLUID_PAC2, 1e-4, 1.179e-4}, {TWO_FLUID_PAC2, 1e-2, 0.3656},
    {TWO_FLUID_PAC4, 1e-3, 0.003935}, {TWO_FLUID_PAC4, 1e-2, 0.226},
};
enum { NTERMINAL = sizeof TERMINAL / sizeof *TERMINAL };

/* At the viscosity of rest, to the digits of the reference; grains of 1 cm have
 * C_D = 0.44. */
START_TEST(one_grain_falls_at_its_terminal_velocity) {
  const double *row = TERMINAL[_i];
  const struct two_fluid_closure c =
      closures(TWO_FLUID_CRITICAL_STATE, (enum two_fluid_fluid)row[0], row[1]);
  EQUAL(falling(&c, 0), row[2], 5e-4);
}
END_TEST

/* alpha, velocity over that of Stokes, and with the exponent as printed. */
static const double HINDERED[][3] = {
    {0.005, 0.976961, 0.981871},   {0.055, 0.768702, 0.813441},
    {0.105, 0.597004, 0.667043},   {0.155, 0.456966, 0.540788},
    {0.255, 0.194585, 0.194585},   {0.305, 0.13208, 0.13208},
    {0.405, 0.0624133, 0.0624133}, {0.505, 0.0288208, 0.0288208},
    {0.605, 0.0122241, 0.0122241},
};
enum { NHINDERED = sizeof HINDERED / sizeof *HINDERED };

/* Re = 1e-9. */
START_TEST(grains_hinder_each_other) {
  const double *row = HINDERED[_i];
  struct two_fluid_closure c =
      closures(TWO_FLUID_CRITICAL_STATE, TWO_FLUID_WATER, 1e-7);
  c.param[TWO_FLUID_FLUID_ETA_0] = c.param[TWO_FLUID_FLUID_ETA_INF] = 1;
  const double stokes = weight(&c) * 1e-14 / 18;
  EQUAL(falling(&c, row[0]) / stokes, row[1], 4e-6);
  if (row[0] < 0.19)
    EQUAL(falling(&c, row[0]) / stokes, pow(1 - row[0], 4.65), 1e-6);
  c.param[TWO_FLUID_DRAG_WEN_YU_EXPONENT] = 0.65;
  EQUAL(falling(&c, row[0]) / stokes, row[2], 4e-6);
}
END_TEST

/* Return drag on grains at rest in a flux q->number, less their weight, both
 * over alpha. */
static double lift(const struct question *q, double alpha) {
  const double u = q->number / (1 - alpha);
  return u * two_fluid_drag_per_phi(q->c, alpha, u,
                                    two_fluid_viscosity(q->c, 0)) -
         (1 - alpha) * weight(q->c);
}

/* Return lift at q->number, of a flux. */
static double lift_at(const struct question *q, double flux) {
  const struct question of_flux = {q->c, flux};
  return lift(&of_flux, q->number);
}

/* Fluid, d, U_mf of 0.585, m/s. */
static const double FLUIDISED[][3] = {
    {TWO_FLUID_AIR, 1e-4, 0.01140},    {TWO_FLUID_AIR, 1e-3, 0.6191},
    {TWO_FLUID_WATER, 1e-3, 0.01033},  {TWO_FLUID_WATER, 1e-2, 0.07671},
    {TWO_FLUID_PAC2, 1e-3, 0.0001729}, {TWO_FLUID_PAC4, 1e-2, 0.005793},
};
enum { NFLUIDISED = sizeof FLUIDISED / sizeof *FLUIDISED };

START_TEST(least_flux_that_lifts_a_bed) {
  const double *row = FLUIDISED[_i];
  const struct two_fluid_closure c =
      closures(TWO_FLUID_CRITICAL_STATE, (enum two_fluid_fluid)row[0], row[1]);
  const struct question q = {&c, 0.585};
  EQUAL(bisect(lift_at, &q, 0, 1e3), row[2], 5e-4);
}
END_TEST

START_TEST(fluidised_bed_expands) {
  const struct two_fluid_closure c =
      closures(TWO_FLUID_CRITICAL_STATE, TWO_FLUID_WATER, 1e-3);
  const struct question slow = {&c, 0.014}, fast = {&c, 0.016};
  ck_assert_double_eq_tol(bisect(lift, &slow, 0.3, 0.7), 0.5411, 5e-5);
  ck_assert_double_eq_tol(bisect(lift, &fast, 0.3, 0.7), 0.5198, 5e-5);
}
END_TEST

/* Slope, J, phi, surface speed, m/s, of a submerged layer of 4.9 mm; sedFoam's
 * friction from the second part on. */
static const double INCLINE[][4] = {
    {19, 0.000114898, 0.578796, 0.000112544},
    {22, 0.000676772, 0.570167, 0.000640362},
    {25, 0.0015073, 0.563137, 0.00137691},
    {30, 0.00378144, 0.55111, 0.00323029},
    {24, 8.24484e-05, 0.579736, 7.81552e-05},
    {25, 0.000233286, 0.576199, 0.000218048},
    {30, 0.00152293, 0.563028, 0.00132909},
};
enum { NINCLINE = sizeof INCLINE / sizeof *INCLINE, NBOYER = 4 };

/* A pressure beside which p_c is nothing. */
static const double HIGH = 1e9;

/* Return phi at a number of shear. */
static double sheared(const struct two_fluid_closure *c, double J) {
  const struct two_fluid_frozen with = {.phi_p = 0.61, .X = J * HIGH};
  return two_fluid_solid_fraction(c, HIGH, &with, 0, 0.6);
}

/* Return tau/p_s of both phases at ln J, less q->number. */
static double stress_ratio(const struct question *q, double ln_J) {
  const double eta_f = 0.096, J = exp(ln_J), gamma = J * HIGH / eta_f;
  const double phi = sheared(q->c, J);
  const struct two_fluid_stress tau =
      two_fluid_stress(q->c, phi, HIGH, gamma, eta_f, 0);
  const double pores = (1 - phi) * two_fluid_pore_viscosity(q->c, phi, eta_f);
  return (tau.tau_y + (tau.eta + pores) * gamma) / HIGH - q->number;
}

/* mu(J) = tan(slope), u = J phi (rho_s - rho_f) g cos(slope) H^2/(2 eta_f). */
START_TEST(submerged_layer_on_a_slope) {
  const double *row = INCLINE[_i], H = 4.9e-3, angle = row[0] * PI / 180;
  struct two_fluid_closure c =
      closures(TWO_FLUID_CRITICAL_STATE, TWO_FLUID_WATER, 1.6e-4);
  c.param[TWO_FLUID_CS_PHI_M] = 0.585, c.param[TWO_FLUID_CS_INERTIAL] = 0;
  c.param[TWO_FLUID_FLUID_DENSITY] = 1041;
  c.param[TWO_FLUID_GRAINS_DENSITY] = 2500;
  if (_i < NBOYER) {
    c.param[TWO_FLUID_CS_MU_1] = 0.32, c.param[TWO_FLUID_CS_MU_2] = 0.7;
    c.param[TWO_FLUID_CS_J_0] = 0.005;
  }
  ck_assert_ptr_null(two_fluid_prepare(&c));
  const struct question q = {&c, tan(angle)};
  const double J = exp(bisect(stress_ratio, &q, log(1e-5), 0));
  const double phi = sheared(&c, J);
  EQUAL(J, row[1], 1e-5);
  EQUAL(phi, row[2], 2e-6);
  EQUAL(J * phi * weight(&c) * cos(angle) * H * H / (2 * 0.096), row[3], 1e-5);
}
END_TEST

Suite *two_fluid_balance_suite(void) {
  Suite *suite = suite_create("two_fluid_balance");
  TCase *tcase = tcase_create("balance");
  tcase_add_loop_test(tcase, bed_at_rest_in_water, 0, NBED);
  tcase_add_loop_test(tcase, bottom_of_a_settled_bed, 0, NSETTLED);
  tcase_add_loop_test(tcase, one_grain_falls_at_its_terminal_velocity, 0,
                      NTERMINAL);
  tcase_add_loop_test(tcase, grains_hinder_each_other, 0, NHINDERED);
  tcase_add_loop_test(tcase, least_flux_that_lifts_a_bed, 0, NFLUIDISED);
  tcase_add_test(tcase, fluidised_bed_expands);
  tcase_add_loop_test(tcase, submerged_layer_on_a_slope, 0, NINCLINE);
  suite_add_tcase(suite, tcase);
  return suite;
}
