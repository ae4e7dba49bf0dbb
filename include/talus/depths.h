/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Depths: grains at rest whose pressure carries their weight, integrated down
 * from the surface of a shape,
 *   dp/dz = -w nu(p),
 * w the weight of grains that fill their volume, less buoyancy. */
#ifndef TALUS_DEPTHS_H
#define TALUS_DEPTHS_H

struct params;

/* Solid fraction over the depth below the surface, every `spacing` m. */
struct depths {
  int n;
  double spacing, *nu; /* [n + 1], owned */
};

/* Integrate to a depth `most` by the midpoint rule; packed returns nu(p) of a
 * context, p >= 0. */
struct depths depths_new(double weight, double most,
                         double (*packed)(const void *context, double p),
                         const void *context);
void depths_free(struct depths *depths);
/* Return nu at a depth, m. */
double depths_at(const struct depths *depths, double depth);

/* Find how far the shape of the case reaches from x along the vertical axis,
 * against gravity, in steps of `step` and then by halving, m. A shape that
 * reaches the side of the box ends there; grains without a shape fill the box.
 */
double depths_below(const struct params *params, int axis, double step,
                    const double x[3]);

/* Return the height of the highest column of the shape, from 64 columns along
 * each horizontal axis and 256 points of each, m. */
double depths_deepest(const struct params *params, int axis);

#endif
