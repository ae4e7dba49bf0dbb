/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Vertices of the leaves of one rank, each listed once. */
#ifndef TALUS_IO_VERTICES_H
#define TALUS_IO_VERTICES_H

#include <stdint.h>

#include "talus/mesh.h"

struct vertices {
  int64_t n;
  double (*x)[DIM];        /* [n], m */
  int64_t (*cell)[NCHILD]; /* [nleaves] vertices of each leaf, numbered over
                              all ranks, in the order of VTK */
};

/* Collective. */
void vertices_find(const struct mesh *mesh, struct vertices *vertices);
void vertices_free(struct vertices *vertices);

#endif
