/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/four_state_closure.h"

#include <check.h>
#include <math.h>

Suite *four_state_closure_suite(void);

/* Return the closures of table I, or with one key changed; knudsen: k. The
 * process ends with each test, and with it what they own. */
static struct four_state_closure closures(const char *key, double value,
                                          double knudsen) {
  struct four_state_closure c;
  struct rheology r;
  rheology_init(&r, rheology_find("lee_huang"));
  if (key != NULL) ck_assert_int_eq(rheology_set(&r, key, value), 0);
  ck_assert_ptr_null(four_state_closure_init(&c, r.param, knudsen));
  return c;
}

/* Plane shear at gamma = 1/s for table I, by an independent program: nu, p,
 * tau, T, I, pE/p, and the rate r of sqrt(T) = sqrt(T_eq) tanh(r t). */
static const double SHEAR[][7] = {
    {0.30, 0.00084980915, 0.00042621797, 4.4049601e-07, 1.9724552, 0,
     0.43003842},
    {0.40, 0.0012185326, 0.00062723461, 3.1597957e-07, 1.6472111, 0,
     0.66168265},
    {0.46, 0.0016965872, 0.00089771236, 2.7821217e-07, 1.3959818, 0,
     0.93528073},
    {0.50, 0.0022749306, 0.0012302751, 2.6066342e-07, 1.2055459, 0, 1.2586091},
    {0.52, 0.0044785548, 0.0022276365, 2.5349403e-07, 0.85920916, 0.39147169,
     1.5084369},
    {0.55, 0.027478792, 0.012067214, 2.4432084e-07, 0.34687182, 0.86071063,
     2.1171098},
    {0.565, 0.10314259, 0.044000304, 2.4033964e-07, 0.17903948, 0.95383154,
     2.6318962},
    {0.57, 0.18091874, 0.076735252, 2.3909207e-07, 0.13518424, 0.97138238,
     2.860641},
    {0.572, 28.258961, 11.869544, 2.3860362e-07, 0.010816575, 0.99981019,
     2.9631741},
    {0.574, 317.62617, 133.40381, 2.3812109e-07, 0.0032263368, 0.99998248,
     3.0730262}};
enum { NSHEAR = sizeof SHEAR / sizeof *SHEAR };

#define EQUAL(a, b, relative) \
  ck_assert_double_eq_tol(a, b, (relative)*fabs(b) + 1e-300)

START_TEST(plane_shear_is_the_closed_form) {
  const struct four_state_closure c = closures(NULL, 0, INFINITY);
  const double *row = SHEAR[_i], nu = row[0], gamma = 1;
  const struct four_state_rates rates = {0.5 * gamma * gamma, 0, INFINITY};
  const double T = four_state_temperature(&c, nu, 1, &rates, 1e6, NULL);
  const double p = four_state_pressure(&c, nu, T, NULL);
  const double p_E = p - four_state_kinetic_pressure(&c, nu, T);
  const double d = c.param[LEE_HUANG_D], rho = c.param[LEE_HUANG_RHO_D];
  const double mu_K = rho * d * sqrt(T) * four_state_numbers(&c, nu).mu;
  const double tau =
      gamma * (mu_K + four_state_contact_viscosity(&c, p_E, gamma));
  /* the digits of the reference */
  EQUAL(T, row[3], 1e-7);
  EQUAL(p, row[1], 1e-6);
  EQUAL(tau, row[2], 1e-6);
  EQUAL(d * gamma / sqrt(p / rho), row[4], 1e-6);
  ck_assert_double_eq_tol(p_E / p, row[5], 1e-6);
}
END_TEST

/* From T = 0, in one step or in many, up to the digits of the rate. */
START_TEST(fluctuations_grow_as_a_tanh_at_any_step) {
  const struct four_state_closure c = closures(NULL, 0, INFINITY);
  const double nu = SHEAR[_i][0], end = 1 / SHEAR[_i][6];
  const double exact = SHEAR[_i][3] * pow(tanh(1), 2);
  const struct four_state_rates rates = {0.5, 0, INFINITY};
  for (int steps = 1; steps <= 1000; steps *= 10) {
    double T = 0;
    for (int k = 0; k < steps; k++)
      T = four_state_temperature(&c, nu, T, &rates, end / steps, NULL);
    EQUAL(T, exact, 1e-6);
  }
}
END_TEST

