/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Volume fractions of a shape given by a level set. Pure functions.
 *
 * A shape is the set f(x) > 0 of a function of position. The fraction of a
 * cell that it fills,
 *
 *   c = 1/h^DIM  integral over the cell of H(f) dV,                      (1)
 *
 * with H the Heaviside function, is found by halving the cell `depth` times
 * where the surface f = 0 may pass, and cutting each smallest piece by the
 * plane f0 + g . (x - x_centre) = 0. g comes from the vertices, and
 *
 *   f0 = 2/3 f(centre) + 1/3 mean of f over the vertices                 (2)
 *
 * is the mean of f over the piece up to third derivatives, so that the
 * curvature of the surface is felt although the cut is plane.
 *
 * f need not be a distance, and its scale does not matter. A cell counts as all
 * in or all out when f has one sign at its vertices and centre, and f at the
 * centre is at least 1.5 times the change from there to any vertex: what f
 * hides from these points (a thread thinner than the cell in a function that is
 * flat elsewhere) is not seen. f = 0 is outside, over a volume too, so that a
 * function may be cut off there, max(0, f), or be 1 inside and 0 outside, which
 * is wrong by the smallest pieces that the surface cuts; a piece with f = 0 all
 * over is halved six times at most. Where two halvings or fewer are left and f
 * is a plane on the lattice of half-edges, to 1e-11 of its change, the piece is
 * cut at once.
 *
 * Accuracy of c, with H = h 2^-depth the edge of the smallest piece:
 *   plane surface                      round-off, 1e-14
 *   faces of a box                     round-off, and so are its edges and
 *                                      corners if they lie on cell faces
 *   edges and corners elsewhere        the pieces that hold them are wrong by
 *                                      at most their volume: H^2/h^2 per
 *                                      corner (2D), H^2/h^2 per edge (3D)
 *   discs and balls of radius R        volume to 0.3 (H/R)^3, for H/R from
 *                                      0.4 to 0.003
 */
#ifndef TALUS_SHAPES_H
#define TALUS_SHAPES_H

/*
 * Return the value of a level set at x, positive inside the grains; any unit.
 * Always three coordinates, x[2] = 0 in two dimensions. `context` is the
 * caller's.
 */
typedef double (*shape_level_set)(void *context, const double x[3]);

/*
 * Return the fraction (1) of the square or cube of edge h around `centre`
 * filled by f > 0: 0 to 1. depth >= 0; 3 is enough for smooth surfaces. Calls f
 * about 17 (2^depth) times (2D) or 17 (4^depth) times (3D) where the surface
 * passes, less where that is plane, and 2^DIM + 1 times in most other cells.
 */
double shape_fraction(shape_level_set f, void *context,
                      const double centre[DIM], double h, int depth);
/* Return the same of a ring, whose volume counts: centre[0] > 0 is its radius,
 * and f does not depend on the angle around the axis. */
double shape_ring_fraction(shape_level_set f, void *context,
                           const double centre[DIM], double h, int depth);

#endif
