/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/mesh.h"

#include <check.h>
#include <stdlib.h>

#include "grid.h"

static const int kLevels[][2] = {{3, 3}, {2, 5}, {1, 4}};

static double linear(const double x[DIM]) {
  static const double slope[] = {1.3, -0.7, 0.4};
  double v = 0.2;
  for (int d = 0; d < DIM; d++) v += slope[d] * x[d];
  return v;
}

/* Largest error of the stencils of a linear field, boundary nodes aside. */
static double linear_error(const struct mesh *mesh) {
  double *v = MEM_NEW(double, mesh->ncells);
  struct bc bc[MESH_MAX_PATCHES] = {{0}};
  const struct bc *bcs[] = {bc};
  for (int32_t i = 0; i < mesh->nleaves; i++) v[i] = linear(mesh->x[i]);
  mesh_fill(mesh, 1, &v, bcs, false);
  double error = 0;
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    for (int s = 0; s < NSTENCIL; s++) {
      const int o[] = {s % 3 - 1, s / 3 % 3 - 1, s / 9 - 1};
      double x[DIM];
      for (int d = 0; d < DIM; d++) x[d] = mesh->x[i][d] + o[d] * mesh->h[i];
      const int32_t node = mesh->stencil[i][s];
      if (node >= mesh->begin_boundary) continue;
      error = fmax(error, fabs(v[node] - linear(x)));
    }
  }
  mem_free(v);
  return mesh_max(mesh, error);
}

START_TEST(stencils_keep_linear_fields) {
  for (int trees = 1; trees <= 2; trees++) {
    struct forest *forest =
        grid_new(MPI_COMM_WORLD, trees, false, kLevels[_i][0], kLevels[_i][1]);
    struct mesh *mesh = mesh_new(forest);
    /* sums of at most a hundred terms of order one */
    ck_assert_double_le(linear_error(mesh), 1e-13);
    mesh_destroy(mesh);
    forest_destroy(forest);
  }
}
END_TEST

/* Sum over the leaves of a nonlinear function of all stencil values. */
static double stencil_sum(const struct mesh *mesh) {
  double *v = MEM_NEW(double, mesh->ncells);
  struct bc bc[MESH_MAX_PATCHES];
  for (int k = 0; k < MESH_MAX_PATCHES; k++) {
    bc[k] = (struct bc){k % 2 ? BC_ROBIN : BC_NEUMANN, 0.3 * k, 0.1};
  }
  const struct bc *bcs[] = {bc};
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    double phase = linear(mesh->x[i]);
    v[i] = sin(7 * phase) + phase * phase;
  }
  mesh_fill(mesh, 1, &v, bcs, false);
  double sum = 0;
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    for (int s = 0; s < NSTENCIL; s++) {
      sum += (1 + s * s) * v[mesh->stencil[i][s]] * mesh_volume(mesh, i);
    }
  }
  mem_free(v);
  return mesh_sum(mesh, sum);
}

START_TEST(stencils_do_not_depend_on_ranks) {
  for (int periodic = 0; periodic < 2; periodic++) {
    double sum[2];
    for (int k = 0; k < 2; k++) {
      struct forest *forest =
          grid_new(k ? MPI_COMM_WORLD : MPI_COMM_SELF, 2, periodic,
                   kLevels[_i][0], kLevels[_i][1]);
      struct mesh *mesh = mesh_new(forest);
      sum[k] = stencil_sum(mesh);
      mesh_destroy(mesh);
      forest_destroy(forest);
    }
    ck_assert_double_le(fabs(sum[1] - sum[0]), 1e-12 * fabs(sum[0]));
  }
}
END_TEST

START_TEST(fluxes_leave_one_cell_and_enter_another) {
  struct forest *forest =
      grid_new(MPI_COMM_WORLD, 1, false, kLevels[_i][0], kLevels[_i][1]);
  struct mesh *mesh = mesh_new(forest);
  double *flux = MEM_NEW(double, mesh->nfaces_all);
  srand(7 + (unsigned)mesh->rank);
  for (int32_t f = 0; f < mesh->nfaces; f++) {
    flux[f] = mesh->face_patch[f] >= 0 ? 0 : rand() / (double)RAND_MAX - 0.5;
  }
  mesh_fill_faces(mesh, 1, &flux);
  double sum = 0, size = 0;
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    double div = 0;
    for (int d = 0; d < DIM; d++) {
      div +=
          flux[mesh->cell_face[i][2 * d + 1]] - flux[mesh->cell_face[i][2 * d]];
    }
    sum += div * mesh_volume(mesh, i) / mesh->h[i];
    size += fabs(div) * mesh_volume(mesh, i) / mesh->h[i];
  }
  sum = mesh_sum(mesh, sum), size = mesh_sum(mesh, size);
  ck_assert_double_le(fabs(sum), 1e-14 * size);
  mem_free(flux);
  mesh_destroy(mesh);
  forest_destroy(forest);
}
END_TEST

START_TEST(every_face_joins_its_neighbours) {
  struct forest *forest =
      grid_new(MPI_COMM_WORLD, 2, true, kLevels[_i][0], kLevels[_i][1]);
  struct mesh *mesh = mesh_new(forest);
  bool good = true;
  for (int d = 0; d < DIM; d++) {
    for (int32_t f = mesh->face_begin[d]; f < mesh->face_begin[d + 1]; f++) {
      const int32_t *leaf = mesh->face_leaf[f];
      const int32_t owner = mesh->face_owner[f];
      good = good && (leaf[0] == owner || leaf[1] == owner);
      good =
          good && mesh->face_h[f] == fmin(mesh->h[leaf[0]], mesh->h[leaf[1]]);
      double gap = mesh->x[leaf[1]][d] - mesh->x[leaf[0]][d];
      if (gap < 0) gap += 1; /* across the periodic side */
      double expected = 0.5 * (mesh->h[leaf[0]] + mesh->h[leaf[1]]);
      good = good && fabs(gap - expected) < 1e-14;
    }
  }
  ck_assert(all_ranks(good));
  mesh_destroy(mesh);
  forest_destroy(forest);
}
END_TEST

Suite *mesh_suite(void);
Suite *mesh_suite(void) {
  Suite *suite = suite_create("mesh");
  TCase *tc = tcase_create("mesh");
  const int n = (int)(sizeof kLevels / sizeof *kLevels);
  tcase_add_loop_test(tc, stencils_keep_linear_fields, 0, n);
  tcase_add_loop_test(tc, stencils_do_not_depend_on_ranks, 0, n);
  tcase_add_loop_test(tc, fluxes_leave_one_cell_and_enter_another, 0, n);
  tcase_add_loop_test(tc, every_face_joins_its_neighbours, 0, n);
  tcase_set_timeout(tc, 60);
  suite_add_tcase(suite, tc);
  return suite;
}