/* Without shear s = s_0/(1 + B s_0 dt/(3 rho nu)). */
START_TEST(fluctuations_decay) {
  const struct four_state_closure c = closures(NULL, 0, 10);
  const double nu = 0.4, T = 0.3, dt = 1e-3;
  const struct four_state_rates none = {0, 0, INFINITY};
  const double after = four_state_temperature(&c, nu, T, &none, dt, NULL);
  const double B = 9 * 0.42 * four_state_numbers(&c, nu).lambda / 1.15e-3;
  EQUAL(sqrt(after), sqrt(T) / (1 + B * sqrt(T) * dt / (3 * nu)), 1e-12);
}
END_TEST

/* The damping is how the rate of change falls with T, here by differences over
 * a step that is short. */
START_TEST(damping_takes_back_a_change_of_temperature) {
  const struct four_state_closure c = closures(NULL, 0, 10);
  const double nu = 0.4, T = 0.3, dt = 1e-9, h = 1e-3;
  for (double DD = 0; DD < 1000; DD += 300) {
    const struct four_state_rates rates = {DD, 0, INFINITY};
    double damping, unused;
    const double lower =
        four_state_temperature(&c, nu, T - h, &rates, dt, &unused) - (T - h);
    const double upper =
        four_state_temperature(&c, nu, T + h, &rates, dt, &unused) - (T + h);
    four_state_temperature(&c, nu, T, &rates, dt, &damping);
    EQUAL(damping, -(upper - lower) / (2 * h * dt), 1e-4);
  }
}
END_TEST

/* By central differences, whose error is h^2 p'''/6 and round-off eps p/h; next
 * to kinks the slope belongs to one side. */
START_TEST(slope_is_the_derivative_of_pressure) {
  const struct four_state_closure c = closures(NULL, 0, 10);
  const double h = 1e-7;
  for (double nu = 0.01; nu < 0.66; nu += 0.0071) {
    for (double T = 0; T<2; T = T> 0 ? 100 * T : 1e-6) {
      double slope, p = four_state_pressure(&c, nu, T, &slope);
      const double up = four_state_pressure(&c, nu + h, T, NULL);
      const double down = four_state_pressure(&c, nu - h, T, NULL);
      ck_assert_double_eq_tol(slope, (up - down) / (2 * h),
                              1e-5 * fabs(slope) + 1e-8 * p / h + 1e-12);
    }
  }
}
END_TEST

START_TEST(pressure_rises_without_jumps) {
  const struct four_state_closure c = closures(NULL, 0, 10);
  for (double T = 0; T<2; T = T> 0 ? 100 * T : 1e-8) {
    double last = four_state_pressure(&c, 0, T, NULL), slope = 0;
    for (double nu = 1e-4; nu < 0.7; nu += 1e-4) {
      const double before = slope;
      const double p = four_state_pressure(&c, nu, T, &slope);
      ck_assert(p >= last);
      /* no more than the steeper end allows */
      ck_assert(p - last <= 1.2e-4 * fmax(slope, before) + 1e-12);
      ck_assert(T == 0 || slope > 0);
      last = p;
    }
  }
}
END_TEST

START_TEST(solid_fraction_inverts_pressure) {
  const struct four_state_closure c = closures(NULL, 0, 10);
  for (double T = 0; T<2; T = T> 0 ? 100 * T : 1e-10) {
    for (double nu = T > 0 ? 0.01 : 0.5701; nu < 0.68; nu += 0.0013) {
      const double p = four_state_pressure(&c, nu, T, NULL);
      const double back = four_state_solid_fraction(&c, p, T, 0, 0.6);
      ck_assert_double_eq_tol(back, nu, 1e-9);
      EQUAL(four_state_pressure(&c, back, T, NULL), p, 1e-10);
    }
  }
  for (double p = 0; p<1e9; p = p> 0 ? 10 * p : 1e-9) {
    const double nu = four_state_packed(&c, p);
    EQUAL(four_state_pressure(&c, nu, 0, NULL), p, 1e-9);
  }
  ck_assert_double_eq(four_state_packed(&c, 0), 0.57);
}
END_TEST

