/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/skin.h"

#include <check.h>

#include "faces.h"
#include "talus/strain.h"
#include "talus/two_phase/properties.h"
#include "talus/viscous.h"

/* A block of grains, of viscosity 1, in a gas without any, which moves as it
 * likes. `low` is where it begins, it ends at 3/4. */
static double low[DIM];

static bool in_block(const double *x) {
  bool in = true;
  for (int d = 0; d < DIM; d++) {
    in = in && x[d] > low[d] + 1e-9 && x[d] < 0.75 - 1e-9;
  }
  return in;
}

static double viscosity(const double *x) { return in_block(x); }

struct block {
  struct forest *forest;
  struct mesh *mesh;
  struct skin *skin;
  double *c, *u[DIM], *eta_f, *force[DIM], *shear_f;
};

/* Make a block with u = A x in the grains. */
static struct block *block_new(int level, double height, double a[DIM][DIM]) {
  static const struct bc neumann[MESH_MAX_PATCHES];
  const struct bc *bc[] = {neumann, neumann, neumann};
  struct block *b = MEM_NEW(struct block, 1);
  for (int d = 0; d < DIM; d++) low[d] = d == 1 ? 0.75 - height : 0.25;
  b->forest = grid_new(MPI_COMM_WORLD, 1, false, level, level);
  b->mesh = mesh_new(b->forest);
  b->skin = skin_new();
  b->c = MEM_NEW(double, b->mesh->ncells);
  b->eta_f = face_field(b->mesh, viscosity, false);
  b->shear_f = MEM_NEW(double, b->mesh->nfaces);
  for (int d = 0; d < DIM; d++) {
    b->u[d] = MEM_NEW(double, b->mesh->ncells);
    b->force[d] = MEM_NEW(double, b->mesh->nleaves);
  }
  for (int32_t i = 0; i < b->mesh->nleaves; i++) {
    const double *x = b->mesh->x[i];
    b->c[i] = in_block(x);
    for (int d = 0; d < DIM; d++) {
      b->u[d][i] = b->c[i] > 0 ? 0 : sin(1e4 * x[d] + 3e4 * x[1 - d % 2]);
      for (int e = 0; e < DIM && b->c[i] > 0; e++) b->u[d][i] += a[d][e] * x[e];
    }
  }
  mesh_fill(b->mesh, 1, &b->c, bc, false);
  mesh_fill(b->mesh, DIM, b->u, bc, false);
  skin_find(b->mesh, b->c, 1e-3, b->skin);
  return b;
}

static void block_destroy(struct block *b) {
  for (int d = 0; d < DIM; d++) {
    mem_free(b->u[d]);
    mem_free(b->force[d]);
  }
  mem_free(b->shear_f);
  mem_free(b->eta_f);
  mem_free(b->c);
  skin_destroy(b->skin);
  mesh_destroy(b->mesh);
  forest_destroy(b->forest);
  mem_free(b);
}

/* Return the largest force of viscosity. */
static double largest_force(struct block *b, const struct skin *skin) {
  double most = 0;
  const struct viscosity viscosity = {.eta_f = b->eta_f, .skin = skin};
  viscous_force(b->mesh, &viscosity, b->u, b->force);
  for (int d = 0; d < DIM; d++) {
    for (int32_t i = 0; i < b->mesh->nleaves; i++) {
      most = larger(most, fabs(b->force[d][i]));
    }
  }
  return mesh_max(b->mesh, most);
}

/* Return the largest departure of the shear rate of the grains from a value. */
static double shear_error(struct block *b, const struct skin *skin,
                          double exact) {
  double most = 0;
  strain_shear_rate(b->mesh, skin, b->u, b->shear_f);
  for (int32_t f = 0; f < b->mesh->nfaces; f++) {
    if (b->eta_f[f] > 0) most = larger(most, fabs(b->shear_f[f] - exact));
  }
  return mesh_max(b->mesh, most);
}

START_TEST(grains_that_turn_feel_no_gas) {
  double a[DIM][DIM] = {{0}};
  a[0][1] = 1, a[1][0] = -1;
  a[DIM - 1][0] += 0.5, a[0][DIM - 1] -= 0.5;
  struct block *b = block_new(4, 0.5, a);
  ck_assert_double_le(largest_force(b, b->skin), 1e-12); /* 1e-16 / h^2 */
  ck_assert_double_le(shear_error(b, b->skin, 0), 1e-13);
  ck_assert_double_ge(largest_force(b, NULL), 10); /* of 1 / (4 h^2) */
  ck_assert_double_ge(shear_error(b, NULL, 0), 1);
  block_destroy(b);
}
END_TEST

/* Lines into traces that the gas carries count by their square, 1e-12. */
START_TEST(grains_that_turn_feel_no_traces) {
  static const struct bc neumann[MESH_MAX_PATCHES];
  const struct bc *bc[] = {neumann};
  double a[DIM][DIM] = {{0}};
  a[0][1] = 1, a[1][0] = -1;
  struct block *b = block_new(4, 0.5, a);
  for (int32_t i = 0; i < b->mesh->nleaves; i++) {
    if (b->c[i] == 0) b->c[i] = 1e-6;
  }
  mesh_fill(b->mesh, 1, &b->c, bc, false);
  b->skin->grains_only = true;
  skin_find(b->mesh, b->c, 1, b->skin);
  ck_assert_double_le(shear_error(b, b->skin, 0), 1e-10);
  block_destroy(b);
}
END_TEST

