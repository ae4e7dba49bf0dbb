/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/rheology.h"

#include <check.h>
#include <float.h>
#include <math.h>
#include <string.h>

Suite *rheology_suite(void);

/* Round numbers for every key of every closure. */
static const struct {
  const char *key;
  double value;
} PARAMETERS[] = {{"eta", 3.}, {"tau_y", 2.},    {"eta_0", 0.5},
                  {"d", 0.1},  {"rho", 4.},      {"mu_s", 0.3},
                  {"I0", 0.4}, {"delta_mu", 0.2}};
enum { NPARAMETERS = sizeof(PARAMETERS) / sizeof(PARAMETERS[0]) };

static struct rheology make(const char *name) {
  struct rheology r;
  const struct rheology_model *model = rheology_find(name);
  ck_assert_ptr_nonnull(model);
  rheology_init(&r, model);
  for (int i = 0; i < NPARAMETERS; i++)
    rheology_set(&r, PARAMETERS[i].key, PARAMETERS[i].value);
  ck_assert_ptr_null(rheology_missing(&r));
  return r;
}

static double viscosity(const struct rheology *r, double gamma, double p) {
  double eta;
  rheology_eval(r, 1, &gamma, &p, &eta);
  return eta;
}

static void assert_near(double a, double b) {
  ck_assert_double_le(fabs(a - b), 4. * DBL_EPSILON * fabs(b));
}

START_TEST(rheology_newtonian_is_eta) {
  struct rheology r = make("newtonian");
  assert_near(viscosity(&r, 0., 0.), 3.);
  assert_near(viscosity(&r, 7., 1e9), 3.);
}
END_TEST

START_TEST(rheology_bingham_is_eta_0_plus_yield_stress_over_shear_rate) {
  struct rheology r = make("bingham");
  assert_near(viscosity(&r, 8., -1.), 0.5 + 2. / 8.);
}
END_TEST

START_TEST(rheology_bagnold_is_rho_d2_shear_rate) {
  struct rheology r = make("bagnold");
  assert_near(viscosity(&r, 5., 1.), 4. * 0.1 * 0.1 * 5.);
}
END_TEST

START_TEST(rheology_coulomb_is_friction_times_pressure) {
  struct rheology r = make("coulomb");
  assert_near(viscosity(&r, 5., 10.), 0.3 * 10. / 5.);
}
END_TEST

START_TEST(rheology_mu_i_is_the_formula_of_the_paper) {
  struct rheology r = make("mu_i");
  /* p = 100, rho = 4: sqrt(p/rho) = 5; gamma = 20, d = 0.1: I = 0.4 = I0 */
  assert_near(viscosity(&r, 20., 100.), (0.3 + 0.2 / 2.) * 100. / 20.);
  for (double gamma = 1e-6; gamma < 1e7; gamma *= 10.)
    for (double p = 1e-6; p < 1e7; p *= 10.) {
      double I = gamma * 0.1 / sqrt(p / 4.);
      double mu = 0.3 + 0.2 / (0.4 / I + 1.);
      assert_near(viscosity(&r, gamma, p), mu * p / gamma);
    }
}
END_TEST

START_TEST(rheology_mu_i_tends_to_its_two_frictions) {
  struct rheology r = make("mu_i");
  ck_assert_double_eq_tol(viscosity(&r, 1e-9, 1.) * 1e-9, 0.3, 1e-9);
  ck_assert_double_eq_tol(viscosity(&r, 1e9, 1.) * 1e9, 0.5, 1e-8);
}
END_TEST

START_TEST(rheology_is_cut_to_its_bounds) {
  struct rheology r = make("coulomb");
  ck_assert_int_eq(rheology_set(&r, "eta_max", 50.), 0);
  ck_assert_int_eq(rheology_set(&r, "eta_min", 0.25), 0);
  ck_assert_double_eq(viscosity(&r, 0., 10.), 50.);
  assert_near(viscosity(&r, 3. / 50., 10.), 50.);
  assert_near(viscosity(&r, 0.1, 10.), 30.);
  ck_assert_double_eq(viscosity(&r, 1e9, 10.), 0.25);
  ck_assert_double_eq(viscosity(&r, 1., 0.), 0.25);
  r = make("newtonian");
  rheology_set(&r, "eta_max", 1.);
  ck_assert_double_eq(viscosity(&r, 0., 0.), 1.);
}
END_TEST

