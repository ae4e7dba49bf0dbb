/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/advection.h"

#include <check.h>

#include "bench.h"

Suite *advection_suite(void);

/* The fields of a Bell-Colella-Glaz step. */
struct flow {
  struct field *u[DIM], *g[DIM], *out[DIM], *u_f;
  struct advection_work work;
};

static struct flow flow_new(struct bench *b) {
  static const char *const name[][3] = {
      {"u_x", "u_y", "u_z"},
      {"g_x", "g_y", "g_z"},
      {"out_x", "out_y", "out_z"},
      {"slope_x", "slope_y", "slope_z"},
      {"transverse_x", "transverse_y", "transverse_z"},
      {"flux_x", "flux_y", "flux_z"}};
  struct flow w = {.u_f = bench_face(b, "u_f")};
  bench_vector(b, name[0], w.u);
  bench_vector(b, name[1], w.g);
  bench_vector(b, name[2], w.out);
  for (int d = 0; d < DIM; d++) {
    w.work.slope[d] = bench_cell(b, name[3][d])->v;
    w.work.transverse[d] = bench_cell(b, name[4][d])->v;
    w.work.flux[d] = bench_face(b, name[5][d])->v;
  }
  w.work.volume = bench_face(b, "volume")->v;
  return w;
}

/* u and g beyond walls go on as inside. */
struct component {
  velocity_function u;
  int d;
};
static double component(const void *context, const double x[3]) {
  const struct component *of = (const struct component *)context;
  return of->u(of->d, x);
}

static void flow_set(const struct bench *b, struct flow *w, velocity_function u,
                     velocity_function g) {
  fill_cells(b->mesh, u, w->u);
  fill_cells(b->mesh, g, w->g);
  fill_faces(b->mesh, u, w->u_f->v);
  field_fill_many(b->mesh, DIM, w->u);
  field_fill_many(b->mesh, DIM, w->g);
  for (int d = 0; d < DIM; d++) {
    const struct component of_u = {u, d}, of_g = {g, d};
    set_boundary_nodes(b->mesh, component, &of_u, w->u[d]->v);
    set_boundary_nodes(b->mesh, component, &of_g, w->g[d]->v);
  }
}

static void flow_advect(const struct bench *b, struct flow *w, double dt) {
  double *u[DIM], *g[DIM], *out[DIM];
  field_arrays(w->u, u), field_arrays(w->g, g), field_arrays(w->out, out);
  advection_momentum(b->mesh, dt, u, g, w->u_f->v, NULL, &w->work, out);
}

static void flow_predict(const struct bench *b, struct flow *w, double dt,
                         double *u_f) {
  double *u[DIM], *g[DIM];
  field_arrays(w->u, u), field_arrays(w->g, g);
  advection_predict(b->mesh, dt, u, g, b->closed, &w->work, u_f);
}

static const double kDrift[] = {1, 0.6, -0.8};
static double drift(int d, const double x[3]) {
  (void)x;
  return kDrift[d];
}
static double nothing(int d, const double x[3]) {
  (void)d, (void)x;
  return 0;
}

/* u = A x + drift, A without trace, and what A carries of itself, u.grad u. */
static const double kA[3][3] = {
    {0.7, -0.4, DIM == 2 ? 0 : 0.5},
    {1.1, DIM == 2 ? -0.7 : -0.2, DIM == 2 ? 0 : 0.3},
    {-0.6, 0.9, -0.5}};
static double linear(int d, const double x[3]) {
  double sum = kDrift[d];
  for (int e = 0; e < DIM; e++) sum += kA[d][e] * x[e];
  return sum;
}
static double linear_inertia(int d, const double x[3]) {
  double sum = 0;
  for (int e = 0; e < DIM; e++) sum += kA[d][e] * linear(e, x);
  return sum;
}

START_TEST(a_uniform_velocity_is_kept_across_levels) {
  struct bench *b = bench_new(1 + _i / 2, _i & 1, 2, 5 - _i / 2);
  struct flow w = flow_new(b);
  flow_set(b, &w, drift, nothing);
  /* carried by a velocity that is not solenoidal at all */
  fill_faces(b->mesh, linear_inertia, w.u_f->v);
  flow_advect(b, &w, 0.5 / 32);
  double *u_f = bench_face(b, "predicted")->v, most = 0, wrong = 0;
  flow_predict(b, &w, 0.5 / 32, u_f);
  for (int d = 0; d < DIM; d++) {
    for (int32_t i = 0; i < b->mesh->nleaves; i++) {
      most = larger(most, fabs(w.out[d]->v[i]));
    }
    for (int32_t f = b->mesh->face_begin[d]; f < b->mesh->face_begin[d + 1];
         f++) {
      wrong = larger(wrong, fabs(u_f[f] - kDrift[d]));
    }
  }
  ck_assert_double_le(mesh_max(b->mesh, most), 1e-14);
  ck_assert_double_le(mesh_max(b->mesh, wrong), 1e-14);
  bench_destroy(b);
}
END_TEST

