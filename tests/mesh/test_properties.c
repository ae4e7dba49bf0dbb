/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/strain.h"
#include "talus/two_phase/properties.h"

#include <check.h>

#include "bench.h"
#include "talus/params.h"
#include "talus/plane.h"
#include "talus/vof.h"

Suite *properties_suite(void);

/* A scalar that is linear in space, with slope k and value v at the origin. */
struct linear {
  double v, k[3];
};
static double linear(const void *context, const double x[3]) {
  const struct linear *of = (const struct linear *)context;
  double sum = of->v;
  for (int d = 0; d < DIM; d++) sum += of->k[d] * x[d];
  return sum;
}

static void fill_linear(const struct mesh *mesh, const struct linear *of,
                        struct field *field) {
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    double x[3] = {0};
    for (int d = 0; d < DIM; d++) x[d] = mesh->x[i][d];
    field->v[i] = linear(of, x);
  }
  field_fill(mesh, field);
}

static struct rheology closure(const char *name, const char *key,
                               double value) {
  struct rheology r;
  rheology_init(&r, rheology_find(name));
  rheology_set(&r, key, value);
  return r;
}

static const double kDensity[] = {1000, 1};

/* On faces it is the mean of the leaves on both sides, over levels too. */
START_TEST(density_is_linear_in_the_fraction) {
  struct bench *b = bench_new(1, false, 2, 5);
  const struct mesh *mesh = b->mesh;
  struct field *c = bench_cell(b, "c");
  double *rho = bench_cell(b, "rho")->v, *alpha_f = bench_face(b, "alpha")->v;
  b->closed[NFACE - 1] = false;
  const struct linear of = {0.1, {0.3, 0.2, 0.1}};
  fill_linear(mesh, &of, c);
  properties_density(mesh, kDensity, c->v, b->closed, rho, alpha_f);
  mesh_fill_ghosts(mesh, 1, &rho);
  double most = 0;
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    most = larger(most, fabs(rho[i] - (1 + 999 * c->v[i])));
  }
  for (int d = 0; d < DIM; d++) {
    for (int32_t f = mesh->face_begin[d]; f < mesh->face_begin[d + 1]; f++) {
      const int patch = mesh->face_patch[f];
      const int32_t *leaf = mesh->face_leaf[f];
      double exact = 0;
      if (patch < 0) exact = 2 / (rho[leaf[0]] + rho[leaf[1]]);
      if (patch == NFACE - 1) { /* no gradient of c at the open side */
        exact = 1 / (1 + 999 * c->v[mesh->face_owner[f]]);
      }
      most = larger(most, fabs(alpha_f[f] - exact));
    }
  }
  ck_assert_double_le(mesh_max(mesh, most), 1e-12); /* of 1000 */
  bench_destroy(b);
}
END_TEST

START_TEST(fractions_out_of_range_count_as_full_or_empty) {
  struct bench *b = bench_new(1, true, 3, 3);
  struct field *c = bench_cell(b, "c");
  double *rho = bench_cell(b, "rho")->v, *alpha_f = bench_face(b, "alpha")->v;
  bool good = true;
  for (int full = 0; full < 2; full++) {
    for (int32_t i = 0; i < b->mesh->nleaves; i++) {
      c->v[i] = full ? 1 + 1e-10 : -1e-10;
    }
    field_fill(b->mesh, c);
    properties_density(b->mesh, kDensity, c->v, b->closed, rho, alpha_f);
    for (int32_t i = 0; i < b->mesh->nleaves; i++) {
      good = good && rho[i] == kDensity[1 - full];
    }
    for (int32_t f = 0; f < b->mesh->nfaces; f++) {
      good = good && alpha_f[f] == 1 / kDensity[1 - full];
    }
  }
  ck_assert(all_ranks(good));
  bench_destroy(b);
}
END_TEST

