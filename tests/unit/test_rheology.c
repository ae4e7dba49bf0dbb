/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/rheology.h"

#include <check.h>
#include <float.h>
#include <math.h>
#include <string.h>

Suite *rheology_suite(void);

/* Round numbers for keys without a default, and for those of mu_i. */
static const struct {
  const char *key;
  double value;
} PARAMETERS[] = {{"eta", 3.},   {"tau_y", 2.},     {"eta_0", 0.5},
                  {"d", 0.1},    {"rho", 4.},       {"mu_s", 0.3},
                  {"I0", 0.4},   {"delta_mu", 0.2}, {"K", 2.},
                  {"n", 0.5},    {"eta_inf", 0.1},  {"lambda", 0.25},
                  {"mu_T", 0.6}, {"s", 0.7}};
enum { NPARAMETERS = sizeof(PARAMETERS) / sizeof(PARAMETERS[0]) };

/* Serve as a function of the user: viscosity gamma p + t. */
static void product(void *context, double time, int32_t n, const double *gamma,
                    const double *p, double *eta) {
  ck_assert_ptr_null(context);
  for (int i = 0; i < n; i++) eta[i] = gamma[i] * p[i] + time;
}

/* Make a closure; its table is freed by the next call. */
static struct rheology make(const char *name) {
  static struct rheology r;
  const struct rheology_model *model = rheology_find(name);
  ck_assert_ptr_nonnull(model);
  rheology_release(&r);
  rheology_init(&r, model);
  for (int i = 0; i < NPARAMETERS; i++)
    for (int k = 0; k < model->nkeys; k++)
      if (strcmp(model->keys[k].name, PARAMETERS[i].key) == 0 &&
          (isnan(model->keys[k].initial) || strcmp(name, "mu_i") == 0))
        rheology_set(&r, PARAMETERS[i].key, PARAMETERS[i].value);
  /* a key that a new closure brings: 1 or what is allowed next to it */
  const struct rheology_key *key;
  while ((key = rheology_missing(&r)) != NULL)
    if (rheology_set(&r, key->name, fmin(fmax(1, key->min), key->max)) != 0)
      break;
  if (model->eval == NULL) r.user = product;
  ck_assert_ptr_null(rheology_missing(&r));
  ck_assert_ptr_null(rheology_prepare(&r));
  return r;
}

static void set(struct rheology *r, const char *key, double value) {
  ck_assert_int_eq(rheology_set(r, key, value), 0);
}

