/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/two_fluid_drag.h"

#include <check.h>
#include <math.h>

#include "talus/two_fluid_pair.h"

Suite *two_fluid_drag_suite(void);

#define EQUAL(a, b, relative) \
  ck_assert_double_eq_tol(a, b, (relative)*fabs(1. * (b)) + 1e-300)

static struct two_fluid_closure closures(enum two_fluid_drag drag,
                                         enum two_fluid_fluid fluid, double d) {
  struct two_fluid_closure c;
  two_fluid_closure_init(&c, TWO_FLUID_CRITICAL_STATE);
  c.drag = drag;
  c.param[TWO_FLUID_GRAINS_D] = d;
  two_fluid_take_fluid(&c, fluid);
  ck_assert_ptr_null(two_fluid_prepare(&c));
  return c;
}

START_TEST(fluids_are_those_of_table_2) {
  const double rho[] = {1.225, 998, 1000, 1000};
  const double eta_0[] = {1.79e-5, 1.002e-3, 7.21e-2, 0.214};
  const double eta_inf[] = {1.79e-5, 1.002e-3, 1.002e-3, 1.002e-3};
  for (int fluid = 0; fluid < TWO_FLUID_OWN; fluid++) {
    const struct two_fluid_closure c = closures(0, fluid, 1e-3);
    ck_assert_double_eq(c.param[TWO_FLUID_FLUID_DENSITY], rho[fluid]);
    EQUAL(two_fluid_viscosity(&c, 0), eta_0[fluid], 1e-15);
    EQUAL(two_fluid_viscosity(&c, 1e30), eta_inf[fluid], 1e-12);
  }
  /* halfway at 1/lambda */
  const struct two_fluid_closure pac4 = closures(0, TWO_FLUID_PAC4, 1e-3);
  EQUAL(two_fluid_viscosity(&pac4, 1 / 0.0261), (0.214 + 1.002e-3) / 2, 1e-12);
  const struct two_fluid_closure pac2 = closures(0, TWO_FLUID_PAC2, 1e-3);
  EQUAL(two_fluid_viscosity(&pac2, 1e3),
        1.002e-3 + (7.21e-2 - 1.002e-3) / (1 + pow(10.9, 0.586)), 1e-12);
}
END_TEST

/* Fluid, d, St, r, K of 0.585 at rest, by an independent program. */
static const double REGIMES[][5] = {
    {TWO_FLUID_AIR, 1e-4, 17.59, 45.71, 2.214e5},
    {TWO_FLUID_AIR, 1e-2, 1.759e4, 45.71, 22.14},
    {TWO_FLUID_WATER, 1e-4, 0.2455, 1.602, 1.239e7},
    {TWO_FLUID_WATER, 1e-3, 7.765, 1.602, 1.239e5},
    {TWO_FLUID_PAC2, 1e-3, 0.1078, 1.6, 8.918e6},
    {TWO_FLUID_PAC4, 1e-2, 1.149, 1.6, 2.647e5},
};
enum { NREGIMES = sizeof REGIMES / sizeof *REGIMES };

/* To the four printed digits. */
START_TEST(regimes_are_those_of_the_reference) {
  const double *row = REGIMES[_i];
  const struct two_fluid_closure c =
      closures(TWO_FLUID_GIDASPOW, (enum two_fluid_fluid)row[0], row[1]);
  const double eta_0 = two_fluid_viscosity(&c, 0);
  EQUAL(two_fluid_stokes_number(&c, 9.81), row[2], 5e-4);
  EQUAL(two_fluid_density_ratio(&c), row[3], 5e-4);
  EQUAL(two_fluid_drag(&c, 0.585, 0, eta_0), row[4], 5e-4);
}
END_TEST

