/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Axisymmetric coordinates, on grids with jumps of level at the axis and away
 * from it. In three dimensions there are none. */
#include <check.h>

#include "sim.h"
#include "talus/hierarchy.h"
#include "talus/level_raster.h"
#include "talus/strain.h"
#include "talus/viscous.h"
#include "transport.h"

static const double kTurn = 6.28318530717958648;
static const double kInner[] = {0, 0.3}; /* where the radius begins */

/* Make a brick of two by two trees of edge 1/2, refined around two places, one
 * of them at its lower radius. */
static struct forest *rings(double inner, int base, int level) {
  struct forest_layout layout = {.size = 0.5, .axisymmetric = true};
  for (int d = 0; d < DIM; d++) layout.trees[d] = 2;
  layout.origin[0] = inner;
  struct forest *forest = forest_new(MPI_COMM_WORLD, &layout, base);
  grid_refine(forest, (const double[]){inner, 0.42, 0}, 0.2, level);
  grid_refine(forest, (const double[]){inner + 0.7, 0.7, 0}, 0.15, level);
  return forest;
}

START_TEST(volumes_and_areas_are_those_of_rings) {
  struct bench *b = bench_on(rings(kInner[_i], 2, 5));
  const double inner = kInner[_i], outer = inner + 1;
  const double disc = 0.5 * kTurn * (outer * outer - inner * inner);
  double volume = 0, area[NFACE] = {0};
  for (int32_t i = 0; i < b->mesh->nleaves; i++)
    volume += mesh_volume(b->mesh, i);
  for (int32_t f = 0; f < b->mesh->nfaces; f++) {
    const int patch = b->mesh->face_patch[f];
    if (patch >= 0) area[patch] += mesh_face_area(b->mesh, f);
  }
  const double want[] = {kTurn * inner, kTurn * outer, disc, disc};
  ck_assert_double_eq_tol(mesh_sum(b->mesh, volume), disc, 1e-13);
  for (int s = 0; s < 4; s++)
    ck_assert_double_eq_tol(mesh_sum(b->mesh, area[s]), want[s], 1e-13);
  bench_destroy(b);
}
END_TEST

/* Any velocity: what the leaves lose is what the walls let through. */
START_TEST(what_leaves_one_leaf_enters_another) {
  struct bench *b = bench_on(rings(kInner[_i], 2, 5));
  struct field *v = bench_face(b, "v");
  double out = 0, through = 0;
  srand(5 + (unsigned)b->mesh->rank);
  for (int32_t f = 0; f < b->mesh->nfaces; f++) {
    v->v[f] = rand() / (double)RAND_MAX;
    if (b->mesh->face_patch[f] < 0) continue;
    const double sign = b->mesh->face_leaf[f][1] < 0 ? 1 : -1;
    through += sign * v->v[f] * mesh_face_area(b->mesh, f);
  }
  field_fill_faces(b->mesh, v);
  for (int32_t i = 0; i < b->mesh->nleaves; i++)
    out += mesh_outflow(b->mesh, v->v, i);
  out = mesh_sum(b->mesh, out), through = mesh_sum(b->mesh, through);
  bench_destroy(b);
  ck_assert_double_eq_tol(out, through, 1e-12); /* of a sum of 1e3 terms */
}
END_TEST

/* Stagnation flow, and what expands from the axis. */
static double stagnation(int d, const double x[3]) {
  return d == 0 ? x[0] : d == 1 ? 0.7 - 2 * x[1] : 0;
}
static double expansion(int d, const double x[3]) {
  return d == 0 ? 1.3 * x[0] : d == 1 ? 0.2 + 0.4 * x[1] : 0;
}

