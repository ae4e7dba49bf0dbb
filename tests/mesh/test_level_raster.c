/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/level_raster.h"

#include <check.h>

#include "sim.h"

Suite *level_raster_suite(void);

enum { COARSE = 2, FINE = DIM == 2 ? 7 : 5 };

/* Return a point of the finest grid, between the centres of all coarser leaves.
 */
static double spot(void *context, const double x[3]) {
  const double *depth = context;
  double away = 0;
  for (int d = 0; d < DIM; d++) {
    away = larger(away, fabs(x[d] - (0.375 + 0.5 / (1 << FINE))));
  }
  return away < 0.4 / (1 << FINE) ? *depth : -*depth;
}

START_TEST(criterion_of_position_misses_nothing) {
  static double depth[] = {FINE, 30, 1e10, 1e300};
  struct params params = box_params(FINE);
  params.level_min = COARSE;
  params.criterion[params.ncriteria++] =
      (struct criterion){.type = CRITERION_FUNCTION,
                         .level = FINE,
                         .function = {spot, &depth[_i]}};
  struct two_phase *sim = sim_start(&params);
  double found = 0, coarsest = 0;
  for (int32_t i = 0; i < sim->grid.mesh->nleaves; i++) {
    double x[3] = {0};
    for (int d = 0; d < DIM; d++) x[d] = sim->grid.mesh->x[i][d];
    if (spot(depth, x) > 0 && sim->grid.mesh->level[i] == FINE) found = 1;
    coarsest = larger(coarsest, sim->grid.mesh->h[i]);
  }
  found = mesh_max(sim->grid.mesh, found),
  coarsest = mesh_max(sim->grid.mesh, coarsest);
  const bool changed = two_phase_adapt(sim);
  two_phase_destroy(sim);
  ck_assert(found > 0);
  ck_assert(!changed);
  ck_assert(coarsest == 1.0 / (1 << COARSE));
}
END_TEST

/* Three trees along x. */
START_TEST(raster_finds_the_most_in_cells_of_all_levels) {
  struct forest_layout layout = {.size = 0.5};
  double depth = 99;
  const struct function function = {spot, &depth};
  for (int d = 0; d < DIM; d++) layout.trees[d] = d == 0 ? 3 : 1;
  struct level_raster *raster =
      level_raster_new(MPI_COMM_WORLD, &layout, &function, FINE + 1);
  bool good = true;
  for (int l = 0; l <= FINE + 1; l++) {
    const double h = 0.5 / (1 << l);
    double at[DIM];
    for (int d = 0; d < DIM; d++) {
      at[d] = h * (floor((0.375 + 0.5 / (1 << FINE)) / h) + 0.5);
    }
    good = good && level_raster_most(raster, at, l) == FINE + 1;
    at[0] += 0.5;
    good = good && level_raster_most(raster, at, l) == 0;
  }
  level_raster_destroy(raster);
  ck_assert(all_ranks(good));
}
END_TEST

Suite *level_raster_suite(void) {
  Suite *suite = suite_create("level_raster");
  TCase *tc = tcase_create("level_raster");
  tcase_add_loop_test(tc, criterion_of_position_misses_nothing, 0, 4);
  tcase_add_test(tc, raster_finds_the_most_in_cells_of_all_levels);
  tcase_set_timeout(tc, 60);
  suite_add_tcase(suite, tc);
  return suite;
}