/* By the formulas as printed. */
START_TEST(branches_are_ergun_and_wen_yu) {
  const double d = 2e-3, eta = 3e-3, u = 0.07, rho = 998;
  const struct two_fluid_closure g =
      closures(TWO_FLUID_GIDASPOW, TWO_FLUID_WATER, d);
  struct two_fluid_closure e = g, w = g;
  e.drag = TWO_FLUID_ERGUN, w.drag = TWO_FLUID_WEN_YU;
  for (double phi = 0.01; phi < 0.7; phi += 0.01) {
    const double a = 1 - phi, Re = a * rho * d * u / eta;
    const double C_D = 24 * (1 + 0.15 * pow(Re, 0.687)) / Re;
    const double wen_yu = 0.75 * C_D * phi * rho * u * pow(a, -1.65) / d;
    const double ergun =
        150 * phi * phi * eta / (a * d * d) + 1.75 * phi * rho * u / d;
    EQUAL(two_fluid_drag(&e, phi, u, eta), ergun, 1e-12);
    EQUAL(two_fluid_drag(&w, phi, u, eta), wen_yu, 1e-12);
    const double K = two_fluid_drag(&g, phi, u, eta);
    if (phi < 0.19) EQUAL(K, wen_yu, 1e-12);
    if (phi > 0.2101) EQUAL(K, ergun, 1e-12);
  }
  EQUAL(
      two_fluid_drag(&g, 0.2, u, eta),
      0.5 * (two_fluid_drag(&e, 0.2, u, eta) + two_fluid_drag(&w, 0.2, u, eta)),
      1e-12);
}
END_TEST

/* C_D = 0.44 from Re = 1000 on, where the formula has 0.438. */
START_TEST(fast_grains_have_the_least_drag_coefficient) {
  const double d = 1e-2, eta = 1e-3, rho = 998, phi = 0.1, a = 0.9;
  struct two_fluid_closure c = closures(TWO_FLUID_WEN_YU, TWO_FLUID_WATER, d);
  for (double u = 1e-3; u < 100; u *= 1.5) {
    const double Re = a * rho * d * u / eta;
    const double formula = 24 * (1 + 0.15 * pow(Re, 0.687)) / Re;
    const double C_D = Re < 900 ? formula : 0.44;
    if (Re > 900 && Re < 1100) continue;
    c.param[TWO_FLUID_DRAG_WEN_YU_LEAST] = 0.44;
    EQUAL(two_fluid_drag(&c, phi, u, eta),
          0.75 * C_D * phi * rho * u * pow(a, -1.65) / d, 1e-12);
    c.param[TWO_FLUID_DRAG_WEN_YU_LEAST] = 0;
    EQUAL(two_fluid_drag(&c, phi, u, eta),
          0.75 * formula * phi * rho * u * pow(a, -1.65) / d, 1e-12);
  }
}
END_TEST

/* Ergun over Wen & Yu at 0.2 by hand: 1.15 at Re = 0, 3.67 at Re = 1e6. */
START_TEST(drag_has_no_jump_but_the_branches_have) {
  const double eta = 1e-3, d = 1e-3;
  const struct two_fluid_closure g =
      closures(TWO_FLUID_GIDASPOW, TWO_FLUID_WATER, d);
  struct two_fluid_closure e = g, w = g;
  e.drag = TWO_FLUID_ERGUN, w.drag = TWO_FLUID_WEN_YU;
  const double jump =
      two_fluid_drag(&e, 0.2, 0, eta) / two_fluid_drag(&w, 0.2, 0, eta);
  EQUAL(jump, 150 * 0.2 / 0.8 / (18 * pow(0.8, -2.65)), 1e-12);
  ck_assert_double_eq_tol(jump, 1.1533, 1e-4);
  for (double u = 0; u<10; u = u> 0 ? 3 * u : 1e-7) {
    double before = 0;
    for (double phi = 0.18; phi < 0.22; phi += 1e-5) {
      const double K = two_fluid_drag_per_phi(&g, phi, u, eta);
      if (before > 0) ck_assert_double_le(fabs(K / before - 1), 2e-3);
      before = K;
    }
  }
}
END_TEST

