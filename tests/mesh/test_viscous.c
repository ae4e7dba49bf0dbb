/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/viscous.h"

#include <check.h>
#include <stdlib.h>

#include "faces.h"

enum { MOST = 100 };

struct flow {
  struct forest *forest;
  struct mesh *mesh;
  struct hierarchy *hierarchy;
  struct bc side[MESH_MAX_PATCHES];
  const struct bc *bc[DIM];
  double *eta_f, *rho, *u[DIM], *rhs[DIM];
};

static struct flow *flow_new(struct forest *forest,
                             double (*eta)(const double *x),
                             enum bc_type type) {
  struct flow *s = MEM_NEW(struct flow, 1);
  s->forest = forest;
  s->mesh = mesh_new(forest);
  s->hierarchy = hierarchy_new(s->mesh);
  s->eta_f = face_field(s->mesh, eta, false);
  s->rho = MEM_NEW(double, s->mesh->nleaves);
  for (int k = 0; k < MESH_MAX_PATCHES; k++) s->side[k].type = type;
  for (int32_t i = 0; i < s->mesh->nleaves; i++) s->rho[i] = 1;
  for (int d = 0; d < DIM; d++) {
    s->bc[d] = s->side;
    s->u[d] = MEM_NEW(double, s->mesh->ncells);
    s->rhs[d] = MEM_NEW(double, s->mesh->nleaves);
  }
  return s;
}

static void flow_destroy(struct flow *s) {
  hierarchy_destroy(s->hierarchy);
  mesh_destroy(s->mesh);
  forest_destroy(s->forest);
  mem_free(s->eta_f);
  mem_free(s->rho);
  for (int d = 0; d < DIM; d++) {
    mem_free(s->u[d]);
    mem_free(s->rhs[d]);
  }
  mem_free(s);
}

static double one(const double *x) {
  (void)x;
  return 1;
}
/* Return a rough coefficient, 1e-3 to 1e3. */
static double rough(const double *x) {
  return pow(10, 3 * sin(1e4 * x[0] + 2e4 * x[1]));
}

/* Set u = A x. */
static void set_linear(struct flow *s, double a[DIM][DIM]) {
  for (int32_t i = 0; i < s->mesh->nleaves; i++) {
    for (int d = 0; d < DIM; d++) {
      s->u[d][i] = 0;
      for (int e = 0; e < DIM; e++) s->u[d][i] += a[d][e] * s->mesh->x[i][e];
    }
  }
  mesh_fill(s->mesh, DIM, s->u, s->bc, false);
}

/* Return the largest force more than 0.26 from the walls, two cells of level 3,
 * where no boundary node is read. */
static double inner_force(struct flow *s) {
  const struct mesh *mesh = s->mesh;
  double most = 0;
  viscous_force(mesh, &(struct viscosity){.eta_f = s->eta_f}, s->u, s->rhs);
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    bool inside = true;
    for (int d = 0; d < DIM; d++) {
      inside = inside && fabs(mesh->x[i][d] - 0.5) < 0.24;
    }
    if (!inside) continue;
    for (int d = 0; d < DIM; d++) most = larger(most, fabs(s->rhs[d][i]));
  }
  return mesh_max(mesh, most);
}

START_TEST(linear_velocity_has_no_force) {
  struct flow *s =
      flow_new(grid_new(MPI_COMM_WORLD, 1, false, 3, 5), one, BC_NEUMANN);
  double a[DIM][DIM];
  for (int d = 0; d < DIM; d++) {
    for (int e = 0; e < DIM; e++) a[d][e] = sin(1 + 3 * d + 5 * e);
  }
  set_linear(s, a);
  const double most = inner_force(s);
  ck_assert_double_le(most, 1e-11); /* 1e-16 / h^2 */
  flow_destroy(s);
}
END_TEST

