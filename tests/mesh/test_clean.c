/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/clean.h"

#include <check.h>
#include <stdlib.h>

#include "grid.h"

/* Return the divergence, times h over the largest velocity, that cleaning
 * leaves of random face velocities of size 1, closed or open at the top. The
 * forest is taken over. */
static double cleaned(struct forest *forest, bool with_opening) {
  struct mesh *mesh = mesh_new(forest);
  struct clean *clean = clean_new(mesh);
  double *u_f = MEM_NEW(double, mesh->nfaces_all);
  bool open[MESH_MAX_PATCHES] = {false};
  open[NFACE - 1] = with_opening;
  srand(3 + (unsigned)mesh->rank);
  for (int32_t f = 0; f < mesh->nfaces; f++) {
    const int patch = mesh->face_patch[f];
    u_f[f] = patch >= 0 && !open[patch] ? 0 : rand() / (double)RAND_MAX;
  }
  clean_face_velocity(clean, mesh, open, u_f);
  double most = 0, h = 1;
  for (int32_t i = 0; i < mesh->nleaves; i++) h = fmin(h, mesh->h[i]);
  for (int32_t f = 0; f < mesh->nfaces; f++) most = larger(most, fabs(u_f[f]));
  double div = clean_divergence(mesh, u_f) * -mesh_max(mesh, -h);
  most = mesh_max(mesh, most);
  mem_free(u_f);
  clean_destroy(clean);
  mesh_destroy(mesh);
  forest_destroy(forest);
  return div / most;
}

START_TEST(divergence_vanishes_to_round_off) {
  double left =
      cleaned(grid_new(MPI_COMM_WORLD, 1 + _i / 4, _i & 1, 2, 5), _i & 2);
  ck_assert_double_le(left, 1e-14);
}
END_TEST

START_TEST(the_brick_may_lie_anywhere) {
  double left = cleaned(grid_brick(_i, 1, 3), false);
  ck_assert_double_le(left, 1e-14);
}
END_TEST

/* A source of size 1 in the leaves of one half, taken out in the other, becomes
 * the divergence to round-off over h. */
START_TEST(divergence_becomes_the_source) {
  struct forest *forest = grid_new(MPI_COMM_WORLD, 1 + _i, false, 2, 5);
  struct mesh *mesh = mesh_new(forest);
  struct clean *clean = clean_new(mesh);
  double *u_f = MEM_NEW(double, mesh->nfaces_all), most = 0;
  double *source = MEM_NEW(double, mesh->nleaves), sum[2] = {0};
  const bool open[MESH_MAX_PATCHES] = {false};
  for (int k = 0; k < 2; k++) {
    for (int32_t i = 0; i < mesh->nleaves; i++) {
      const int half = mesh->x[i][0] > 0.3;
      if (k == 0) sum[half] += mesh_volume(mesh, i);
      if (k == 1) source[i] = (half ? 1 : -1) / sum[half];
    }
    for (int j = 0; j < 2 && k == 0; j++) sum[j] = mesh_sum(mesh, sum[j]);
  }
  clean_to_source(clean, mesh, open, source, u_f);
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    double net = 0;
    for (int f = 0; f < NFACE; f++) {
      net += (f & 1 ? 1 : -1) * u_f[mesh->cell_face[i][f]];
    }
    most = larger(most, fabs(net - source[i] * mesh->h[i]));
  }
  most = mesh_max(mesh, most);
  mem_free(source);
  mem_free(u_f);
  clean_destroy(clean);
  mesh_destroy(mesh);
  forest_destroy(forest);
  ck_assert_double_le(most, 1e-13);
}
END_TEST

START_TEST(a_solenoidal_field_is_left_alone) {
  struct forest *forest = grid_new(MPI_COMM_WORLD, 1, true, 2, 5);
  struct mesh *mesh = mesh_new(forest);
  struct clean *clean = clean_new(mesh);
  double *u_f = MEM_NEW(double, mesh->nfaces_all);
  const bool open[MESH_MAX_PATCHES] = {false};
  for (int d = 0; d < DIM; d++) {
    for (int32_t f = mesh->face_begin[d]; f < mesh->face_begin[d + 1]; f++) {
      u_f[f] = 0.3 + d;
    }
  }
  clean_face_velocity(clean, mesh, open, u_f);
  double most = 0;
  for (int d = 0; d < DIM; d++) {
    for (int32_t f = mesh->face_begin[d]; f < mesh->face_begin[d + 1]; f++) {
      most = larger(most, fabs(u_f[f] - 0.3 - d));
    }
  }
  ck_assert_double_le(mesh_max(mesh, most), 1e-14);
  mem_free(u_f);
  clean_destroy(clean);
  mesh_destroy(mesh);
  forest_destroy(forest);
}
END_TEST

Suite *clean_suite(void);
Suite *clean_suite(void) {
  Suite *suite = suite_create("clean");
  TCase *tc = tcase_create("clean");
  tcase_add_loop_test(tc, divergence_vanishes_to_round_off, 0, 8);
  tcase_add_loop_test(tc, the_brick_may_lie_anywhere, 0, 2);
  tcase_add_loop_test(tc, divergence_becomes_the_source, 0, 2);
  tcase_add_test(tc, a_solenoidal_field_is_left_alone);
  suite_add_tcase(suite, tc);
  return suite;
}
