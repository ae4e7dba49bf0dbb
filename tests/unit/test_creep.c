/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/two_phase/creep.h"

#include <check.h>
#include <math.h>
#include <string.h>

#include "talus/params.h"

Suite *creep_suite(void);

static struct params params_of(const char *closure, const char *key,
                               double value) {
  struct params p = {.dimension = 2, .gravity = {0.9, -1.2}};
  p.grains.density = 2;
  rheology_init(&p.grains.rheology, rheology_find(closure));
  ck_assert_int_eq(rheology_set(&p.grains.rheology, key, value), 0);
  return p;
}

/* rho g sin(alpha) H^2 / (2 eta_max) at tan(alpha) = mu_s */
START_TEST(a_slope_creeps_as_a_liquid_of_eta_max) {
  struct params p = params_of("coulomb", "mu_s", 0.75);
  p.grains.rheology.eta_max = 40;
  const double exact = 2 * 1.5 * 0.6 * 3 * 3 / (2 * 40);
  ck_assert_double_le(fabs(creep_speed(&p, 3) / exact - 1), 1e-12);
  p = params_of("mu_i", "mu_s", 0.75); /* with an I of 1e-6 */
  rheology_set(&p.grains.rheology, "d", 0.01);
  rheology_set(&p.grains.rheology, "rho", 2);
  p.grains.rheology.eta_max = 40;
  ck_assert_double_le(fabs(creep_speed(&p, 3) / exact - 1), 1e-6);
}
END_TEST

/* Cohesion adds to friction: tau = 0.5 p + 1.5 at p = rho g H = 3. */
START_TEST(cohesion_holds_too) {
  struct params p = params_of("coulomb", "mu_s", 0.5);
  p.grains.rheology.cohesion = 1.5;
  ck_assert_double_eq_tol(creep_friction(&p, 1), 1, 1e-12);
}
END_TEST

START_TEST(a_liquid_has_no_friction_to_speak_of) {
  struct params p = params_of("newtonian", "eta", 1);
  ck_assert_double_le(creep_friction(&p, 1), 1e-5);
  p.gravity[0] = p.gravity[1] = 0;
  ck_assert_double_eq(creep_friction(&p, 1), 0);
  ck_assert_double_eq(creep_speed(&p, 1), 0);
}
END_TEST

/* Bounds and regularisation have no part in friction. */
START_TEST(friction_is_that_of_the_closure_itself) {
  struct params p = params_of("coulomb", "mu_s", 0.5);
  p.grains.rheology.gamma_r = 1;
  ck_assert_int_eq(
      rheology_set_regularisation(&p.grains.rheology, "bercovier_engelman"), 0);
  ck_assert_double_eq_tol(creep_friction(&p, 1), 0.5, 1e-12);
  p = params_of("newtonian", "eta", 1);
  p.grains.rheology.eta_min = 1e12;
  ck_assert_double_le(creep_friction(&p, 1), 1e-5);
}
END_TEST

Suite *creep_suite(void) {
  Suite *suite = suite_create("creep");
  TCase *tcase = tcase_create("cap");
  tcase_add_test(tcase, a_slope_creeps_as_a_liquid_of_eta_max);
  tcase_add_test(tcase, cohesion_holds_too);
  tcase_add_test(tcase, friction_is_that_of_the_closure_itself);
  tcase_add_test(tcase, a_liquid_has_no_friction_to_speak_of);
  suite_add_tcase(suite, tcase);
  return suite;
}
