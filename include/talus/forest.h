/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Forest: the distributed quadtree/octree, held by p4est.
 *
 * A brick of cubic trees of edge `size`; leaves are numbered in Morton order
 * (morton.h), each rank holding one contiguous piece. The forest
 * knows topology only; physics works on the flattened mesh (mesh.h).
 * Refinement is 2:1 over faces, edges and corners. Every change of the
 * leaves or of their distribution raises the revision.
 */
#ifndef TALUS_FOREST_H
#define TALUS_FOREST_H

#include <mpi.h>
#include <stdbool.h>
#include <stdint.h>

enum {
  FOREST_MAX_LEVEL = DIM == 2 ? 24 : 16,
  FOREST_MAX_TREES = (1 << 15) - 1 /* a key has 15 bits for their numbers */
};

struct forest;

/* The patches that share a boundary face, by one of which (the one that the
 * face belongs to) each field has its condition. The value is the mean over
 * all: by the part of the area that a patch covers, or (BC_CARRIED) by what
 * flows in through it. */
enum { PATCH_SHARES = 4 };
struct patch_shares {
  int n; /* 0: the face belongs to one patch alone */
  int8_t patch[PATCH_SHARES];
  double part[PATCH_SHARES]; /* of the area */
  double flux[PATCH_SHARES]; /* part of what flows in */
};

struct forest_layout {
  double size;        /* edge of a tree, m */
  double origin[DIM]; /* lower corner of the brick, m */
  int trees[DIM];     /* trees along each axis, >= 1 */
  bool periodic[DIM];
  bool axisymmetric; /* x is the distance from an axis, y lies along it */
  /* Patch of a boundary face with centre x and edge h: `side` (2d lower, 2d+1
   * upper side of axis d) or another id below MESH_MAX_PATCHES; NULL: the
   * side. Fills `shares`, which comes with n = 0, if there are several. */
  int (*patch)(void *context, int side, const double x[3], double h,
               struct patch_shares *shares);
  void *patch_context;
};

/* Says what became of the leaves in one forest_adapt, rank-local and before the
 * repartition. New leaf i was made from old leaves first[i] .. first[i] +
 * count[i] - 1: count == 1 and delta == 0: kept; count == 1, delta > 0:
 * refined delta times from one leaf, count > 1: merged (delta == -1). */
struct forest_map {
  int32_t nold, nnew;
  int32_t *first;   /* [nnew] */
  int32_t *count;   /* [nnew] */
  int8_t *delta;    /* [nnew] */
  double (*x)[DIM]; /* [nnew] centres */
  int8_t *level;    /* [nnew] */
};

/* Make a uniform forest at `level`. Collective. The layout is copied. */
struct forest *forest_new(MPI_Comm comm, const struct forest_layout *layout,
                          int level);
/* Make a forest from a list of the levels of all leaves in Morton order, as
 * forest_levels gives it: `levels` [n] is this rank's contiguous share of the
 * global list. Collective. Returns NULL on all ranks if the levels do not tile
 * the brick. */
struct forest *forest_from_levels(MPI_Comm comm,
                                  const struct forest_layout *layout, int64_t n,
                                  const int8_t *levels);
void forest_destroy(struct forest *forest);

uint64_t forest_revision(const struct forest *forest);
int32_t forest_nleaves(const struct forest *forest); /* this rank */
int64_t forest_nleaves_global(const struct forest *forest);
int64_t forest_first_leaf(const struct forest *forest); /* global number of
                                                           local leaf 0 */
int forest_finest_level(const struct forest *forest);   /* collective */
const struct forest_layout *forest_layout(const struct forest *forest);
MPI_Comm forest_comm(const struct forest *forest);
/* Give the levels of the local leaves in order, levels [nleaves]. */
void forest_levels(const struct forest *forest, int8_t *levels);

/* Refine leaves flagged > 0 once, merge families whose leaves are all
 * flagged < 0, keep levels within [level_min, level_max], restore 2:1
 * balance, without moving leaves between ranks. flag [nleaves]. Collective.
 * Returns true if any rank changed; *map is then filled (free it with
 * forest_map_destroy), else left empty. */
bool forest_adapt(struct forest *forest, const int8_t *flag, int level_min,
                  int level_max, struct forest_map *map);
void forest_map_destroy(struct forest_map *map);

/* Spread leaves evenly over ranks (families stay together, so the next
 * forest_adapt can merge them). `data` are nfields arrays, allocated with
 * mem_alloc, of one double per local leaf; each is replaced by its moved
 * version. Collective. Returns true if any leaf moved. */
bool forest_partition(struct forest *forest, int nfields, double **data);

#endif
