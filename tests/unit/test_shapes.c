/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <check.h>
#include <math.h>
#include <stdbool.h>

#include "level_sets.h"
#include "random.h"
#include "talus/plane.h"
#include "talus/shape_memory.h"
#include "talus/shapes.h"

Suite *shapes_suite(void);

static const double PI = 3.14159265358979323846;

struct box {
  double lo[3], hi[3];
};

static double box_value(void *context, const double x[3]) {
  const struct box *box = context;
  return level_set_box(box->lo, box->hi, x);
}

struct sphere {
  double centre[3], radius, scale;
  long calls;
};

static double sphere_value(void *context, const double x[3]) {
  struct sphere *sphere = context;
  sphere->calls++;
  return sphere->scale * level_set_ball(sphere->centre, sphere->radius, x);
}

struct plane {
  double n[3], alpha;
  long calls;
};

static double plane_value(void *context, const double x[3]) {
  struct plane *plane = context;
  plane->calls++;
  return plane->alpha - plane->n[0] * x[0] - plane->n[1] * x[1] -
         plane->n[2] * x[2];
}

static double constant_value(void *context, const double x[3]) {
  ck_assert(DIM == 3 || x[2] == 0.);
  return *(double *)context;
}

/* Return the volume of a shape in [0, 1]^DIM by n^DIM cells; the largest
 * fraction that is not in [0, 1] makes it NaN. */
static double total(shape_level_set f, void *context, int n, int depth) {
  double sum = 0., h = 1. / n;
  int ncells = DIM == 2 ? n * n : n * n * n;
  for (int i = 0; i < ncells; i++) {
    double x[DIM];
    for (int d = 0, rest = i; d < DIM; d++, rest /= n)
      x[d] = (rest % n + 0.5) * h;
    double c = shape_fraction(f, context, x, h, depth);
    sum += c >= 0. && c <= 1. ? c : NAN;
  }
  return sum / ncells;
}

START_TEST(shape_fraction_of_a_plane_is_exact) {
  uint64_t state = 1;
  double error = 0.;
  for (int i = 0; i < 20000; i++) {
    struct plane plane = {{0.}, 0., 0};
    double x[DIM], h = 1. / (1 << i % 7), local = 0., length = 0.;
    for (int d = 0; d < DIM; d++) {
      plane.n[d] = 2. * uniform(&state) - 1.;
      if (uniform(&state) < 0.1) plane.n[d] = 0.;
      length += fabs(plane.n[d]);
      x[d] = uniform(&state);
      local -= plane.n[d] * x[d];
    }
    if (length == 0) continue; /* no plane */
    plane.alpha = h * length * (1.2 * uniform(&state) - 0.6) - local;
    local = (plane.alpha + local) / h;
    double c = shape_fraction(plane_value, &plane, x, h, i % 4);
    /* x and alpha are of order 1, so the plane is known to 1e-16/h cells */
    raise_to(&error, h * fabs(c - plane_volume(plane.n, local)));
  }
  ck_assert_double_le(error, 1e-15);
}
END_TEST

START_TEST(shape_fraction_does_not_depend_on_the_scale_of_the_level_set) {
  double x[DIM] = {0.4, 0.3}, c[3];
  for (int k = 0; k < 3; k++) {
    struct sphere sphere = {{0.}, 0.5, pow(2., 100 * (k - 1)), 0};
    c[k] = shape_fraction(sphere_value, &sphere, x, 0.1, 3);
  }
  ck_assert_double_eq(c[0], c[1]);
  ck_assert_double_eq(c[2], c[1]);
}
END_TEST

static double largest_value(void *context, const double x[3]) {
  return x[0] < *(const double *)context ? 1.7e308 : -1.7e308;
}

/* Values near the largest number, of which there is no difference. */
START_TEST(shape_fraction_of_the_largest_values_is_right) {
  double edge = 0.5; /* on a face of the smallest pieces, which hold both */
  double found = total(largest_value, &edge, 5, 3);
  ck_assert_double_le(fabs(found - 0.5), 0.5 / (5 * 8));
}
END_TEST

START_TEST(shape_fraction_of_a_constant_is_its_sign) {
  double x[DIM] = {0.4, 0.3}, value[] = {-1., 1., -1e-300, 0.};
  for (int k = 0; k < 4; k++)
    ck_assert_double_eq(shape_fraction(constant_value, &value[k], x, 0.1, 2),
                        value[k] > 0.);
  value[0] = NAN;
  ck_assert_double_nan(shape_fraction(constant_value, &value[0], x, 0.1, 2));
}
END_TEST

