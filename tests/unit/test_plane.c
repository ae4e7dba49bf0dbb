/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <check.h>
#include <math.h>
#include <stdint.h>

#include "random.h"
#include "talus/plane.h"

Suite *plane_suite(void);

enum { SAMPLES = 200000 };

/* Draw a normal with |n|_1 = 1, often with components that are 0, tiny or
 * equal. */
static void random_normal(uint64_t *state, double n[DIM]) {
  static const double scale[] = {1., 1.,    1.,    1.,     1.,    1e-4,
                                 0., 1e-14, 1e-16, 1e-300, 5e-324};
  double sum = 0.;
  while (sum < 1e-20) {
    sum = 0.;
    for (int d = 0; d < DIM; d++) {
      n[d] = (2. * uniform(state) - 1.) * scale[(int)(11. * uniform(state))];
      if (uniform(state) < 0.05) n[d] = 1.;
      sum += fabs(n[d]);
    }
  }
  for (int d = 0; d < DIM; d++) n[d] /= sum;
}

/* Draw an alpha whose plane cuts the cell, often within 1e-15 of a corner. */
static double random_alpha(uint64_t *state) {
  double a = 0.5 * uniform(state);
  if (uniform(state) < 0.3) a = 0.5 - exp(-35. * uniform(state));
  return uniform(state) < 0.5 ? a : -a;
}

START_TEST(plane_volume_of_cuts_done_by_hand) {
  double axis[DIM] = {0., -2.}, diagonal[DIM];
  for (int d = 0; d < DIM; d++) diagonal[d] = d == 0 ? -1. : 1.;
  ck_assert_double_eq_tol(plane_volume(axis, -0.5), 0.25, 1e-16);
  ck_assert_double_eq(plane_volume(axis, 1.1), 1.);
  ck_assert_double_eq(plane_volume(axis, -1.1), 0.);
  ck_assert_double_eq(plane_volume(diagonal, 0.), 0.5);
  /* a simplex of edge 1/2 at one corner: (1/2)^DIM/DIM! */
  double simplex = DIM == 2 ? 1. / 8. : 1. / 48.;
  double alpha = 0.5 - 0.5 * DIM;
  ck_assert_double_eq_tol(plane_volume(diagonal, alpha), simplex, 1e-16);
  ck_assert_double_eq_tol(plane_volume(diagonal, -alpha), 1. - simplex, 1e-15);
}
END_TEST

/* Return the volume by columns along the largest component, cut exactly;
 * midpoints across. */
static double volume_by_columns(const double n[DIM], double alpha, int points) {
  int main_axis = 0;
  for (int d = 1; d < DIM; d++)
    if (fabs(n[d]) > fabs(n[main_axis])) main_axis = d;
  double sum = 0.;
  int columns = DIM == 2 ? points : points * points;
  for (int i = 0; i < columns; i++) {
    double rest = alpha;
    for (int k = 1, index = i; k < DIM; k++, index /= points)
      rest -=
          n[(main_axis + k) % DIM] * ((index % points + 0.5) / points - 0.5);
    sum += fmin(fmax(rest / fabs(n[main_axis]) + 0.5, 0.), 1.);
  }
  return sum / columns;
}

START_TEST(plane_volume_equals_quadrature) {
  uint64_t state = 1;
  double error = 0.;
  for (int i = 0; i < 300; i++) {
    double n[DIM];
    random_normal(&state, n);
    double alpha = random_alpha(&state);
    raise_to(&error,
             fabs(plane_volume(n, alpha) - volume_by_columns(n, alpha, 100)));
  }
  /* kinks of the integrand: slope <= 1, so 1/(4 points^2) per crossed column */
  ck_assert_double_le(error, 1e-4);
}
END_TEST

START_TEST(plane_volume_and_its_complement_fill_the_cell) {
  uint64_t state = 2;
  double error = 0.;
  for (int i = 0; i < SAMPLES; i++) {
    double n[DIM], m[DIM];
    random_normal(&state, n);
    double alpha = random_alpha(&state);
    for (int d = 0; d < DIM; d++) m[d] = -n[d];
    double sum = plane_volume(n, alpha) + plane_volume(m, -alpha);
    raise_to(&error, fabs(sum - 1.));
  }
  ck_assert_double_le(error, 2.3e-16); /* one rounding */
}
END_TEST

