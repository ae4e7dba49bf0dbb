/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/hierarchy.h"

#include <check.h>

#include "../../src/solver/levels.h"
#include "faces.h"

static double one(const double *x) {
  (void)x;
  return 1;
}

START_TEST(neighbours_point_back) {
  struct forest *forest =
      grid_new(MPI_COMM_WORLD, 1 + _i % 2, _i / 2, 1, DIM == 2 ? 5 : 4);
  struct mesh *mesh = mesh_new(forest);
  struct hierarchy *h = hierarchy_new(mesh);
  const int32_t nvalues = h->nslots + h->njumps + h->nmirrors;
  int wrong = 0;
  for (int32_t i = 0; i < h->nowned; i++) {
    for (int f = 0; f < NFACE; f++) {
      const int32_t j = h->neighbour[f][i];
      if (j < 0 || j >= nvalues) wrong++;
      if (j < 0 || j >= h->nowned) continue;
      if (h->neighbour[f ^ 1][j] != i) wrong++;
    }
    for (int e = 0; e < NCORNER; e++) {
      if (h->corner[e][i] < 0 || h->corner[e][i] >= nvalues) wrong++;
    }
  }
  ck_assert_int_eq((int)mesh_sum(mesh, wrong), 0);
  hierarchy_destroy(h);
  mesh_destroy(mesh);
  forest_destroy(forest);
}
END_TEST

/* Beyond a wall lies the image of the node; on a grid without a fine edge
 * beside it, diagonally that of the neighbour along the wall. */
START_TEST(walls_show_images) {
  struct forest *forest = grid_new(MPI_COMM_WORLD, 1, false, 1, 3);
  struct mesh *mesh = mesh_new(forest);
  struct hierarchy *h = hierarchy_new(mesh);
  const int32_t first = h->nslots + h->njumps; /* image */
  int wrong = 0, walls = 0;
  for (int32_t i = 0; i < h->nowned; i++) {
    for (int f = 0; f < 2; f++) {
      if (!(h->wall[i] >> f & 1)) continue;
      walls++;
      if (h->neighbour[f][i] < first) wrong++;
      if (h->mirror[h->neighbour[f][i] - first].source != i) wrong++;
      const int32_t next = h->neighbour[3][i]; /* upwards */
      const int32_t diagonal = h->corner[corner_entry(0, f, 1, 1)][i];
      if (next >= h->nslots) continue;
      if (diagonal < first || h->mirror[diagonal - first].source != next)
        wrong++;
    }
  }
  ck_assert_int_eq((int)mesh_sum(mesh, wrong), 0);
  ck_assert(mesh_sum(mesh, walls) > 0);
  hierarchy_destroy(h);
  mesh_destroy(mesh);
  forest_destroy(forest);
}
END_TEST

START_TEST(every_leaf_has_a_place) {
  struct forest *forest = grid_new(MPI_COMM_WORLD, 2, false, 0, 3);
  struct mesh *mesh = mesh_new(forest);
  struct hierarchy *h = hierarchy_new(mesh);
  double nodes = 0;
  int wrong = 0;
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    if (h->leaf_slot[i] < 0 || h->leaf_slot[i] >= h->nslots) wrong++;
  }
  for (int l = 0; l < h->nlevels; l++) nodes += h->level[l].nowned;
  /* each family replaces one node by NCHILD: leaves - trees = families
   * (NCHILD - 1), nodes = leaves + families */
  const double leaves = (double)forest_nleaves_global(forest);
  const double families = (leaves - NCHILD) / (NCHILD - 1);
  ck_assert_double_eq(mesh_sum(mesh, nodes), leaves + families);
  ck_assert_int_eq((int)mesh_sum(mesh, wrong), 0);
  hierarchy_destroy(h);
  mesh_destroy(mesh);
  forest_destroy(forest);
}
END_TEST

/* The residual of the two-point operator, seen through the cycle itself: a
 * stationary iteration e += M (r - A e) must contract fast. Here on one level,
 * where the operator of the solver is the same. */
START_TEST(one_cycle_leaves_little) {
  struct forest *forest = grid_new(MPI_COMM_WORLD, 1, true, 4, 4);
  struct mesh *mesh = mesh_new(forest);
  struct hierarchy *h = hierarchy_new(mesh);
  struct bc bc[MESH_MAX_PATCHES] = {{0}};
  const struct bc *bcs[] = {bc};
  double *alpha_f = face_field(mesh, one, false);
  double *r = MEM_NEW(double, mesh->nleaves), error = 0;
  double *e = MEM_NEW(double, mesh->nleaves);
  double *mass = MEM_NEW(double, mesh->nleaves);
  /* -lap e + e = r with e = cos(2 pi x): 4 / h^2 sin^2(pi h) + 1 */
  const double hh = ldexp(1, -4), s = sin(kPi * hh);
  const double eigenvalue = 4 * s * s / (hh * hh) + 1;
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    mass[i] = 1;
    r[i] = eigenvalue * cos(2 * kPi * mesh->x[i][0]);
  }
  coefficients_set(h, 1, alpha_f, 1, mass, bcs);
  cycle_run(h, 1, r, e);
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    error = larger(error, fabs(e[i] - cos(2 * kPi * mesh->x[i][0])));
  }
  error = mesh_max(mesh, error);
  ck_assert_double_le(error, 0.1);
  mem_free(alpha_f);
  mem_free(r);
  mem_free(e);
  mem_free(mass);
  hierarchy_destroy(h);
  mesh_destroy(mesh);
  forest_destroy(forest);
}
END_TEST