START_TEST(shape_fraction_of_a_box_on_cell_faces_is_exact) {
  /* 1/5 and 1/40 are not binary numbers: the faces meet to round-off only */
  const double edge = 0.2, h = 0.025;
  struct box box;
  for (int d = 0; d < 3; d++) box.lo[d] = edge, box.hi[d] = 2. * edge;
  double error = 0.;
  int ncells = DIM == 2 ? 400 : 8000;
  for (int depth = 0; depth < 3; depth++)
    for (int i = 0; i < ncells; i++) {
      double x[DIM];
      bool inside = true;
      for (int d = 0, rest = i; d < DIM; d++, rest /= 20) {
        x[d] = (rest % 20 + 0.5) * h;
        inside = inside && x[d] > edge && x[d] < 2. * edge;
      }
      double c = shape_fraction(box_value, &box, x, h, depth);
      raise_to(&error, fabs(c - inside));
    }
  ck_assert_double_le(error, 1e-14);
}
END_TEST

static double cut_off_value(void *context, const double x[3]) {
  return fmax(0., box_value(context, x));
}

static double one_or_zero_value(void *context, const double x[3]) {
  return box_value(context, x) > 0. ? 1. : 0.;
}

START_TEST(shape_fraction_is_0_where_the_level_set_is) {
  struct box box = {{0.2, 0.2, 0.2}, {0.6, 0.6, 0.6}};
  const double exact = DIM == 2 ? 0.16 : 0.064;
  ck_assert_double_eq_tol(total(cut_off_value, &box, 5, 3), exact, 1e-14);
  const double skin = DIM * (DIM == 2 ? 0.8 : 0.32) / (5 * 8);
  ck_assert_double_eq_tol(total(one_or_zero_value, &box, 5, 3), exact, skin);
}
END_TEST

START_TEST(shape_fraction_of_a_column_reaches_beyond_the_domain) {
  /* the usual start of a collapse: a column open to the left and below */
  struct box box = {{-INFINITY, -INFINITY, -INFINITY}, {0.5, 0.7, INFINITY}};
  ck_assert_double_eq_tol(total(box_value, &box, 20, 0), 0.35, 1e-14);
}
END_TEST

START_TEST(shape_fraction_of_a_box_errs_at_corners_only) {
  struct box box = {{0.213, 0.107, 0.311}, {0.774, 0.913, 0.689}};
  double exact = 1.;
  for (int d = 0; d < DIM; d++) exact *= box.hi[d] - box.lo[d];
  const int n = 10;
  for (int depth = 0; depth < 4; depth++) {
    double error = fabs(total(box_value, &box, n, depth) - exact);
    double piece = 1. / (n << depth);
    /* a piece that holds an edge errs by less than its volume; those pieces
     * make up: 2D 4 corners, 3D 4 edges along each axis */
    double bound = 4. * piece * piece;
    if (DIM == 3) bound *= 0.561 + 0.806 + 0.378;
    ck_assert_double_le(error, 0.5 * bound);
  }
}
END_TEST

START_TEST(shape_fraction_of_a_sphere_converges_with_third_order) {
  struct sphere sphere = {{0.511, 0.487, 0.503}, 0.3, 1., 0};
  double r = sphere.radius;
  double exact = DIM == 2 ? PI * r * r : 4. / 3. * PI * r * r * r;
  for (int depth = 0; depth < 4; depth++) {
    double error = fabs(total(sphere_value, &sphere, 16, depth) / exact - 1.);
    double piece = 1. / (16 << depth) / r;
    /* seen: 2D 7.9e-5 5.0e-5 1.4e-6 1.0e-6, 3D 1.4e-5 9.2e-6 9.9e-7 4.7e-7 */
    ck_assert_double_le(error, 0.1 * piece * piece * piece);
  }
}
END_TEST

START_TEST(shape_fraction_sees_a_sphere_smaller_than_the_cell) {
  uint64_t state = 2;
  double error = 0.;
  for (int i = 0; i < 200; i++) {
    struct sphere sphere = {{0.}, 0.05, 1., 0};
    double x[DIM] = {0.}, r = sphere.radius;
    for (int d = 0; d < DIM; d++)
      sphere.centre[d] = 0.9 * (uniform(&state) - 0.5);
    double exact = DIM == 2 ? PI * r * r : 4. / 3. * PI * r * r * r;
    double c = shape_fraction(sphere_value, &sphere, x, 1., 6);
    raise_to(&error, fabs(c / exact - 1.));
  }
  ck_assert_double_le(error, 1e-2);
}
END_TEST