START_TEST(rigid_rotation_has_no_stress) {
  struct flow *s =
      flow_new(grid_new(MPI_COMM_WORLD, 1, false, 3, 5), rough, BC_NEUMANN);
  double a[DIM][DIM] = {{0}};
  a[0][1] = 1, a[1][0] = -1;
  a[DIM - 1][0] += 0.5, a[0][DIM - 1] -= 0.5;
  set_linear(s, a);
  const double most = inner_force(s);
  ck_assert_double_le(most, 1e-8); /* 1e3 times that */
  flow_destroy(s);
}
END_TEST

static void set_noise(struct flow *s) {
  for (int32_t i = 0; i < s->mesh->nleaves; i++) {
    for (int d = 0; d < DIM; d++) {
      const double *x = s->mesh->x[i];
      s->u[d][i] = sin(1e4 * x[d] + 3e4 * x[(d + 1) % DIM]);
    }
  }
  mesh_fill(s->mesh, DIM, s->u, s->bc, false);
}

START_TEST(momentum_balances) {
  struct flow *s =
      flow_new(grid_new(MPI_COMM_WORLD, 2, true, 1, 4), rough, BC_NEUMANN);
  double sum[DIM] = {0}, size = 0;
  set_noise(s);
  viscous_force(s->mesh, &(struct viscosity){.eta_f = s->eta_f}, s->u, s->rhs);
  for (int32_t i = 0; i < s->mesh->nleaves; i++) {
    for (int d = 0; d < DIM; d++) {
      sum[d] += mesh_volume(s->mesh, i) * s->rhs[d][i];
      size += mesh_volume(s->mesh, i) * fabs(s->rhs[d][i]);
    }
  }
  size = mesh_sum(s->mesh, size);
  for (int d = 0; d < DIM; d++) sum[d] = mesh_sum(s->mesh, sum[d]);
  for (int d = 0; d < DIM; d++) ck_assert_double_le(fabs(sum[d]), 1e-14 * size);
  flow_destroy(s);
}
END_TEST

/* On one level, between walls at rest or in a periodic box. */
START_TEST(force_takes_energy_from_any_velocity) {
  struct flow *s =
      flow_new(grid_new(MPI_COMM_WORLD, 2, _i, 3, 3), rough, BC_DIRICHLET);
  double work = 0;
  set_noise(s);
  viscous_force(s->mesh, &(struct viscosity){.eta_f = s->eta_f}, s->u, s->rhs);
  for (int32_t i = 0; i < s->mesh->nleaves; i++) {
    for (int d = 0; d < DIM; d++) {
      work += mesh_volume(s->mesh, i) * s->u[d][i] * s->rhs[d][i];
    }
  }
  work = mesh_sum(s->mesh, work);
  flow_destroy(s);
  ck_assert_double_lt(work, 0);
}
END_TEST

/* u_x = sin 2 pi x_t with viscosity 1: the second difference of a wave is the
 * wave times -4/h^2 sin^2(pi h), and twice that where it is compressed (t = 0).
 */
START_TEST(force_on_waves_is_exact) {
  struct flow *s =
      flow_new(grid_new(MPI_COMM_WORLD, 1, true, 4, 4), one, BC_NEUMANN);
  const double h = 1.0 / 16, root = 2 / h * sin(kPi * h);
  const double eigenvalue = (_i == 0 ? 2 : 1) * root * root;
  double most = 0;
  for (int32_t i = 0; i < s->mesh->nleaves; i++) {
    for (int d = 0; d < DIM; d++) s->u[d][i] = 0;
    s->u[0][i] = sin(2 * kPi * s->mesh->x[i][_i]);
  }
  mesh_fill(s->mesh, DIM, s->u, s->bc, false);
  viscous_force(s->mesh, &(struct viscosity){.eta_f = s->eta_f}, s->u, s->rhs);
  for (int32_t i = 0; i < s->mesh->nleaves; i++) {
    for (int d = 0; d < DIM; d++) {
      most = larger(most, fabs(s->rhs[d][i] + eigenvalue * s->u[d][i]));
    }
  }
  most = mesh_max(s->mesh, most);
  flow_destroy(s);
  ck_assert_double_le(most, 1e-12);
}
END_TEST

