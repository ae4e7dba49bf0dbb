/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The sets critical_state, rauter and mu_i_phi_i. */
#include <check.h>
#include <math.h>

#include "talus/two_fluid_drag.h"
#include "talus/two_fluid_grains.h"

Suite *two_fluid_shearing_suite(void);

#define EQUAL(a, b, relative) \
  ck_assert_double_eq_tol(a, b, (relative)*fabs(1. * (b)) + 1e-300)

enum { NSETS = 3 };

static struct two_fluid_closure closures(enum two_fluid_set set) {
  struct two_fluid_closure c;
  two_fluid_closure_init(&c, set);
  ck_assert_ptr_null(two_fluid_prepare(&c));
  return c;
}

static void put(struct two_fluid_closure *c, const char *section,
                const char *name, double value) {
  const int k = two_fluid_find_number(section, name);
  ck_assert_int_ge(k, 0);
  c->param[k] = value;
}

/* Return one of the sets with the constants of [boyer_2011], viscous. */
static struct two_fluid_closure boyer(enum two_fluid_set set) {
  struct two_fluid_closure c = closures(set);
  const char *section = two_fluid_set_names[set];
  put(&c, section, "mu_1", 0.32), put(&c, section, "mu_2", 0.70);
  put(&c, section, "J_0", 0.005), put(&c, section, "phi_m", 0.585);
  put(&c, section, "inertial", 0);
  ck_assert_ptr_null(two_fluid_prepare(&c));
  return c;
}

/* J, phi, mu of both phases, mu of the grains, by an independent program. */
static const double MU_J[][4] = {
    {1e-05, 0.583156, 0.325393, 0.320758},
    {5.62341e-05, 0.580646, 0.33525, 0.324226},
    {0.000316228, 0.574779, 0.368927, 0.342604},
    {0.00177828, 0.561329, 0.483144, 0.419693},
    {0.01, 0.531818, 0.729583, 0.573333},
    {0.0562341, 0.472866, 1.07202, 0.668972},
    {0.316228, 0.374438, 1.83274, 0.694085},
    {1, 0.2925, 3.16061, 0.698109},
};
enum { NMU_J = sizeof MU_J / sizeof *MU_J };

/* A pressure is imposed so high that p_c is nothing beside it; phi_p is above
 * all phi. To the digits of the reference. */
START_TEST(imposed_pressure_gives_boyer) {
  const double *row = MU_J[_i / 2], p = 1e9, eta_f = 0.3;
  const struct two_fluid_closure c =
      boyer(_i % 2 ? TWO_FLUID_RAUTER : TWO_FLUID_CRITICAL_STATE);
  const double gamma = row[0] * p / eta_f;
  const struct two_fluid_frozen with = {.phi_p = 0.61,
                                        .X = two_fluid_shear(&c, gamma, eta_f)};
  const double phi = two_fluid_solid_fraction(&c, p, &with, 0, 0.6);
  EQUAL(phi, row[1], 3e-6);
  const struct two_fluid_stress tau =
      two_fluid_stress(&c, phi, p, gamma, eta_f, 0);
  const double grains = (tau.tau_y + tau.eta * gamma) / p;
  EQUAL(grains, row[3], 3e-6);
  const double fluid =
      (1 - phi) * two_fluid_pore_viscosity(&c, phi, eta_f) * gamma / p;
  EQUAL(grains + fluid, row[2], 6e-6);
  EQUAL(fluid, row[0] + 2.5 * 0.585 * sqrt(row[0]), 1e-5);
}
END_TEST

/* mu of I in air and phi = phi_m/(1 + b I), whose tangent at I = 0 is phi_m -
 * 0.2 I. Smaller I have phi so near to phi_m that P goes on linearly. */
