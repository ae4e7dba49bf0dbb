/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/slip_strip.h"

#include <check.h>

#include "sim.h"
#include "talus/hierarchy.h"
#include "talus/openings.h"
#include "talus/viscous.h"

enum { UP = DIM - 1, FLOOR = 2 * UP, SMOOTH = 6 };

/* Describe a floor with a strip under a column at the corner. */
static struct params strip_params(double length) {
  struct params p = box_params(DIM == 2 ? 5 : 4);
  p.shape = (struct function){column, NULL};
  p.boundary[FLOOR] =
      (struct boundary){.type = BOUNDARY_STRIP, .strip = length};
  p.smooth = SMOOTH, p.nboundaries = SMOOTH + 1;
  p.boundary[SMOOTH].type = BOUNDARY_SLIP;
  params_follow_surface(&p, p.level_max - 2, 1);
  return p;
}

/* Return how far x is from the grains along the floor, in the plane of the
 * floor: the column ends at 0.4, which leaves of 1/32 or 1/16 hold to `edge`.
 */
static double ahead(const double *x, double edge) {
  double square = 0;
  for (int d = 0; d < UP; d++) {
    const double away = x[d] > edge ? x[d] - edge : 0;
    square += away * away;
  }
  return sqrt(square);
}

/* Faces of the floor, and boundary nodes below them, are smooth ahead of the
 * grains as far as the strip reaches. */
START_TEST(the_strip_lies_ahead_of_the_grains) {
  const double length = _i ? 0.2 : 1e-6;
  struct params p = strip_params(length);
  struct two_phase *sim = sim_new(&p, MPI_COMM_WORLD);
  const struct mesh *mesh = sim->grid.mesh;
  const double h = ldexp(1, -p.level_max), edge = ceil(0.4 / h) * h;
  double *u = sim->u[0]->v, found[3] = {0};
  for (int32_t i = 0; i < mesh->nleaves; i++) u[i] = 1;
  field_fill(mesh, sim->u[0]);
  for (int32_t f = mesh->face_begin[UP]; f < mesh->face_begin[UP + 1]; f++) {
    if (mesh->face_leaf[f][0] >= 0) continue;
    const double *x = mesh->x[mesh->face_owner[f]];
    const double half = 0.5 * mesh->face_h[f], reach = ahead(x, edge);
    const bool smooth = mesh->face_patch[f] != FLOOR;
    const double below = u[mesh->face_node[f][0]];
    found[smooth]++;
    ck_assert(!smooth ||
              mesh->face_patch[f] == openings_patch_number(SMOOTH, UP));
    ck_assert_double_eq(below, smooth ? 1 : -1);
    /* within an edge of where the strip ends its leaves may go either way */
    if (reach == 0) ck_assert(!smooth);
    if (reach > 0 && reach < length - half) ck_assert(smooth);
    if (reach > length + 3 * half) ck_assert(!smooth);
  }
  for (int k = 0; k < 2; k++) found[k] = mesh_sum(mesh, found[k]);
  two_phase_destroy(sim);
  ck_assert_double_gt(found[0], 0);
  ck_assert_double_gt(found[1], 0);
}
END_TEST

/* It follows c at once, and comes back to where it was. */
START_TEST(the_strip_follows_the_grains) {
  struct params p = strip_params(0.1);
  struct two_phase *sim = sim_new(&p, MPI_COMM_WORLD);
  struct mesh *mesh = sim->grid.mesh;
  double count[3];
  for (int k = 0; k < 3; k++) {
    double smooth = 0;
    for (int32_t i = 0; i < mesh->nleaves; i++) {
      sim->c->v[i] = k == 1 ? 0 : column(NULL, mesh->x[i]) > 0;
    }
    slip_strip_renew(&sim->grid, sim->c->v);
    for (int32_t f = 0; f < mesh->nfaces; f++)
      smooth += mesh->face_patch[f] >= 6;
    count[k] = mesh_sum(mesh, smooth);
  }
  two_phase_destroy(sim);
  ck_assert_double_gt(count[0], 0);
  ck_assert_double_eq(count[1], 0);
  ck_assert_double_eq(count[2], count[0]);
}
END_TEST