START_TEST(rheology_at_rest_is_eta_max_where_there_is_a_yield_stress) {
  const char *names[] = {"bingham", "coulomb", "mu_i"};
  for (int i = 0; i < 3; i++) {
    struct rheology r = make(names[i]);
    ck_assert_double_eq(viscosity(&r, 0., 2.), 1e30);
    ck_assert_double_eq(viscosity(&r, 5e-324, 2.), 1e30);
  }
}
END_TEST

START_TEST(rheology_regularisations_are_their_formulas) {
  struct rheology r = make("bingham");
  ck_assert_int_eq(rheology_set(&r, "gamma_r", 0.5), 0);
  ck_assert_int_eq(rheology_set_regularisation(&r, "papanastasiou"), 0);
  assert_near(viscosity(&r, 0., 0.), 0.5 + 2. / 0.5);
  assert_near(viscosity(&r, 0.25, 0.), 0.5 + 2. * (1. - exp(-0.5)) / 0.25);
  assert_near(viscosity(&r, 1e3, 0.), 0.5 + 2. / 1e3);
  ck_assert_int_eq(rheology_set_regularisation(&r, "bercovier_engelman"), 0);
  assert_near(viscosity(&r, 0., 0.), 0.5 + 2. / 0.5);
  assert_near(viscosity(&r, 1.2, 0.), 0.5 + 2. / 1.3);
  ck_assert_int_eq(rheology_set_regularisation(&r, "clip"), 0);
  assert_near(viscosity(&r, 0.25, 0.), 0.5 + 2. / 0.25);
  ck_assert_int_eq(rheology_set_regularisation(&r, "Clip"), -1);
  ck_assert_int_eq(r.regularisation, RHEOLOGY_CLIP);
}
END_TEST

START_TEST(rheology_takes_negative_pressure_as_zero) {
  for (int i = 0; i < rheology_count(); i++) {
    struct rheology r = make(rheology_get(i)->name);
    for (double gamma = 0.; gamma < 3.; gamma += 1.) {
      double none = viscosity(&r, gamma, 0.);
      ck_assert_double_eq(viscosity(&r, gamma, -1.), none);
      ck_assert_double_eq(viscosity(&r, gamma, -1e12), none);
    }
  }
  struct rheology r = make("mu_i");
  ck_assert_double_eq(viscosity(&r, 0., -1.), 0.);
}
END_TEST

/* 0, denormals, and powers of ten up to 1e12 */
static double extreme(int i) {
  static const double small[] = {0., 5e-324, 1e-310, DBL_MIN, 1e-300, 1e-160};
  return i < 6 ? small[i] : pow(10., 2 * (i - 6) - 24);
}
enum { NEXTREME = 25 };

START_TEST(rheology_is_finite_and_not_negative_anywhere) {
  ck_assert_double_eq(extreme(NEXTREME - 1), 1e12);
  int bad = 0;
  for (int m = 0; m < rheology_count(); m++)
    for (int k = 0; rheology_regularisation_name(k); k++)
      for (int i = 0; i < NEXTREME; i++)
        for (int j = 0; j < NEXTREME; j++) {
          struct rheology r = make(rheology_get(m)->name);
          rheology_set_regularisation(&r, rheology_regularisation_name(k));
          double eta = viscosity(&r, extreme(i), extreme(j));
          bad += !(eta >= 0. && eta <= 1e30);
        }
  ck_assert_int_eq(bad, 0);
}
END_TEST