/* Return eta of the test with periodic waves u_d = sin(theta + d), theta = 2 pi
 * sum x, in a fluid of eta = exp(steepness cos(2 pi x_0)). */
static double steepness;
static double smooth_eta(const double *x) {
  return exp(steepness * cos(2 * kPi * x[0]));
}
static double wave(const double *x, int d) {
  double theta = d;
  for (int e = 0; e < DIM; e++) theta += 2 * kPi * x[e];
  return sin(theta);
}
static double wave_force(const double *x, int d) {
  const double k = 2 * kPi, eta = smooth_eta(x);
  const double slope = -steepness * k * sin(k * x[0]) * eta;
  double force = 0;
  for (int e = 0; e < DIM; e++) {
    const double y[] = {x[0] + 0.25, x[1], DIM > 2 ? x[DIM - 1] : 0};
    if (e == 0) force += slope * k * (wave(y, d) + wave(y, e));
    force -= eta * k * k * (wave(x, d) + wave(x, e));
  }
  return force;
}

/* Return the bulk viscosity of that test, and what it adds to the force. */
static double smooth_kappa(const double *x) {
  return 3 + 2 * sin(2 * kPi * x[1]);
}
static double bulk_force(const double *x, int d) {
  const double k = 2 * kPi, y[] = {x[0] + 0.25, x[1], DIM > 2 ? x[DIM - 1] : 0};
  const double eta = smooth_eta(x), lambda = smooth_kappa(x) - 2. / 3 * eta;
  double slope = 0, force = 0; /* of lambda along d */
  if (d == 0) slope = 2. / 3 * steepness * k * sin(k * x[0]) * eta;
  if (d == 1) slope = 2 * k * cos(k * x[1]);
  for (int e = 0; e < DIM; e++) {
    force += k * slope * wave(y, e) - k * k * lambda * wave(x, e);
  }
  return force;
}

static double wave_error(int base, int level, bool bulk, bool *converged) {
  struct flow *s = flow_new(grid_new(MPI_COMM_WORLD, 1, true, base, level),
                            smooth_eta, BC_NEUMANN);
  double error = 0, *kappa_f = face_field(s->mesh, smooth_kappa, false);
  const struct viscosity viscosity = {.eta_f = s->eta_f,
                                      .kappa_f = bulk ? kappa_f : NULL};
  for (int32_t i = 0; i < s->mesh->nleaves; i++) {
    const double *x = s->mesh->x[i];
    for (int d = 0; d < DIM; d++) {
      const double force = wave_force(x, d) + (bulk ? bulk_force(x, d) : 0);
      s->rhs[d][i] = wave(x, d) - force;
    }
  }
  const struct solve_stats stats =
      viscous_solve(s->mesh, s->hierarchy, s->rho, &viscosity, 1, s->rhs, s->bc,
                    1e-8, MOST, s->u);
  mem_free(kappa_f);
  *converged = *converged && stats.status == SOLVE_CONVERGED;
  for (int32_t i = 0; i < s->mesh->nleaves; i++) {
    for (int d = 0; d < DIM; d++) {
      const double e = s->u[d][i] - wave(s->mesh->x[i], d);
      error += mesh_volume(s->mesh, i) * e * e;
    }
  }
  error = sqrt(mesh_sum(s->mesh, error));
  flow_destroy(s);
  return error;
}

/* Uniform and adapted, without bulk viscosity and with it. */
START_TEST(manufactured_solution_is_second_order) {
  const int base = DIM == 2 ? 5 : 4, adapted = _i % 2;
  const bool bulk = _i / 2 > 0;
  steepness = bulk ? 1 : 2;
  bool converged = true;
  const double coarse = wave_error(base, base + adapted, bulk, &converged);
  const double fine =
      wave_error(base + 1, base + 1 + adapted, bulk, &converged);
  ck_assert(converged);
  ck_assert_double_ge(log2(coarse / fine), 1.9);
}
END_TEST