START_TEST(shear_rate_of_linear_velocities_is_exact) {
  static const char *const names[] = {"u_x", "u_y", "u_z"};
  struct bench *b = bench_new(1 + _i / 2, _i & 1, 2, 5 - _i / 2);
  const struct mesh *mesh = b->mesh;
  struct field *field[DIM];
  double *u[DIM], grad[DIM][DIM], squared = 0, most = 0, count = 0;
  double *shear_f = bench_face(b, "shear")->v, div = 0;
  double *slide_f = bench_face(b, "slide")->v;
  bench_vector(b, names, field);
  field_arrays(field, u);
  srand(11); /* the same on all ranks */
  for (int e = 0; e < DIM; e++) {
    struct linear of = {.v = 1};
    for (int d = 0; d < DIM; d++) {
      grad[e][d] = of.k[d] = 2 * (rand() / (double)RAND_MAX) - 1;
    }
    fill_linear(mesh, &of, field[e]);
    set_boundary_nodes(mesh, linear, &of, u[e]);
  }
  for (int e = 0; e < DIM; e++) {
    for (int d = 0; d < DIM; d++) {
      const double strain = 0.5 * (grad[e][d] + grad[d][e]);
      squared += 2 * strain * strain; /* 2 D:D */
    }
    div += grad[e][e];
  }
  const double slide = sqrt(fmax(squared - 2 * div * div, 0));
  strain_shear_rate(mesh, NULL, u, shear_f);
  strain_sliding_rate(mesh, u, slide_f);
  for (int d = 0; d < DIM; d++) {
    for (int32_t f = mesh->face_begin[d]; f < mesh->face_begin[d + 1]; f++) {
      if (_i & 1) { /* across a periodic side the profile jumps */
        bool middle = true;
        double x[3];
        face_centre(mesh, d, f, x);
        for (int e = 0; e < DIM; e++) middle &= fabs(x[e] - 0.5) < 0.2;
        if (!middle) continue;
      }
      most = larger(most, fabs(shear_f[f] - sqrt(squared)));
      most = larger(most, fabs(slide_f[f] - slide));
      count++;
    }
  }
  ck_assert_double_gt(mesh_sum(mesh, count), 0);
  /* round-off of values up to 4 over the finest h */
  ck_assert_double_le(mesh_max(mesh, most), 32 * 2e-15);
  bench_destroy(b);
}
END_TEST

/* Arrays that properties_viscosity reads and writes. */
struct mixture {
  struct phase grains, gas;
  struct field *c, *p, *plane;
  double *normal[DIM], *shear, *work[2], *eta;
};

static struct mixture mixture_new(struct bench *b) {
  static const char *const names[] = {"normal_x", "normal_y", "normal_z"};
  struct mixture m = {
      .grains = {1, closure("newtonian", "eta", 200)},
      .gas = {1, closure("newtonian", "eta", 0.5)},
      .c = bench_cell(b, "c"),
      .p = bench_cell(b, "p"),
      .plane = bench_cell(b, "plane"),
      .shear = bench_face(b, "shear")->v,
      .work = {bench_face(b, "work_0")->v, bench_face(b, "work_1")->v},
      .eta = bench_face(b, "eta")->v};
  struct field *normal[DIM];
  bench_vector(b, names, normal);
  field_arrays(normal, m.normal);
  field_fill(b->mesh, m.p); /* 0 where a test sets nothing else */
  return m;
}

static void mixture_eval(const struct bench *b, struct mixture *m, bool gas,
                         const double gravity[DIM]) {
  const struct mesh *mesh = b->mesh;
  field_fill(mesh, m->c);
  vof_reconstruct(mesh, m->c->v, m->normal, m->plane->v);
  properties_viscosity(mesh, 0, &m->grains, gas ? &m->gas : NULL, gravity,
                       m->c->v, m->normal, m->plane->v, m->p->v, b->closed,
                       m->shear, m->work, m->eta);
}

/* With eta = mu p / gamma the viscosity tells which pressure was taken. The
 * profile is that of grains at rest, the upper side open. */