/* Without time to change, face values are those of the profile; within dt
 * they change by -dt/2 u.grad u, u being taken at the face and at the centre
 * of the upwind leaf, at most h/2 (coarse: 3/4 h of the face) from there. */
/* Loop 1: the sides are open, and what leaves by them is predicted too. */
START_TEST(prediction_of_a_linear_profile_is_exact) {
  struct bench *b = bench_new(1, false, 2, 5);
  struct flow w = flow_new(b);
  for (int k = 0; k < NFACE; k++) b->closed[k] = _i == 0;
  flow_set(b, &w, linear, nothing);
  double *u_f = bench_face(b, "predicted")->v, still = 0, moved = 0;
  for (int k = 0; k < 2; k++) {
    const double dt = k * 1e-2;
    flow_predict(b, &w, dt, u_f);
    for (int d = 0; d < DIM; d++) {
      for (int32_t f = b->mesh->face_begin[d]; f < b->mesh->face_begin[d + 1];
           f++) {
        double x[3];
        face_centre(b->mesh, d, f, x);
        const bool leaves = b->mesh->face_leaf[f][linear(d, x) > 0 ? 1 : 0] < 0;
        if (k > 0 && b->mesh->face_patch[f] >= 0 && !(_i && leaves)) continue;
        const double exact = linear(d, x) - 0.5 * dt * linear_inertia(d, x);
        const double error = fabs(u_f[f] - exact);
        if (k == 0) {
          still = larger(still, error);
        } else {
          moved = larger(moved, error / (dt * b->mesh->face_h[f]));
        }
      }
    }
  }
  /* 1/2 sum |A| |A| x at most 3/4 */
  ck_assert_double_le(mesh_max(b->mesh, still), 1e-14);
  ck_assert_double_le(mesh_max(b->mesh, moved), DIM == 2 ? 1 : 2);
  bench_destroy(b);
}
END_TEST

/* A difference of products of linear functions over one leaf is exact. */
START_TEST(a_linear_velocity_is_advected_exactly_in_the_limit) {
  struct bench *b = bench_new(1, false, 4, 4);
  struct flow w = flow_new(b);
  flow_set(b, &w, linear, nothing);
  const double dt = 1e-9;
  flow_advect(b, &w, dt);
  double most = 0;
  for (int32_t i = 0; i < b->mesh->nleaves; i++) {
    double x[3] = {0};
    for (int d = 0; d < DIM; d++) x[d] = b->mesh->x[i][d];
    for (int d = 0; d < DIM; d++) {
      const double rate = -w.out[d]->v[i] / dt;
      most = larger(most, fabs(rate - linear_inertia(d, x)));
    }
  }
  /* dt |A|^2 |u|, and round-off of 1e-15 / h */
  ck_assert_double_le(mesh_max(b->mesh, most), 1e-7);
  bench_destroy(b);
}
END_TEST

/* Return a periodic flow that turns in itself: u.grad u = -grad p. In three
 * dimensions all axes take part. */
static double swirl(int d, const double x[3]) {
  const double k = 2 * acos(-1);
  if (DIM == 2) {
    return d == 0 ? 0.3 + sin(k * x[0]) * cos(k * x[1])
                  : 0.2 - cos(k * x[0]) * sin(k * x[1]);
  }
  return sin(k * x[(d + 2) % 3]) + 0.7 * cos(k * x[(d + 1) % 3]);
}
static double swirl_inertia(int d, const double x[3]) {
  const double step = 1e-4;
  double sum = 0;
  for (int e = 0; e < DIM; e++) {
    double far[3], near[3];
    memcpy(far, x, sizeof far), memcpy(near, x, sizeof near);
    far[e] += step, near[e] -= step;
    sum += swirl(e, x) * (swirl(d, far) - swirl(d, near)) / (2 * step);
  }
  return sum;
}

/* Measure the largest and the mean of the error of one step, by which
 * acceleration should have balanced advection, per dt. */
static void steady_error(int base, int level, double *most, double *mean) {
  struct bench *b = bench_new(1, true, base, level);
  struct flow w = flow_new(b);
  const struct mesh *mesh = b->mesh;
  flow_set(b, &w, swirl, swirl_inertia);
  clean_face_velocity(b->clean, mesh, b->open, w.u_f->v);
  const double dt = 0.2 / (1 << level);
  flow_advect(b, &w, dt);
  double *error = bench_cell(b, "error")->v;
  *most = 0;
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    for (int d = 0; d < DIM; d++) {
      const double e = fabs(w.out[d]->v[i] / dt + w.g[d]->v[i]);
      *most = larger(*most, e);
      error[i] += e;
    }
  }
  *most = mesh_max(mesh, *most);
  *mean = integral(mesh, error);
  bench_destroy(b);
}

