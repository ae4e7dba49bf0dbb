/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Outlines of heaps of grains computed one by one, examples/reference/, and how
 * far another outline is from them. A file that cannot be read ends the case:
 * no bar is skipped. */
#ifndef TALUS_TESTS_OUTLINES_H
#define TALUS_TESTS_OUTLINES_H

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "talus/csv_row.h"
#include "talus/error.h"
#include "talus/outline.h"

/* Straight between its points, level before the first, 0 beyond the last. */
enum { CURVE_MOST = 1024 };
struct curve {
  int n;
  double x[CURVE_MOST], height[CURVE_MOST];
};

static inline void curve_add(struct curve *curve, double x, double height) {
  CHECK(curve->n < CURVE_MOST, "more than %d points", CURVE_MOST);
  curve->x[curve->n] = x;
  curve->height[curve->n++] = height;
}

static inline double curve_at(const struct curve *curve, double x) {
  int k = 0;
  if (x <= curve->x[0]) return curve->height[0];
  while (k + 1 < curve->n && curve->x[k + 1] < x) k++;
  if (k + 1 == curve->n) return 0;
  const double part = (x - curve->x[k]) / (curve->x[k + 1] - curve->x[k]);
  return curve->height[k] + part * (curve->height[k + 1] - curve->height[k]);
}

static inline void curve_of_outline(const struct outline *outline,
                                    struct curve *curve) {
  curve->n = 0;
  for (int k = 0; k < outline->n[0]; k++) {
    curve_add(curve, outline->first[0] + k * outline->spacing,
              outline->height[k]);
  }
}

static inline FILE *reference_open(const char *path) {
  FILE *file = fopen(path, "r");
  if (!file) FATAL("cannot read %s: start from the root of the checkout", path);
  return file;
}

/* Read from a file with a header `time,x,height` and a row per point. */
static inline void reference_read_rows(const char *path, double time,
                                       struct curve *curve) {
  FILE *file = reference_open(path);
  struct csv_row row = {0};
  double at, x, height;
  curve->n = 0;
  while (csv_row_read(file, &row)) {
    if (!csv_row_number(&row, 0, &at) || !csv_row_number(&row, 1, &x) ||
        !csv_row_number(&row, 2, &height) || fabs(at - time) >= 1e-9) {
      continue;
    }
    curve_add(curve, x, height);
  }
  csv_row_free(&row);
  fclose(file);
  CHECK(curve->n > 2, "%s has no outline at %g", path, time);
}

/* Read from a file with a header `x,t=0.66,...` and a row per x. */
static inline void reference_read_columns(const char *path, double time,
                                          struct curve *curve) {
  FILE *file = reference_open(path);
  struct csv_row row = {0};
  int column = 0;
  double x, height;
  curve->n = 0;
  while (csv_row_read(file, &row)) {
    for (int k = 1; k < row.n; k++) {
      const char *word = csv_row_cell(&row, k);
      if (strncmp(word, "t=", 2) != 0) continue;
      if (fabs(atof(word + 2) - time) < 1e-9) column = k;
    }
    if (column > 0 && csv_row_number(&row, 0, &x) &&
        csv_row_number(&row, column, &height)) {
      curve_add(curve, x, height);
    }
  }
  csv_row_free(&row);
  fclose(file);
  CHECK(curve->n > 2, "%s has no outline at %g", path, time);
}

/* Return the symmetric difference of two outlines over the area of the first,
 * the heights of the second scaled so that both have the same area:
 *   int |h - s r| dx / int h dx,   s = int h dx / int r dx. */
static inline double curve_difference(const struct curve *h,
                                      const struct curve *r) {
  enum { STEPS = 20000 };
  const double to = fmax(h->x[h->n - 1], r->x[r->n - 1]);
  double area[2] = {0}, apart = 0;
  for (int k = 0; k < STEPS; k++) {
    const double x = (k + 0.5) * to / STEPS;
    area[0] += curve_at(h, x), area[1] += curve_at(r, x);
  }
  for (int k = 0; k < STEPS; k++) {
    const double x = (k + 0.5) * to / STEPS;
    apart += fabs(curve_at(h, x) - area[0] / area[1] * curve_at(r, x));
  }
  return apart / area[0];
}

#endif
