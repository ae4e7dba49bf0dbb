/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/side_map.h"

#include <check.h>
#include <math.h>
#include <stdlib.h>

Suite *side_map_suite(void);

/* Sides [-1, 1] and [-1, 1] x [-1, 0], of two trees along the first axis. */
enum { LEVEL = 5, WALL = 3, SLOT = 7, HOLE = 8 };
static const double kH = 1.0 / (1 << LEVEL);

struct figure {
  double low, high; /* of the slot along the first axis */
  double bottom;    /* and of a rectangle along the second */
  double x, y, radius;
  int calls;
};

static int select_slot(void *context, const double t[2]) {
  struct figure *figure = context;
  figure->calls++;
  if (t[0] > figure->low && t[0] < figure->high && t[1] >= figure->bottom) {
    return SLOT;
  }
  return hypot(t[0] - figure->x, t[1] - figure->y) < figure->radius ? HOLE
                                                                    : WALL;
}

static struct side_map *map_new(int naxes, int level, struct figure *figure) {
  const struct side_map_layout layout = {.naxes = naxes,
                                         .size = 1,
                                         .origin = {-1, -1},
                                         .trees = {2, 1},
                                         .level = level,
                                         .select = select_slot,
                                         .context = figure};
  return side_map_new(&layout);
}

static double part_of(const struct side_map *map, double t, double h) {
  double part[SIDE_MAP_MOST];
  const double at[2] = {t};
  side_map_parts(map, at, h, part);
  return part[SLOT];
}

START_TEST(parts_of_a_slot_are_exact_on_faces_of_any_level) {
  struct figure figure = {.low = -0.3137, .high = 0.2711, .bottom = -9};
  struct side_map *map = map_new(1, LEVEL, &figure);
  for (double h = 1; h >= kH; h /= 2) {
    double sum = 0;
    for (double t = -1 + h / 2; t < 1; t += h) {
      const double lo = fmax(t - h / 2, figure.low);
      const double hi = fmin(t + h / 2, figure.high);
      const double part = part_of(map, t, h);
      ck_assert_double_eq_tol(part, fmax(0, hi - lo) / h, 1e-6);
      sum += part * h;
    }
    ck_assert_double_eq_tol(sum, figure.high - figure.low, 1e-7);
  }
  ck_assert_double_eq_tol(side_map_covered(map)[SLOT], 0.5848, 1e-7);
  ck_assert_double_eq_tol(side_map_covered(map)[WALL], 2 - 0.5848, 1e-7);
  side_map_destroy(map);
}
END_TEST

START_TEST(slot_that_ends_at_faces_is_whole_faces) {
  struct figure figure = {.low = -4 * kH, .high = 3 * kH, .bottom = -9};
  struct side_map *map = map_new(1, LEVEL, &figure);
  double part[SIDE_MAP_MOST], taken[SIDE_MAP_MOST];
  for (int k = -32; k < 32; k++) {
    const double t[2] = {(k + 0.5) * kH};
    const int expected = k >= -4 && k < 3 ? SLOT : WALL;
    ck_assert_int_eq(side_map_parts(map, t, kH, part), expected);
  }
  side_map_taken(map, 0, taken);
  ck_assert_double_eq_tol(taken[SLOT], 7 * kH, 1e-12);
  side_map_destroy(map);
}
END_TEST

/* 3.4 faces, of which the outer ones are covered by 0.3 and 0.1. */
START_TEST(face_goes_to_its_centre_or_to_the_weighted) {
  struct figure figure = {.low = -0.3 * kH, .high = 3.1 * kH, .bottom = -9};
  struct side_map *map = map_new(1, LEVEL, &figure);
  const double first[2] = {-0.5 * kH}, last[2] = {3.5 * kH}, in[2] = {kH / 2};
  double taken[SIDE_MAP_MOST];
  ck_assert_int_eq(side_map_owner(map, first, kH, 0), WALL);
  ck_assert_int_eq(side_map_owner(map, first, kH, 1 << SLOT), SLOT);
  ck_assert_int_eq(side_map_owner(map, last, kH, 1 << SLOT), SLOT);
  ck_assert_int_eq(side_map_owner(map, in, kH, 0), SLOT);
  side_map_taken(map, 0, taken);
  ck_assert_double_eq_tol(taken[SLOT], 3 * kH, 1e-12);
  side_map_taken(map, 1 << SLOT, taken);
  ck_assert_double_eq_tol(taken[SLOT], 5 * kH, 1e-12);
  side_map_destroy(map);
}
END_TEST

START_TEST(slot_inside_a_face_is_seen_and_takes_none) {
  struct figure figure = {.low = 0.1 * kH, .high = 0.3 * kH, .bottom = -9};
  struct side_map *map = map_new(1, LEVEL, &figure);
  double taken[SIDE_MAP_MOST];
  side_map_taken(map, 0, taken);
  ck_assert_uint_eq(side_map_seen(map), 1u << SLOT | 1u << WALL);
  ck_assert_double_eq_tol(side_map_covered(map)[SLOT], 0.2 * kH, 1e-7 * kH);
  ck_assert_double_eq(taken[SLOT], 0);
  side_map_destroy(map);
}
END_TEST