START_TEST(limits_are_finite) {
  for (int drag = 0; drag < 3; drag++) {
    const struct two_fluid_closure c = closures(drag, TWO_FLUID_WATER, 1e-3);
    const double eta = 1.002e-3;
    ck_assert_double_eq(two_fluid_drag(&c, 0, 0, eta), 0);
    ck_assert_double_eq(two_fluid_drag(&c, 0, 1, eta), 0);
    for (int k = 0; k <= 8; k++)
      for (double u = 0; u<1e6; u = u> 0 ? 10 * u : 1e-300) {
        const double K = two_fluid_drag_per_phi(&c, k / 8., u, eta);
        ck_assert(isfinite(K) && K >= 0);
        ck_assert(isfinite(two_fluid_pore_shear_rate(k / 8., K, u, eta)));
      }
  }
  /* a grain alone at rest: 18 eta/d^2, Stokes */
  const struct two_fluid_closure c =
      closures(TWO_FLUID_GIDASPOW, TWO_FLUID_WATER, 1e-3);
  EQUAL(two_fluid_drag_per_phi(&c, 0, 0, 1e-3), 18 * 1e-3 / 1e-6, 1e-14);
  ck_assert_double_eq(two_fluid_pore_shear_rate(0.5, 0, 1, 1e-3), 0);
  for (double phi = 0; phi < 1.2; phi += 0.01)
    ck_assert(isfinite(two_fluid_pore_viscosity(&c, phi, 1)));
}
END_TEST

/* Checks that the fluid dissipates what drag takes: K u^2 = (1 - phi) eta
 * gamma^2. */
START_TEST(pores_dissipate_what_drag_takes) {
  const double K = 1.3e5, u = 0.02, eta = 0.1, phi = 0.4;
  const double gamma = two_fluid_pore_shear_rate(phi, K, u, eta);
  EQUAL((1 - phi) * eta * gamma * gamma, K * u * u, 1e-14);
}
END_TEST

/* Return the two velocities of m_s (u_s - a_s) = k (u_f - u_s) = -m_f (u_f -
 * a_f) by the formulas of the design. */
static void by_determinant(double m_s, double m_f, double k, const double a[2],
                           double u[2]) {
  const double D = m_s * m_f + k * (m_s + m_f);
  u[0] = ((m_f + k) * m_s * a[0] + k * m_f * a[1]) / D;
  u[1] = ((m_s + k) * m_f * a[1] + k * m_s * a[0]) / D;
}

START_TEST(pair_solves_both_momenta) {
  const double a[2] = {1.7, -0.4};
  for (double phi = 1e-6; phi < 1; phi += 0.07)
    for (double k = 1e-12; k < 1e13; k *= 10) {
      const struct two_fluid_pair pair = {phi, 2560, 1.2, k / phi};
      const double m_s = phi * 2560, m_f = (1 - phi) * 1.2;
      double u[2] = {a[0], a[1]}, exact[2];
      two_fluid_pair_solve(&pair, u);
      by_determinant(m_s, m_f, k, a, exact);
      ck_assert_double_eq_tol(u[0], exact[0], 1e-12);
      ck_assert_double_eq_tol(u[1], exact[1], 1e-12);
      EQUAL(m_s * u[0] + m_f * u[1], m_s * a[0] + m_f * a[1], 1e-12);
      const double lambda =
          (phi * phi * m_f + (1 - phi) * (1 - phi) * m_s + k) /
          (m_s * m_f + k * (m_s + m_f));
      EQUAL(two_fluid_pair_mobility(&pair), lambda, 1e-12);
      EQUAL(two_fluid_pair_inertia(&pair),
            2560 + 1.2 * phi / (1 - phi) + k / (phi * (1 - phi) * (1 - phi)),
            1e-12);
    }
}
END_TEST

/* The pressure moves j = phi u_s + (1 - phi) u_f by -dt lambda grad p. */
START_TEST(mobility_is_that_of_the_pair) {
  for (double c = 0; c<1e9; c = c> 0 ? 10 * c : 1e-3) {
    const struct two_fluid_pair pair = {0.4, 2560, 998, c};
    double u[2] = {-1 / 2560., -1 / 998.};
    two_fluid_pair_solve(&pair, u);
    EQUAL(-(0.4 * u[0] + 0.6 * u[1]), two_fluid_pair_mobility(&pair), 1e-13);
  }
}
END_TEST

