/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/solve.h"

#include <check.h>
#include <math.h>

Suite *solve_suite(void);

static struct solve_stats of(int iterations, double residual,
                             enum solve_status status) {
  return (struct solve_stats){
      .iterations = iterations, .residual_after = residual, .status = status};
}

/* Verifies that both solves count, and the worse result of the two is kept,
 * whichever came first. */
START_TEST(the_worse_of_two_solves_is_kept) {
  const struct solve_stats good = of(3, 1e-6, SOLVE_CONVERGED);
  const struct solve_stats better = of(2, 1e-8, SOLVE_CONVERGED);
  const struct solve_stats stalled = of(40, 1e-7, SOLVE_STALLED);
  const struct solve_stats wild = of(50, NAN, SOLVE_STALLED);
  const struct solve_stats *by_rank[] = {&better, &good, &stalled, &wild};
  for (int a = 0; a < 4; a++) {
    for (int b = 0; b < 4; b++) {
      const struct solve_stats *worse = by_rank[a > b ? a : b];
      struct solve_stats last = *by_rank[a];
      solve_add(&last, by_rank[b]);
      ck_assert_int_eq(last.iterations,
                       by_rank[a]->iterations + by_rank[b]->iterations);
      ck_assert_int_eq(last.status, worse->status);
      ck_assert(last.residual_after == worse->residual_after || worse == &wild);
      ck_assert(worse != &wild || last.residual_after != last.residual_after);
    }
  }
}
END_TEST

/* Verifies that a stalled solve passes near its tolerance or at round-off. */
START_TEST(a_stalled_solve_passes_near_its_tolerance) {
  struct solve_stats stats = of(9, 9e-4, SOLVE_STALLED);
  ck_assert(solve_passes(&stats, 1e-4, 0));
  ck_assert(!solve_passes(&stats, 8e-5, 0));
  ck_assert(solve_passes(&stats, 1e-9, 1e-3));
  stats.status = SOLVE_INCOMPATIBLE;
  ck_assert(!solve_passes(&stats, 1e-4, 1e-3));
  stats.status = SOLVE_CONVERGED;
  ck_assert(solve_passes(&stats, 1e-12, 0));
  stats = of(9, NAN, SOLVE_STALLED);
  ck_assert(!solve_passes(&stats, 1e-4, 1e-3));
}
END_TEST

Suite *solve_suite(void) {
  Suite *suite = suite_create("solve");
  TCase *tcase = tcase_create("solve");
  suite_add_tcase(suite, tcase);
  tcase_add_test(tcase, the_worse_of_two_solves_is_kept);
  tcase_add_test(tcase, a_stalled_solve_passes_near_its_tolerance);
  return suite;
}
