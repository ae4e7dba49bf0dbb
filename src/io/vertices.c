/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "vertices.h"

#include <math.h>
#include <stdlib.h>

#include "talus/error.h"
#include "talus/forest.h"
#include "talus/memory.h"

/* A corner of a leaf: place in finest cells, leaf and corner. */
struct corner {
  int64_t place[DIM];
  int32_t leaf, number;
};

static int compare_corners(const void *a, const void *b) {
  const int64_t *p = ((const struct corner *)a)->place;
  const int64_t *q = ((const struct corner *)b)->place;
  for (int d = DIM - 1; d >= 0; d--)
    if (p[d] != q[d]) return p[d] < q[d] ? -1 : 1;
  return 0;
}

/* VTK goes round the lower face, then round the upper one. */
static int vtk_number(int corner) {
  return (corner & 2) != 0 ? corner ^ 1 : corner;
}

static struct corner *list_corners(const struct mesh *mesh, double unit) {
  const double *origin = forest_layout(mesh->forest)->origin;
  struct corner *corner =
      MEM_NEW(struct corner, (size_t)mesh->nleaves * NCHILD);
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    for (int k = 0; k < NCHILD; k++) {
      struct corner *c = &corner[(int64_t)i * NCHILD + k];
      for (int d = 0; d < DIM; d++) {
        double side = (k >> d & 1) != 0 ? 0.5 : -0.5;
        double x = mesh->x[i][d] + side * mesh->h[i] - origin[d];
        c->place[d] = llround(x / unit);
      }
      c->leaf = i;
      c->number = vtk_number(k);
    }
  }
  return corner;
}

void vertices_find(const struct mesh *mesh, struct vertices *vertices) {
  const struct forest_layout *layout = forest_layout(mesh->forest);
  const double unit = ldexp(layout->size, -mesh->level_finest);
  const int64_t ncorners = (int64_t)mesh->nleaves * NCHILD;
  struct corner *corner = list_corners(mesh, unit);
  qsort(corner, (size_t)ncorners, sizeof *corner, compare_corners);

  vertices->x = mem_alloc((size_t)ncorners, sizeof *vertices->x);
  vertices->cell = mem_alloc((size_t)mesh->nleaves, sizeof *vertices->cell);
  int64_t n = 0;
  for (int64_t k = 0; k < ncorners; k++) {
    const struct corner *c = &corner[k];
    if (k == 0 || compare_corners(c, c - 1) != 0) {
      for (int d = 0; d < DIM; d++)
        vertices->x[n][d] = layout->origin[d] + unit * (double)c->place[d];
      n++;
    }
    vertices->cell[c->leaf][c->number] = n - 1;
  }
  vertices->n = n;
  mem_free(corner);

  int64_t first = 0;
  MPI_CHECK(MPI_Scan(&n, &first, 1, MPI_INT64_T, MPI_SUM, mesh->comm));
  first -= n;
  for (int64_t k = 0; k < ncorners; k++)
    vertices->cell[k / NCHILD][k % NCHILD] += first;
}

void vertices_free(struct vertices *vertices) {
  mem_free(vertices->x);
  mem_free(vertices->cell);
}