START_TEST(pair_has_limits) {
  /* no drag: each on its own; much drag: as one */
  const struct two_fluid_pair none = {0.5, 2560, 998, 0};
  EQUAL(two_fluid_pair_mobility(&none), 0.5 / 2560 + 0.5 / 998, 1e-14);
  double u[2] = {3, -2};
  two_fluid_pair_solve(&none, u);
  ck_assert_double_eq_tol(u[0], 3, 1e-14);
  ck_assert_double_eq_tol(u[1], -2, 1e-14);
  const struct two_fluid_pair much = {0.5, 2560, 998, 1e300};
  EQUAL(two_fluid_pair_mobility(&much), 1 / 1779., 1e-12);
  two_fluid_pair_solve(&much, u);
  EQUAL(u[0], (3 * 2560 - 2 * 998.) / 3558, 1e-12);
  EQUAL(u[1], u[0], 1e-12);
  /* no grains: the fluid alone, and a grain that it drags along */
  const struct two_fluid_pair fluid = {0, 2560, 998, 2560};
  double v[2] = {4, 2};
  two_fluid_pair_solve(&fluid, v);
  EQUAL(v[0], 3, 1e-14);
  EQUAL(v[1], 2, 1e-14);
  EQUAL(two_fluid_pair_mobility(&fluid), 1. / 998, 1e-14);
  ck_assert(isfinite(two_fluid_pair_inertia(&fluid)));
}
END_TEST

/* The determinant is 0 where the fluid has no density and nothing drags it. */
START_TEST(pair_without_determinant_stays) {
  const struct two_fluid_pair vacuum = {0.5, 2560, 0, 0};
  double u[2] = {3, -2};
  two_fluid_pair_solve(&vacuum, u);
  ck_assert_double_eq(u[0], 3);
  ck_assert_double_eq(u[1], -2);
  const struct two_fluid_pair nothing = {0, 0, 0, 0};
  two_fluid_pair_solve(&nothing, u);
  ck_assert_double_eq(u[0], 3);
  ck_assert_double_eq(u[1], -2);
  /* without density but dragged, the fluid goes with the grains */
  const struct two_fluid_pair dragged = {0.5, 2560, 0, 10};
  two_fluid_pair_solve(&dragged, u);
  EQUAL(u[0], 3, 1e-14);
  EQUAL(u[1], 3, 1e-14);
}
END_TEST

START_TEST(a_fluid_as_dense_as_grains_is_refused) {
  struct two_fluid_closure c =
      closures(TWO_FLUID_GIDASPOW, TWO_FLUID_WATER, 1e-3);
  c.param[TWO_FLUID_FLUID_DENSITY] = 2560;
  ck_assert_ptr_nonnull(two_fluid_prepare(&c));
}
END_TEST

Suite *two_fluid_drag_suite(void) {
  Suite *suite = suite_create("two_fluid_drag");
  TCase *tcase = tcase_create("drag");
  tcase_add_test(tcase, fluids_are_those_of_table_2);
  tcase_add_loop_test(tcase, regimes_are_those_of_the_reference, 0, NREGIMES);
  tcase_add_test(tcase, branches_are_ergun_and_wen_yu);
  tcase_add_test(tcase, fast_grains_have_the_least_drag_coefficient);
  tcase_add_test(tcase, drag_has_no_jump_but_the_branches_have);
  tcase_add_test(tcase, limits_are_finite);
  tcase_add_test(tcase, pores_dissipate_what_drag_takes);
  tcase_add_test(tcase, pair_solves_both_momenta);
  tcase_add_test(tcase, mobility_is_that_of_the_pair);
  tcase_add_test(tcase, pair_has_limits);
  tcase_add_test(tcase, pair_without_determinant_stays);
  tcase_add_test(tcase, a_fluid_as_dense_as_grains_is_refused);
  suite_add_tcase(suite, tcase);
  return suite;
}