START_TEST(mu_i_phi_i_knows_only_the_inertial_number) {
  const struct two_fluid_closure c = closures(TWO_FLUID_MU_I_PHI_I);
  const double p = 1e9, rho = 2560, d = 1e-3;
  for (double I = 0.006; I < 3; I *= 2) {
    const double gamma = I / d * sqrt(p / rho);
    const struct two_fluid_frozen with = {.X = two_fluid_shear(&c, gamma, 1e9)};
    const double phi = two_fluid_solid_fraction(&c, p, &with, 0, 0.6);
    /* p_c is 1e-7 p at most */
    EQUAL(phi, 0.585 / (1 + 0.2 / 0.585 * I), 1e-7);
    if (I < 0.1) ck_assert_double_eq_tol(phi, 0.585 - 0.2 * I, 0.07 * I * I);
    const struct two_fluid_stress tau =
        two_fluid_stress(&c, phi, p, gamma, 1e9, 0);
    EQUAL((tau.tau_y + tau.eta * gamma) / p,
          0.38 + (0.64 - 0.38) / (1 + 0.279 / I), 1e-12);
  }
}
END_TEST

/* J = J_viscous + a_I I^2. */
START_TEST(inertia_adds_to_the_number_of_shear) {
  const struct two_fluid_closure c = closures(TWO_FLUID_CRITICAL_STATE);
  const double gamma = 7, eta_f = 0.01, rho = 2560, d = 1e-3;
  const double X = eta_f * gamma + 0.635 * rho * d * d * gamma * gamma;
  EQUAL(two_fluid_shear(&c, gamma, eta_f), X, 1e-12);
  const double p = 20, J = X / p;
  const struct two_fluid_stress tau =
      two_fluid_stress(&c, 0.5, p, gamma, eta_f, 0);
  EQUAL(tau.tau_y, 0.425 * p, 1e-12);
  EQUAL(tau.eta * gamma, (0.765 - 0.425) / (1 + 0.004 / J) * p, 1e-12);
}
END_TEST

START_TEST(stress_is_finite_at_rest_and_without_pressure) {
  for (int set = 0; set < NSETS; set++) {
    const struct two_fluid_closure c = closures(set);
    for (double p = 0; p<1e12; p = p> 0 ? 100 * p : 1e-300)
      for (double gamma = 0;
           gamma<1e12; gamma = gamma> 0 ? 100 * gamma : 1e-300) {
        const struct two_fluid_stress tau =
            two_fluid_stress(&c, 0.55, p, gamma, 1e-3, 0);
        ck_assert(isfinite(tau.eta) && tau.eta >= 0);
        ck_assert(isfinite(tau.tau_y) && tau.tau_y >= 0);
        const double eta = two_fluid_capped(&tau, gamma, 0, 1e7);
        ck_assert(eta >= 0 && eta <= 1e7);
        ck_assert(two_fluid_capped(&tau, gamma, 1e-3, 1e7) <= 1e7);
      }
  }
  /* (mu_2 - mu_1) eta_f/J_0 and the cap */
  const struct two_fluid_closure c = boyer(TWO_FLUID_RAUTER);
  const struct two_fluid_stress tau = two_fluid_stress(&c, 0.5, 9, 0, 1e-3, 0);
  EQUAL(tau.eta, 0.38e-3 / 0.005, 1e-12);
  ck_assert_double_eq(two_fluid_capped(&tau, 0, 0, 1e5), 1e5);
  const struct two_fluid_stress none = {3, 0, 0};
  ck_assert_double_eq(two_fluid_capped(&none, 0, 0, 1e5), 3);
  EQUAL(two_fluid_capped(&tau, 0, 0.1, 1e5), tau.eta + 28.8, 1e-12);
  EQUAL(two_fluid_capped(&tau, 2, 0, 1e5), tau.eta + 1.44, 1e-12);
}
END_TEST

/* Return phi_p after shear at an imposed pressure has gone on for a strain. */
static double shear_on(const struct two_fluid_closure *c, double phi_p,
                       double p, double gamma, double eta_f, double strain) {
  const double dt = 1e-3 / gamma, X = two_fluid_shear(c, gamma, eta_f);
  for (double t = 0; t < strain / gamma; t += dt) {
    const struct two_fluid_frozen with = {.phi_p = phi_p, .X = X};
    const double phi = two_fluid_solid_fraction(c, p, &with, 0, 0.62);
    phi_p = two_fluid_plastic(
        c, phi_p, two_fluid_plastic_rate(c, phi, p, gamma, eta_f), dt);
  }
  return phi_p;
}