/* On a brick of trees that are not divided a cycle is the solve of the coarsest
 * level alone, which leaves 1e-3 of the residual. Here a periodic brick, on
 * which r - (e - lap e) is a sum over neighbours. Loop 1: without mass nothing
 * solves for a constant, which is left alone. */
START_TEST(coarsest_level_leaves_a_thousandth) {
  enum { TREES = DIM == 2 ? 16 : 8 };
  struct forest *forest = grid_new(MPI_COMM_WORLD, TREES, true, 0, 0);
  struct mesh *mesh = mesh_new(forest);
  struct hierarchy *h = hierarchy_new(mesh);
  struct bc bc[MESH_MAX_PATCHES] = {{0}};
  const struct bc *bcs[] = {bc};
  double *alpha_f = face_field(mesh, one, false), sum[2] = {0}, most = 0;
  double *r = MEM_NEW(double, mesh->nleaves);
  double *mass = MEM_NEW(double, mesh->nleaves);
  double *filled = MEM_NEW(double, mesh->ncells);
  double *e = MEM_NEW(double, mesh->nleaves);
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    double r2 = 0;
    for (int d = 0; d < DIM; d++) r2 += pow(mesh->x[i][d] - 0.4 - 0.1 * d, 2);
    mass[i] = _i ? 0 : 1;
    r[i] = _i ? 1 : exp(-8 * r2);
  }
  coefficients_set(h, 1, alpha_f, 1, mass, bcs);
  cycle_run(h, 1, r, e);
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    filled[i] = e[i];
    most = larger(most, fabs(filled[i]));
  }
  most = mesh_max(mesh, most);
  mesh_fill(mesh, 1, &filled, bcs, false);
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    double laplacian = -NFACE * filled[i];
    for (int f = 0; f < NFACE; f++) {
      laplacian += filled[mesh->stencil[i][stencil_face(f)]];
    }
    laplacian *= TREES * TREES;
    sum[0] += pow(r[i] - filled[i] + laplacian, 2);
    sum[1] += r[i] * r[i];
  }
  const double left = sqrt(mesh_sum(mesh, sum[0]) / mesh_sum(mesh, sum[1]));
  mem_free(alpha_f);
  mem_free(r);
  mem_free(mass);
  mem_free(filled);
  mem_free(e);
  hierarchy_destroy(h);
  mesh_destroy(mesh);
  forest_destroy(forest);
  if (_i) {
    ck_assert_double_eq(most, 0);
  } else {
    ck_assert_double_le(left, 1.01e-3);
  }
}
END_TEST

START_TEST(leaves_no_memory_behind) {
  struct forest *forest = grid_new(MPI_COMM_WORLD, 2, false, 0, 3);
  struct mesh *mesh = mesh_new(forest);
  const int64_t before = mem_live_blocks();
  hierarchy_destroy(hierarchy_new(mesh));
  const bool good = all_ranks(mem_live_blocks() == before);
  mesh_destroy(mesh);
  forest_destroy(forest);
  ck_assert(good);
}
END_TEST

/* One leaf in all, whose walls let nothing pass: r = mass e. */
START_TEST(ranks_without_leaves) {
  struct forest_layout layout = {.size = 1};
  struct bc bc[MESH_MAX_PATCHES] = {{0}};
  const struct bc *bcs[] = {bc};
  for (int d = 0; d < DIM; d++) layout.trees[d] = 1;
  struct forest *forest = forest_new(MPI_COMM_WORLD, &layout, 0);
  struct mesh *mesh = mesh_new(forest);
  struct hierarchy *h = hierarchy_new(mesh);
  const double leaves = mesh_sum(mesh, h->nleaves), mass = 2, r = 3;
  double *alpha_f = face_field(mesh, one, false);
  double value = 0;
  coefficients_set(h, 1, alpha_f, 1, &mass, bcs);
  cycle_run(h, 1, &r, &value);
  const double found = mesh_sum(mesh, mesh->nleaves > 0 ? value : 0);
  mem_free(alpha_f);
  hierarchy_destroy(h);
  mesh_destroy(mesh);
  forest_destroy(forest);
  ck_assert_double_eq(leaves, 1);
  ck_assert_double_eq(found, 1.5);
}
END_TEST

Suite *hierarchy_suite(void);
Suite *hierarchy_suite(void) {
  Suite *suite = suite_create("hierarchy");
  TCase *t = tcase_create("hierarchy");
  tcase_set_timeout(t, 60);
  tcase_add_loop_test(t, neighbours_point_back, 0, 4);
  tcase_add_test(t, walls_show_images);
  tcase_add_test(t, every_leaf_has_a_place);
  tcase_add_test(t, one_cycle_leaves_little);
  tcase_add_loop_test(t, coarsest_level_leaves_a_thousandth, 0, 2);
  tcase_add_test(t, leaves_no_memory_behind);
  tcase_add_test(t, ranks_without_leaves);
  suite_add_tcase(suite, t);
  return suite;
}