START_TEST(linear_flow_has_its_divergence) {
  struct bench *b = bench_on(rings(kInner[_i], 2, 5));
  struct field *v = bench_face(b, "v");
  double none = 0, some = 0;
  fill_faces(b->mesh, stagnation, v->v);
  for (int32_t i = 0; i < b->mesh->nleaves; i++)
    none = larger(none, fabs(mesh_divergence(b->mesh, v->v, i)));
  fill_faces(b->mesh, expansion, v->v);
  for (int32_t i = 0; i < b->mesh->nleaves; i++)
    some = larger(some, fabs(mesh_divergence(b->mesh, v->v, i) - 3));
  none = mesh_max(b->mesh, none), some = mesh_max(b->mesh, some);
  bench_destroy(b);
  ck_assert_double_le(none, 1e-13); /* 1e-16/h */
  ck_assert_double_le(some, 1e-13);
}
END_TEST

START_TEST(cleaning_makes_it_solenoidal) {
  struct bench *b = bench_on(rings(kInner[_i], 2, 5));
  struct field *v = bench_face(b, "v");
  double most = 0, speed = 0;
  srand(7 + (unsigned)b->mesh->rank);
  for (int32_t f = 0; f < b->mesh->nfaces; f++) {
    v->v[f] = b->mesh->face_patch[f] >= 0 ? 0 : rand() / (double)RAND_MAX;
  }
  clean_face_velocity(b->clean, b->mesh, b->open, v->v);
  for (int32_t i = 0; i < b->mesh->nleaves; i++) {
    const double left = fabs(mesh_divergence(b->mesh, v->v, i));
    most = larger(most, b->mesh->h[i] * left);
  }
  for (int32_t f = 0; f < b->mesh->nfaces; f++)
    speed = larger(speed, fabs(v->v[f]));
  most = mesh_max(b->mesh, most), speed = mesh_max(b->mesh, speed);
  bench_destroy(b);
  ck_assert_double_le(most, 1e-13); /* 1e-14 at h, a leaf of half the area */
  ck_assert_double_le(speed, 12);   /* 10 without an axis: no jet along it */
}
END_TEST

static double expands(const void *context, const double x[3]) {
  return expansion(*(const int *)context, x);
}

/* Fill a linear flow with boundary nodes on it. */
static void fill_linear(struct bench *b, struct field *const u[DIM]) {
  fill_cells(b->mesh, expansion, u);
  field_fill_many(b->mesh, DIM, u);
  for (int d = 0; d < DIM; d++)
    set_boundary_nodes(b->mesh, expands, &d, u[d]->v);
}

/* The stress of a linear flow is the same all over, the hoop's as well, and its
 * force vanishes, in the leaves at the axis as elsewhere. */
START_TEST(linear_flow_has_no_force) {
  static const char *const names[] = {"u", "v", "w"};
  static const char *const forces[] = {"fu", "fv", "fw"};
  struct bench *b = bench_on(rings(kInner[_i], 2, 5));
  struct field *u[DIM], *force[DIM], *eta = bench_face(b, "eta");
  struct field *kappa = bench_face(b, "kappa");
  double *v[DIM], *out[DIM], most = 0;
  bench_vector(b, names, u), bench_vector(b, forces, force);
  field_arrays(u, v), field_arrays(force, out);
  fill_linear(b, u);
  for (int32_t f = 0; f < b->mesh->nfaces_all; f++)
    eta->v[f] = 1, kappa->v[f] = 2;
  for (int k = 0; k < 2; k++) {
    const struct viscosity viscosity = {.eta_f = eta->v,
                                        .kappa_f = k ? kappa->v : NULL};
    viscous_force(b->mesh, &viscosity, v, out);
    for (int d = 0; d < DIM; d++)
      for (int32_t i = 0; i < b->mesh->nleaves; i++)
        most = larger(most, fabs(out[d][i]));
  }
  most = mesh_max(b->mesh, most);
  bench_destroy(b);
  ck_assert_double_le(most, 1e-10); /* 1e-15/h^2 */
}
END_TEST