START_TEST(rheology_is_finite_at_the_ends_of_all_ranges) {
  int bad = 0;
  for (int m = 0; m < rheology_count(); m++)
    for (int mask = 0; mask < 1 << 8; mask++)
      for (int i = 0; i < NEXTREME * NEXTREME; i += 7) {
        struct rheology r;
        const struct rheology_key *key;
        rheology_init(&r, rheology_get(m));
        for (int k = 0; (key = rheology_key(r.model, k)) != NULL; k++)
          if (strcmp(key->name, "eta_min") != 0)
            rheology_set(&r, key->name, mask >> k & 1 ? key->max : key->min);
        rheology_set_regularisation(&r, rheology_regularisation_name(i % 3));
        double eta =
            viscosity(&r, extreme(i % NEXTREME), extreme(i / NEXTREME));
        bad += !(eta >= 0. && eta <= 1e30);
      }
  ck_assert_int_eq(bad, 0);
}
END_TEST

START_TEST(rheology_lets_nan_through) {
  struct rheology r = make("mu_i");
  ck_assert_double_nan(viscosity(&r, NAN, 1.));
  ck_assert_double_nan(viscosity(&r, 1., NAN));
}
END_TEST

START_TEST(rheology_stress_grows_with_shear_rate_and_pressure) {
  for (int m = 0; m < rheology_count(); m++)
    for (int k = 0; rheology_regularisation_name(k); k++) {
      struct rheology r = make(rheology_get(m)->name);
      rheology_set_regularisation(&r, rheology_regularisation_name(k));
      rheology_set(&r, "eta_max", 1e3);
      const double most = 1. + 1e-15; /* rounding of a flat part */
      double last = 0.;
      for (double gamma = 1e-8; gamma < 1e4; gamma *= 1.1) {
        double stress = gamma * viscosity(&r, gamma, 2.);
        ck_assert_double_le(last, stress * most);
        ck_assert_double_le(viscosity(&r, gamma, 2.),
                            viscosity(&r, gamma, 3.) * most);
        last = stress;
      }
    }
}
END_TEST

START_TEST(rheology_of_an_array_is_that_of_its_elements) {
  enum { N = 1500 }; /* several blocks, the last one short */
  double gamma[N], p[N], eta[N + 1];
  struct rheology r = make("mu_i");
  for (int i = 0; i < N; i++) gamma[i] = 0.01 * i, p[i] = i % 7 - 1;
  eta[N] = -5.;
  rheology_eval(&r, N, gamma, p, eta);
  for (int i = 0; i < N; i++)
    assert_near(eta[i], viscosity(&r, gamma[i], p[i]));
  ck_assert_double_eq(eta[N], -5.);
  rheology_eval(&r, 0, NULL, NULL, NULL);
}
END_TEST

START_TEST(rheology_names_and_keys_are_unique_and_complete) {
  for (int i = 0; i < rheology_count(); i++) {
    const struct rheology_model *model = rheology_get(i);
    ck_assert_ptr_eq(rheology_find(model->name), model);
    ck_assert(model->title && model->source && model->eval);
    ck_assert_int_le(model->nkeys, RHEOLOGY_MAX_KEYS);
    const struct rheology_key *key, *other;
    for (int k = 0; (key = rheology_key(model, k)) != NULL; k++) {
      ck_assert(key->name && key->unit && key->help);
      ck_assert_double_le(key->min, key->max);
      ck_assert(isnan(key->initial) ||
                (key->initial >= key->min && key->initial <= key->max));
      for (int j = 0; j < k && (other = rheology_key(model, j)) != NULL; j++)
        ck_assert_str_ne(key->name, other->name);
    }
  }
  ck_assert_ptr_null(rheology_get(-1));
  ck_assert_ptr_null(rheology_get(rheology_count()));
  ck_assert_ptr_null(rheology_find("mu_I"));
}
END_TEST

START_TEST(rheology_set_refuses_unknown_keys_and_bad_values) {
  struct rheology r = make("mu_i"), before = r;
  ck_assert_int_eq(rheology_set(&r, "mu", 0.3), -1);
  ck_assert_int_eq(rheology_set(&r, "eta", 0.3), -1);
  ck_assert_int_eq(rheology_set(&r, "mu_s", -0.1), -2);
  ck_assert_int_eq(rheology_set(&r, "d", 0.), -2);
  ck_assert_int_eq(rheology_set(&r, "d", NAN), -2);
  ck_assert_int_eq(rheology_set(&r, "eta_max", INFINITY), -2);
  for (int k = 0; rheology_key(r.model, k) != NULL; k++)
    ck_assert_double_eq(rheology_value(&r, k), rheology_value(&before, k));
}
END_TEST