/* Compares how much the steady flow changes in one step at two resolutions. */
START_TEST(a_steady_swirl_is_kept_to_second_order) {
  const int jump = _i, level = DIM == 2 ? 6 : 5 - jump;
  double most[2], mean[2];
  for (int k = 0; k < 2; k++) {
    steady_error(level + k - jump, level + k, &most[k], &mean[k]);
  }
  /* where levels meet the error is of first order, on few leaves */
  ck_assert_double_ge(log2(most[0] / most[1]), jump ? 0.9 : 1.8);
  ck_assert_double_ge(log2(mean[0] / mean[1]), jump ? 1.5 : 1.8);
}
END_TEST

/* Momentum that leaves one leaf enters another. */
START_TEST(momentum_is_conserved_across_levels) {
  struct bench *b = bench_new(1, true, 2, 5);
  struct flow w = flow_new(b);
  flow_set(b, &w, swirl, swirl_inertia);
  clean_face_velocity(b->clean, b->mesh, b->open, w.u_f->v);
  flow_advect(b, &w, 0.2 / 32);
  double most = 0;
  for (int d = 0; d < DIM; d++) {
    most = larger(most, fabs(integral(b->mesh, w.out[d]->v)));
  }
  ck_assert_double_le(most, 1e-15); /* of changes of 0.05 */
  bench_destroy(b);
}
END_TEST

/* Return a block carried obliquely, its other components moving nothing: the
 * limited schemes leave it between 0 and 1, the plain one does not. */
static double block(int d, const double x[3]) {
  double outside = 0;
  for (int e = 0; e < DIM; e++) outside = larger(outside, fabs(x[e] - 0.5));
  return d == 0 && outside < 0.25;
}

START_TEST(limited_slopes_make_no_new_extrema) {
  enum { LEVEL = DIM == 2 ? 5 : 4, STEPS = 40 };
  struct bench *b = bench_new(1, true, LEVEL, LEVEL);
  struct flow w = flow_new(b);
  const size_t bytes = (size_t)b->mesh->nleaves * sizeof(double);
  flow_set(b, &w, block, nothing);
  fill_faces(b->mesh, drift, w.u_f->v);
  w.work.limiter = (enum limiter)_i;
  const double dt = courant_dt(b->mesh, w.u_f->v, 0.5);
  double most = 0;
  for (int step = 0; step < STEPS; step++) {
    for (int d = 0; d < DIM; d++) memcpy(w.out[d]->v, w.u[d]->v, bytes);
    field_fill_many(b->mesh, DIM, w.u);
    flow_advect(b, &w, dt);
    memcpy(w.u[0]->v, w.out[0]->v, bytes);
    for (int32_t i = 0; i < b->mesh->nleaves; i++) {
      most = larger(most, fmax(-w.u[0]->v[i], w.u[0]->v[i] - 1));
    }
  }
  most = mesh_max(b->mesh, most);
  bench_destroy(b);
  if (_i == LIMITER_NONE) {
    ck_assert_double_ge(most, 0.05);
  } else {
    /* both leave none here; at other angles 1e-4 were seen */
    ck_assert_double_le(most, _i == LIMITER_MINMOD ? 1e-14 : 1e-3);
  }
}
END_TEST

/* A half of the box is in the band: its faces are left to the sweeps. */
START_TEST(faces_of_the_band_are_left_out) {
  struct bench *b = bench_new(1, true, 4, 4);
  struct flow w = flow_new(b);
  struct field *band = bench_cell(b, "band");
  double *u[DIM], *g[DIM], *out[DIM];
  flow_set(b, &w, linear, nothing);
  for (int32_t i = 0; i < b->mesh->nleaves; i++) {
    band->v[i] = b->mesh->x[i][0] < 0.5;
  }
  mesh_fill_ghosts(b->mesh, 1, &band->v);
  field_arrays(w.u, u), field_arrays(w.g, g), field_arrays(w.out, out);
  advection_momentum(b->mesh, 0.01, u, g, w.u_f->v, band->v, &w.work, out);
  bool good = true, moved = false;
  for (int32_t i = 0; i < b->mesh->nleaves; i++) {
    const double change = fabs(out[0][i]);
    good = good && (band->v[i] == 0 || change == 0);
    moved = moved || change > 1e-3;
  }
  ck_assert(all_ranks(good));
  ck_assert(mesh_max(b->mesh, moved) > 0);
  bench_destroy(b);
}
END_TEST

Suite *advection_suite(void) {
  Suite *suite = suite_create("advection");
  TCase *tc = tcase_create("advection");
  tcase_add_loop_test(tc, a_uniform_velocity_is_kept_across_levels, 0, 4);
  tcase_add_loop_test(tc, prediction_of_a_linear_profile_is_exact, 0, 2);
  tcase_add_test(tc, a_linear_velocity_is_advected_exactly_in_the_limit);
  tcase_add_loop_test(tc, a_steady_swirl_is_kept_to_second_order, 0, 2);
  tcase_add_test(tc, momentum_is_conserved_across_levels);
  tcase_add_loop_test(tc, limited_slopes_make_no_new_extrema, LIMITER_NONE,
                      LIMITER_GENERALISED + 1);
  tcase_add_test(tc, faces_of_the_band_are_left_out);
  tcase_set_timeout(tc, 60);
  suite_add_tcase(suite, tc);
  return suite;
}