START_TEST(linear_flow_has_its_strain) {
  static const char *const names[] = {"u", "v", "w"};
  struct bench *b = bench_on(rings(kInner[_i], 2, 5));
  struct field *u[DIM], *shear = bench_face(b, "shear");
  struct field *slide = bench_face(b, "slide");
  double *v[DIM], slip = 0, *rows[STRAIN_ROWS], hoop = 0, rate = 0, norm = 0;
  bench_vector(b, names, u), field_arrays(u, v);
  fill_linear(b, u);
  const int n = strain_rows(b->mesh);
  for (int k = 0; k < STRAIN_ROWS; k++)
    rows[k] = MEM_NEW(double, b->mesh->nfaces_all);
  strain_find(b->mesh, NULL, v, rows);
  strain_shear_rate(b->mesh, NULL, v, shear->v);
  for (int32_t i = 0; i < b->mesh->ncells; i++) v[1][i] *= -5;
  strain_sliding_rate(b->mesh, v, slide->v);
  ck_assert_int_eq(n, 3);
  fill_cells(b->mesh, stagnation, u); /* without trace */
  for (int32_t f = 0; f < b->mesh->nfaces; f++) {
    double *const row[] = {(double[]){1}, (double[]){0}, (double[]){1}};
    hoop = larger(hoop, fabs(rows[STRAIN_HOOP][f] - 1.3));
    rate =
        larger(rate, fabs(shear->v[f] - sqrt(2 * (2 * 1.3 * 1.3 + 0.4 * 0.4))));
    norm = strain_norm_squared(3, row, 0, 0);
    /* of diag(1.3, -2, 1.3) */
    slip = larger(slip, fabs(slide->v[f] - sqrt(14.04)));
  }
  for (int k = 0; k < STRAIN_ROWS; k++) mem_free(rows[k]);
  hoop = mesh_max(b->mesh, hoop), rate = mesh_max(b->mesh, rate);
  slip = mesh_max(b->mesh, slip);
  bench_destroy(b);
  ck_assert_double_le(hoop, 1e-13);
  ck_assert_double_le(slip, 1e-12);
  ck_assert_double_le(rate, 1e-12);
  ck_assert_double_eq(norm, 3); /* (1 + 1 + 4)/2 of diag(1, 1, -2) */
}
END_TEST

/* Return a velocity that is no linear flow. */
static double swirls(int d, const double x[3]) {
  return d == 0 ? sin(3 * x[0]) * cos(4 * x[1])
                : cos(2 * x[0] + 0.3) * sin(5 * x[1]);
}

/* The operator that is solved has the force of viscous_force in it: of rho u -
 * dt div tau, made with that, the solution is u. */
START_TEST(the_solver_knows_the_force) {
  static const char *const names[] = {"u", "v", "w"};
  static const char *const forces[] = {"fu", "fv", "fw"};
  struct bench *b = bench_on(rings(kInner[_i], 2, 5));
  struct hierarchy *hierarchy = hierarchy_new(b->mesh);
  struct field *u[DIM], *rhs[DIM], *eta = bench_face(b, "eta");
  struct field *rho = bench_cell(b, "rho");
  struct bc side[DIM][MESH_MAX_PATCHES] = {{{0}}};
  const struct bc *bc[DIM];
  double *v[DIM], *out[DIM], most = 0;
  bench_vector(b, names, u), bench_vector(b, forces, rhs);
  field_arrays(u, v), field_arrays(rhs, out);
  fill_cells(b->mesh, swirls, u);
  for (int d = 0; d < DIM; d++) {
    bc[d] = side[d];
    for (int k = 0; k < NFACE; k++) side[d][k].type = BC_DIRICHLET;
  }
  side[1][0].type = BC_NEUMANN; /* the axis, or a wall that slips */
  mesh_fill(b->mesh, DIM, v, bc, false);
  for (int32_t f = 0; f < b->mesh->nfaces_all; f++) eta->v[f] = 1;
  const struct viscosity viscosity = {.eta_f = eta->v};
  viscous_force(b->mesh, &viscosity, v, out);
  for (int d = 0; d < DIM; d++) {
    for (int32_t i = 0; i < b->mesh->nleaves; i++) {
      rho->v[i] = 2;
      out[d][i] = 2 * v[d][i] - 0.1 * out[d][i];
      v[d][i] = 0;
    }
  }
  const struct solve_stats stats = viscous_solve(
      b->mesh, hierarchy, rho->v, &viscosity, 0.1, out, bc, 1e-11, 60, v);
  for (int d = 0; d < DIM; d++) {
    for (int32_t i = 0; i < b->mesh->nleaves; i++) {
      most = larger(most, fabs(v[d][i] - swirls(d, b->mesh->x[i])));
    }
  }
  most = mesh_max(b->mesh, most);
  hierarchy_destroy(hierarchy);
  bench_destroy(b);
  ck_assert_int_eq(stats.status, SOLVE_CONVERGED);
  ck_assert_int_le(stats.iterations, 25); /* 18 and 17; the mesh is rough */
  ck_assert_double_le(most, 1e-10);
}
END_TEST

