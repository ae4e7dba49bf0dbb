/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/grid_size.h"

#include <check.h>

#include "sim.h"
#include "talus/forest.h"
#include "transport.h"

Suite *grid_size_suite(void);

enum { FINE = DIM == 2 ? 8 : 5 };

/* Estimate over the leaves of the grid as it is made. */
static double ratio(const struct params *params) {
  const double estimate = grid_size_leaves(params);
  struct two_phase *sim = sim_start(params);
  const double leaves = (double)forest_nleaves_global(sim->grid.forest);
  two_phase_destroy(sim);
  return estimate / leaves;
}

static struct body drop = {{0.3, 0.35, 0.32}, 0.15};

static struct params drop_params(void) {
  struct params params = box_params(FINE);
  params.level_min = 1;
  params.shape = (struct function){ball, &drop};
  return params;
}

static double corner(void *context, const double x[3]) {
  (void)context;
  return fabs(x[0] - 0.5) + fabs(x[DIM - 1]) < 0.2 ? FINE : 3;
}

static void add(struct params *params, struct criterion criterion) {
  params->criterion[params->ncriteria++] = criterion;
}

START_TEST(uniform_grids_are_counted) {
  struct params params = box_params(DIM == 2 ? 24 : 16);
  params.trees[1] = 3;
  params.max_cells = 0;
  ck_assert_double_eq(grid_size_leaves(&params), 3 * 0x1p48);
}
END_TEST

START_TEST(adapted_grids_are_estimated) {
  struct params band = drop_params(), inside = drop_params();
  struct params place = drop_params(), both = drop_params();
  add(&band,
      (struct criterion){CRITERION_INTERFACE, .level = FINE, .width = 3});
  add(&inside, (struct criterion){CRITERION_INSIDE, .level = FINE});
  add(&place, (struct criterion){CRITERION_FUNCTION, .level = FINE,
                                 .function = {corner, NULL}});
  add(&both,
      (struct criterion){CRITERION_INTERFACE, .level = FINE, .width = 2});
  add(&both, (struct criterion){CRITERION_INSIDE, .level = FINE - 1});
  const double r[] = {ratio(&band), ratio(&inside), ratio(&place),
                      ratio(&both)};
  for (int k = 0; k < 4; k++) {
    ck_assert_double_ge(r[k], 0.75);
    ck_assert_double_le(r[k], DIM == 2 ? 1.25 : 1.4); /* few cells across */
  }
}
END_TEST

START_TEST(the_cap_binds) {
  struct params params = drop_params();
  add(&params, (struct criterion){CRITERION_INSIDE, .level = FINE});
  params.max_cells = 100;
  ck_assert_double_eq(grid_size_leaves(&params), 100);
  params.level_min = 5;
  ck_assert_double_eq(grid_size_leaves(&params), ldexp(1, 5 * DIM));
}
END_TEST

Suite *grid_size_suite(void) {
  Suite *suite = suite_create("grid_size");
  TCase *tcase = tcase_create("estimate");
  tcase_add_test(tcase, uniform_grids_are_counted);
  tcase_add_test(tcase, adapted_grids_are_estimated);
  tcase_add_test(tcase, the_cap_binds);
  suite_add_tcase(suite, tcase);
  return suite;
}
