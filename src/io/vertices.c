/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Balance over corners lets every leaf at a vertex see all others there in its
 * stencil: as they are, as part of an average, or by a virtual child. */
#include "vertices.h"

#include <math.h>
#include <stdbool.h>

#include "talus/error.h"
#include "talus/forest.h"
#include "talus/memory.h"

/* Return the leaf of this rank with the same corner k as a node, or -1. */
static int32_t leaf_at(const struct mesh *mesh, int32_t node, int k) {
  while (node >= mesh->begin_average && node < mesh->begin_virtual) {
    node = mesh->average_child[node - mesh->begin_average][k];
  }
  if (node >= mesh->begin_virtual && node < mesh->begin_boundary) {
    const int32_t child = node - mesh->begin_virtual;
    node = child % NCHILD == k ? mesh->virtual_leaf[child / NCHILD] : -1;
  }
  return node < mesh->nleaves ? node : -1;
}

/* Is corner k of leaf i where corner l of leaf j is? Across a periodic side
 * they are the box apart. */
static bool same_place(const struct mesh *mesh, int32_t i, int k, int32_t j,
                       int l) {
  for (int d = 0; d < DIM; d++) {
    const double p = mesh->x[i][d] + ((k >> d & 1) - 0.5) * mesh->h[i];
    const double q = mesh->x[j][d] + ((l >> d & 1) - 0.5) * mesh->h[j];
    if (fabs(p - q) > 0.25 * mesh->h[i]) return false;
  }
  return true;
}

/* Return the vertex at corner k of leaf i, if a leaf before it has it too, else
 * -1. */
static int32_t find_vertex(const struct mesh *mesh,
                           const struct vertices *vertices, int32_t i, int k) {
  for (int m = 1; m < NCHILD; m++) { /* axes along which the corner is passed */
    int s = STENCIL_CENTRE;
    for (int d = 0; d < DIM; d++) {
      if (m >> d & 1) s += (k >> d & 1 ? 1 : -1) * stencil_step(d);
    }
    const int32_t j = leaf_at(mesh, mesh->stencil[i][s], k ^ m);
    if (j >= 0 && j < i && same_place(mesh, i, k, j, k ^ m)) {
      return vertices->cell[j][k ^ m];
    }
  }
  return -1;
}

void vertices_find(const struct mesh *mesh, struct vertices *vertices) {
  int32_t n = 0;
  vertices->cell = mem_alloc((size_t)mesh->nleaves, sizeof *vertices->cell);
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    for (int k = 0; k < NCHILD; k++) {
      const int32_t vertex = find_vertex(mesh, vertices, i, k);
      vertices->cell[i][k] = vertex >= 0 ? vertex : n++;
    }
  }
  vertices->n = n;
  MPI_CHECK(MPI_Scan(&vertices->n, &vertices->first, 1, MPI_INT64_T, MPI_SUM,
                     mesh->comm));
  vertices->first -= n;
}

void vertices_free(struct vertices *vertices) { mem_free(vertices->cell); }

/* Give corner k of leaf i, the same to the last bit for every leaf that has it.
 */
static void corner_place(const struct mesh *mesh, int32_t i, int k,
                         double x[DIM]) {
  const struct forest_layout *layout = forest_layout(mesh->forest);
  const double unit = ldexp(layout->size, -mesh->level_finest);
  for (int d = 0; d < DIM; d++) {
    const double side = ((k >> d & 1) - 0.5) * mesh->h[i];
    x[d] = layout->origin[d] +
           unit * round((mesh->x[i][d] + side - layout->origin[d]) / unit);
  }
}

void vertices_place(const struct mesh *mesh, const struct vertices *vertices,
                    int64_t begin, int64_t n, int32_t *leaf, double (*x)[DIM]) {
  for (int64_t next = 0; next < n;) {
    for (int k = 0; k < NCHILD && next < n; k++) {
      if (vertices->cell[*leaf][k] != begin + next) continue;
      corner_place(mesh, *leaf, k, x[next++]);
    }
    if (next < n) (*leaf)++;
  }
}