START_TEST(face_pressure_is_exact_for_linear_profiles) {
  struct bench *b = bench_new(1, false, 2, 5);
  const struct mesh *mesh = b->mesh;
  struct mixture m = mixture_new(b);
  const double gravity[] = {0.25, -0.35, 0.2}, density = 2;
  struct linear of = {2, {0}};
  double most = 0;
  m.grains = (struct phase){density, closure("coulomb", "mu_s", 0.3)};
  m.grains.rheology.eta_max = 1e30;
  const int top = NFACE - 1;
  for (int d = 0; d < DIM; d++) of.k[d] = density * gravity[d];
  b->closed[top] = false;
  m.p->bc[top] = (struct bc){BC_NEUMANN, of.k[DIM - 1], 0};
  fill_linear(mesh, &of, m.p);
  for (int32_t i = 0; i < mesh->nleaves; i++) m.c->v[i] = 1;
  for (int32_t f = 0; f < mesh->nfaces; f++) m.shear[f] = 0.25;
  mixture_eval(b, &m, false, gravity);
  for (int d = 0; d < DIM; d++) {
    for (int32_t f = mesh->face_begin[d]; f < mesh->face_begin[d + 1]; f++) {
      double x[3];
      face_centre(mesh, d, f, x);
      most = larger(most, fabs(m.eta[f] - 0.3 * linear(&of, x) / 0.25));
    }
  }
  ck_assert_double_le(mesh_max(mesh, most), 1e-14);
  bench_destroy(b);
}
END_TEST

/* A plane surface, n.x <= 0.5, with a normal that stencils find exactly. */
static const double kNormal[] = {0.2, DIM == 2 ? 0.6 : 0.1, 0.7};
static double plane_level_set(void *context, const double x[3]) {
  double sum = 0.5;
  (void)context;
  for (int d = 0; d < DIM; d++) sum -= kNormal[d] * x[d];
  return sum;
}

static struct gravity gravity_new(struct bench *b) {
  return (struct gravity){.weight = bench_cell(b, "weight")->v,
                          .surface = bench_cell(b, "surface")->v,
                          .count = bench_cell(b, "count")->v,
                          .near_surface = bench_cell(b, "near_surface")->v,
                          .near_weight = bench_cell(b, "near_weight")->v};
}

/* Is a leaf well away from walls, where the stencil bends the plane? */
static bool is_inner(const double x[3], double h) {
  bool inner = true;
  for (int d = 0; d < DIM; d++)
    inner = inner && fabs(x[d] - 0.5) < 0.5 - 1.6 * h;
  return inner;
}

/* With gravity across the surface, G = g.x on it, the force on faces is the
 * difference of q = rho g.x - [rho] G c between their nodes, filled as the
 * pressure is: so a pressure can hold it, however the surface lies in the
 * grid, across levels and at walls. */
START_TEST(gravity_on_a_tilted_bed_is_a_gradient) {
  struct bench *b = bench_new(1, false, _i ? 2 : 4, _i ? 5 : 4);
  const struct mesh *mesh = b->mesh;
  struct mixture m = mixture_new(b);
  struct field *q = bench_cell(b, "q");
  double *rho = bench_cell(b, "rho")->v, *alpha_f = bench_face(b, "alpha")->v;
  double *gravity_f = bench_face(b, "gravity")->v, most = 0;
  struct gravity gravity = gravity_new(b);
  for (int d = 0; d < DIM; d++) gravity.bounded[d] = -kNormal[d];
  fill_shape(mesh, plane_level_set, NULL, m.c->v);
  field_fill(mesh, m.c);
  vof_reconstruct(mesh, m.c->v, m.normal, m.plane->v);
  properties_density(mesh, kDensity, m.c->v, b->closed, rho, alpha_f);
  properties_gravity(mesh, kDensity, &gravity, m.c->v, m.normal, m.plane->v,
                     alpha_f, gravity_f);
  const double jump = kDensity[0] - kDensity[1], on_surface = -0.5;
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    double g_x = 0;
    for (int d = 0; d < DIM; d++) g_x += gravity.bounded[d] * mesh->x[i][d];
    q->v[i] = rho[i] * g_x - jump * on_surface * m.c->v[i];
  }
  field_fill(mesh, q);
  for (int32_t f = 0; f < mesh->nfaces; f++) {
    const int32_t *node = mesh->face_node[f];
    const double exact =
        mesh->face_patch[f] >= 0
            ? 0 /* closed */
            : alpha_f[f] * (q->v[node[1]] - q->v[node[0]]) / mesh->face_h[f];
    most = larger(most, fabs(gravity_f[f] - exact));
  }
  /* planes good to 1e-12, times the ratio of the densities */
  ck_assert_double_le(mesh_max(mesh, most), 1e-9);
  bench_destroy(b);
}
END_TEST

