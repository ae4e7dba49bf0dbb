/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Outline: the heap as seen from its side, h(x, y) = int c dz per column.
 *
 * z stands for the vertical axis: that of gravity, or the last axis if gravity
 * is tilted or zero. Columns are as wide as the finest leaf, which is Delta;
 * a coarser leaf counts in each column it covers.
 *
 * The front. 2D: from the tallest column outwards, the first column of a height
 * <= h_end = min(Delta, height of the tallest)/2 ends the heap; the front lies
 * where the line between its top and the top of the column before it has the
 * height h_end, which is Delta/2 but for a layer thinner than a cell. The front
 * is the x of the upper end if the heap leans on the lower side of the box
 * (which may be a plane of symmetry), of the lower end if it leans on the upper
 * side only, and else of the end farther from the centre of the heap, the upper
 * one where they are level within Delta. A heap that reaches the side ends
 * there. 3D: the same walk over rings of width Delta around an axis, with the
 * mean height of the columns in each ring, gives a radius. The axis goes, for
 * each of x and y, through the lower side if the heap leans on it, else the
 * upper one, else through the centre of the heap; a direction in which the heap
 * leans on both sides does not count in the radius (a slice of a plane heap).
 * Axisymmetric: the radius of the outer end; columns are rings.
 */
#ifndef TALUS_OUTLINE_H
#define TALUS_OUTLINE_H

#include <stdbool.h>

struct mesh;

struct outline {
  int n[2];        /* columns along the two horizontal axes; n[1] = 1 in 2D */
  double first[2]; /* centre of the first column, m */
  double spacing;  /* Delta, m */
  double *height;  /* [n[1]][n[0]], m, owned */
  bool rings;      /* columns are rings around an axis */
};

/* Return the vertical axis for this gravity. */
int outline_axis(const double gravity[DIM]);
/* Measure the columns along `axis` of the leaves with heap[i], c [nleaves].
 * Collective, the same on all ranks. Columns are made wider, with a warning, if
 * there would be more than 2^24. Free with outline_free. */
void outline_measure(const struct mesh *mesh, const double *c, const bool *heap,
                     int axis, struct outline *outline);
void outline_free(struct outline *outline);

/* Return the largest height, m. */
double outline_height(const struct outline *outline);
/* Return the front, m; without any grains the lower side in 2D, 0 in 3D. Where
 * end > 0 the heap ends at that height, m, or half the largest, instead. */
double outline_front(const struct outline *outline, double end);

#endif