/* Loose and dense beds meet at phi_c/(1 + sqrt(J)), with p_c the rest of p. */
START_TEST(loose_and_dense_beds_meet_at_the_critical_state) {
  const struct two_fluid_closure c = closures(TWO_FLUID_CRITICAL_STATE);
  const double p = 200, eta_f = 0.012, gamma = 2;
  const double X = two_fluid_shear(&c, gamma, eta_f);
  const double phi_eq = 0.57 / (1 + sqrt(X / p));
  const double p_sh = X * pow(phi_eq / (0.625 - phi_eq), 2);
  const double exact = two_fluid_plastic_of(&c, phi_eq, p - p_sh);
  const double starts[] = {0.5, 0.609};
  for (int k = 0; k < 2; k++) {
    const double phi_p = shear_on(&c, starts[k], p, gamma, eta_f, 3);
    EQUAL(phi_p, exact, 1e-9);
    const struct two_fluid_frozen with = {.phi_p = phi_p, .X = X};
    EQUAL(two_fluid_solid_fraction(&c, p, &with, 0, 0.62), phi_eq, 1e-9);
  }
}
END_TEST

START_TEST(plastic_packing_keeps_its_bounds) {
  const struct two_fluid_closure c = closures(TWO_FLUID_CRITICAL_STATE);
  /* |delta| <= 1/2: loose grows, dense falls; none at rest */
  EQUAL(two_fluid_plastic_rate(&c, 0.3, 50, 4, 1e-3), 2, 1e-15);
  EQUAL(two_fluid_plastic_rate(&c, 0.62, 50, 4, 1e-3), -2, 1e-15);
  ck_assert_double_eq(two_fluid_plastic_rate(&c, 0.3, 0, 0, 1e-3), 0);
  /* 40 (phi - phi_eq), with the least pressure in J */
  const double J = two_fluid_shear(&c, 4, 1e-3) / 0.5;
  const double phi = 0.57 / (1 + sqrt(J)) + 0.01;
  EQUAL(two_fluid_plastic_rate(&c, phi, 0, 4, 1e-3), -0.4 * 4, 1e-12);
  ck_assert_double_eq(two_fluid_plastic(&c, 0.55, 100, 1), 0.585);
  ck_assert_double_eq(two_fluid_plastic(&c, 0.55, -100, 1), 0.48);
  ck_assert_double_eq(two_fluid_plastic(&c, 0.609, 100, 1), 0.609);
  ck_assert_double_eq(two_fluid_plastic(&c, 0.609, 0, 1), 0.609);
  EQUAL(two_fluid_plastic(&c, 0.55, -0.1, 0.2), 0.55 * exp(-0.02), 1e-15);
  /* other sets have none */
  const struct two_fluid_closure r = closures(TWO_FLUID_RAUTER);
  ck_assert_double_eq(two_fluid_plastic_rate(&r, 0.3, 50, 4, 1e-3), 0);
}
END_TEST

START_TEST(shear_pressure_builds_up_with_strain_and_falls_at_once) {
  static const enum two_fluid_set sets[] = {
      TWO_FLUID_CRITICAL_STATE, TWO_FLUID_RAUTER, TWO_FLUID_MU_I_PHI_I};
  static const char *const names[] = {"critical_state", "rauter", "mu_i_phi_i"};
  for (int s = 0; s < 3; s++) {
    struct two_fluid_closure c = closures(sets[s]);
    const double steady = two_fluid_shear(&c, 10, 1e-3);
    const double at_once = s == 1 ? 10 * 1e-3 : 0; /* the viscous part */
    const double after = steady - (steady - at_once) * exp(-0.5);
    /* one step or many of a strain 0.5 phi */
    double X = two_fluid_relaxed_shear(&c, 0, 10, 1e-3, 0.5, 0.1);
    EQUAL(X, after, 1e-14);
    X = 0;
    for (int k = 0; k < 100; k++)
      X = two_fluid_relaxed_shear(&c, X, 10, 1e-3, 0.5, 1e-3);
    EQUAL(X, after, 1e-13);
    ck_assert_double_eq(two_fluid_relaxed_shear(&c, 5, 0, 1e-3, 0.5, 1e-9), 0);
    put(&c, names[s], "relax", 1e30);
    ck_assert(two_fluid_prepare(&c) == NULL);
    X = two_fluid_relaxed_shear(&c, 0, 10, 1e-3, 0.5, 1e-9);
    EQUAL(X, steady, 1e-15);
  }
}
END_TEST

