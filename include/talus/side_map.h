/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Side map: which boundary holds where on a side of the box that a function of
 * position divides among several.
 *
 * The function is asked on a raster of several points to a face of the finest
 * level, those on the edges of the face included; a face in which it gives more
 * than one answer is divided until the part of each is known to 1e-7 of the
 * face (on the sides of a cube, which have two axes: 1e-5). What is narrower
 * than the raster may be missed.
 *
 * Stored as a tree: a node is one boundary all over, or divided, or, at the
 * finest level, has a part for each boundary. So a face of any level has its
 * parts in a few steps.
 *
 * A face that one boundary covers belongs to that boundary. A face that several
 * share belongs to the boundary at its centre; but where boundaries of a given
 * set (inflows, whose values are weighted by their parts) are among the
 * several, to the one of the set with the largest part.
 */
#ifndef TALUS_SIDE_MAP_H
#define TALUS_SIDE_MAP_H

#include <stdint.h>

enum { SIDE_MAP_MOST = 16 }; /* boundaries, numbered from 0 */

struct side_map;

struct side_map_layout {
  int naxes;        /* along the side: 1 or 2 */
  double size;      /* edge of a tree, m */
  double origin[2]; /* lower corner, m */
  int trees[2];     /* along each axis */
  int level;        /* finest level */
  /* Boundary at a point of the side, in [0, SIDE_MAP_MOST). */
  int (*select)(void *context, const double t[2]);
  void *context;
};

/* Make the map of a side; the layout is copied. Owned by the caller. */
struct side_map *side_map_new(const struct side_map_layout *layout);
void side_map_destroy(struct side_map *map);

/* Find the parts of a face with centre t and edge h that the boundaries cover,
 * part [SIDE_MAP_MOST], their sum 1. Returns the boundary that covers all of
 * it, or -1. Parts below 1e-6 are taken as none. */
int side_map_parts(const struct side_map *map, const double t[2], double h,
                   double part[]);
/* Find the boundary that takes a face; `weighted` has a bit for each boundary
 * of the set. */
int side_map_owner(const struct side_map *map, const double t[2], double h,
                   uint32_t weighted);
/* List the boundaries in the box [lo, hi] of the side, a bit for each. */
uint32_t side_map_within(const struct side_map *map, const double lo[2],
                         const double hi[2]);

/* List the boundaries that the function has returned, other than on the border
 * of the side, a bit for each. */
uint32_t side_map_seen(const struct side_map *map);
/* Return the length or area of the side that each boundary covers,
 * [SIDE_MAP_MOST], m or m^2. Owned by the map. */
const double *side_map_covered(const struct side_map *map);
/* Measure the faces of the finest level that each boundary takes: their length
 * or area into taken [SIDE_MAP_MOST], m or m^2. */
void side_map_taken(const struct side_map *map, uint32_t weighted,
                    double taken[]);

#endif