START_TEST(shear_rate_of_grains_is_exact_up_to_the_surface) {
  double a[DIM][DIM] = {{0}}, squared = 0;
  for (int d = 0; d < DIM; d++) {
    for (int e = 0; e < DIM; e++) a[d][e] = sin(1 + 3 * d + 5 * e);
  }
  for (int d = 0; d < DIM; d++) {
    for (int e = 0; e < DIM; e++) {
      squared += 0.5 * (a[d][e] + a[e][d]) * (a[d][e] + a[e][d]);
    }
  }
  struct block *b = block_new(4, 0.5, a);
  ck_assert_double_le(shear_error(b, b->skin, sqrt(squared)), 1e-13);
  block_destroy(b);
}
END_TEST

/* Both nodes of its faces are grains. */
START_TEST(skin_lies_between_grains) {
  double a[DIM][DIM] = {{0}}, wrong = 0;
  struct block *b = block_new(4, 0.5, a);
  for (int32_t k = 0; k < b->skin->n; k++) {
    const int32_t *node = b->mesh->face_node[b->skin->face[k].face];
    wrong += b->c[node[0]] + b->c[node[1]] != 2;
  }
  const double faces = mesh_sum(b->mesh, b->skin->n);
  wrong = mesh_sum(b->mesh, wrong);
  block_destroy(b);
  ck_assert_double_gt(faces, 0);
  ck_assert_double_eq(wrong, 0);
}
END_TEST

/* Its cells have no neighbours along y that are grains: nothing bends it. */
START_TEST(film_of_one_cell_does_not_bend) {
  double a[DIM][DIM] = {{0}};
  a[1][0] = 1;
  struct block *b = block_new(4, 1. / 16, a);
  ck_assert_double_le(largest_force(b, b->skin), 1e-12);
  block_destroy(b);
}
END_TEST

/* With traces of grains at the far ends of its lines, which round-off makes. */
START_TEST(traces_of_grains_do_not_weigh_lines) {
  double a[DIM][DIM] = {{0}}, most = 0;
  struct block *b = block_new(4, 1. / 16, a);
  for (int32_t i = 0; i < b->mesh->ncells; i++) {
    if (b->c[i] == 0) b->c[i] = 1e-19 * (1 + 0.5 * sin(1e3 * i));
  }
  b->skin->grains_only = true;
  skin_find(b->mesh, b->c, 1, b->skin);
  for (int32_t k = 0; k < b->skin->n; k++) {
    const struct skin_face *face = &b->skin->face[k];
    for (int e = 0; e < 4 && face->axis != 1; e++) {
      most = larger(most, fabs(face->weight[1][e]));
    }
  }
  const double faces = mesh_sum(b->mesh, b->skin->n);
  most = mesh_max(b->mesh, most);
  block_destroy(b);
  ck_assert_double_gt(faces, 0);
  ck_assert_double_eq(most, 0);
}
END_TEST

/* Count the iterations of a viscous solve for the block in a gas 1000 times
 * lighter and 1e5 times softer. A cycle that does not know the weights takes 12
 * and 14 in 2D and 3D, 8 and 9 without weights. */
static int iterations(struct block *b, bool with_skin) {
  static const struct bc no_slip[MESH_MAX_PATCHES] = {{.type = BC_DIRICHLET}};
  const struct bc *bc[] = {no_slip, no_slip, no_slip};
  struct hierarchy *hierarchy = hierarchy_new(b->mesh);
  double *rho = MEM_NEW(double, b->mesh->nleaves);
  for (int32_t f = 0; f < b->mesh->nfaces_all; f++) {
    b->eta_f[f] = b->eta_f[f] > 0 ? 10 : 1e-4;
  }
  for (int32_t i = 0; i < b->mesh->nleaves; i++) {
    rho[i] = b->c[i] + (1 - b->c[i]) * 1e-3;
    for (int d = 0; d < DIM; d++) b->force[d][i] = rho[i] * b->u[d][i];
  }
  const struct viscosity viscosity = {.eta_f = b->eta_f,
                                      .skin = with_skin ? b->skin : NULL};
  const struct solve_stats stats = viscous_solve(
      b->mesh, hierarchy, rho, &viscosity, 0.01, b->force, bc, 1e-5, 50, b->u);
  ck_assert_int_eq(stats.status, SOLVE_CONVERGED);
  mem_free(rho);
  hierarchy_destroy(hierarchy);
  return stats.iterations;
}

/* At present 10 and 12. */
START_TEST(weights_cost_few_iterations) {
  double a[DIM][DIM] = {{0}};
  int n[2];
  a[0][1] = 1;
  for (int k = 0; k < 2; k++) {
    struct block *b = block_new(5, 0.5, a);
    n[k] = iterations(b, k);
    block_destroy(b);
  }
  ck_assert_int_le(n[1], n[0] + DIM);
}
END_TEST

Suite *skin_suite(void);
Suite *skin_suite(void) {
  Suite *suite = suite_create("skin");
  TCase *t = tcase_create("skin");
  tcase_add_test(t, grains_that_turn_feel_no_gas);
  tcase_add_test(t, grains_that_turn_feel_no_traces);
  tcase_add_test(t, shear_rate_of_grains_is_exact_up_to_the_surface);
  tcase_add_test(t, skin_lies_between_grains);
  tcase_add_test(t, film_of_one_cell_does_not_bend);
  tcase_add_test(t, traces_of_grains_do_not_weigh_lines);
  tcase_add_test(t, weights_cost_few_iterations);
  suite_add_tcase(suite, t);
  return suite;
}