START_TEST(a_prepared_dense_bed_carries_its_weight) {
  const struct two_fluid_closure c = closures(TWO_FLUID_CRITICAL_STATE);
  for (double p = 1; p < 1e4; p *= 10) {
    const struct two_fluid_frozen with = {.phi_p =
                                              two_fluid_plastic_of(&c, 0.6, p)};
    ck_assert_double_eq_tol(two_fluid_pressure(&c, 0.6, &with, NULL), p,
                            1e-9 * p);
  }
  ck_assert_double_eq(two_fluid_plastic_of(&c, 0.3, 1e9), 0);
}
END_TEST

START_TEST(numbers_that_contradict_are_refused) {
  static const struct {
    enum two_fluid_set set;
    const char *name;
    double value;
  } WRONG[] = {{TWO_FLUID_CRITICAL_STATE, "mu_1", 0.9},
               {TWO_FLUID_CRITICAL_STATE, "phi_max", 0.49},
               {TWO_FLUID_CRITICAL_STATE, "phi_p_high", 0.4},
               {TWO_FLUID_CRITICAL_STATE, "phi_c", 0.63},
               {TWO_FLUID_RAUTER, "phi_rlp", 0.62},
               {TWO_FLUID_MU_I_PHI_I, "mu_2", 0.1},
               {TWO_FLUID_MU_I_PHI_I, "phi_rcp", 0.6},
               {TWO_FLUID_KTGF, "phi_fr", 0.62},
               {TWO_FLUID_KTGF, "phi_star", 0.63}};
  for (size_t k = 0; k < sizeof WRONG / sizeof *WRONG; k++) {
    struct two_fluid_closure c = closures(WRONG[k].set);
    put(&c, two_fluid_set_names[WRONG[k].set], WRONG[k].name, WRONG[k].value);
    ck_assert_ptr_nonnull(two_fluid_prepare(&c));
  }
  ck_assert_int_eq(two_fluid_find_number("rauter", "angle"), -1);
  ck_assert_int_eq(two_fluid_find_number("ktgf", "angle"), TWO_FLUID_KT_ANGLE);
}
END_TEST

START_TEST(every_number_has_a_default_in_its_range) {
  const struct two_fluid_closure c = closures(TWO_FLUID_KTGF);
  for (int k = 0; k < TWO_FLUID_NKEYS; k++) {
    const struct key *key = &two_fluid_numbers[k];
    ck_assert_ptr_nonnull(key->path);
    ck_assert_uint_eq(key->offset, offsetof(struct two_fluid_closure, param) +
                                       (size_t)k * sizeof(double));
    ck_assert(key->low <= c.param[k] && c.param[k] <= key->high);
  }
}
END_TEST

Suite *two_fluid_shearing_suite(void) {
  Suite *suite = suite_create("two_fluid_shearing");
  TCase *tcase = tcase_create("shearing");
  tcase_add_loop_test(tcase, imposed_pressure_gives_boyer, 0, 2 * NMU_J);
  tcase_add_test(tcase, mu_i_phi_i_knows_only_the_inertial_number);
  tcase_add_test(tcase, inertia_adds_to_the_number_of_shear);
  tcase_add_test(tcase, stress_is_finite_at_rest_and_without_pressure);
  tcase_add_test(tcase, loose_and_dense_beds_meet_at_the_critical_state);
  tcase_add_test(tcase, plastic_packing_keeps_its_bounds);
  tcase_add_test(tcase, shear_pressure_builds_up_with_strain_and_falls_at_once);
  tcase_add_test(tcase, a_prepared_dense_bed_carries_its_weight);
  tcase_add_test(tcase, numbers_that_contradict_are_refused);
  tcase_add_test(tcase, every_number_has_a_default_in_its_range);
  suite_add_tcase(suite, tcase);
  return suite;
}