static double bulk; /* viscosity of the disc below, 0 around it */
static double bulk_of_disc(const double *x) {
  return from_middle(x) < 0.25 ? bulk : 0;
}

/* Return the iterations from zero to 1e-8 of the first residual. */
static int bulk_iterations(int level) {
  struct flow *s = flow_new(grid_new(MPI_COMM_WORLD, 1, false, level, level),
                            one, BC_DIRICHLET);
  double *kappa_f = face_field(s->mesh, bulk_of_disc, false);
  const struct viscosity viscosity = {.eta_f = s->eta_f, .kappa_f = kappa_f};
  for (int32_t i = 0; i < s->mesh->nleaves; i++) {
    const double *x = s->mesh->x[i];
    for (int d = 0; d < DIM; d++) {
      s->rhs[d][i] = sin(3 * x[d] + 1) * cos(5 * x[(d + 1) % DIM]);
    }
  }
  const struct solve_stats stats =
      viscous_solve(s->mesh, s->hierarchy, s->rho, &viscosity, 1, s->rhs, s->bc,
                    1e-8, MOST, s->u);
  mem_free(kappa_f);
  flow_destroy(s);
  return stats.status == SOLVE_CONVERGED ? stats.iterations : MOST;
}

/* Times eta; 0 makes lambda negative. */
START_TEST(bulk_viscosity_of_a_disc) {
  static const double bulks[] = {0, 1, 10, 100};
  static const int most[] = {8, 10, 17, 48};
  const int level = DIM == 2 ? 5 : 3;
  bulk = bulks[_i];
  for (int l = level; l <= level + 2; l++) {
    ck_assert_int_le(bulk_iterations(l), most[_i]);
  }
}
END_TEST

static double contrast; /* of the disc below to the fluid around it */
static double disc(const double *x) {
  return from_middle(x) < 0.25 ? fmax(contrast, 1) : fmax(1 / contrast, 1);
}

/* Return the iterations from zero to 1e-8 times the first residual, with dt so
 * that rho h^2 / (eta_soft dt) = lambda. */
static int disc_iterations(int base, int level, double lambda) {
  struct flow *s = flow_new(grid_new(MPI_COMM_WORLD, 1, false, base, level),
                            disc, BC_DIRICHLET);
  const double dt = ldexp(1, -2 * level) / lambda;
  for (int32_t i = 0; i < s->mesh->nleaves; i++) {
    const double *x = s->mesh->x[i];
    for (int d = 0; d < DIM; d++) {
      s->rhs[d][i] = sin(3 * x[d] + 1) * cos(5 * x[(d + 1) % DIM]);
    }
  }
  const struct solve_stats stats = viscous_solve(
      s->mesh, s->hierarchy, s->rho, &(struct viscosity){.eta_f = s->eta_f}, dt,
      s->rhs, s->bc, 1e-8, MOST, s->u);
  flow_destroy(s);
  return stats.status == SOLVE_CONVERGED ? stats.iterations : MOST;
}

START_TEST(contrast_of_viscosity) {
  static const double contrasts[] = {1, 1e4, 1e8, 1e-4, 1e-8};
  static const double lambdas[] = {1, 1e-4};
  const int level = DIM == 2 ? 5 : 4;
  contrast = contrasts[_i % 5];
  const double lambda = lambdas[_i / 5];
  ck_assert_int_lt(disc_iterations(level, level, lambda), 40);
  /* with jumps of level across the surface of the ball */
  const int most = DIM == 2 ? 40 : 55;
  ck_assert_int_lt(disc_iterations(level - 1, level + 1, lambda), most);
}
END_TEST

