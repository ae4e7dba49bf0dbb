/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Invariants
 * 1. p4est carries no user data: flags live in quadrant p.user_int, only
 *    between forest_adapt's first and last line.
 * 2. first_keys matches the partition whenever no function is running.
 * 3. revision grows with every change of leaves or partition.
 */
#include "talus/forest.h"

#include <string.h>

#include "p4.h"
#include "talus/count.h"
#include "talus/error.h"
#include "talus/memory.h"
#include "talus/morton.h"

struct forest {
  MPI_Comm comm;
  int rank, nranks;
  struct forest_layout layout;
  struct brick brick;
  p4est_connectivity_t *connectivity;
  p4est_t *p4est;
  uint64_t revision;
  uint64_t *first_keys;     /* [nranks + 1] */
  int level_min, level_max; /* bounds during an adaptation */
};

enum { COORDINATE_SHIFT = P4EST_MAXLEVEL - FOREST_MAX_LEVEL };

static void abort_handler(void) { FATAL("p4est or libsc gave up"); }

static void library_begin(MPI_Comm comm) {
  if (p4est_package_id >= 0) return;
  sc_init(comm, 0, 0, NULL, SC_LP_ERROR);
  p4est_init(NULL, SC_LP_ERROR);
  sc_set_abort_handler(abort_handler);
}

static p4est_connectivity_t *brick_new(const struct forest_layout *l) {
#if DIM == 2
  return p4est_connectivity_new_brick(l->trees[0], l->trees[1], l->periodic[0],
                                      l->periodic[1]);
#else
  return p8est_connectivity_new_brick(l->trees[0], l->trees[1], l->trees[2],
                                      l->periodic[0], l->periodic[1],
                                      l->periodic[2]);
#endif
}

/* Find the places of the trees: p4est numbers them in an order of its own, and
 * the first vertex of a tree tells its place. */
static void brick_begin(struct forest *forest) {
  struct brick *brick = &forest->brick;
  const p4est_connectivity_t *conn = forest->connectivity;
  brick->ntrees = conn->num_trees;
  brick->tree_number = MEM_NEW(int32_t, brick->ntrees);
  brick->tree_place = mem_alloc(brick->ntrees, sizeof *brick->tree_place);
  for (int32_t t = 0; t < brick->ntrees; t++) {
    const double *v =
        conn->vertices + 3 * conn->tree_to_vertex[P4EST_CHILDREN * t];
    int64_t place = 0;
    for (int d = DIM - 1; d >= 0; d--) {
      brick->tree_place[t][d] = (int32_t)(v[d] + 0.5);
      place = place * brick->trees[d] + brick->tree_place[t][d];
    }
    brick->tree_number[place] = t;
  }
}

static void quadrant_place(const struct brick *brick, p4est_topidx_t tree,
                           const p4est_quadrant_t *q, int64_t x[DIM]) {
  const p4est_qcoord_t local[] = {
    q->x,
    q->y,
#if DIM == 3
    q->z
#endif
  };
  for (int d = 0; d < DIM; d++) {
    x[d] = ((int64_t)brick->tree_place[tree][d] << FOREST_MAX_LEVEL) +
           (local[d] >> COORDINATE_SHIFT);
  }
}

static void first_keys_update(struct forest *forest) {
  const p4est_t *p4est = forest->p4est;
  for (int r = 0; r <= forest->nranks; r++) {
    const p4est_quadrant_t *q = p4est->global_first_position + r;
    if (q->p.which_tree >= forest->brick.ntrees) {
      forest->first_keys[r] = (uint64_t)forest->brick.ntrees << MORTON_BITS;
    } else {
      int64_t x[DIM];
      quadrant_place(&forest->brick, q->p.which_tree, q, x);
      forest->first_keys[r] = morton_key(&forest->brick, x);
    }
  }
}

static struct forest *forest_begin(MPI_Comm comm,
                                   const struct forest_layout *layout) {
  struct forest *forest = MEM_NEW(struct forest, 1);
  library_begin(comm);
  MPI_CHECK(MPI_Comm_dup(comm, &forest->comm));
  MPI_CHECK(MPI_Comm_rank(comm, &forest->rank));
  MPI_CHECK(MPI_Comm_size(comm, &forest->nranks));
  forest->layout = *layout;
  for (int d = 0; d < DIM; d++) forest->brick.trees[d] = layout->trees[d];
  int64_t ntrees = 1;
  for (int d = 0; d < DIM; d++) ntrees *= layout->trees[d];
  CHECK(ntrees <= FOREST_MAX_TREES, "brick of %lld trees, at most %d",
        (long long)ntrees, FOREST_MAX_TREES);
  forest->connectivity = brick_new(layout);
  brick_begin(forest);
  forest->first_keys = MEM_NEW(uint64_t, forest->nranks + 1);
  return forest;
}

