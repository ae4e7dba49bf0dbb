/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Boundary conditions of a state, as the case gives them. */
#include "talus/two_phase/state.h"

#include <check.h>

#include "sim.h"
#include "talus/error.h"

Suite *state_suite(void);

/* Slip lengths of the two walls, of which the upper one moves with speed 1. */
static const double kSlip[] = {0.3, 0.2};
static double couette(void *context, const double x[3]) {
  (void)context;
  return (x[DIM - 1] + kSlip[0]) / (1 + kSlip[0] + kSlip[1]);
}

/* The flow between two walls on which it slips is linear, and steady. */
START_TEST(walls_slip_by_their_length) {
  struct params params = periodic_params(3);
  params.grains.rheology = newtonian(1);
  params.tolerance_viscous = params.tolerance_pressure = 1e-12;
  params.pressure_level_given = true;
  params.velocity[0] = (struct function){couette, NULL};
  for (int side = 0; side < 2; side++) {
    params.boundary[2 * DIM - 2 + side] =
        (struct boundary){.type = BOUNDARY_NAVIER,
                          .slip_length = kSlip[side],
                          .velocity = {side, 0, 0}};
  }
  struct two_phase *sim = sim_new(&params, MPI_COMM_WORLD);
  double most = 0;
  bool done = true;
  for (int k = 0; k < 3 && done; k++) {
    done = step_advance(sim, 1) == EXIT_DONE;
  }
  for (int32_t i = 0; i < sim->grid.mesh->nleaves; i++) {
    double x[3] = {0};
    for (int d = 0; d < DIM; d++) x[d] = sim->grid.mesh->x[i][d];
    most = larger(most, fabs(sim->u[0]->v[i] - couette(NULL, x)));
  }
  most = mesh_max(sim->grid.mesh, most);
  two_phase_destroy(sim);
  ck_assert(done);
  ck_assert_double_le(most, 1e-10);
}
END_TEST

START_TEST(the_grid_begins_at_the_origin) {
  const double origin[] = {1.5, -2.25, 4};
  struct params params = box_params(2);
  double low[DIM], off = 0;
  for (int d = 0; d < DIM; d++) {
    params.origin[d] = origin[d];
    params.trees[d] = 1 + d;
    low[d] = INFINITY;
  }
  struct two_phase *sim = sim_new(&params, MPI_COMM_WORLD);
  const struct mesh *mesh = sim->grid.mesh;
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    for (int d = 0; d < DIM; d++) {
      low[d] = smaller(low[d], mesh->x[i][d] - 0.5 * mesh->h[i]);
    }
  }
  for (int d = 0; d < DIM; d++) {
    off = larger(off, fabs(-mesh_max(mesh, -low[d]) - origin[d]));
  }
  two_phase_destroy(sim);
  ck_assert_double_le(off, 1e-14);
}
END_TEST

static int choose_patch(void *context, int side, const double x[3]) {
  (void)context, (void)side, (void)x;
  return 6;
}

/* One patch on all sides, on which grains slip instead of being held: across it
 * the velocity is given, along it the stress. */
START_TEST(patches_know_the_axis_they_lie_across) {
  struct params params = box_params(2);
  params.nboundaries = 7;
  for (int side = 0; side < 6; side++) {
    params.boundary[side].type = BOUNDARY_NO_SLIP;
  }
  params.boundary[6].type = BOUNDARY_SLIP;
  params.boundary_select = choose_patch;
  struct two_phase *sim = sim_new(&params, MPI_COMM_WORLD);
  const struct mesh *mesh = sim->grid.mesh;
  double faces = 0, wrong = 0;
  for (int d = 0; d < DIM; d++) {
    for (int32_t f = mesh->face_begin[d]; f < mesh->face_begin[d + 1]; f++) {
      const int patch = mesh->face_patch[f];
      if (patch < 0) continue;
      faces++;
      for (int e = 0; e < DIM; e++) {
        const enum bc_type type = e == d ? BC_DIRICHLET : BC_NEUMANN;
        wrong += sim->u[e]->bc[patch].type != type;
      }
    }
  }
  faces = mesh_sum(mesh, faces), wrong = mesh_sum(mesh, wrong);
  two_phase_destroy(sim);
  ck_assert_double_eq(faces, NFACE * pow(4, DIM - 1));
  ck_assert_double_eq(wrong, 0);
}
END_TEST

Suite *state_suite(void) {
  Suite *suite = suite_create("state");
  TCase *tc = tcase_create("boundaries");
  tcase_add_test(tc, walls_slip_by_their_length);
  tcase_add_test(tc, the_grid_begins_at_the_origin);
  tcase_add_test(tc, patches_know_the_axis_they_lie_across);
  suite_add_tcase(suite, tc);
  return suite;
}
