/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/mesh.h"

#include <check.h>
#include <stdlib.h>

#include "faces.h"

static const int kLevels[][2] = {{3, 3}, {2, 5}, {1, 4}};

static double linear(const double x[DIM]) {
  static const double slope[] = {1.3, -0.7, 0.4};
  double v = 0.2;
  for (int d = 0; d < DIM; d++) v += slope[d] * x[d];
  return v;
}

/* Return the largest error of the stencils of a linear field, boundary nodes
 * aside. */
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
      error = larger(error, fabs(v[node] - linear(x)));
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

/* Loop 3: through periodic sides between leaves of two levels too. */
START_TEST(fluxes_leave_one_cell_and_enter_another) {
  struct forest *forest = _i == 3 ? grid_brick(true, 1, 3)
                                  : grid_new(MPI_COMM_WORLD, 1, false,
                                             kLevels[_i][0], kLevels[_i][1]);
  struct mesh *mesh = mesh_new(forest);
  double *flux = MEM_NEW(double, mesh->nfaces_all);
  srand(7 + (unsigned)mesh->rank);
  for (int32_t f = 0; f < mesh->nfaces; f++) {
    flux[f] = mesh->face_patch[f] >= 0 ? 0 : rand() / (double)RAND_MAX - 0.5;
  }
  mesh_fill_faces(mesh, 1, &flux);
  double sum = 0, size = 0;
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    sum += mesh_outflow(mesh, flux, i);
    size += fabs(mesh_outflow(mesh, flux, i));
  }
  sum = mesh_sum(mesh, sum), size = mesh_sum(mesh, size);
  ck_assert_double_le(fabs(sum), 1e-14 * size);
  mem_free(flux);
  mesh_destroy(mesh);
  forest_destroy(forest);
}
END_TEST

/* A velocity u_e = kOffset[e] + sum_d kSlope[e][d] x_d. */
static const double kOffset[] = {0.6, -1.1, 0.9};
static const double kSlope[3][3] = {
    {0.8, -1.7, 0.3}, {1.9, -2.3, -0.6}, {-0.4, 0.7, 0.5}};

static double component(int e, const double *x) {
  double u = kOffset[e];
  for (int d = 0; d < DIM; d++) u += kSlope[e][d] * x[d];
  return u;
}

/* Set the normal component on faces, v [nfaces_all] of the caller. */
static double *linear_velocity(const struct mesh *mesh) {
  double *v = MEM_NEW(double, mesh->nfaces_all);
  for (int32_t f = 0; f < mesh->nfaces; f++) {
    double x[DIM];
    face_centre(mesh, f, x);
    v[f] = component(face_direction(mesh, f), x);
  }
  mesh_fill_faces(mesh, 1, &v);
  return v;
}

/* Measure the largest errors in leaf i of a linear velocity v: of the net along
 * each axis, of divergence and outflow, of the means over both sides, of the
 * turnover. */
static void leaf_errors(const struct mesh *mesh, const double *v, int32_t i,
                        double error[4]) {
  const double h = mesh->h[i], volume = pow(h, DIM);
  double div = 0, through = 0, mean = 0;
  for (int d = 0; d < DIM; d++) {
    const double u = component(d, mesh->x[i]), half = 0.5 * kSlope[d][d] * h;
    const double net = mesh_net_along(mesh, v, i, d);
    div += kSlope[d][d];
    mean += u / DIM;
    through += 0.5 * (fabs(u - half) + fabs(u + half));
    error[0] = larger(error[0], fabs(net - kSlope[d][d] * h));
    error[2] = larger(error[2], fabs(mesh_mean_along(mesh, v, i, d) - u));
  }
  error[2] = larger(error[2], fabs(mesh_mean(mesh, v, i) - mean));
  error[1] = larger(error[1], h * fabs(mesh_divergence(mesh, v, i) - div));
  error[1] = larger(error[1], fabs(mesh_outflow(mesh, v, i) - div * volume));
  error[3] = larger(error[3], fabs(h * mesh_turnover(mesh, v, i) - through));
}