/* Grains fill the box up to x = 1/2 and gas the rest, with c = 1e-7 to 3e-7 in
 * the leaves beside the cliff. Whichever way the planes of these lean, gravity
 * has no part across it; by places in their corners it had 0.998 of all. */
START_TEST(a_film_beside_a_cliff_moves_no_surface) {
  struct bench *b = bench_new(1, false, 4, 4);
  const struct mesh *mesh = b->mesh;
  struct mixture m = mixture_new(b);
  double *rho = bench_cell(b, "rho")->v, *alpha_f = bench_face(b, "alpha")->v;
  double *gravity_f = bench_face(b, "gravity")->v, most = 0, faces = 0;
  struct gravity gravity = gravity_new(b);
  gravity.bounded[DIM - 1] = -1;
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    const double h = mesh->h[i], beyond = mesh->x[i][0] - 0.5;
    const int row = (int)(mesh->x[i][DIM - 1] / h);
    m.c->v[i] = beyond < 0 ? 1 : beyond < h ? 1e-7 * (1 + row * row % 3) : 0;
  }
  field_fill(mesh, m.c);
  vof_reconstruct(mesh, m.c->v, m.normal, m.plane->v);
  properties_density(mesh, kDensity, m.c->v, b->closed, rho, alpha_f);
  properties_gravity(mesh, kDensity, &gravity, m.c->v, m.normal, m.plane->v,
                     alpha_f, gravity_f);
  for (int32_t f = mesh->face_begin[0]; f < mesh->face_begin[1]; f++) {
    const int32_t i = mesh->face_owner[f];
    if (fabs(mesh->x[i][0] - 0.5) > mesh->h[i]) continue;
    most = larger(most, fabs(gravity_f[f]));
    faces++;
  }
  most = mesh_max(mesh, most), faces = mesh_sum(mesh, faces);
  bench_destroy(b);
  ck_assert_double_ge(faces, 16);
  ck_assert_double_le(most, 1e-4);
}
END_TEST

/* With gravity along the last axis the leaves of the same bed differ in G. A
 * face takes the mean of what their planes say by c (1.01 - c); an empty leaf
 * has no say. */