struct forest *forest_new(MPI_Comm comm, const struct forest_layout *layout,
                          int level) {
  CHECK(level >= 0 && level <= FOREST_MAX_LEVEL, "level %d, allowed 0 to %d",
        level, FOREST_MAX_LEVEL);
  struct forest *forest = forest_begin(comm, layout);
  forest->p4est = p4est_new_ext(forest->comm, forest->connectivity, 0, level, 1,
                                0, NULL, NULL);
  forest->revision = 1;
  forest_partition(forest, 0, NULL);
  first_keys_update(forest);
  return forest;
}

/* Write quadrants of this rank as p4est_inflate wants them (coordinates in
 * the tree, level) and count them per tree; the keys run on from `key`. */
static bool unfold_levels(const struct forest *forest, int64_t n,
                          const int8_t *levels, uint64_t key,
                          p4est_qcoord_t *out, p4est_gloidx_t *pertree) {
  const uint64_t end = (uint64_t)forest->brick.ntrees << MORTON_BITS;
  for (int64_t i = 0; i < n; i++) {
    if (levels[i] < 0 || levels[i] > FOREST_MAX_LEVEL || key >= end ||
        key % morton_span(levels[i]) != 0) {
      return false;
    }
    const uint64_t morton = key & (((uint64_t)1 << MORTON_BITS) - 1);
    for (int d = 0; d < DIM; d++) {
      out[(DIM + 1) * i + d] =
          (p4est_qcoord_t)(morton_gather(morton >> d) << COORDINATE_SHIFT);
    }
    out[(DIM + 1) * i + DIM] = levels[i];
    pertree[(key >> MORTON_BITS) + 1]++;
    key += morton_span(levels[i]);
  }
  return true;
}

struct forest *forest_from_levels(MPI_Comm comm,
                                  const struct forest_layout *layout, int64_t n,
                                  const int8_t *levels) {
  struct forest *forest = forest_begin(comm, layout);
  const int32_t ntrees = forest->brick.ntrees;
  count_index(n, "leaves");
  uint64_t span = 0, start = 0, total = 0;
  for (int64_t i = 0; i < n; i++) {
    bool valid = levels[i] >= 0 && levels[i] <= FOREST_MAX_LEVEL;
    span += valid ? morton_span(levels[i]) : 1;
  }
  MPI_CHECK(MPI_Exscan(&span, &start, 1, MPI_UINT64_T, MPI_SUM, comm));
  if (forest->rank == 0) start = 0;
  MPI_CHECK(MPI_Allreduce(&span, &total, 1, MPI_UINT64_T, MPI_SUM, comm));

  sc_array_t *quadrants =
      sc_array_new_count(sizeof(p4est_qcoord_t), (size_t)n * (DIM + 1));
  p4est_gloidx_t *pertree = MEM_NEW(p4est_gloidx_t, ntrees + 1);
  p4est_gloidx_t *first = MEM_NEW(p4est_gloidx_t, forest->nranks + 1);
  int good = unfold_levels(forest, n, levels, start,
                           (p4est_qcoord_t *)quadrants->array, pertree);
  good = good && total == (uint64_t)ntrees << MORTON_BITS;
  MPI_CHECK(MPI_Allreduce(MPI_IN_PLACE, &good, 1, MPI_INT, MPI_MIN, comm));
  if (good) {
    int64_t count = n;
    MPI_CHECK(
        MPI_Allgather(&count, 1, MPI_INT64_T, first + 1, 1, MPI_INT64_T, comm));
    for (int r = 0; r < forest->nranks; r++) first[r + 1] += first[r];
    MPI_CHECK(MPI_Allreduce(MPI_IN_PLACE, pertree, ntrees + 1, MPI_INT64_T,
                            MPI_SUM, comm));
    for (int32_t t = 0; t < ntrees; t++) pertree[t + 1] += pertree[t];
    forest->p4est = p4est_inflate(forest->comm, forest->connectivity, first,
                                  pertree, quadrants, NULL, NULL);
    forest->revision = 1;
    first_keys_update(forest);
  }
  sc_array_destroy(quadrants);
  mem_free(pertree);
  mem_free(first);
  if (!good) {
    forest_destroy(forest);
    return NULL;
  }
  return forest;
}

void forest_destroy(struct forest *forest) {
  if (!forest) return;
  if (forest->p4est) p4est_destroy(forest->p4est);
  p4est_connectivity_destroy(forest->connectivity);
  MPI_CHECK(MPI_Comm_free(&forest->comm));
  mem_free(forest->brick.tree_number);
  mem_free(forest->brick.tree_place);
  mem_free(forest->first_keys);
  mem_free(forest);
}