START_TEST(a_linear_velocity_has_its_divergence) {
  for (int trees = 1; trees <= 2; trees++) {
    struct forest *forest =
        grid_new(MPI_COMM_WORLD, trees, false, kLevels[_i][0], kLevels[_i][1]);
    struct mesh *mesh = mesh_new(forest);
    double error[4] = {0}, *v = linear_velocity(mesh);
    for (int32_t i = 0; i < mesh->nleaves; i++) leaf_errors(mesh, v, i, error);
    for (int k = 0; k < 4; k++) {
      /* sums of ten terms of order one */
      ck_assert_double_le(mesh_max(mesh, error[k]), 1e-14);
    }
    mem_free(v);
    mesh_destroy(mesh);
    forest_destroy(forest);
  }
}
END_TEST

/* Return the flux of v out of the box, and the area of its boundary. */
static double boundary_flux(const struct mesh *mesh, const double *v,
                            double *area) {
  double flux = 0, sum = 0;
  for (int32_t f = 0; f < mesh->nfaces; f++) {
    if (mesh->face_patch[f] < 0) continue;
    sum += mesh_face_area(mesh, f);
    flux +=
        (mesh->face_leaf[f][1] < 0 ? 1 : -1) * v[f] * mesh_face_area(mesh, f);
  }
  *area = mesh_sum(mesh, sum);
  return mesh_sum(mesh, flux);
}

START_TEST(leaves_lose_what_leaves_the_box) {
  struct forest *forest =
      grid_new(MPI_COMM_WORLD, 2, false, kLevels[_i][0], kLevels[_i][1]);
  struct mesh *mesh = mesh_new(forest);
  double outflow = 0, volume = 0, area, *v = linear_velocity(mesh);
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    outflow += mesh_outflow(mesh, v, i);
    volume += mesh_volume(mesh, i);
  }
  const double flux = boundary_flux(mesh, v, &area);
  /* sums of hundreds of terms that add up to order one */
  ck_assert_double_le(fabs(mesh_sum(mesh, outflow) - flux), 1e-13);
  ck_assert_double_le(fabs(mesh_sum(mesh, volume) - 1), 1e-13);
  ck_assert_double_le(fabs(area - NFACE), 1e-13);
  mem_free(v);
  mesh_destroy(mesh);
  forest_destroy(forest);
}
END_TEST

START_TEST(gradients_across_faces_are_exact_for_linear_fields) {
  struct forest *forest =
      grid_new(MPI_COMM_WORLD, 2, false, kLevels[_i][0], kLevels[_i][1]);
  struct mesh *mesh = mesh_new(forest);
  const struct bc bc[MESH_MAX_PATCHES] = {{0}}, *bcs[] = {bc};
  double error = 0, *v = MEM_NEW(double, mesh->ncells);
  for (int32_t i = 0; i < mesh->nleaves; i++) v[i] = component(0, mesh->x[i]);
  mesh_fill(mesh, 1, &v, bcs, false);
  for (int32_t f = 0; f < mesh->nfaces; f++) {
    const double slope = kSlope[0][face_direction(mesh, f)];
    if (mesh->face_patch[f] >= 0) continue;
    error = larger(error, fabs(mesh_gradient(mesh, v, f) - slope));
  }
  /* differences of values of order one over at least 1/64 */
  ck_assert_double_le(mesh_max(mesh, error), 1e-12);
  mem_free(v);
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
      good =
          good && mesh_edges(mesh, owner, gap) == mesh_face_edges(mesh, f, gap);
      good = good && mesh_edges(mesh, owner, mesh->h[owner]) == 1;
      good = good && mesh_leaf_slope(mesh, owner, mesh->h[owner]) == 1;
    }
  }
  ck_assert(all_ranks(good));
  mesh_destroy(mesh);
  forest_destroy(forest);
}
END_TEST

/* Count the poisoned values among [begin, end). */
static int32_t count_poison(const double *v, int32_t begin, int32_t end) {
  int32_t n = 0;
  for (int32_t i = begin; i < end; i++) n += is_poison(&v[i]);
  return n;
}