START_TEST(cut_leaves_keep_the_level_of_their_own_plane) {
  struct bench *b = bench_new(1, false, 4, 4);
  const struct mesh *mesh = b->mesh;
  struct mixture m = mixture_new(b);
  double *rho = bench_cell(b, "rho")->v, *alpha_f = bench_face(b, "alpha")->v;
  double *gravity_f = bench_face(b, "gravity")->v, most = 0, faces = 0;
  double *level = bench_cell(b, "level")->v;
  struct gravity gravity = gravity_new(b);
  gravity.bounded[DIM - 1] = -1;
  fill_shape(mesh, plane_level_set, NULL, m.c->v);
  field_fill(mesh, m.c);
  vof_reconstruct(mesh, m.c->v, m.normal, m.plane->v);
  properties_density(mesh, kDensity, m.c->v, b->closed, rho, alpha_f);
  properties_gravity(mesh, kDensity, &gravity, m.c->v, m.normal, m.plane->v,
                     alpha_f, gravity_f);
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    double n[DIM], at[DIM];
    for (int d = 0; d < DIM; d++) n[d] = m.normal[d][i];
    plane_foot(n, m.plane->v[i], at);
    level[i] = -(mesh->x[i][DIM - 1] + mesh->h[i] * at[DIM - 1]);
  }
  mesh_fill_ghosts(mesh, 2, (double *const[]){rho, level});
  for (int32_t f = 0; f < mesh->nfaces; f++) {
    const int32_t *at = mesh->face_leaf[f];
    if (mesh->face_patch[f] >= 0) continue;
    const double c[] = {m.c->v[at[0]], m.c->v[at[1]]};
    const bool cut[] = {vof_is_cut(c[0]), vof_is_cut(c[1])};
    if (!cut[0] && !cut[1]) continue;
    if (larger(c[0], c[1]) > 1 - VOF_EMPTY) continue;
    const double w[] = {c[0] * (1.01 - c[0]), c[1] * (1.01 - c[1])};
    const double mean =
        (w[0] * level[at[0]] + w[1] * level[at[1]]) / (w[0] + w[1]);
    const double weight = -rho[at[1]] * mesh->x[at[1]][DIM - 1] +
                          rho[at[0]] * mesh->x[at[0]][DIM - 1];
    const double jump = (kDensity[0] - kDensity[1]) * (c[1] - c[0]);
    const double exact = alpha_f[f] * (weight - jump * mean) / mesh->face_h[f];
    most = larger(most, fabs(gravity_f[f] - exact));
    faces++;
  }
  most = mesh_max(mesh, most), faces = mesh_sum(mesh, faces);
  bench_destroy(b);
  ck_assert_double_gt(faces, 5);
  ck_assert_double_le(most, 1e-9); /* as above */
}
END_TEST

/* Harmonic mean of 200 and 0.5 by the part of the line between the two nodes
 * of a face that lies below the surface. */
START_TEST(phases_are_mixed_in_series_along_the_line) {
  struct bench *b = bench_new(1, false, 4, 4);
  const struct mesh *mesh = b->mesh;
  struct mixture m = mixture_new(b);
  const double still[DIM] = {0};
  double most = 0, mixed = 0;
  fill_shape(mesh, plane_level_set, NULL, m.c->v);
  mixture_eval(b, &m, true, still);
  for (int d = 0; d < DIM; d++) {
    for (int32_t f = mesh->face_begin[d]; f < mesh->face_begin[d + 1]; f++) {
      double x[3], end[2], part;
      face_centre(mesh, d, f, x);
      if (!is_inner(x, mesh->face_h[f])) continue;
      for (int side = 0; side < 2; side++) {
        x[d] += (side ? 1 : -0.5) * mesh->face_h[f];
        end[side] = plane_level_set(NULL, x);
      }
      part = end[0] > 0;
      if ((end[0] > 0) != (end[1] > 0)) {
        part = fmax(end[0], end[1]) / fabs(end[0] - end[1]);
        mixed++;
      }
      const double exact = 1 / (part / 200 + (1 - part) / 0.5);
      most = larger(most, fabs(m.eta[f] / exact - 1));
    }
  }
  ck_assert_double_gt(mesh_sum(mesh, mixed), 10);
  /* alpha from c, good to 1e-12 in a corner, times the ratio of 400 */
  ck_assert_double_le(mesh_max(mesh, most), 1e-9);
  bench_destroy(b);
}
END_TEST

/* A flat surface through the centres of a row of leaves, up to round-off of
 * either sign: the lines along it lie half in the grains. */