/* In a box a thousand times as large, and with no more calls than a surface
 * needs. */
START_TEST(shape_fraction_finds_a_ball_in_a_large_cell) {
  double centre[DIM] = {0.};
  struct sphere sphere = {{0.127, -0.211, 0.093}, 1e-3, 1., 0};
  const double exact = (DIM == 2 ? PI * 1e-6 : 4. / 3. * PI * 1e-9);
  const double c = shape_fraction(sphere_value, &sphere, centre, 1., 12);
  ck_assert_double_eq_tol(c / exact, 1., 0.03);
  ck_assert_int_le(sphere.calls, DIM == 2 ? 20000 : 200000);
}
END_TEST

START_TEST(shape_fraction_calls_the_level_set_sparingly) {
  /* a cell in the middle of a flat surface, and one far from it */
  double x[DIM] = {0.}, far[DIM] = {3.};
  for (int depth = 0; depth < 5; depth++) {
    struct sphere sphere = {{1e4}, 1e4, 1., 0};
    shape_fraction(sphere_value, &sphere, x, 1., depth);
    ck_assert_int_le(sphere.calls, 18 << (DIM - 1) * depth);
    sphere.calls = 0;
    shape_fraction(sphere_value, &sphere, far, 1., depth);
    ck_assert_int_eq(sphere.calls, (1 << DIM) + 1);
  }
}
END_TEST

/* Corners are asked for about once in place of 2^DIM times. */
/* Halves of the cell see the plane and are cut at once. */
START_TEST(shape_fraction_calls_a_plane_hardly_ever) {
  struct plane plane = {{0.6, 0.3, 0.1}, 0.5, 0};
  const double centre[] = {0.5, 0.5, 0.5};
  const double c = shape_fraction(plane_value, &plane, centre, 1., 3);
  ck_assert(c > 0. && c < 1.);
  ck_assert_int_le(plane.calls, DIM == 2 ? 40 : 180);
}
END_TEST

START_TEST(shape_memory_gives_the_same_with_fewer_calls) {
  enum { N = DIM == 2 ? 64 : 16 };
  const double h = 1. / N;
  struct sphere sphere = {{0.4, 0.5, 0.6}, 0.3, 1, 0};
  struct shape_memory *memory = shape_memory_new(sphere_value, &sphere);
  long plain = 0, remembered = 0;
  for (int i = 0, n = DIM == 2 ? N * N : N * N * N; i < n; i++) {
    double x[DIM];
    for (int d = 0, rest = i; d < DIM; d++, rest /= N) {
      x[d] = (rest % N + 0.5) * h;
    }
    sphere.calls = 0;
    const double exact = shape_fraction(sphere_value, &sphere, x, h, 1);
    plain += sphere.calls, sphere.calls = 0;
    ck_assert(exact == shape_fraction(shape_memory_value, memory, x, h, 1));
    remembered += sphere.calls;
  }
  shape_memory_destroy(memory);
  ck_assert_int_le(remembered, plain / 2);
}
END_TEST

Suite *shapes_suite(void) {
  Suite *suite = suite_create("shapes");
  TCase *tcase = tcase_create("fraction");
  tcase_add_test(tcase, shape_fraction_of_a_plane_is_exact);
  tcase_add_test(tcase,
                 shape_fraction_does_not_depend_on_the_scale_of_the_level_set);
  tcase_add_test(tcase, shape_fraction_of_the_largest_values_is_right);
  tcase_add_test(tcase, shape_fraction_of_a_constant_is_its_sign);
  tcase_add_test(tcase, shape_fraction_of_a_box_on_cell_faces_is_exact);
  tcase_add_test(tcase, shape_fraction_is_0_where_the_level_set_is);
  tcase_add_test(tcase, shape_fraction_of_a_column_reaches_beyond_the_domain);
  tcase_add_test(tcase, shape_fraction_of_a_box_errs_at_corners_only);
  tcase_add_test(tcase, shape_fraction_of_a_sphere_converges_with_third_order);
  tcase_add_test(tcase, shape_fraction_sees_a_sphere_smaller_than_the_cell);
  tcase_add_test(tcase, shape_fraction_finds_a_ball_in_a_large_cell);
  tcase_add_test(tcase, shape_fraction_calls_the_level_set_sparingly);
  tcase_add_test(tcase, shape_fraction_calls_a_plane_hardly_ever);
  tcase_add_test(tcase, shape_memory_gives_the_same_with_fewer_calls);
  suite_add_tcase(suite, tcase);
  return suite;
}