uint64_t forest_revision(const struct forest *forest) {
  return forest->revision;
}
int32_t forest_nleaves(const struct forest *forest) {
  return forest->p4est->local_num_quadrants;
}
int64_t forest_nleaves_global(const struct forest *forest) {
  return forest->p4est->global_num_quadrants;
}
int64_t forest_first_leaf(const struct forest *forest) {
  return forest->p4est->global_first_quadrant[forest->rank];
}
const struct forest_layout *forest_layout(const struct forest *forest) {
  return &forest->layout;
}
MPI_Comm forest_comm(const struct forest *forest) { return forest->comm; }
const struct brick *forest_brick(const struct forest *forest) {
  return &forest->brick;
}
const uint64_t *forest_first_keys(const struct forest *forest) {
  return forest->first_keys;
}

/* Visit the local leaves in order; `visit` returns void and sees the tree,
 * the quadrant and its number. */
typedef void (*leaf_visitor)(const struct forest *forest, p4est_topidx_t tree,
                             p4est_quadrant_t *q, int32_t i, void *context);

static void leaves_visit(const struct forest *forest, leaf_visitor visit,
                         void *context) {
  const p4est_t *p4est = forest->p4est;
  int32_t i = 0;
  for (p4est_topidx_t t = p4est->first_local_tree; t <= p4est->last_local_tree;
       t++) {
    sc_array_t *quadrants = &p4est_tree_array_index(p4est->trees, t)->quadrants;
    for (size_t k = 0; k < quadrants->elem_count; k++, i++) {
      visit(forest, t, p4est_quadrant_array_index(quadrants, k), i, context);
    }
  }
}

static void take_level(const struct forest *forest, p4est_topidx_t tree,
                       p4est_quadrant_t *q, int32_t i, void *context) {
  (void)forest, (void)tree;
  ((int8_t *)context)[i] = q->level;
}

void forest_levels(const struct forest *forest, int8_t *levels) {
  leaves_visit(forest, take_level, levels);
}

static void take_key(const struct forest *forest, p4est_topidx_t tree,
                     p4est_quadrant_t *q, int32_t i, void *context) {
  int64_t x[DIM];
  quadrant_place(&forest->brick, tree, q, x);
  ((uint64_t *)context)[i] = morton_key(&forest->brick, x);
}

void forest_keys(const struct forest *forest, uint64_t *keys) {
  leaves_visit(forest, take_key, keys);
}

int forest_finest_level(const struct forest *forest) {
  const p4est_t *p4est = forest->p4est;
  int finest = 0;
  for (p4est_topidx_t t = p4est->first_local_tree; t <= p4est->last_local_tree;
       t++) {
    int level = p4est_tree_array_index(p4est->trees, t)->maxlevel;
    if (level > finest) finest = level;
  }
  MPI_CHECK(
      MPI_Allreduce(MPI_IN_PLACE, &finest, 1, MPI_INT, MPI_MAX, forest->comm));
  return finest;
}

static void put_flag(const struct forest *forest, p4est_topidx_t tree,
                     p4est_quadrant_t *q, int32_t i, void *context) {
  int flag = ((const int8_t *)context)[i];
  (void)tree;
  if (flag > 0 && q->level >= forest->level_max) flag = 0;
  if (flag < 0 && q->level <= forest->level_min) flag = 0;
  q->p.user_int = flag;
}

static void clear_flag(p4est_t *p4est, p4est_topidx_t tree,
                       p4est_quadrant_t *q) {
  (void)p4est, (void)tree;
  q->p.user_int = 0;
}

static int wants_refine(p4est_t *p4est, p4est_topidx_t tree,
                        p4est_quadrant_t *q) {
  (void)p4est, (void)tree;
  return q->p.user_int > 0;
}

static int wants_merge(p4est_t *p4est, p4est_topidx_t tree,
                       p4est_quadrant_t *q[]) {
  (void)p4est, (void)tree;
  for (int k = 0; k < P4EST_CHILDREN; k++) {
    if (q[k]->p.user_int >= 0) return 0;
  }
  return 1;
}

/* Match the old leaves with the new by one walk, as both lists tile the same
 * keys. */
