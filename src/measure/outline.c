/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/outline.h"

#include <math.h>
#include <mpi.h>
#include <stdint.h>

#include "talus/error.h"
#include "talus/forest.h"
#include "talus/memory.h"
#include "talus/mesh.h"
#include "talus/minmax.h"

int outline_axis(const double gravity[DIM]) {
  int axis = DIM - 1, count = 0;
  for (int d = 0; d < DIM; d++) {
    if (gravity[d] == 0) continue;
    axis = d;
    count++;
  }
  return count == 1 ? axis : DIM - 1;
}

/* Return the level of the columns: the finest one that is not too many of them.
 */
static int column_level(const struct mesh *mesh, const int horizontal[2]) {
  const int *trees = forest_layout(mesh->forest)->trees;
  int level = mesh->level_finest;
  for (;; level--) {
    double n = 1;
    for (int k = 0; k < DIM - 1; k++) n *= ldexp(trees[horizontal[k]], level);
    if (n <= 0x1p24 || level == 0) break;
    WARN_ONCE(
        "more than 2^24 columns at level %d, outlines are taken at a coarser "
        "one",
        level);
  }
  return level;
}

/* Add the height of one leaf to the columns that the leaf covers, or a share of
 * it where one column covers the leaf. */
static void add_leaf(const struct mesh *mesh, const int horizontal[2],
                     int32_t i, double c, struct outline *outline) {
  int begin[2] = {0, 0}, end[2] = {1, 1};
  double height = c * mesh->h[i];
  for (int k = 0; k < DIM - 1; k++) {
    double lower = mesh->x[i][horizontal[k]] - 0.5 * mesh->h[i];
    double side = outline->first[k] - 0.5 * outline->spacing;
    /* the half of a finest leaf keeps round-off out of the floor */
    double place = (lower - side) / outline->spacing;
    double width = mesh->h[i] / outline->spacing;
    begin[k] = (int)floor(place + 0.5 * min2(width, 1));
    end[k] = begin[k] + (width > 1 ? (int)lround(width) : 1);
    height *= min2(width, 1);
    if (outline->rings && width < 1) /* a share of a wider ring */
      height *=
          mesh->x[i][0] / (outline->first[0] + begin[0] * outline->spacing);
  }
  for (int b = begin[1]; b < end[1]; b++)
    for (int a = begin[0]; a < end[0]; a++)
      outline->height[(int64_t)b * outline->n[0] + a] += height;
}

void outline_measure(const struct mesh *mesh, const double *c, const bool *heap,
                     int axis, struct outline *outline) {
  const struct forest_layout *layout = forest_layout(mesh->forest);
  int horizontal[2] = {0, 0};
  for (int d = 0, k = 0; d < DIM; d++)
    if (d != axis) horizontal[k++] = d;
  int level = column_level(mesh, horizontal);
  *outline = (struct outline){.n = {1, 1}};
  outline->rings = mesh_is_axisymmetric(mesh);
  outline->spacing = ldexp(layout->size, -level);
  for (int k = 0; k < DIM - 1; k++) {
    outline->n[k] = layout->trees[horizontal[k]] << level;
    outline->first[k] = layout->origin[horizontal[k]] + 0.5 * outline->spacing;
  }
  int count = outline->n[0] * outline->n[1];
  outline->height = MEM_NEW(double, (size_t)count);
  for (int32_t i = 0; i < mesh->nleaves; i++)
    if (heap[i]) add_leaf(mesh, horizontal, i, c[i], outline);
  MPI_CHECK(MPI_Allreduce(MPI_IN_PLACE, outline->height, count, MPI_DOUBLE,
                          MPI_SUM, mesh->comm));
}

void outline_free(struct outline *outline) {
  mem_free(outline->height);
  outline->height = NULL;
}

double outline_height(const struct outline *outline) {
  double height = 0;
  for (int k = 0; k < outline->n[0] * outline->n[1]; k++)
    height = max2(height, outline->height[k]);
  return height;
}

/* Return the height at which a heap of this largest height ends. */
static double end_height(const struct outline *o, double end, double height) {
  return min2(end > 0 ? end : 0.5 * o->spacing, 0.5 * height);
}