/* Return max |rhs - u + force| of a solve with dt = 1. */
static double true_residual(struct flow *s) {
  double *force[DIM], most = 0;
  for (int d = 0; d < DIM; d++) force[d] = MEM_NEW(double, s->mesh->nleaves);
  viscous_force(s->mesh, &(struct viscosity){.eta_f = s->eta_f}, s->u, force);
  for (int d = 0; d < DIM; d++) {
    for (int32_t i = 0; i < s->mesh->nleaves; i++) {
      most = larger(most, fabs(s->rhs[d][i] - s->u[d][i] + force[d][i]));
    }
    mem_free(force[d]);
  }
  return mesh_max(s->mesh, most);
}

/* Directions of 24 bits must not be seen in the residual. */
START_TEST(residual_is_what_it_is_said_to_be) {
  static const double digits[] = {1e-5, 1e-8, 1e-11};
  contrast = _i < 3 ? 1 : 100;
  struct flow *s =
      flow_new(grid_new(MPI_COMM_WORLD, 1, false, 3, 5), disc, BC_DIRICHLET);
  for (int32_t i = 0; i < s->mesh->nleaves; i++) {
    for (int d = 0; d < DIM; d++) s->rhs[d][i] = sin(5 * s->mesh->x[i][d] + 1);
  }
  const double tolerance = digits[_i % 3];
  const struct solve_stats stats = viscous_solve(
      s->mesh, s->hierarchy, s->rho, &(struct viscosity){.eta_f = s->eta_f}, 1,
      s->rhs, s->bc, tolerance, MOST, s->u);
  const double residual = true_residual(s);
  ck_assert_int_eq(stats.status, SOLVE_CONVERGED);
  ck_assert_double_le(residual, tolerance);
  flow_destroy(s);
}
END_TEST

static double soft_at_floor(const double *x) { return x[1] > 0 ? 1 : 0.2; }

static int floor_iterations(double (*eta)(const double *x)) {
  const int level = DIM == 2 ? 6 : 5;
  struct flow *s = flow_new(grid_new(MPI_COMM_WORLD, 1, false, level, level),
                            eta, BC_DIRICHLET);
  for (int32_t i = 0; i < s->mesh->nleaves; i++) {
    s->rhs[1][i] = sin(7 * s->mesh->x[i][0]) * cos(5 * s->mesh->x[i][1]);
  }
  const struct solve_stats stats = viscous_solve(
      s->mesh, s->hierarchy, s->rho, &(struct viscosity){.eta_f = s->eta_f},
      1e4, s->rhs, s->bc, 1e-8, MOST, s->u);
  flow_destroy(s);
  return stats.status == SOLVE_CONVERGED ? stats.iterations : MOST;
}

/* Coarse levels must not take the softness of the floor's faces for that of
 * the cells on it: no more than a cycle is lost by it. */
START_TEST(soft_wall_costs_no_iterations) {
  const int even = floor_iterations(one);
  ck_assert_int_le(floor_iterations(soft_at_floor), even + 1);
}
END_TEST

START_TEST(solution_does_not_depend_on_ranks) {
  double sum[2];
  int iterations[2];
  contrast = 1e3;
  for (int alone = 0; alone < 2; alone++) {
    struct flow *s =
        flow_new(grid_new(alone ? MPI_COMM_SELF : MPI_COMM_WORLD, 2, _i & 1,
                          _i < 2 ? 1 : 3, _i < 2 ? 6 - DIM + 1 : 3),
                 disc, BC_DIRICHLET);
    for (int32_t i = 0; i < s->mesh->nleaves; i++) {
      for (int d = 0; d < DIM; d++) s->rhs[d][i] = sin(5 * s->mesh->x[i][d]);
    }
    const struct solve_stats stats = viscous_solve(
        s->mesh, s->hierarchy, s->rho, &(struct viscosity){.eta_f = s->eta_f},
        0.01, s->rhs, s->bc, 1e-10, MOST, s->u);
    double local = 0;
    for (int32_t i = 0; i < s->mesh->nleaves; i++) {
      local += mesh_volume(s->mesh, i) * (s->u[0][i] + 2 * s->u[1][i]);
    }
    sum[alone] = mesh_sum(s->mesh, local);
    iterations[alone] = stats.iterations;
    flow_destroy(s);
  }
  const bool good = all_ranks(fabs(sum[0] - sum[1]) <= 1e-9 &&
                              abs(iterations[0] - iterations[1]) <= 1);
  ck_assert(good);
}
END_TEST

