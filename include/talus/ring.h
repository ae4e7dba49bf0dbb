/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Planes that cut a ring: plane.h in axisymmetric coordinates, where a cell of
 * edge h with its centre at the radius r is a ring, and the volume of a part of
 * it that of the body which the part sweeps once around the axis. Pure
 * functions.
 *
 * Lengths are in cell widths, as in plane.h, and axis 0 points away from the
 * axis. At x the radius is r (1 + 2 k x_0), with the slant k = h/(2r); so the
 * part of a ring in n.x <= alpha is
 *
 *   V = int_cut (1 + 2 k x_0) dx_0 dx_1,   -1 <= k <= 1,                  (1)
 *
 * and k = 0 gives plane.h to the last bit. The width of the cut along x_1 is
 * linear in x_0 between two corners and constant outside, so that (1) is a sum
 * of two such integrals, good to a few 1e-16. Beyond the axis, r and k are
 * negative, and what is there is the mirror image. In three dimensions k is 0.
 */
#ifndef TALUS_RING_H
#define TALUS_RING_H

/* Return (1), 0 to 1. */
double ring_volume(const double n[DIM], double alpha, double slant);
/* Return the alpha for which ring_volume is c, to 1e-15; c is cut to [0, 1]. */
double ring_alpha(const double n[DIM], double c, double slant);
/* Return the part of the box lo <= x <= hi of the ring with n.x <= alpha, by
 * volume. */
double ring_box_volume(const double n[DIM], double alpha, const double lo[DIM],
                       const double hi[DIM], double slant);

#endif