/* dE/dnu = p_ES/nu^2; the error of the quadrature is below 1e-5. */
START_TEST(elastic_energy_is_the_work_of_packing) {
  const struct four_state_closure c = closures(NULL, 0, 10);
  ck_assert_double_eq(four_state_elastic(&c, 0.57), 0);
  for (double nu = 0.571; nu < 0.63; nu += 0.004) {
    const double h = 1e-5;
    const double slope =
        (four_state_elastic(&c, nu + h) - four_state_elastic(&c, nu - h)) /
        (2 * h);
    EQUAL(slope, four_state_pressure(&c, nu, 0, NULL) / (nu * nu), 2e-4);
  }
}
END_TEST

/* Few grains: all numbers but lambda fall with nu if the mean free path counts,
 * and do not if the paper's do. */
START_TEST(mean_free_path_calms_few_grains) {
  const struct four_state_closure ours = closures(NULL, 0, 10);
  const struct four_state_closure paper = closures(NULL, 0, INFINITY);
  const struct four_state_numbers few = four_state_numbers(&ours, 1e-6);
  const struct four_state_numbers kept = four_state_numbers(&paper, 1e-6);
  const double path = 1 / (6 * sqrt(2) * 1e-6);
  EQUAL(few.mu, kept.mu / (1 + path / 10), 1e-4);
  EQUAL(few.kappa, kept.kappa / (1 + path / 10), 1e-4);
  EQUAL(few.delta, kept.delta / (1 + path / 10), 1e-4);
  EQUAL(few.lambda, kept.lambda, 1e-15);
  /* of a dilute gas: 5 sqrt(pi)/(24 (1 + e)(3 - e)) */
  EQUAL(kept.mu, 5 * sqrt(acos(-1)) / (24 * 1.58 * 2.42), 1e-5);
}
END_TEST

START_TEST(contact_stress_is_that_of_coulomb_or_of_a_stiff_fluid) {
  const struct four_state_closure c = closures(NULL, 0, 10);
  EQUAL(four_state_contact_viscosity(&c, 700, 1) * 1, 0.42 * 700, 1e-15);
  EQUAL(four_state_contact_viscosity(&c, 700, 0), 0.5e5 * 0.42 * 700, 1e-12);
  EQUAL(four_state_contact_viscosity(&c, 700, 1e-5),
        0.42 * 700 * -expm1(-0.5) / 1e-5, 1e-12);
  ck_assert_double_eq(four_state_contact_viscosity(&c, 0, 0), 0);
}
END_TEST

START_TEST(states_have_their_limits) {
  const struct four_state_closure c = closures(NULL, 0, 10);
  ck_assert_int_eq(four_state_name(&c, 0.009, 1), RHEOLOGY_INERTIAL);
  ck_assert_int_eq(four_state_name(&c, 0.5, 1), RHEOLOGY_DENSE);
  ck_assert_int_eq(four_state_name(&c, 0.995, 1), RHEOLOGY_QUASI_STATIC);
  ck_assert_int_eq(four_state_name(&c, 0.995, 1e-6), RHEOLOGY_SOLID);
}
END_TEST

START_TEST(bad_parameters_are_refused) {
  struct four_state_closure c;
  struct rheology r;
  rheology_init(&r, rheology_find("lee_huang"));
  rheology_set(&r, "nu_min", 0.61);
  ck_assert_ptr_nonnull(four_state_closure_init(&c, r.param, 10));
}
END_TEST

Suite *four_state_closure_suite(void) {
  Suite *suite = suite_create("four_state_closure");
  TCase *shear = tcase_create("shear"), *rest = tcase_create("functions");
  tcase_add_loop_test(shear, plane_shear_is_the_closed_form, 0, NSHEAR);
  tcase_add_loop_test(shear, fluctuations_grow_as_a_tanh_at_any_step, 0,
                      NSHEAR);
  tcase_add_test(rest, fluctuations_decay);
  tcase_add_test(rest, damping_takes_back_a_change_of_temperature);
  tcase_add_test(rest, slope_is_the_derivative_of_pressure);
  tcase_add_test(rest, pressure_rises_without_jumps);
  tcase_add_test(rest, solid_fraction_inverts_pressure);
  tcase_add_test(rest, elastic_energy_is_the_work_of_packing);
  tcase_add_test(rest, mean_free_path_calms_few_grains);
  tcase_add_test(rest, contact_stress_is_that_of_coulomb_or_of_a_stiff_fluid);
  tcase_add_test(rest, states_have_their_limits);
  tcase_add_test(rest, bad_parameters_are_refused);
  suite_add_tcase(suite, shear);
  suite_add_tcase(suite, rest);
  return suite;
}