START_TEST(plane_volume_grows_with_alpha) {
  uint64_t state = 3;
  double drop = 0.;
  for (int i = 0; i < SAMPLES / 100; i++) {
    double n[DIM], last = 0.;
    random_normal(&state, n);
    for (int k = -110; k <= 110; k++) {
      double v = plane_volume(n, 0.005 * k);
      raise_to(&drop, last - v);
      last = v;
    }
    ck_assert_double_eq(last, 1.);
  }
  ck_assert_double_eq(drop, 0.);
}
END_TEST

START_TEST(plane_volume_is_smooth_between_its_pieces) {
  /* V changes by at most DIM dalpha, also across a = m_d and a = m_1 + m_2 */
  uint64_t state = 4;
  double jump = 0.;
  for (int i = 0; i < SAMPLES / 10; i++) {
    double n[DIM];
    random_normal(&state, n);
    for (int mask = 1; mask < 1 << DIM; mask++) {
      double a = 0.;
      for (int d = 0; d < DIM; d++)
        if (mask >> d & 1) a += fabs(n[d]);
      double low = plane_volume(n, a - 0.5 - 1e-15);
      raise_to(&jump, fabs(plane_volume(n, a - 0.5 + 1e-15) - low));
    }
  }
  ck_assert_double_le(jump, DIM * 2e-15 + 1e-15);
}
END_TEST

START_TEST(plane_alpha_inverts_plane_volume) {
  uint64_t state = 5;
  double error = 0.;
  for (int i = 0; i < SAMPLES; i++) {
    double n[DIM], c = uniform(&state);
    random_normal(&state, n);
    if (i % 3 == 0) c = exp(-40. * c);
    if (i % 5 == 0) c = 1. - c;
    raise_to(&error, fabs(plane_volume(n, plane_alpha(n, c)) - c));
    c = plane_volume(n, random_alpha(&state));
    raise_to(&error, fabs(plane_volume(n, plane_alpha(n, c)) - c));
  }
  ck_assert_double_le(error, 1e-15); /* seen: 3.1e-16 */
}
END_TEST

START_TEST(plane_alpha_of_empty_and_full_is_at_the_corner) {
  double n[DIM] = {-3., 1.};
  double c[] = {-1., 0., 1., 2.}, alpha[] = {-2., -2., 2., 2.};
  for (int i = 0; i < 4; i++)
    ck_assert_double_eq(plane_alpha(n, c[i]), alpha[i]);
}
END_TEST

START_TEST(plane_functions_ignore_the_length_of_the_normal) {
  uint64_t state = 6;
  double error = 0.;
  for (int i = 0; i < SAMPLES / 10; i++) {
    double n[DIM], m[DIM], length = exp(200. * uniform(&state) - 100.);
    random_normal(&state, n);
    double alpha = random_alpha(&state), c = uniform(&state);
    for (int d = 0; d < DIM; d++) m[d] = length * n[d];
    double v = plane_volume(m, length * alpha) - plane_volume(n, alpha);
    double a = plane_alpha(m, c) / length - plane_alpha(n, c);
    raise_to(&error, fmax(fabs(v), fabs(a)));
  }
  ck_assert_double_le(error, 2e-15);
}
END_TEST

START_TEST(plane_volumes_of_children_add_up_to_the_parents) {
  uint64_t state = 7;
  double error = 0.;
  for (int i = 0; i < SAMPLES; i++) {
    double n[DIM], sum = 0.;
    random_normal(&state, n);
    double alpha = random_alpha(&state);
    for (int child = 0; child < 1 << DIM; child++) {
      double lo[DIM], hi[DIM];
      for (int d = 0; d < DIM; d++) {
        lo[d] = (child >> d & 1) ? 0. : -0.5;
        hi[d] = lo[d] + 0.5;
      }
      sum += plane_box_volume(n, alpha, lo, hi);
    }
    raise_to(&error, fabs(sum / (1 << DIM) - plane_volume(n, alpha)));
  }
  ck_assert_double_le(error, 1e-15); /* seen: 4.4e-16 */
}
END_TEST