/* Find where the heap ends, in columns from the centre of column 0, walking
 * from `start` in steps of +1 or -1 over heights h [n]. */
static double walk(int n, const double *h, double threshold, int start,
                   int step) {
  for (int k = start; k + step >= 0 && k + step < n; k += step)
    if (h[k + step] <= threshold)
      return k + step * (h[k] - threshold) / (h[k] - h[k + step]);
  return step > 0 ? n - 0.5 : -0.5;
}

static int tallest(int n, const double *h) {
  int best = 0;
  for (int k = 1; k < n; k++)
    if (h[k] > h[best]) best = k;
  return best;
}

static double front_2d(const struct outline *o, double end) {
  const int n = o->n[0];
  const double threshold = end_height(o, end, outline_height(o));
  const double *h = o->height;
  int start = tallest(n, h);
  if (h[start] <= 0) return o->first[0] - 0.5 * o->spacing;
  double upper = walk(n, h, threshold, start, 1);
  if (o->rings) return o->first[0] + o->spacing * upper;
  double lower = walk(n, h, threshold, start, -1);
  double mass = 0, moment = 0;
  for (int k = 0; k < n; k++) {
    mass += h[k];
    moment += k * h[k];
  }
  double centre = moment / mass;
  bool leans_lower = h[0] > threshold, leans_upper = h[n - 1] > threshold;
  bool take_lower = leans_lower   ? false
                    : leans_upper ? true
                                  : centre - lower > upper - centre + 1;
  return o->first[0] + o->spacing * (take_lower ? lower : upper);
}

/* Find the largest height in the first and in the last row across axis k, and
 * the centre of the heap along it, in columns. */
static void lean(const struct outline *o, int k, double *first, double *last,
                 double *centre) {
  double mass = 0, moment = 0;
  *first = *last = 0;
  for (int j = 0; j < o->n[1]; j++) {
    for (int i = 0; i < o->n[0]; i++) {
      double h = o->height[(int64_t)j * o->n[0] + i];
      int place = k == 0 ? i : j;
      if (place == 0) *first = max2(*first, h);
      if (place == o->n[k] - 1) *last = max2(*last, h);
      mass += h;
      moment += place * h;
    }
  }
  *centre = mass > 0 ? moment / mass : 0;
}

/* Find the axis of the rings, in columns, and which directions count in the
 * radius. */
static void find_axis(const struct outline *o, double threshold, double axis[2],
                      double weight[2]) {
  for (int k = 0; k < 2; k++) {
    double first, last, centre;
    lean(o, k, &first, &last, &centre);
    bool lower = first > threshold, upper = last > threshold;
    weight[k] = lower && upper ? 0 : 1;
    axis[k] = lower ? -0.5 : upper ? o->n[k] - 0.5 : centre;
  }
  if (weight[0] == 0 && weight[1] == 0) weight[0] = weight[1] = 1;
}

static double front_3d(const struct outline *o, double end) {
  double axis[2], weight[2];
  find_axis(o, end_height(o, end, outline_height(o)), axis, weight);
  int n = (int)hypot(weight[0] * o->n[0], weight[1] * o->n[1]) + 2;
  double *mean = MEM_NEW(double, (size_t)n),
         *count = MEM_NEW(double, (size_t)n);
  for (int j = 0; j < o->n[1]; j++) {
    for (int i = 0; i < o->n[0]; i++) {
      int ring =
          (int)hypot(weight[0] * (i - axis[0]), weight[1] * (j - axis[1]));
      mean[ring] += o->height[(int64_t)j * o->n[0] + i];
      count[ring]++;
    }
  }
  for (int k = 0; k < n; k++) /* a ring may slip between the centres */
    mean[k] = count[k] > 0 ? mean[k] / count[k] : k > 0 ? mean[k - 1] : 0;
  while (n > 1 && count[n - 1] == 0) n--; /* outside the box */
  double front = 0;
  int start = tallest(n, mean);
  const double threshold = end_height(o, end, mean[start]);
  if (mean[start] > 0)
    front = o->spacing * (walk(n, mean, threshold, start, 1) + 0.5);
  mem_free(mean);
  mem_free(count);
  return front;
}

double outline_front(const struct outline *outline, double end) {
  return DIM == 2 ? front_2d(outline, end) : front_3d(outline, end);
}
