/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Symmetric flows stay symmetric: columns in the middle of a box or, in 3D, in
 * its corner, which fall. */
#include <check.h>
#include <math.h>

#include "sim.h"

Suite *symmetry_suite(void);

/* Level sets of grains around the middle of the floor, and in [0, 0.4]^2 x [0,
 * 0.5] if it is the corner. */
static double middle(void *context, const double x[3]) {
  (void)context;
  double outside = fabs(x[0] - 0.5) - 0.22;
  if (DIM == 3) outside = larger(outside, x[1] - 0.4);
  return -larger(outside, x[DIM - 1] - 0.5);
}

static double corner(void *context, const double x[3]) {
  (void)context;
  return 0.4 - larger(larger(x[0], x[1]), x[2] - 0.1);
}

/* Describe their box, with a refined surface. */
static struct params falling(double (*shape)(void *, const double *)) {
  struct params p = box_params(DIM == 2 ? 6 : 5);
  params_follow_surface(&p, 3, 2);
  p.shape = (struct function){shape, NULL};
  for (int side = 0; side < 6; side++) p.boundary[side].type = BOUNDARY_NO_SLIP;
  return p;
}

/* Give it mu(I) with an exact yield, on one level. */
static void let_yield(struct params *p) {
  p->level_min = p->level_max = 4;
  p->ncriteria = 0;
  rheology_release(&p->grains.rheology);
  rheology_init(&p->grains.rheology, rheology_find("mu_i"));
  rheology_set(&p->grains.rheology, "rho", 1);
  rheology_set_regularisation(&p->grains.rheology, "exact");
  rheology_set(&p->grains.rheology, "d", 0.02);
  rheology_set(&p->grains.rheology, "eta_min", 0.002);
  p->tolerance_pressure = p->tolerance_viscous = 1e-4;
}

/* Find the leaf with its centre at x, which is there. */
static int32_t leaf_at(const struct mesh *mesh, const double x[DIM]) {
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    double off = 0;
    for (int d = 0; d < DIM; d++) off = larger(off, fabs(mesh->x[i][d] - x[d]));
    if (off < 0.1 * mesh->h[i]) return i;
  }
  ck_abort_msg("no leaf at (%g, %g)", x[0], x[1]);
}

/* Return the largest difference of c and u to their image, axis 0 turned round
 * or exchanged with axis 1. */
static double asymmetry(const struct two_phase *sim, bool exchanged) {
  const struct mesh *mesh = sim->grid.mesh;
  double most = 0;
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    double x[DIM];
    for (int d = 0; d < DIM; d++) x[d] = mesh->x[i][d];
    x[0] = exchanged ? mesh->x[i][1] : 1 - x[0];
    if (exchanged) x[1] = mesh->x[i][0];
    const int32_t j = leaf_at(mesh, x);
    most = larger(most, fabs(sim->c->v[i] - sim->c->v[j]));
    for (int e = 0; e < DIM; e++) {
      const int other = exchanged && e < 2 ? 1 - e : e;
      const double sign = !exchanged && e == 0 ? -1 : 1;
      most = larger(most, fabs(sim->u[e]->v[i] - sign * sim->u[other]->v[j]));
    }
  }
  return most;
}

/* Take steps and return the largest asymmetry of them. */
static double fall(const struct params *params, bool exchanged, int nsteps) {
  struct two_phase *sim = sim_new(params, MPI_COMM_SELF);
  double most = 0;
  for (int k = 0; k < nsteps; k++) {
    ck_assert_int_eq(step_advance(sim, 1), EXIT_DONE);
    most = larger(most, asymmetry(sim, exchanged));
  }
  two_phase_destroy(sim);
  return most;
}

/* A sweep of the pressure begins with one of two colours, which change places
 * with the sides, so that only what the solvers leave may differ; round-off
 * grows by 1e6 in a step where the surface cuts 1e-9 off a leaf. */
START_TEST(a_column_falls_to_both_sides_alike) {
  struct params p = falling(middle);
  p.tolerance_pressure = p.tolerance_viscous = 1e-13;
  ck_assert_double_lt(fall(&p, false, 1), 1e-10);
}
END_TEST

/* Whatever the tolerances; on an octree for as many steps as no surface grazes
 * a leaf. */
START_TEST(horizontal_axes_are_alike) {
  if (DIM == 2) return;
  struct params p = falling(corner);
  if (_i) let_yield(&p);
  ck_assert_double_lt(fall(&p, true, _i ? 8 : 2), 1e-10);
}
END_TEST

/* Take two steps and return the sim; grains of which round-off could have made
 * as many are put into each leaf of gas first. */
static struct two_phase *fall_with_traces(const struct params *params,
                                          double traces) {
  struct two_phase *sim = sim_new(params, MPI_COMM_SELF);
  for (int k = 0; k < 2; k++) {
    for (int32_t i = 0; i < sim->grid.mesh->nleaves; i++) {
      if (sim->c->v[i] < 1e-16) sim->c->v[i] = traces * (i % 2);
    }
    ck_assert_int_eq(step_advance(sim, 1), EXIT_DONE);
  }
  return sim;
}

START_TEST(traces_of_grains_leave_the_flow_as_it_is) {
  struct params p = falling(DIM == 2 ? middle : corner);
  double most = 0;
  let_yield(&p);
  struct two_phase *sim = fall_with_traces(&p, 0);
  struct two_phase *other = fall_with_traces(&p, 1e-17);
  for (int32_t f = 0; f < sim->grid.mesh->nfaces; f++) {
    most = larger(most, fabs(sim->u_f->v[f] - other->u_f->v[f]));
  }
  two_phase_destroy(sim);
  two_phase_destroy(other);
  ck_assert_double_lt(most, 1e-12);
}
END_TEST

Suite *symmetry_suite(void) {
  Suite *suite = suite_create("symmetry");
  TCase *tc = tcase_create("collapse");
  tcase_add_test(tc, a_column_falls_to_both_sides_alike);
  tcase_add_test(tc, traces_of_grains_leave_the_flow_as_it_is);
  tcase_add_loop_test(tc, horizontal_axes_are_alike, 0, 2);
  suite_add_tcase(suite, tc);
  return suite;
}