START_TEST(plane_volumes_on_both_sides_of_a_slice_add_up) {
  /* the donor's flux volume and what stays behind, down to slices of 1e-14 */
  uint64_t state = 8;
  double error = 0.;
  for (int i = 0; i < SAMPLES; i++) {
    double n[DIM], lo[DIM], hi[DIM], whole;
    random_normal(&state, n);
    double alpha = random_alpha(&state), width = exp(-32. * uniform(&state));
    for (int d = 0; d < DIM; d++) lo[d] = -0.5, hi[d] = 0.5;
    int d = i % DIM;
    whole = plane_volume(n, alpha);
    hi[d] = lo[d] + width;
    double left = plane_box_volume(n, alpha, lo, hi) * (hi[d] - lo[d]);
    lo[d] = hi[d], hi[d] = 0.5;
    double right = plane_box_volume(n, alpha, lo, hi) * (hi[d] - lo[d]);
    raise_to(&error, fabs(left + right - whole));
  }
  ck_assert_double_le(error, 1e-15);
}
END_TEST

START_TEST(plane_zero_normal_is_an_even_fog) {
  double n[DIM] = {0.}, x[DIM], lo[DIM], hi[DIM];
  for (int d = 0; d < DIM; d++) lo[d] = 0.1 * d, hi[d] = 0.4;
  double alpha = plane_alpha(n, 0.3);
  ck_assert_double_eq_tol(plane_volume(n, alpha), 0.3, 1e-16);
  ck_assert_double_eq_tol(plane_box_volume(n, alpha, lo, hi), 0.3, 1e-16);
  plane_foot(n, alpha, x);
  for (int d = 0; d < DIM; d++) ck_assert_double_eq(x[d], 0.);
}
END_TEST

START_TEST(plane_foot_is_the_nearest_point_of_the_plane) {
  uint64_t state = 10;
  double off_plane = 0., across = 0., outside = 0.;
  for (int i = 0; i < SAMPLES; i++) {
    double n[DIM], x[DIM], dot = 0.;
    random_normal(&state, n);
    double alpha = random_alpha(&state);
    plane_foot(n, alpha, x);
    for (int d = 0; d < DIM; d++) {
      int e = (d + 1) % DIM;
      dot += n[d] * x[d];
      raise_to(&across, fabs(n[d] * x[e] - n[e] * x[d]));
      raise_to(&outside, fabs(x[d]) - 0.5);
    }
    raise_to(&off_plane, fabs(dot - alpha));
  }
  ck_assert_double_le(off_plane, 1e-15);
  ck_assert_double_le(across, 1e-15);
  ck_assert_double_le(outside, DIM == 2 ? 0.11 : 0.19);
}
END_TEST

Suite *plane_suite(void) {
  Suite *suite = suite_create("plane");
  TCase *volume = tcase_create("volume");
  tcase_add_test(volume, plane_volume_of_cuts_done_by_hand);
  tcase_add_test(volume, plane_volume_equals_quadrature);
  tcase_add_test(volume, plane_volume_and_its_complement_fill_the_cell);
  tcase_add_test(volume, plane_volume_grows_with_alpha);
  tcase_add_test(volume, plane_volume_is_smooth_between_its_pieces);
  tcase_add_test(volume, plane_alpha_inverts_plane_volume);
  tcase_add_test(volume, plane_alpha_of_empty_and_full_is_at_the_corner);
  tcase_add_test(volume, plane_functions_ignore_the_length_of_the_normal);
  tcase_add_test(volume, plane_volumes_of_children_add_up_to_the_parents);
  tcase_add_test(volume, plane_volumes_on_both_sides_of_a_slice_add_up);
  tcase_add_test(volume, plane_zero_normal_is_an_even_fog);
  suite_add_tcase(suite, volume);
  TCase *foot = tcase_create("foot");
  tcase_add_test(foot, plane_foot_is_the_nearest_point_of_the_plane);
  suite_add_tcase(suite, foot);
  return suite;
}