static void map_make(const struct forest *forest, int32_t nold,
                     const uint64_t *old_key, const int8_t *old_level,
                     struct forest_map *map) {
  const struct forest_layout *layout = &forest->layout;
  const int32_t nnew = forest_nleaves(forest);
  uint64_t *key = MEM_NEW(uint64_t, nnew);
  map->nold = nold, map->nnew = nnew;
  map->first = MEM_NEW(int32_t, nnew);
  map->count = MEM_NEW(int32_t, nnew);
  map->delta = MEM_NEW(int8_t, nnew);
  map->level = MEM_NEW(int8_t, nnew);
  map->x = mem_alloc(nnew, sizeof *map->x);
  forest_keys(forest, key);
  forest_levels(forest, map->level);
  for (int32_t i = 0, j = 0; i < nnew; i++) {
    const uint64_t end = key[i] + morton_span(map->level[i]);
    while (old_key[j] + morton_span(old_level[j]) <= key[i]) j++;
    int32_t last = j;
    while (last + 1 < nold && old_key[last + 1] < end) last++;
    map->first[i] = j;
    map->count[i] = last - j + 1;
    map->delta[i] = (int8_t)(last > j ? -1 : map->level[i] - old_level[j]);
    int64_t x[DIM];
    morton_coordinates(&forest->brick, key[i], x);
    for (int d = 0; d < DIM; d++) {
      double centre = (double)x[d] + 0.5 * (double)morton_edge(map->level[i]);
      map->x[i][d] =
          layout->origin[d] + layout->size * centre / (double)morton_edge(0);
    }
  }
  mem_free(key);
}

bool forest_adapt(struct forest *forest, const int8_t *flag, int level_min,
                  int level_max, struct forest_map *map) {
  const int32_t nold = forest_nleaves(forest);
  uint64_t *key = MEM_NEW(uint64_t, nold);
  int8_t *level = MEM_NEW(int8_t, nold);
  forest_keys(forest, key);
  forest_levels(forest, level);
  memset(map, 0, sizeof *map);
  forest->level_min = level_min, forest->level_max = level_max;
  leaves_visit(forest, put_flag, (void *)flag);
  p4est_refine_ext(forest->p4est, 0, level_max, wants_refine, clear_flag, NULL);
  p4est_coarsen(forest->p4est, 0, wants_merge, clear_flag);
  p4est_balance(forest->p4est, P4EST_CONNECT_FULL, clear_flag);

  const int32_t nnew = forest_nleaves(forest);
  int changed = nnew != nold;
  if (!changed) {
    uint64_t *new_key = MEM_NEW(uint64_t, nnew);
    forest_keys(forest, new_key);
    changed = memcmp(key, new_key, (size_t)nold * sizeof *key) != 0;
    mem_free(new_key);
  }
  MPI_CHECK(
      MPI_Allreduce(MPI_IN_PLACE, &changed, 1, MPI_INT, MPI_MAX, forest->comm));
  if (changed) {
    map_make(forest, nold, key, level, map);
    forest->revision++;
    first_keys_update(forest);
  }
  mem_free(key);
  mem_free(level);
  return changed;
}

void forest_map_destroy(struct forest_map *map) {
  mem_free(map->first);
  mem_free(map->count);
  mem_free(map->delta);
  mem_free(map->level);
  mem_free(map->x);
  memset(map, 0, sizeof *map);
}

/* Move interleaved data of n doubles per leaf to the new partition. */
static void data_move(struct forest *forest, const p4est_gloidx_t *before,
                      int n, double **data) {
  const p4est_t *p4est = forest->p4est;
  const size_t nold = (size_t)(before[forest->rank + 1] - before[forest->rank]);
  const size_t nnew = (size_t)p4est->local_num_quadrants;
  double *out = MEM_NEW(double, nold *(size_t)n);
  double *in = MEM_NEW(double, nnew *(size_t)n);
  for (int k = 0; k < n; k++) {
    for (size_t i = 0; i < nold; i++) out[i * (size_t)n + k] = data[k][i];
  }
  p4est_transfer_fixed(p4est->global_first_quadrant, before, forest->comm, 1,
                       in, out, (size_t)n * sizeof(double));
  for (int k = 0; k < n; k++) {
    data[k] = mem_resize(data[k], nnew, sizeof(double));
    for (size_t i = 0; i < nnew; i++) data[k][i] = in[i * (size_t)n + k];
  }
  mem_free(out);
  mem_free(in);
}

bool forest_partition(struct forest *forest, int nfields, double **data) {
  if (forest->nranks == 1) return false;
  p4est_t *p4est = forest->p4est;
  p4est_gloidx_t *before = MEM_NEW(p4est_gloidx_t, forest->nranks + 1);
  memcpy(before, p4est->global_first_quadrant,
         (size_t)(forest->nranks + 1) * sizeof *before);
  bool moved = p4est_partition_ext(p4est, 1, NULL) > 0;
  if (moved) {
    if (nfields > 0) data_move(forest, before, nfields, data);
    forest->revision++;
    first_keys_update(forest);
  }
  mem_free(before);
  return moved;
}