START_TEST(rheology_missing_names_the_first_key_without_a_value) {
  struct rheology r;
  rheology_init(&r, rheology_find("mu_i"));
  ck_assert_str_eq(rheology_missing(&r)->name, "d");
  rheology_set(&r, "d", 1.);
  ck_assert_str_eq(rheology_missing(&r)->name, "rho");
  rheology_set(&r, "rho", 1.);
  ck_assert_ptr_null(rheology_missing(&r));
}
END_TEST

START_TEST(rheology_value_reads_what_set_wrote) {
  struct rheology r = make("mu_i");
  rheology_set(&r, "eta_max", 17.);
  const struct rheology_key *key;
  for (int k = 0; (key = rheology_key(r.model, k)) != NULL; k++) {
    if (strcmp(key->name, "eta_max") == 0)
      ck_assert_double_eq(rheology_value(&r, k), 17.);
    for (int i = 0; i < NPARAMETERS; i++)
      if (strcmp(key->name, PARAMETERS[i].key) == 0)
        ck_assert_double_eq(rheology_value(&r, k), PARAMETERS[i].value);
  }
}
END_TEST

START_TEST(rheology_nearest_finds_what_was_meant) {
  ck_assert_str_eq(rheology_nearest("mu(I)"), "mu_i");
  ck_assert_str_eq(rheology_nearest("Binghamm"), "bingham");
  ck_assert_str_eq(rheology_nearest("newton"), "newtonian");
  ck_assert_str_eq(rheology_nearest("coulomb"), "coulomb");
  ck_assert_ptr_nonnull(rheology_nearest(""));
}
END_TEST

Suite *rheology_suite(void) {
  Suite *suite = suite_create("rheology");
  TCase *formula = tcase_create("formula");
  tcase_add_test(formula, rheology_newtonian_is_eta);
  tcase_add_test(formula,
                 rheology_bingham_is_eta_0_plus_yield_stress_over_shear_rate);
  tcase_add_test(formula, rheology_bagnold_is_rho_d2_shear_rate);
  tcase_add_test(formula, rheology_coulomb_is_friction_times_pressure);
  tcase_add_test(formula, rheology_mu_i_is_the_formula_of_the_paper);
  tcase_add_test(formula, rheology_mu_i_tends_to_its_two_frictions);
  suite_add_tcase(suite, formula);
  TCase *shared = tcase_create("shared");
  tcase_add_test(shared, rheology_is_cut_to_its_bounds);
  tcase_add_test(shared,
                 rheology_at_rest_is_eta_max_where_there_is_a_yield_stress);
  tcase_add_test(shared, rheology_regularisations_are_their_formulas);
  tcase_add_test(shared, rheology_takes_negative_pressure_as_zero);
  tcase_add_test(shared, rheology_is_finite_and_not_negative_anywhere);
  tcase_add_test(shared, rheology_is_finite_at_the_ends_of_all_ranges);
  tcase_add_test(shared, rheology_lets_nan_through);
  tcase_add_test(shared, rheology_stress_grows_with_shear_rate_and_pressure);
  tcase_add_test(shared, rheology_of_an_array_is_that_of_its_elements);
  suite_add_tcase(suite, shared);
  TCase *registry = tcase_create("registry");
  tcase_add_test(registry, rheology_names_and_keys_are_unique_and_complete);
  tcase_add_test(registry, rheology_set_refuses_unknown_keys_and_bad_values);
  tcase_add_test(registry,
                 rheology_missing_names_the_first_key_without_a_value);
  tcase_add_test(registry, rheology_value_reads_what_set_wrote);
  tcase_add_test(registry, rheology_nearest_finds_what_was_meant);
  suite_add_tcase(suite, registry);
  return suite;
}
