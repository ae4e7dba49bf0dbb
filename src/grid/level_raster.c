/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/level_raster.h"

#include <math.h>

#include "talus/error.h"
#include "talus/memory.h"
#include "talus/minmax.h"

struct level_raster {
  struct forest_layout layout;
  const struct function *function;
  int finest, deepest;                /* level of the grid, of the raster */
  int8_t *most[FOREST_MAX_LEVEL + 1]; /* [cells of the level], x fastest */
};

static int64_t cells_along(const struct level_raster *raster, int level,
                           int d) {
  return (int64_t)raster->layout.trees[d] << level;
}

static int64_t cells_of(const struct level_raster *raster, int level) {
  int64_t n = 1;
  for (int d = 0; d < DIM; d++) n *= cells_along(raster, level, d);
  return n;
}

static int ask(const struct level_raster *raster, const double at[DIM]) {
  double x[3] = {0};
  for (int d = 0; d < DIM; d++) x[d] = at[d];
  const double level = raster->function->eval(raster->function->context, x);
  return (int)min2(max2(floor(level + 0.5), 0), raster->finest);
}

/* Return the level asked for in cell k of a level: in the middle, at the centre
 * of a cell of the finest level. */
static int8_t ask_cell(const struct level_raster *raster, int level,
                       int64_t k) {
  const double h = ldexp(raster->layout.size, -level);
  const double aside =
      level < raster->finest ? ldexp(raster->layout.size, -raster->finest) : 0;
  double x[DIM];
  for (int d = 0; d < DIM; d++) {
    const int64_t n = cells_along(raster, level, d);
    x[d] = raster->layout.origin[d] + h * ((double)(k % n) + 0.5) - 0.5 * aside;
    k /= n;
  }
  return (int8_t)ask(raster, x);
}

/* Ask in all cells, each rank in its share. */
static void ask_all(struct level_raster *raster, MPI_Comm comm) {
  int rank, nranks;
  MPI_CHECK(MPI_Comm_rank(comm, &rank));
  MPI_CHECK(MPI_Comm_size(comm, &nranks));
  const int64_t n = cells_of(raster, raster->deepest);
  int8_t *most = raster->most[raster->deepest];
  int *begin = MEM_NEW(int, nranks + 1), *count = MEM_NEW(int, nranks);
  for (int r = 0; r <= nranks; r++) begin[r] = (int)(n * r / nranks);
  for (int r = 0; r < nranks; r++) count[r] = begin[r + 1] - begin[r];
  for (int64_t k = begin[rank]; k < begin[rank + 1]; k++) {
    most[k] = ask_cell(raster, raster->deepest, k);
  }
  MPI_CHECK(MPI_Allgatherv(MPI_IN_PLACE, 0, MPI_DATATYPE_NULL, most, count,
                           begin, MPI_INT8_T, comm));
  mem_free(begin);
  mem_free(count);
}

/* Number of the cell of the next coarser level around cell k. */
static int64_t parent_of(const struct level_raster *raster, int level,
                         int64_t k) {
  int64_t parent = 0, stride = 1;
  for (int d = 0; d < DIM; d++) {
    const int64_t n = cells_along(raster, level, d);
    parent += stride * (k % n / 2);
    stride *= n / 2;
    k /= n;
  }
  return parent;
}

static void merge_cells(struct level_raster *raster) {
  for (int l = raster->deepest; l > 0; l--) {
    const int64_t n = cells_of(raster, l);
    for (int64_t k = 0; k < n; k++) {
      int8_t *above = &raster->most[l - 1][parent_of(raster, l, k)];
      if (raster->most[l][k] > *above) *above = raster->most[l][k];
    }
  }
}

struct level_raster *level_raster_new(MPI_Comm comm,
                                      const struct forest_layout *layout,
                                      const struct function *function,
                                      int finest) {
  struct level_raster *raster = MEM_NEW(struct level_raster, 1);
  raster->layout = *layout;
  raster->function = function;
  raster->finest = raster->deepest = finest;
  while (raster->deepest > 0 &&
         (double)cells_of(raster, 0) * ldexp(1, DIM * raster->deepest) >
             LEVEL_RASTER_POINTS) {
    raster->deepest--;
  }
  for (int l = 0; l <= raster->deepest; l++) {
    raster->most[l] = MEM_NEW(int8_t, cells_of(raster, l));
  }
  ask_all(raster, comm);
  merge_cells(raster);
  return raster;
}

void level_raster_destroy(struct level_raster *raster) {
  if (!raster) return;
  for (int l = 0; l <= raster->deepest; l++) mem_free(raster->most[l]);
  mem_free(raster);
}

/* Ask at the centres of the finest cells, or of cells DEPTH levels finer, in a
 * cell that the raster does not resolve. */
static int ask_inside(const struct level_raster *raster, const double x[DIM],
                      int level) {
  enum { DEPTH = 2 };
  const int depth =
      level + DEPTH < raster->finest ? DEPTH : raster->finest - level;
  const int n = depth > 0 ? 1 << depth : 1;
  const double h = ldexp(raster->layout.size, -level);
  int most = 0;
  for (int k = 0; k < (DIM == 2 ? n * n : n * n * n); k++) {
    const int at[] = {k % n, k / n % n, k / n / n};
    double point[DIM];
    for (int d = 0; d < DIM; d++) {
      point[d] = x[d] + h * ((at[d] + 0.5) / n - 0.5);
    }
    const int asked = ask(raster, point);
    if (asked > most) most = asked;
  }
  return most;
}

int level_raster_most(const struct level_raster *raster, const double x[DIM],
                      int level) {
  if (level > raster->deepest) return ask_inside(raster, x, level);
  const double h = ldexp(raster->layout.size, -level);
  int64_t k = 0;
  for (int d = DIM - 1; d >= 0; d--) {
    const double place = floor((x[d] - raster->layout.origin[d]) / h);
    k = k * cells_along(raster, level, d) + (int64_t)place;
  }
  return raster->most[level][k];
}
