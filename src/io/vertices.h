/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Vertices of the leaves of one rank, each listed once. */
#ifndef TALUS_IO_VERTICES_H
#define TALUS_IO_VERTICES_H

#include <stdint.h>

#include "talus/mesh.h"

/* Vertices are numbered in the order in which a walk over the leaves, and over
 * the corners x + 2 y + 4 z of each, meets them. */
struct vertices {
  int64_t n;               /* of this rank */
  int64_t first;           /* vertices of the ranks before */
  int32_t (*cell)[NCHILD]; /* [nleaves] vertex at each corner, of this rank */
};

/* Find the vertices of the leaves. Collective. */
void vertices_find(const struct mesh *mesh, struct vertices *vertices);
void vertices_free(struct vertices *vertices);

/* Give the places of the vertices [begin, begin + n) into x [n], m. *leaf says
 * where the walk is: 0 for the first call, later ones go on from the one
 * before. */
void vertices_place(const struct mesh *mesh, const struct vertices *vertices,
                    int64_t begin, int64_t n, int32_t *leaf, double (*x)[DIM]);

#endif