START_TEST(what_is_on_the_border_alone_is_not_seen) {
  struct figure figure = {.low = 1 - 1e-12, .high = 2, .bottom = -9};
  struct side_map *map = map_new(1, LEVEL, &figure);
  ck_assert_uint_eq(side_map_seen(map), 1u << WALL);
  side_map_destroy(map);
}
END_TEST

START_TEST(areas_of_rectangle_and_disc_are_known) {
  struct figure figure = {.low = -0.731,
                          .high = -0.2507,
                          .bottom = -0.3141,
                          .x = 0.41,
                          .y = -0.53,
                          .radius = 0.2013};
  struct side_map *map = map_new(2, LEVEL, &figure);
  const double *covered = side_map_covered(map), pi = acos(-1);
  const double rectangle = (0.731 - 0.2507) * 0.3141;
  const double disc = pi * figure.radius * figure.radius;
  double sum = 0, part[SIDE_MAP_MOST];
  ck_assert_double_eq_tol(covered[SLOT] / rectangle, 1, 2e-5);
  ck_assert_double_eq_tol(covered[HOLE] / disc, 1, 1e-4);
  ck_assert_double_eq_tol(covered[SLOT] + covered[HOLE] + covered[WALL], 2,
                          1e-12);
  for (double x = -0.875; x < 1; x += 0.25) { /* on coarse faces as well */
    for (double y = -0.875; y < 0; y += 0.25) {
      side_map_parts(map, (double[2]){x, y}, 0.25, part);
      sum += part[HOLE] / 16;
    }
  }
  ck_assert_double_eq_tol(sum, covered[HOLE], 1e-12);
  side_map_destroy(map);
}
END_TEST

START_TEST(box_lists_what_is_in_it) {
  struct figure figure = {.low = -0.3, .high = -0.2, .bottom = -9};
  struct side_map *map = map_new(1, LEVEL, &figure);
  const uint32_t wall = 1u << WALL, slot = 1u << SLOT;
  const double at[] = {-1, -0.32, -0.3, -0.25, -0.19, 0, 1};
  const uint32_t expected[] = {wall,        wall | slot, slot,
                               wall | slot, wall,        wall};
  for (int k = 0; k < 6; k++) {
    const double lo[2] = {at[k]}, hi[2] = {at[k + 1]};
    /* to the face: a part of one is taken for all of it */
    if (k == 2) continue;
    ck_assert_uint_eq(side_map_within(map, lo, hi) & expected[k], expected[k]);
    ck_assert_uint_eq(side_map_within(map, lo, hi) & ~(wall | slot), 0);
    if (k == 0 || k == 5) {
      ck_assert_uint_eq(side_map_within(map, lo, hi), wall);
    }
  }
  side_map_destroy(map);
}
END_TEST

/* Level 20 of two trees has two million faces: asked about 3e5 times. */
START_TEST(deep_grid_costs_no_more_calls_than_there_is_room_for) {
  struct figure figure = {.low = -0.25, .high = 0.123456, .bottom = -9};
  struct side_map *map = map_new(1, 20, &figure);
  ck_assert_double_eq_tol(side_map_covered(map)[SLOT], 0.373456, 1e-12);
  ck_assert_int_le(figure.calls, 600000);
  side_map_destroy(map);
}
END_TEST

static int select_noise(void *context, const double t[2]) {
  unsigned *seed = context;
  (void)t;
  *seed = *seed * 1103515245u + 12345u;
  return *seed >> 16 & 1 ? SLOT : WALL;
}

START_TEST(function_without_order_ends) {
  unsigned seed = 1;
  for (int naxes = 1; naxes <= 2; naxes++) {
    const struct side_map_layout layout = {.naxes = naxes,
                                           .size = 1,
                                           .trees = {1, 1},
                                           .level = 9 - naxes,
                                           .select = select_noise,
                                           .context = &seed};
    struct side_map *map = side_map_new(&layout);
    ck_assert_double_eq_tol(side_map_covered(map)[SLOT], 0.5, 0.1);
    side_map_destroy(map);
  }
}
END_TEST

Suite *side_map_suite(void) {
  Suite *suite = suite_create("side_map");
  TCase *tcase = tcase_create("side_map");
  tcase_add_test(tcase, parts_of_a_slot_are_exact_on_faces_of_any_level);
  tcase_add_test(tcase, slot_that_ends_at_faces_is_whole_faces);
  tcase_add_test(tcase, face_goes_to_its_centre_or_to_the_weighted);
  tcase_add_test(tcase, slot_inside_a_face_is_seen_and_takes_none);
  tcase_add_test(tcase, what_is_on_the_border_alone_is_not_seen);
  tcase_add_test(tcase, areas_of_rectangle_and_disc_are_known);
  tcase_add_test(tcase, box_lists_what_is_in_it);
  tcase_add_test(tcase, deep_grid_costs_no_more_calls_than_there_is_room_for);
  tcase_add_test(tcase, function_without_order_ends);
  suite_add_tcase(suite, tcase);
  return suite;
}