START_TEST(lines_along_the_surface_lie_half_in_the_grains) {
  struct bench *b = bench_new(1, false, 3, 3);
  const struct mesh *mesh = b->mesh;
  struct mixture m = mixture_new(b);
  const double still[DIM] = {0};
  const double off[] = {-1e-12, 0, 1e-12}, exact = 1 / (0.5 / 200 + 0.5 / 0.5);
  double most = 0, lines = 0;
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    const double above = mesh->x[i][DIM - 1] - 0.4375; /* a centre */
    m.c->v[i] = fabs(above) < 1e-9 ? 0.5 + off[_i] : above < 0;
  }
  mixture_eval(b, &m, true, still);
  for (int32_t f = 0; f < mesh->face_begin[DIM - 1]; f++) {
    const double c = m.c->v[mesh->face_owner[f]];
    if (fabs(c - 0.5) > 0.1) continue;
    most = larger(most, fabs(m.eta[f] / exact - 1));
    lines++;
  }
  most = mesh_max(mesh, most), lines = mesh_sum(mesh, lines);
  bench_destroy(b);
  ck_assert_double_eq(lines, (DIM - 1) * 9 * pow(8, DIM - 2));
  ck_assert_double_le(most, 1e-14);
}
END_TEST

/* Each phase has the viscosity of its own closure: grains mu p / gamma, gas
 * constant. Where the surface is a face both halves of the line share the
 * stress: the grains yield at mu p, and below that only the gas gives way. */
START_TEST(each_phase_takes_its_own_closure) {
  struct bench *b = bench_new(1, true, 3, 3);
  const struct mesh *mesh = b->mesh;
  struct mixture m = mixture_new(b);
  const double still[DIM] = {0};
  double most = 0;
  m.grains = (struct phase){1, closure("coulomb", "mu_s", 0.4)};
  m.grains.rheology.eta_max = 1e30;
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    m.c->v[i] = mesh->x[i][0] < 0.5;
    m.p->v[i] = 3 + mesh->x[i][1];
  }
  field_fill(mesh, m.p);
  for (int32_t f = 0; f < mesh->nfaces; f++) m.shear[f] = 0.1 + f % 7;
  mixture_eval(b, &m, true, still);
  for (int32_t f = 0; f < mesh->nfaces; f++) {
    const int32_t *node = mesh->face_node[f];
    const double c_f = 0.5 * (m.c->v[node[0]] + m.c->v[node[1]]);
    const double p_f = 0.5 * (m.p->v[node[0]] + m.p->v[node[1]]);
    const double yielded = 0.4 * p_f / m.shear[f];
    const double exact = c_f == 1  ? yielded
                         : c_f > 0 ? fmin(yielded, 0.5 / (1 - c_f))
                                   : 0.5;
    most = larger(most, fabs(m.eta[f] / exact - 1));
  }
  /* 24 halvings of the range of the grains' rate */
  ck_assert_double_le(mesh_max(mesh, most), 1e-6);
  bench_destroy(b);
}
END_TEST

Suite *properties_suite(void) {
  Suite *suite = suite_create("properties");
  TCase *tc = tcase_create("properties");
  tcase_add_test(tc, density_is_linear_in_the_fraction);
  tcase_add_test(tc, fractions_out_of_range_count_as_full_or_empty);
  tcase_add_loop_test(tc, shear_rate_of_linear_velocities_is_exact, 0, 4);
  tcase_add_test(tc, face_pressure_is_exact_for_linear_profiles);
  tcase_add_loop_test(tc, gravity_on_a_tilted_bed_is_a_gradient, 0, 2);
  tcase_add_test(tc, cut_leaves_keep_the_level_of_their_own_plane);
  tcase_add_test(tc, a_film_beside_a_cliff_moves_no_surface);
  tcase_add_test(tc, phases_are_mixed_in_series_along_the_line);
  tcase_add_loop_test(tc, lines_along_the_surface_lie_half_in_the_grains, 0, 3);
  tcase_add_test(tc, each_phase_takes_its_own_closure);
  tcase_set_timeout(tc, 60);
  suite_add_tcase(suite, tc);
  return suite;
}