/* A ball drawn out along the axis by a linear flow, at a Courant number of 1/2:
 * its volume stays, c stays in [0, 1], and what remains in a box that the flow
 * leaves through the sides is what it brought. */
START_TEST(a_ball_in_a_linear_flow_keeps_its_volume) {
  struct bench *b = bench_on(rings(kInner[_i], 3, 5));
  struct transport t = transport_new(b);
  double radius = 0.2;
  const double outside[3] = {kInner[_i], 0.45};
  for (int32_t i = 0; i < b->mesh->nleaves; i++) {
    double inner = 0;
    for (int k = 0; k < 256; k++) { /* midpoints, by volume */
      const double s[] = {(k % 16 + 0.5) / 16 - 0.5, (k / 16 + 0.5) / 16 - 0.5};
      const double r = b->mesh->x[i][0] + s[0] * b->mesh->h[i];
      const double z = b->mesh->x[i][1] + s[1] * b->mesh->h[i];
      const bool in = hypot(r - outside[0], z - outside[1]) < radius;
      inner += in ? r / b->mesh->x[i][0] / 256 : 0;
    }
    t.c->v[i] = inner > 1 - 1e-9 ? 1 : inner;
  }
  fill_faces(b->mesh, stagnation, t.u_f->v);
  for (int32_t f = 0; f < b->mesh->nfaces; f++)
    if (b->mesh->face_patch[f] >= 0) t.u_f->v[f] = 0;
  clean_face_velocity(b->clean, b->mesh, b->open, t.u_f->v);
  double rate = 0;
  for (int32_t i = 0; i < b->mesh->nleaves; i++)
    rate = larger(rate, mesh_turnover(b->mesh, t.u_f->v, i));
  const double before = integral(b->mesh, t.c->v);
  const double dt = 0.5 / mesh_max(b->mesh, rate);
  double excess = 0;
  for (int step = 0; step < 40; step++) {
    transport_step(b, &t, step, dt);
    excess = larger(excess, transport_excess(b, &t));
  }
  const double after = integral(b->mesh, t.c->v);
  bench_destroy(b);
  ck_assert_double_le(excess, 1e-12);
  ck_assert_double_eq_tol(after / before, 1, 1e-13);
}
END_TEST

/* Describe rings between an inner and an outer wall, or around the axis. */
static struct params ring_params(double inner, int level) {
  struct params p = box_params(level);
  p.coordinates = COORDINATES_AXISYMMETRIC;
  p.origin[0] = inner;
  return p;
}

/* Finer in a stripe that moves with *context. */
static double moving(void *context, const double x[3]) {
  const double away = fabs(x[0] - x[1] - *(const double *)context);
  return away < 0.2 ? 5 : 3;
}

static double off_axis(void *context, const double x[3]) {
  return 0.24 - hypot(x[0] - *(const double *)context - 0.2, x[1] - 0.5);
}

/* Dividing and merging keeps the volume of grains and the momentum along the
 * axis, a radial velocity that grows with the radius and one that grows with
 * height. */
