/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/depths.h"

#include <math.h>
#include <stdbool.h>

#include "talus/memory.h"
#include "talus/minmax.h"
#include "talus/params.h"

struct depths depths_new(double weight, double most,
                         double (*packed)(const void *context, double p),
                         const void *context) {
  enum { N = 4000 };
  struct depths depths = {N, most / N, MEM_NEW(double, N + 1)};
  const double pull = weight * depths.spacing;
  double p = 0;
  for (int k = 0; k <= N; k++) {
    depths.nu[k] = packed(context, p);
    const double half = p + 0.5 * pull * depths.nu[k];
    p += pull * packed(context, half);
  }
  return depths;
}

void depths_free(struct depths *depths) { mem_free(depths->nu); }

double depths_at(const struct depths *depths, double depth) {
  const double at = fmax(depth, 0) / depths->spacing;
  const int k = (int)fmin(at, depths->n - 1);
  return depths->nu[k] + (at - k) * (depths->nu[k + 1] - depths->nu[k]);
}

double depths_below(const struct params *params, int axis, double step,
                    const double x[3]) {
  const double up = params->gravity[axis] > 0 ? -1 : 1;
  const double most = params->size * params->trees[axis];
  const bool full = !params->shape.eval; /* to the wall */
  double at[3] = {x[0], x[1], x[2]};
  double inside = full ? most : 0, outside = full ? most : step;
  for (; outside < most; inside = outside, outside += step) {
    at[axis] = x[axis] + up * outside;
    if (!(params->shape.eval(params->shape.context, at) > 0)) break;
  }
  for (int k = 0; k < 40 && outside < most; k++) {
    const double middle = 0.5 * (inside + outside);
    at[axis] = x[axis] + up * middle;
    if (params->shape.eval(params->shape.context, at) > 0)
      inside = middle;
    else
      outside = middle;
  }
  const double wall = up > 0 ? params->origin[axis] + most - x[axis]
                             : x[axis] - params->origin[axis];
  return min2(inside, wall);
}

/* Return the height of the highest part of the column through x without a gap.
 */
static double column_height(const struct params *params, int axis,
                            const double x[3]) {
  enum { N = 256 };
  const double box = params->size * params->trees[axis];
  double at[3] = {x[0], x[1], x[2]};
  int inside = 0, most = 0;
  for (int k = 0; k < N; k++) {
    at[axis] = params->origin[axis] + (k + 0.5) * box / N;
    const bool in = !params->shape.eval ||
                    params->shape.eval(params->shape.context, at) > 0;
    inside = in ? inside + 1 : 0;
    if (inside > most) most = inside;
  }
  return most * box / N;
}

double depths_deepest(const struct params *params, int axis) {
  enum { N = 64 };
  double most = 0;
  const int other[2] = {(axis + 1) % params->dimension,
                        (axis + 2) % params->dimension};
  const int rows = params->dimension == 3 ? N : 1;
  for (int k = 0; k < N * rows; k++) {
    const int place[2] = {k % N, k / N};
    double x[3] = {0};
    for (int e = params->dimension - 2; e >= 0; e--) {
      const double box = params->size * params->trees[other[e]];
      x[other[e]] = params->origin[other[e]] + (place[e] + 0.5) * box / N;
    }
    most = max2(most, column_height(params, axis, x));
  }
  return most;
}
