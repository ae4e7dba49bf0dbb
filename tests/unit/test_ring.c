/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/ring.h"

#include <check.h>
#include <math.h>
#include <string.h>

#include "random.h"
#include "talus/plane.h"
#include "talus/shapes.h"

enum { SAMPLES = 2000 };

/* A plane and a slant; every fifth plane lies along an axis. */
struct sample {
  double n[DIM], alpha, slant;
};

static struct sample draw(uint64_t *state, int k) {
  struct sample s = {.slant = 2 * uniform(state) - 1};
  double norm = 0;
  if (k % 7 == 0) s.slant = k % 2 ? 1 : -1;
  for (int d = 0; d < DIM; d++) s.n[d] = 2 * uniform(state) - 1;
  if (k % 5 == 0) s.n[k % 2] = k % 3 ? 0 : 1e-14;
  for (int d = 0; d < DIM; d++) norm += fabs(s.n[d]);
  for (int d = 0; d < DIM; d++) s.n[d] /= norm;
  s.alpha = uniform(state) - 0.5;
  return s;
}

/* Sum the volume over thin strips along z, each cut by plane.h. */
static double strips(const struct sample *s) {
  enum { N = 400 };
  double sum = 0;
  for (int k = 0; k < N; k++) {
    double lo[DIM], hi[DIM];
    for (int d = 0; d < DIM; d++) lo[d] = -0.5, hi[d] = 0.5;
    lo[0] = (double)k / N - 0.5, hi[0] = lo[0] + 1. / N;
    sum += plane_box_volume(s->n, s->alpha, lo, hi) *
           (1 + s->slant * (lo[0] + hi[0])) / N;
  }
  return sum;
}

START_TEST(the_volume_is_that_of_its_strips) {
  uint64_t state = 1;
  double error = 0;
  for (int k = 0; k < SAMPLES / 10; k++) {
    const struct sample s = draw(&state, k);
    raise_to(&error, fabs(ring_volume(s.n, s.alpha, s.slant) - strips(&s)));
  }
  /* a strip of width w that is cut has its centre wrong by w, half of w^2 */
  ck_assert_double_le(error, DIM == 2 ? 1e-5 : 1);
}
END_TEST

START_TEST(the_offset_inverts_the_volume) {
  uint64_t state = 2;
  double error = 0, beyond = 0;
  for (int k = 0; k < SAMPLES; k++) {
    const struct sample s = draw(&state, k);
    const double c = k % 3 ? uniform(&state) : pow(10, -12 * uniform(&state));
    const double alpha = ring_alpha(s.n, c, s.slant);
    raise_to(&error, fabs(ring_volume(s.n, alpha, s.slant) - c));
    raise_to(&beyond, fabs(alpha));
  }
  ck_assert_double_le(error, 1e-15);
  ck_assert_double_le(beyond, 0.5 + 1e-15);
}
END_TEST

START_TEST(both_sides_of_a_plane_fill_the_ring) {
  uint64_t state = 3;
  double error = 0;
  for (int k = 0; k < SAMPLES; k++) {
    const struct sample s = draw(&state, k);
    double other[DIM];
    for (int d = 0; d < DIM; d++) other[d] = -s.n[d];
    const double sum = ring_volume(s.n, s.alpha, s.slant) +
                       ring_volume(other, -s.alpha, s.slant);
    raise_to(&error, fabs(sum - 1));
  }
  ck_assert_double_le(error, 1e-15);
}
END_TEST

/* Cut the ring into four boxes anywhere. */
START_TEST(boxes_that_tile_a_ring_hold_what_it_holds) {
  uint64_t state = 4;
  double error = 0;
  for (int k = 0; k < SAMPLES; k++) {
    const struct sample s = draw(&state, k);
    double at[2] = {uniform(&state) - 0.5, uniform(&state) - 0.5}, sum = 0;
    for (int c = 0; c < 4; c++) {
      double lo[DIM], hi[DIM], weight = 1;
      for (int d = 0; d < DIM; d++) lo[d] = -0.5, hi[d] = 0.5;
      for (int d = 0; d < 2; d++) *(c >> d & 1 ? &lo[d] : &hi[d]) = at[d];
      for (int d = 0; d < 2; d++) weight *= hi[d] - lo[d];
      if (DIM == 2) weight *= 1 + s.slant * (lo[0] + hi[0]);
      sum += weight * ring_box_volume(s.n, s.alpha, lo, hi, s.slant);
    }
    raise_to(&error, fabs(sum - ring_volume(s.n, s.alpha, s.slant)));
  }
  ck_assert_double_le(error, 2e-15);
}
END_TEST

/* A cylinder of the radius r in the cell at the axis, edge 1: c = r^2. */
START_TEST(a_cylinder_around_the_axis_has_its_volume) {
  const double n[3] = {1};
  if (DIM == 3) return;
  for (double r = 0.1; r < 1; r += 0.1) {
    ck_assert_double_eq_tol(ring_volume(n, r - 0.5, 1), r * r, 1e-15);
    ck_assert_double_eq_tol(ring_alpha(n, r * r, 1), r - 0.5, 1e-15);
  }
}
END_TEST

START_TEST(without_a_slant_it_is_the_plane) {
  uint64_t state = 5;
  for (int k = 0; k < SAMPLES; k++) {
    const struct sample s = draw(&state, k);
    const double c = uniform(&state);
    const double ours[] = {ring_volume(s.n, s.alpha, 0), ring_alpha(s.n, c, 0)};
    const double plane[] = {plane_volume(s.n, s.alpha), plane_alpha(s.n, c)};
    ck_assert_int_eq(memcmp(ours, plane, sizeof ours), 0);
  }
}
END_TEST

static double ball(void *context, const double x[3]) {
  return *(const double *)context - hypot(x[0], x[1] - 0.3);
}

/* The ball of radius 0.37 on 16 cells to a unit: 4/3 pi R^3, at the accuracy of
 * shapes.h, 0.3 (H/R)^3 with H = 1/128. */
START_TEST(a_ball_has_its_volume) {
  enum { N = 16 };
  double radius = 0.37, sum = 0;
  if (DIM == 3) return;
  for (int j = 0; j < N; j++) {
    for (int i = 0; i < N; i++) {
      const double x[3] = {(i + 0.5) / N, (j + 0.5) / N - 0.2};
      sum += 6.283185307179586 * x[0] / N / N *
             shape_ring_fraction(ball, &radius, x, 1. / N, 3);
    }
  }
  const double exact = 4.1887902047863905 * pow(radius, 3);
  ck_assert_double_eq_tol(sum / exact, 1, 3e-6);
}
END_TEST

Suite *ring_suite(void);
Suite *ring_suite(void) {
  Suite *suite = suite_create("ring");
  TCase *tcase = tcase_create("cut");
  tcase_add_test(tcase, the_volume_is_that_of_its_strips);
  tcase_add_test(tcase, the_offset_inverts_the_volume);
  tcase_add_test(tcase, both_sides_of_a_plane_fill_the_ring);
  tcase_add_test(tcase, boxes_that_tile_a_ring_hold_what_it_holds);
  tcase_add_test(tcase, a_cylinder_around_the_axis_has_its_volume);
  tcase_add_test(tcase, without_a_slant_it_is_the_plane);
  tcase_add_test(tcase, a_ball_has_its_volume);
  suite_add_tcase(suite, tcase);
  return suite;
}
