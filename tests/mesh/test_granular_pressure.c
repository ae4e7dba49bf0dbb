/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Donors of the granular pressure at faces. */
#include <check.h>

#include "grid.h"
#include "talus/granular_pressure.h"

Suite *granular_pressure_suite(void);

static double linear(const double x[DIM]) {
  double sum = 3;
  for (int d = 0; d < DIM; d++) sum += (0.4 - d) * x[d];
  return sum;
}

/* Does a leaf touch a side of the box? Slopes end there. */
static bool at_side(const struct mesh *mesh, int32_t i) {
  for (int s = 0; s < NFACE; s++)
    if (mesh->stencil[i][stencil_face(s)] >= mesh->begin_boundary) return true;
  return false;
}

/* Return the largest error of the donors of a linear field at faces of axis d
 * whose velocity is u: over dt that slice passes which lies upstream, and v of
 * its middle is the mean. */
static double donor_error(const struct mesh *mesh, int d, double u, double dt,
                          const double *v, double *slope) {
  double worst = 0;
  granular_slopes(mesh, d, v, slope);
  for (int32_t f = mesh->face_begin[d]; f < mesh->face_begin[d + 1]; f++) {
    const int32_t donor = mesh->face_leaf[f][u > 0 ? 0 : 1];
    const int32_t owner = mesh->face_owner[f];
    const double half = 0.5 * mesh->face_h[f];
    if (donor < 0 || donor >= mesh->nleaves || at_side(mesh, donor)) continue;
    double x[DIM];
    for (int e = 0; e < DIM; e++) x[e] = mesh->x[owner][e];
    x[d] += (mesh->face_node[f][0] == owner ? half : -half) - 0.5 * u * dt;
    worst = larger(worst,
                   fabs(granular_donor(mesh, f, dt, u, v, slope) - linear(x)));
  }
  return mesh_max(mesh, worst);
}

START_TEST(donors_of_a_linear_field_are_exact) {
  struct forest *forest = grid_new(MPI_COMM_WORLD, 1, false, 3, 5);
  struct mesh *mesh = mesh_new(forest);
  double *v = MEM_NEW(double, mesh->ncells);
  double *slope = MEM_NEW(double, mesh->ncells);
  static const struct bc neumann[MESH_MAX_PATCHES];
  const struct bc *bc = neumann;
  for (int32_t i = 0; i < mesh->nleaves; i++) v[i] = linear(mesh->x[i]);
  mesh_fill(mesh, 1, &v, &bc, false);
  double worst = 0;
  for (int d = 0; d < DIM; d++) {
    for (int k = -1; k <= 1; k += 2)
      worst = larger(worst, donor_error(mesh, d, k * 0.5, 0.02, v, slope));
  }
  mem_free(v), mem_free(slope);
  mesh_destroy(mesh);
  forest_destroy(forest);
  ck_assert_double_le(worst, 1e-13);
}
END_TEST

Suite *granular_pressure_suite(void) {
  Suite *suite = suite_create("granular_pressure");
  TCase *tcase = tcase_create("donors");
  tcase_add_test(tcase, donors_of_a_linear_field_are_exact);
  suite_add_tcase(suite, tcase);
  return suite;
}