START_TEST(robin_walls_slip) {
  /* Couette flow from a wall that slips by 0.3 to one that moves: with
   * u = (y + L) / (1 + L) the shear is the same everywhere. */
  struct forest_layout layout = {.size = 1};
  for (int d = 0; d < DIM; d++) layout.trees[d] = 1, layout.periodic[d] = true;
  layout.periodic[1] = false;
  struct flow *s =
      flow_new(forest_new(MPI_COMM_WORLD, &layout, 4), one, BC_DIRICHLET);
  struct bc along[MESH_MAX_PATCHES] = {{0}};
  along[2] = (struct bc){BC_ROBIN, 0, 0.3};
  along[3] = (struct bc){BC_DIRICHLET, 1, 0};
  s->bc[0] = along;
  const struct solve_stats stats = viscous_solve(
      s->mesh, s->hierarchy, s->rho, &(struct viscosity){.eta_f = s->eta_f},
      1e8, s->rhs, s->bc, 1e-4, MOST, s->u);
  double error = 0;
  for (int32_t i = 0; i < s->mesh->nleaves; i++) {
    const double exact = (s->mesh->x[i][1] + 0.3) / 1.3;
    error = larger(error, fabs(s->u[0][i] - exact));
  }
  error = mesh_max(s->mesh, error);
  ck_assert_int_eq(stats.status, SOLVE_CONVERGED);
  ck_assert_double_le(error, 1e-7); /* 1 / dt is left of inertia */
  flow_destroy(s);
}
END_TEST

Suite *viscous_suite(void);
Suite *viscous_suite(void) {
  Suite *suite = suite_create("viscous");
  TCase *t = tcase_create("viscous");
  TCase *alone = tcase_create("long solves");
  tcase_set_timeout(t, 120);
  tcase_set_timeout(alone, 120);
  tcase_add_test(t, linear_velocity_has_no_force);
  tcase_add_test(t, rigid_rotation_has_no_stress);
  tcase_add_test(t, momentum_balances);
  tcase_add_loop_test(t, force_takes_energy_from_any_velocity, 0, 2);
  tcase_add_loop_test(t, force_on_waves_is_exact, 0, DIM);
  tcase_set_tags(alone, "one_rank");
  tcase_add_loop_test(alone, manufactured_solution_is_second_order, 0, 3);
  tcase_add_loop_test(t, manufactured_solution_is_second_order, 3, 4);
  tcase_add_loop_test(alone, bulk_viscosity_of_a_disc, 0, 2);
  tcase_add_loop_test(t, bulk_viscosity_of_a_disc, 2, 3);
  tcase_add_loop_test(alone, bulk_viscosity_of_a_disc, 3, 4);
  tcase_add_loop_test(alone, contrast_of_viscosity, 0, 7);
  tcase_add_loop_test(t, contrast_of_viscosity, 7, 8);
  tcase_add_loop_test(alone, contrast_of_viscosity, 8, 10);
  tcase_add_loop_test(t, residual_is_what_it_is_said_to_be, 0, 6);
  tcase_add_test(t, soft_wall_costs_no_iterations);
  tcase_add_loop_test(t, solution_does_not_depend_on_ranks, 0, 4);
  tcase_add_test(t, robin_walls_slip);
  suite_add_tcase(suite, t);
  suite_add_tcase(suite, alone);
  return suite;
}
