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