static double viscosity(const struct rheology *r, double gamma, double p) {
  double eta;
  rheology_eval(r, 0, 1, &gamma, &p, &eta);
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

START_TEST(rheology_power_law_is_its_formula) {
  struct rheology r = make("power_law");
  assert_near(viscosity(&r, 16., 9.), 2. / 4.);
  set(&r, "n", 1.);
  ck_assert_double_eq(viscosity(&r, 0., 0.), 2.); /* Newtonian */
  ck_assert_double_eq(viscosity(&r, 1e12, 0.), 2.);
  set(&r, "n", 2.);
  assert_near(viscosity(&r, 3., 0.), 6.);
  ck_assert_double_le(viscosity(&r, 0., 0.), 1e-200);
}
END_TEST

START_TEST(rheology_herschel_bulkley_is_its_formula) {
  struct rheology r = make("herschel_bulkley");
  assert_near(viscosity(&r, 16., 9.), 2. / 4. + 2. / 16.);
  set(&r, "n", 1.); /* Bingham */
  assert_near(viscosity(&r, 8., 0.), 2. + 2. / 8.);
}
END_TEST

START_TEST(rheology_cross_falls_from_one_viscosity_to_the_other) {
  struct rheology r = make("cross");
  assert_near(viscosity(&r, 16., 0.), 0.1 + 0.4 / 3.);
  ck_assert_double_eq(viscosity(&r, 0., 0.), 0.5);
  ck_assert_double_eq_tol(viscosity(&r, 1e12, 0.), 0.1, 1e-6);
  /* [busch_johansen_2020, table 2], PAC4: half way where lambda gamma = 1 */
  set(&r, "eta_0", 0.214), set(&r, "eta_inf", 1.002e-3);
  set(&r, "lambda", 0.0261), set(&r, "n", 0.608);
  ck_assert_double_eq_tol(viscosity(&r, 1 / 0.0261, 0.), 0.107501, 1e-12);
  set(&r, "eta_0", 1.002e-3); /* water */
  ck_assert_double_eq(viscosity(&r, 3., 0.), 1.002e-3);
}
END_TEST

/* p = 100, rho = 4: sqrt(p/rho) = 5; gamma = 20, d = 0.1: I = 0.4 */
START_TEST(rheology_simple_frictions_are_their_formulas) {
  struct rheology r = make("mu_i_linear");
  assert_near(viscosity(&r, 20., 100.), (0.25 + 1.1 * 0.4) * 5.);
  ck_assert_double_eq_tol(viscosity(&r, 1e-9, 1.) * 1e-9, 0.25, 1e-9);
  r = make("mu_i_quadratic");
  assert_near(viscosity(&r, 20., 100.), (0.3 + 0.6 * 0.16) * 5.);
  assert_near(viscosity(&r, 20., 0.), 0.6 * 4. * 0.01 * 20.); /* Bagnold */
  r = make("mu_i_power");
  ck_assert_double_eq_tol(viscosity(&r, 20., 100.),
                          (0.3 + 0.7 * sqrt(0.4)) * 5., 1e-14);
  ck_assert_double_eq_tol(viscosity(&r, 1e-12, 1.) * 1e-12, 0.3, 1e-6);
}
END_TEST

START_TEST(rheology_mu_i_well_posed_joins_its_branches) {
  struct rheology r = make("mu_i_well_posed");
  const double per_I = 5., p = 100.; /* gamma = 50 I */
  const double upper =
      (0.342 * 0.069 + 0.557 * 0.4 + 0.05 * 0.16) / (0.069 + 0.4);
  assert_near(viscosity(&r, 20., p), upper * per_I);
  set(&r, "I_1", 0.004);
  ck_assert_ptr_null(rheology_prepare(&r));
  const double mu_1 =
      (0.342 * 0.069 + 0.557 * 0.004 + 0.05 * 1.6e-5) / (0.069 + 0.004);
  const double A = 0.004 * exp(1.9 / (mu_1 * mu_1));
  for (int i = 0; i < 12; i++) {
    const double I = 0.004 * pow(10., -i), gamma = 50. * I;
    ck_assert_double_eq_tol(viscosity(&r, gamma, p) * gamma / p,
                            sqrt(1.9 / log(A / I)), 1e-14);
  }
  const double below = viscosity(&r, 0.2 * (1 - 1e-12), p);
  ck_assert_double_eq_tol(viscosity(&r, 0.2 * (1 + 1e-12), p), below,
                          1e-10 * below);
  ck_assert_double_eq(viscosity(&r, 0., p), 1e30);
  rheology_release(&r);
}
END_TEST

START_TEST(rheology_user_is_called_with_time) {
  enum { N = 700 }; /* several blocks */
  double gamma[N], p[N], eta[N];
  struct rheology r = make("user");
  for (int i = 0; i < N; i++) gamma[i] = i, p[i] = 0.5;
  rheology_eval(&r, 2.5, N, gamma, p, eta);
  for (int i = 0; i < N; i++) ck_assert_double_eq(eta[i], 0.5 * i + 2.5);
  r.user = NULL;
  ck_assert_ptr_nonnull(rheology_prepare(&r));
}
END_TEST

/* [barker_2015], and [barker_gray_2017] for the last, whose lower branch is
 * well posed down to rest */
START_TEST(rheology_window_is_where_mu_i_is_well_posed) {
  static const double CASES[][5] = {{0.32, 0.60, 0.40, 0.01363, 1.810},
                                    {0.342, 0.557, 0.069, 0.00397, 0.280}};
  double window[2];
  struct rheology r = make("mu_i");
  set(&r, "cohesion", 5.), set(&r, "eta_max", 1.); /* of no account */
  for (int i = 0; i < 2; i++) {
    const double *c = CASES[i]; /* printed to so many digits */
    set(&r, "mu_s", c[0]), set(&r, "delta_mu", c[1] - c[0]);
    set(&r, "I0", c[2]);
    ck_assert(rheology_window(&r, window));
    ck_assert_double_eq_tol(window[0], c[3], 5e-6);
    ck_assert_double_eq_tol(window[1], c[4], 5e-4);
  }
  r = make("mu_i_well_posed");
  ck_assert(rheology_window(&r, window));
  ck_assert_double_eq(window[0], 0.);
  ck_assert_double_eq_tol(window[1], 16.992, 5e-4);
  r = make("mu_i_linear");
  set(&r, "b", 0.);
  ck_assert(!rheology_window(&r, window)); /* Coulomb: never well posed */
  r = make("bingham");
  ck_assert(!rheology_window(&r, window));
}
END_TEST

START_TEST(rheology_cohesion_is_a_yield_stress_of_any_closure) {
  for (int m = 0; rheology_get(m) != NULL; m++)
    for (int k = 0; rheology_regularisation_name(k); k++) {
      struct rheology r = make(rheology_get(m)->name);
      rheology_set_regularisation(&r, rheology_regularisation_name(k));
      const double without = viscosity(&r, 5., 10.);
      set(&r, "cohesion", 3.);
      ck_assert_double_eq_tol(viscosity(&r, 5., 10.), without + 3. / 5., 1e-6);
    }
}
END_TEST

/* Closures with a regularisation of their own, n of lee_huang, have next to
 * none here: exp(-n gamma/2) < 1e-21. */
START_TEST(rheology_parts_add_up_to_the_viscosity) {
  for (int m = 0; rheology_get(m) != NULL; m++) {
    struct rheology r = make(rheology_get(m)->name);
    if (r.model->limits != NULL) set(&r, "n", 1e12);
    set(&r, "cohesion", 3.);
    for (double gamma = 1e-10; gamma < 1e6; gamma *= 7)
      for (double p = 1e-3; p < 1e6; p *= 7) {
        double eta, tau_y;
        rheology_parts(&r, 0, 1, &gamma, &p, &eta, &tau_y);
        const double sum = viscosity(&r, gamma, p);
        ck_assert_double_ge(tau_y, 3.);
        ck_assert_double_eq_tol(eta + tau_y / gamma, sum, 1e-13 * sum);
      }
  }
}
END_TEST

START_TEST(rheology_holds_where_there_is_a_yield_stress_at_rest) {
  const double gamma = 0, p = 7;
  for (int m = 0; rheology_get(m) != NULL; m++) {
    struct rheology r = make(rheology_get(m)->name);
    double eta, tau_y;
    rheology_parts(&r, 0, 1, &gamma, &p, &eta, &tau_y);
    ck_assert_int_eq(rheology_yields(&r), tau_y > 0);
    ck_assert(tau_y >= 0 && eta >= 0 && isfinite(eta) && isfinite(tau_y));
    set(&r, "cohesion", 3.);
    ck_assert(rheology_yields(&r));
  }
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
  const char *names[] = {"bingham",    "coulomb",         "mu_i",
                         "mu_i_power", "mu_i_well_posed", "power_law"};
  for (int i = 0; i < 6; i++) {
    struct rheology r = make(names[i]);
    for (double p = 2e-12; p < 1e12; p *= 10) {
      assert_near(viscosity(&r, 0., p), 1e30);
      assert_near(viscosity(&r, 5e-324, p), 1e30);
    }
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
  for (int i = 0; rheology_get(i) != NULL; i++) {
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

/* Return 0, denormals, and powers of ten up to 1e12 */
static double extreme(int i) {
  static const double small[] = {0., 5e-324, 1e-310, DBL_MIN, 1e-300, 1e-160};
  return i < 6 ? small[i] : pow(10., 2 * (i - 6) - 24);
}
enum { NEXTREME = 25 };

static int count_bad(const struct rheology *r) {
  int bad = 0;
  for (int i = 0; i < NEXTREME * NEXTREME; i++) {
    const double eta =
        viscosity(r, extreme(i % NEXTREME), extreme(i / NEXTREME));
    bad += !(eta >= 0. && eta <= 1e30);
  }
  return bad;
}

START_TEST(rheology_is_finite_and_not_negative_anywhere) {
  ck_assert_double_eq(extreme(NEXTREME - 1), 1e12);
  for (int m = 0; rheology_get(m) != NULL; m++) {
    struct rheology r = make(rheology_get(m)->name);
    for (int k = 0; rheology_regularisation_name(k); k++) {
      rheology_set_regularisation(&r, rheology_regularisation_name(k));
      ck_assert_int_eq(count_bad(&r), 0);
    }
  }
}
END_TEST

/* Parameters that do not go together are refused; so are all such ends of
 * lee_huang, whose three solid fractions must differ. */
START_TEST(rheology_is_finite_at_the_ends_of_all_ranges) {
  int bad = 0;
  for (int m = 0; rheology_get(m) != NULL; m++)
    for (int mask = 0; mask < 1 << 11; mask++) {
      struct rheology r = make(rheology_get(m)->name);
      const struct rheology_key *key;
      for (int k = 0; (key = rheology_key(r.model, k)) != NULL; k++)
        if (strcmp(key->name, "eta_min") != 0)
          rheology_set(&r, key->name, mask >> k & 1 ? key->max : key->min);
      if (mask >> r.model->nkeys > 15 || r.model->limits != NULL) break;
      rheology_set_regularisation(&r, rheology_regularisation_name(mask % 3));
      if (rheology_prepare(&r) == NULL) bad += count_bad(&r);
      if (r.model->prepare != NULL) rheology_release(&r);
    }
  ck_assert_int_eq(bad, 0);
}
END_TEST

/* Relative steps of 1e-9 in either, from next to nothing to 1e12, and the step
 * from 0. The tables of lee_huang meet to 1e-6. */
START_TEST(rheology_is_continuous) {
  const double step = 1 + 1e-9, most = 2e-6;
  for (int m = 0; rheology_get(m) != NULL; m++) {
    struct rheology r = make(rheology_get(m)->name);
    for (double fixed = 1e-6; fixed <= 1e12; fixed *= 1e3) {
      ck_assert_double_eq_tol(viscosity(&r, fixed, 0.),
                              viscosity(&r, fixed, 5e-324), 1e-100);
      const double rest = viscosity(&r, 0., fixed);
      ck_assert_double_le(fabs(viscosity(&r, 5e-324, fixed) - rest),
                          most * rest + 1e-300);
      for (double x = 1e-12; x < 1e12; x *= 1.7) {
        double eta = viscosity(&r, x, fixed);
        ck_assert_double_le(fabs(viscosity(&r, x * step, fixed) - eta),
                            most * eta);
        eta = viscosity(&r, fixed, x);
        ck_assert_double_le(fabs(viscosity(&r, fixed, x * step) - eta),
                            most * eta);
      }
    }
  }
}
END_TEST

START_TEST(rheology_lets_nan_through) {
  static const char *const names[] = {"mu_i", "mu_i_well_posed", "lee_huang"};
  for (int i = 0; i < 3; i++) {
    struct rheology r = make(names[i]);
    ck_assert_double_nan(viscosity(&r, NAN, 1.));
    ck_assert_double_nan(viscosity(&r, 1., NAN));
  }
}
END_TEST

/* Units 2^36 times as small: rho, p and eta are as many times as large. */
START_TEST(rheology_does_not_depend_on_the_unit_of_mass) {
  static const double more = 0x1p36;
  static const char *const scaled[] = {"rho",   "rho_d", "K",      "tau_y",
                                       "eta_0", "eta",   "eta_inf"};
  for (int m = 0; rheology_get(m) != NULL; m++) {
    struct rheology r = make(rheology_get(m)->name), s;
    if (r.model->eval == NULL || r.model->limits != NULL) continue;
    for (int i = 0; i < NEXTREME * NEXTREME; i++) {
      const double gamma = extreme(i % NEXTREME), p = extreme(i / NEXTREME);
      if ((p > 0 && p < 1e-200) || (gamma > 0 && gamma < 1e-200)) continue;
      r.eta_max = 1e3;
      const double eta = viscosity(&r, gamma, p);
      s = r;
      s.eta_max *= more;
      for (unsigned k = 0; k < sizeof scaled / sizeof *scaled; k++)
        for (int j = 0; j < r.model->nkeys; j++)
          if (strcmp(r.model->keys[j].name, scaled[k]) == 0) s.param[j] *= more;
      ck_assert_double_eq_tol(viscosity(&s, gamma, more * p) / more, eta,
                              1e-13 * eta + 1e-200);
    }
  }
}
END_TEST

/* Closure lee_huang does so below I_tran only: test_lee_huang.c. */
START_TEST(rheology_stress_grows_with_shear_rate_and_pressure) {
  for (int m = 0; rheology_get(m) != NULL; m++)
    for (int k = 0; rheology_regularisation_name(k); k++) {
      if (rheology_get(m)->limits != NULL) continue;
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
  rheology_eval(&r, 0, N, gamma, p, eta);
  for (int i = 0; i < N; i++)
    assert_near(eta[i], viscosity(&r, gamma[i], p[i]));
  ck_assert_double_eq(eta[N], -5.);
  rheology_eval(&r, 0, 0, NULL, NULL, NULL);
}
END_TEST

START_TEST(rheology_names_and_keys_are_unique_and_complete) {
  for (int i = 0; rheology_get(i) != NULL; i++) {
    const struct rheology_model *model = rheology_get(i);
    ck_assert_ptr_eq(rheology_find(model->name), model);
    ck_assert(model->title && model->source);
    ck_assert(model->eval || strcmp(model->name, "user") == 0);
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
  tcase_add_test(formula, rheology_power_law_is_its_formula);
  tcase_add_test(formula, rheology_herschel_bulkley_is_its_formula);
  tcase_add_test(formula, rheology_cross_falls_from_one_viscosity_to_the_other);
  tcase_add_test(formula, rheology_simple_frictions_are_their_formulas);
  tcase_add_test(formula, rheology_mu_i_well_posed_joins_its_branches);
  tcase_add_test(formula, rheology_user_is_called_with_time);
  tcase_add_test(formula, rheology_window_is_where_mu_i_is_well_posed);
  suite_add_tcase(suite, formula);
  TCase *shared = tcase_create("shared");
  tcase_set_timeout(shared, 60); /* tables of lee_huang, sanitizers */
  tcase_add_test(shared, rheology_parts_add_up_to_the_viscosity);
  tcase_add_test(shared, rheology_holds_where_there_is_a_yield_stress_at_rest);
  tcase_add_test(shared, rheology_is_cut_to_its_bounds);
  tcase_add_test(shared,
                 rheology_at_rest_is_eta_max_where_there_is_a_yield_stress);
  tcase_add_test(shared, rheology_regularisations_are_their_formulas);
  tcase_add_test(shared, rheology_takes_negative_pressure_as_zero);
  tcase_add_test(shared, rheology_is_finite_and_not_negative_anywhere);
  tcase_add_test(shared, rheology_is_finite_at_the_ends_of_all_ranges);
  tcase_add_test(shared, rheology_is_continuous);
  tcase_add_test(shared, rheology_cohesion_is_a_yield_stress_of_any_closure);
  tcase_add_test(shared, rheology_lets_nan_through);
  tcase_add_test(shared, rheology_does_not_depend_on_the_unit_of_mass);
  tcase_add_test(shared, rheology_stress_grows_with_shear_rate_and_pressure);
  tcase_add_test(shared, rheology_of_an_array_is_that_of_its_elements);
  if (DIM == 2) suite_add_tcase(suite, shared); /* src/rheology has no DIM */
  TCase *registry = tcase_create("registry");
  tcase_add_test(registry, rheology_names_and_keys_are_unique_and_complete);
  tcase_add_test(registry, rheology_set_refuses_unknown_keys_and_bad_values);
  tcase_add_test(registry,
                 rheology_missing_names_the_first_key_without_a_value);
  tcase_add_test(registry, rheology_value_reads_what_set_wrote);
  suite_add_tcase(suite, registry);
  return suite;
}