START_TEST(adaptation_keeps_what_there_is) {
  double inner = kInner[_i], place = -0.4, wrong = 0;
  int changes = 0;
  struct params p = ring_params(inner, 5);
  p.level_min = 3;
  p.shape = (struct function){off_axis, &inner};
  p.criterion[p.ncriteria++] = (struct criterion){
      .type = CRITERION_FUNCTION, .level = 5, .function = {moving, &place}};
  struct two_phase *sim = sim_start(&p);
  fill_cells(sim->grid.mesh, expansion, sim->u);
  for (int32_t i = 0; i < sim->grid.mesh->nleaves; i++)
    sim->u[1]->v[i] += cos(5 * sim->grid.mesh->x[i][0]);
  srand(11 + (unsigned)sim->grid.mesh->rank);
  for (int32_t f = 0; f < sim->grid.mesh->nfaces; f++) {
    const bool wall = sim->grid.mesh->face_patch[f] >= 0;
    sim->u_f->v[f] = wall ? 0 : rand() / (double)RAND_MAX;
  }
  clean_face_velocity(sim->grid.clean, sim->grid.mesh, sim->grid.open,
                      sim->u_f->v);
  const double volume = integral(sim->grid.mesh, sim->c->v);
  const double momentum = sim_momentum(sim, 1);
  for (int k = 0; k < 8; k++) {
    place += 0.15;
    level_raster_destroy(sim->grid.level_raster[0]);
    sim->grid.level_raster[0] = NULL; /* or the stripe would stay */
    sim->planes_hold = false;
    changes += two_phase_adapt(sim);
  }
  const struct mesh *mesh = sim->grid.mesh;
  const double divergence = clean_divergence(mesh, sim->u_f->v);
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    if (sim->c->v[i] > 0) continue; /* cut leaves have one velocity */
    if (mesh->x[i][0] < inner + 0.55) continue;
    wrong = larger(wrong, fabs(sim->u[0]->v[i] - 1.3 * mesh->x[i][0]));
  }
  wrong = mesh_max(mesh, wrong);
  const double kept[] = {integral(mesh, sim->c->v) / volume,
                         sim_momentum(sim, 1) / momentum};
  two_phase_destroy(sim);
  ck_assert_int_eq(changes, 8);
  ck_assert_double_eq_tol(kept[0], 1, 1e-13);
  ck_assert_double_eq_tol(kept[1], 1, 1e-13);
  ck_assert_double_le(wrong, 1e-13);
  ck_assert_double_le(divergence, 1e-12);
}
END_TEST

Suite *rings_suite(void);
Suite *rings_suite(void) {
  Suite *suite = suite_create("rings");
  TCase *tcase = tcase_create("geometry");
  if (DIM == 3) {
    suite_add_tcase(suite, tcase);
    return suite;
  }
  tcase_add_loop_test(tcase, volumes_and_areas_are_those_of_rings, 0, 2);
  tcase_add_loop_test(tcase, what_leaves_one_leaf_enters_another, 0, 2);
  tcase_add_loop_test(tcase, linear_flow_has_its_divergence, 0, 2);
  tcase_add_loop_test(tcase, cleaning_makes_it_solenoidal, 0, 2);
  suite_add_tcase(suite, tcase);
  tcase = tcase_create("linear flow");
  tcase_add_loop_test(tcase, linear_flow_has_no_force, 0, 2);
  tcase_add_loop_test(tcase, linear_flow_has_its_strain, 0, 2);
  tcase_add_loop_test(tcase, the_solver_knows_the_force, 0, 2);
  suite_add_tcase(suite, tcase);
  tcase = tcase_create("grains");
  tcase_add_loop_test(tcase, a_ball_in_a_linear_flow_keeps_its_volume, 0, 2);
  tcase_add_loop_test(tcase, adaptation_keeps_what_there_is, 0, 2);
  suite_add_tcase(suite, tcase);
  return suite;
}
