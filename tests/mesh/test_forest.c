/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/forest.h"

#include <check.h>

#include "grid.h"

START_TEST(levels_rebuild_the_forest) {
  struct forest *forest = grid_new(MPI_COMM_WORLD, 2, false, 2, 5);
  const int32_t n = forest_nleaves(forest);
  int8_t *level = MEM_NEW(int8_t, n), *again = MEM_NEW(int8_t, n);
  forest_levels(forest, level);
  struct forest *copy =
      forest_from_levels(MPI_COMM_WORLD, forest_layout(forest), n, level);
  ck_assert_ptr_nonnull(copy);
  ck_assert(all_ranks(forest_nleaves(copy) == n));
  forest_levels(copy, again);
  bool good = true;
  for (int32_t i = 0; i < n; i++) good = good && level[i] == again[i];
  ck_assert(all_ranks(good));
  if (n > 0) level[0]++; /* no longer tiles the brick */
  ck_assert_ptr_null(
      forest_from_levels(MPI_COMM_WORLD, forest_layout(forest), n, level));
  mem_free(level);
  mem_free(again);
  forest_destroy(copy);
  forest_destroy(forest);
}
END_TEST

/* A map read backwards must account for all the volume of the old leaves. */
START_TEST(map_covers_all_volume) {
  struct forest *forest = grid_new(MPI_COMM_WORLD, 1, false, 2, 5);
  const int32_t n = forest_nleaves(forest);
  int8_t *flag = MEM_NEW(int8_t, n), *level = MEM_NEW(int8_t, n);
  forest_levels(forest, level);
  for (int32_t i = 0; i < n; i++) flag[i] = i % 7 == 0 ? 1 : -1;
  struct forest_map map;
  ck_assert(forest_adapt(forest, flag, 1, 6, &map));
  double *share = MEM_NEW(double, n);
  bool good = map.nold == n && map.nnew == forest_nleaves(forest);
  for (int32_t i = 0; i < map.nnew; i++) {
    double each = 1;
    if (map.delta[i] > 0) each = pow(0.5, DIM * map.delta[i]);
    for (int32_t k = 0; k < map.count[i]; k++) share[map.first[i] + k] += each;
    good = good && (map.delta[i] >= 0 || map.count[i] == NCHILD);
  }
  for (int32_t i = 0; i < n; i++) good = good && fabs(share[i] - 1) < 1e-14;
  ck_assert(all_ranks(good));
  forest_map_destroy(&map);
  mem_free(flag);
  mem_free(level);
  mem_free(share);
  forest_destroy(forest);
}
END_TEST

/* Centres of the new leaves are those of a mesh made of them. */
START_TEST(map_knows_where_leaves_lie) {
  struct forest *forest = grid_brick(false, 1, 3);
  const int32_t n = forest_nleaves(forest);
  int8_t *flag = MEM_NEW(int8_t, n);
  for (int32_t i = 0; i < n; i++) flag[i] = i % 5 == 0 ? 1 : -1;
  struct forest_map map;
  const bool changed = forest_adapt(forest, flag, 0, 4, &map);
  struct mesh *mesh = mesh_new(forest);
  double most = 0;
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    for (int d = 0; d < DIM; d++) {
      most = larger(most, fabs(map.x[i][d] - mesh->x[i][d]));
    }
  }
  most = mesh_max(mesh, most);
  mesh_destroy(mesh);
  forest_map_destroy(&map);
  mem_free(flag);
  forest_destroy(forest);
  ck_assert(changed);
  ck_assert_double_le(most, 1e-14);
}
END_TEST

START_TEST(partition_moves_data_with_leaves) {
  struct forest *forest = grid_new(MPI_COMM_WORLD, 1, true, 3, 3);
  struct mesh *mesh = mesh_new(forest);
  int8_t *flag = MEM_NEW(int8_t, mesh->nleaves);
  for (int32_t i = 0; i < mesh->nleaves; i++) flag[i] = mesh->x[i][0] < 0.3;
  mesh_destroy(mesh);
  struct forest_map map;
  forest_adapt(forest, flag, 0, 5, &map);
  forest_map_destroy(&map);
  mem_free(flag);
  mesh = mesh_new(forest);
  double *data[2];
  for (int k = 0; k < 2; k++) {
    data[k] = MEM_NEW(double, mesh->nleaves);
    for (int32_t i = 0; i < mesh->nleaves; i++) data[k][i] = mesh->x[i][k];
  }
  mesh_destroy(mesh);
  forest_partition(forest, 2, data);
  mesh = mesh_new(forest);
  bool good = true;
  for (int k = 0; k < 2; k++) {
    for (int32_t i = 0; i < mesh->nleaves; i++) {
      good = good && data[k][i] == mesh->x[i][k];
    }
    mem_free(data[k]);
  }
  ck_assert(all_ranks(good));
  mesh_destroy(mesh);
  forest_destroy(forest);
}
END_TEST

Suite *forest_suite(void);
Suite *forest_suite(void) {
  Suite *suite = suite_create("forest");
  TCase *tc = tcase_create("forest");
  tcase_add_test(tc, levels_rebuild_the_forest);
  tcase_add_test(tc, map_covers_all_volume);
  tcase_add_test(tc, map_knows_where_leaves_lie);
  tcase_add_test(tc, partition_moves_data_with_leaves);
  suite_add_tcase(suite, tc);
  return suite;
}