/* In debug builds; else nothing is. */
START_TEST(nodes_are_poison_from_a_write_to_the_next_fill) {
  struct forest *forest =
      grid_new(MPI_COMM_WORLD, 2, false, kLevels[_i][0], kLevels[_i][1]);
  struct mesh *mesh = mesh_new(forest);
  const struct bc bc[MESH_MAX_PATCHES] = {{0}}, *bcs[] = {bc};
  double *v = MEM_NEW(double, mesh->ncells);
  bool good = true;
  for (int k = 0; k < 2; k++) {
    for (int32_t i = 0; i < mesh->nleaves; i++) v[i] = linear(mesh->x[i]) + k;
    mesh_touch(mesh, v);
    good = good && count_poison(v, 0, mesh->nleaves) == 0;
    good = good && count_poison(v, mesh->nleaves, mesh->ncells) ==
                       (POISON_ON ? mesh->ncells - mesh->nleaves : 0);
    mesh_fill(mesh, 1, &v, bcs, false);
    good = good && count_poison(v, 0, mesh->ncells) == 0;
  }
  ck_assert(all_ranks(good));
  mem_free(v);
  mesh_destroy(mesh);
  forest_destroy(forest);
}
END_TEST

/* The traps, which would end the test, are off. */
START_TEST(who_reads_nodes_not_filled_gets_no_number) {
  struct forest *forest =
      grid_new(MPI_COMM_WORLD, 2, false, kLevels[_i][0], kLevels[_i][1]);
  struct mesh *mesh = mesh_new(forest);
  double *v = MEM_NEW(double, mesh->ncells), sum = 0;
  mesh_touch(mesh, v);
  const bool trapped = base_trap_floating_point(false);
  for (int32_t f = 0; f < mesh->nfaces; f++) sum += mesh_gradient(mesh, v, f);
  const bool wild = sum != sum;
  base_trap_floating_point(trapped);
  ck_assert(all_ranks(wild == POISON_ON));
  mem_free(v);
  mesh_destroy(mesh);
  forest_destroy(forest);
}
END_TEST

/* Count the places that are asked for, and those not on their side. */
struct asked {
  const struct forest_layout *layout;
  int n, wrong;
};
static int ask(void *context, int side, const double x[3], double h,
               struct patch_shares *shares) {
  struct asked *asked = (struct asked *)context;
  const struct forest_layout *layout = asked->layout;
  (void)shares;
  asked->n++;
  for (int d = 0; d < DIM; d++) {
    const double low = layout->origin[d];
    const double high = low + layout->size * layout->trees[d];
    const double wall = side & 1 ? high : low;
    const bool inside = x[d] > low + 0.49 * h && x[d] < high - 0.49 * h;
    asked->wrong += d == side / 2 ? fabs(x[d] - wall) > 1e-12 : !inside;
  }
  return side;
}

START_TEST(patches_are_asked_for_on_their_side) {
  struct forest_layout layout = {.size = 0.5, .patch = ask};
  struct asked asked = {.layout = &layout};
  layout.patch_context = &asked;
  for (int d = 0; d < DIM; d++) {
    layout.origin[d] = d - 1.2;
    layout.trees[d] = 3 - d;
  }
  struct forest *forest = forest_new(MPI_COMM_WORLD, &layout, 2);
  struct mesh *mesh = mesh_new(forest);
  const double n = mesh_sum(mesh, asked.n);
  const double wrong = mesh_sum(mesh, asked.wrong);
  mesh_destroy(mesh);
  forest_destroy(forest);
  ck_assert_double_gt(n, 0);
  ck_assert_double_eq(wrong, 0);
}
END_TEST

Suite *mesh_suite(void);
Suite *mesh_suite(void) {
  Suite *suite = suite_create("mesh");
  TCase *tc = tcase_create("mesh");
  const int n = (int)(sizeof kLevels / sizeof *kLevels);
  tcase_add_loop_test(tc, stencils_keep_linear_fields, 0, n);
  tcase_add_loop_test(tc, stencils_do_not_depend_on_ranks, 0, n);
  tcase_add_loop_test(tc, fluxes_leave_one_cell_and_enter_another, 0, n + 1);
  tcase_add_loop_test(tc, a_linear_velocity_has_its_divergence, 0, n);
  tcase_add_loop_test(tc, leaves_lose_what_leaves_the_box, 0, n);
  tcase_add_loop_test(tc, gradients_across_faces_are_exact_for_linear_fields, 0,
                      n);
  tcase_add_loop_test(tc, every_face_joins_its_neighbours, 0, n);
  tcase_add_loop_test(tc, nodes_are_poison_from_a_write_to_the_next_fill, 0, n);
  tcase_add_loop_test(tc, who_reads_nodes_not_filled_gets_no_number, 0, n);
  tcase_set_timeout(tc, 60);
  tcase_add_test(tc, patches_are_asked_for_on_their_side);
  suite_add_tcase(suite, tc);
  return suite;
}