/* Solve the viscous equation for any right hand side and put u into `out`. */
static void solve(struct two_phase *sim, struct hierarchy *hierarchy,
                  double *out) {
  const struct mesh *mesh = sim->grid.mesh;
  const struct viscosity viscosity = {.eta_f = sim->eta_f->v};
  const struct bc *bc[DIM];
  double *u[DIM], *rhs[DIM];
  scratch_take(&sim->scratch, FIELD_CELL, __func__, DIM, rhs);
  field_arrays(sim->u, u);
  srand(3 + (unsigned)mesh->rank);
  for (int d = 0; d < DIM; d++) {
    bc[d] = sim->u[d]->bc;
    for (int32_t i = 0; i < mesh->nleaves; i++) {
      u[d][i] = 0, rhs[d][i] = rand() / (double)RAND_MAX;
    }
  }
  viscous_solve(mesh, hierarchy, sim->rho->v, &viscosity, 0.1, rhs, bc, 1e-3, 3,
                u);
  memcpy(out, u[0], (size_t)mesh->nleaves * sizeof *out);
  scratch_give(&sim->scratch, __func__);
}

/* A hierarchy that has followed the floor is, to the last bit, the one that is
 * made anew on it. */
START_TEST(the_hierarchy_follows_the_floor) {
  struct params p = strip_params(0.1);
  struct two_phase *sim = sim_new(&p, MPI_COMM_WORLD);
  const struct mesh *mesh = sim->grid.mesh;
  struct hierarchy *anew = hierarchy_new(mesh);
  double *u[2];
  for (int k = 0; k < 2; k++) {
    u[k] = MEM_NEW(double, mesh->nleaves);
    solve(sim, k ? anew : sim->grid.hierarchy, u[k]);
  }
  const bool same = memcmp(u[0], u[1], (size_t)mesh->nleaves * sizeof **u) == 0;
  for (int k = 0; k < 2; k++) mem_free(u[k]);
  hierarchy_destroy(anew);
  two_phase_destroy(sim);
  ck_assert(all_ranks(same));
}
END_TEST

/* Gas that is pushed over a floor slips in the strip and sticks beyond; the
 * solver still converges, on any number of ranks. */
START_TEST(gas_slips_in_the_strip) {
  struct params p = strip_params(0.2);
  double speed[2] = {0};
  p.boundary[FLOOR + 1].type = BOUNDARY_OUTFLOW;
  struct two_phase *sim = sim_start(&p);
  bool good = true;
  int most = 0;
  for (int k = 0; k < 12 && good; k++) {
    good = step_advance(sim, 0.02) == EXIT_DONE;
    /* those of the first step are of all its repetitions */
    if (k > 0 && sim->viscous.iterations > most) most = sim->viscous.iterations;
  }
  const struct mesh *mesh = sim->grid.mesh;
  field_fill(mesh, sim->u[0]);
  for (int32_t f = mesh->face_begin[UP]; f < mesh->face_begin[UP + 1]; f++) {
    if (mesh->face_leaf[f][0] >= 0) continue;
    const int32_t *node = mesh->face_node[f];
    const double *u = sim->u[0]->v;
    const double wall = 0.5 * fabs(u[node[0]] + u[node[1]]);
    double *of = &speed[mesh->face_patch[f] != FLOOR];
    *of = larger(*of, wall);
  }
  for (int k = 0; k < 2; k++) speed[k] = mesh_max(mesh, speed[k]);
  two_phase_destroy(sim);
  ck_assert(good);
  ck_assert_double_eq(speed[0], 0);
  ck_assert_double_gt(speed[1], 0.1);
  ck_assert_int_le(most, 20);
}
END_TEST

Suite *slip_strip_suite(void);
Suite *slip_strip_suite(void) {
  Suite *suite = suite_create("slip_strip");
  TCase *tcase = tcase_create("floor");
  tcase_add_loop_test(tcase, the_strip_lies_ahead_of_the_grains, 0, 2);
  tcase_add_test(tcase, the_strip_follows_the_grains);
  tcase_add_test(tcase, the_hierarchy_follows_the_floor);
  tcase_add_test(tcase, gas_slips_in_the_strip);
  suite_add_tcase(suite, tcase);
  return suite;
}
