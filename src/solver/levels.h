/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The insides of a hierarchy, shared by the files of solver/.
 *
 * Slots: [0, nowned) nodes of this rank, level after level; [nowned, nslots)
 * ghosts, nodes of other ranks that ours refer to. A family is the NCHILD
 * children of one node; it is whole on one rank. On level l >= 1 the slots
 * are sorted by child number, red ones first, then by family: what a sweep over
 * one colour reads of its own follows in memory, and so do the siblings.
 *
 * Velocities in 3D are kept as (x, y, z, 0) node by node, so that a neighbour
 * takes one load; elsewhere a component is an array. Component c of node i is
 * v[c][i * stride] in both.
 */
#ifndef TALUS_SOLVER_LEVELS_H
#define TALUS_SOLVER_LEVELS_H

#include <stdbool.h>

#include "talus/hierarchy.h"
#include "talus/krylov.h"
#include "talus/plan.h"
#include "talus/skin.h"

enum {
  HALF = NCHILD / 2,
  NPAIR = DIM * (DIM - 1) / 2, /* pairs of axes */
  NCORNER = 4 * NPAIR,         /* nodes diagonally across an edge (3D) or a
                                  corner (2D) */
  LANES = DIM == 3 ? 4 : 1,    /* numbers of a velocity side by side */
  NODE_ROOM = DIM == 3 ? LANES : DIM, /* numbers of a node */
  SWEEP_BLOCK = 64,                   /* nodes that are taken together */
  LEVEL_GATHERED = 256 /* nodes of a level that one rank does alone */
};

struct level {
  int32_t begin;        /* first slot */
  int32_t nowned;       /* slots, trees on level 0, else NCHILD per family */
  int32_t nfamilies;    /* 0 on level 0 */
  int32_t family_begin; /* into family_parent */
  int32_t side_begin, side_end;     /* into sides */
  int32_t jump_begin, jump_end;     /* into jump */
  int32_t mirror_begin, mirror_end; /* into mirror */
  struct plan copy;                 /* owned -> ghost values of this level */
  struct plan add; /* the same backwards; borrows the lists of copy */
};

/* A face of an owned node beyond which lies a leaf one level coarser. The
 * node sees a virtual child of that leaf, as on the mesh: slot nslots + k of
 * h->e, interpolated linearly. */
struct jump {
  int32_t fine, coarse; /* slots */
  int32_t face;
  int32_t node[DIM][2]; /* slots whose difference is the slope along an axis */
  float weight[DIM];
};

/* A node beyond a wall: the image of one inside, slot nslots + njumps + k of
 * h->e. */
struct mirror {
  int32_t source; /* slot */
  int32_t side;   /* number of the side beyond which it lies, */
  int8_t face;    /* through this face */
  int8_t patch;   /* of that side */
};

/* A node at a wall. */
struct side {
  int32_t slot;
  int8_t patch[NFACE]; /* beyond that face, -1: no wall */
};

/* A leaf beside the surface of the grains, where the transposed gradient has
 * weights (skin_nodes.c): what they change in its rows of the operator.
 * `around` are the nodes around it in each plane of axes a < b, 4 + i + 3 j for
 * offsets i along a, j along b; row[0] is that of component a, times component
 * b, row[1] the other way round. */
struct skin_node {
  int32_t slot, parent;
  int32_t around[NPAIR][9];
  double row[NPAIR][2][9];
  double diagonal[DIM];
  double inverse[DIM][DIM]; /* of the block of the node */
  double next[DIM];         /* work: e once it is relaxed */
};

struct hierarchy {
  const struct mesh *mesh; /* borrowed */
  uint64_t revision;       /* of the mesh */
  int nlevels;             /* level_finest + 1 */
  int nranks;
  struct level *level;             /* [nlevels] */
  int32_t nowned, nactive, nslots; /* [nowned, nactive): ghosts that are
                                      parents of our families */
  int32_t nleaves;
  int32_t *leaf_slot;        /* [nleaves] */
  int32_t *family_parent;    /* slot one level up */
  int32_t *neighbour[NFACE]; /* [nactive] slots; its own image at a wall,
                                a virtual child across a jump */
  int32_t *corner[NCORNER];  /* [nactive] of axes a < b, 4 pair + (upper
                                a) + 2 (upper b); an image beyond a wall */
  uint8_t *wall;             /* [nactive] bit f: face f is a wall */
  int32_t nsides;
  struct side *sides; /* [nsides] by slot */
  int32_t njumps;
  struct jump *jump;
  int32_t nmirrors;
  struct mirror *mirror;
  /* Mirrors level by level and on each by the run of the source, those of
   * ghosts last */
  int32_t *mirror_order; /* [nmirrors] */
  int32_t *mirror_run;   /* [nlevels * (NCHILD + 1) + 1], where each begins */
  /* Operator: set by coefficients_set for each solve */
  int nparts;      /* 1, or DIM: velocity */
  int64_t stride;  /* from node to node: LANES of a velocity, else 1 */
  bool has_mass;   /* somewhere, perhaps */
  float *w[NFACE]; /* [nslots] alpha area / distance, 0 at a wall;
                      the inverse is exactly that of what is rounded */
  bool has_bulk;
  float *bulk[NFACE]; /* [nslots] likewise with lambda (bulk.c); NULL: never */
  double *inverse[DIM]; /* [nslots * stride] 1 / diagonal, 0 if it is 0 */
  double *e[DIM];       /* [(nslots + njumps + nmirrors) * stride] correction */
  double *r[DIM];       /* [nslots * stride] residual */
  double *apart;        /* [LANES * apart_room] e of runs that wait for the
                           others of their colour; none in 2D */
  int64_t apart_room;
  /* Conductance across a side of a family over that inside it, at most 1,
   * [families] */
  float *limit[NFACE];
  /* Nodes near jumps of the coefficient, level by level and on each by child
   * number, NULL: never needed; how often a cycle relaxes them besides */
  int32_t *rough;       /* [nowned] */
  int32_t *rough_begin; /* [nlevels * NCHILD + 1] */
  int rough_sweeps;
  /* Nodes beside the surface of the grains, in the order of `rough` */
  int32_t nskin, skin_room;
  struct skin_node *skin_node; /* [nskin] */
  int32_t *skin_begin;         /* [nlevels * NCHILD + 1] */
  int ncycles;                 /* since coefficients_set */
  double first_residual;       /* before the first of them, or the second */
  /* Value beyond a wall over that inside, [nlevels] */
  double (*beyond)[DIM][MESH_MAX_PATCHES];
  double *radius;    /* [nowned] r of rings, NULL in a plane */
  double *coarse[3]; /* [trees] for conjugate gradients */
  /* Work of the outer solver. Cells and faces share the arena with e and r:
   * neither is needed while the other is in use */
  double *arena;
  double *work_cells; /* [DIM * ncells] */
  double *work_faces; /* [DIM * nfaces_all] */
  double *residual;   /* [DIM * nleaves] */
  float *weight;      /* [DIM * nleaves] */
  struct krylov_space *krylov;
};

/* Set v to the components in a block of n nodes. */
static inline void set_parts(const struct hierarchy *h, double *block,
                             int64_t n, double *v[DIM]) {
  for (int c = 0; c < DIM; c++) v[c] = block + (h->stride > 1 ? c : c * n);
}
/* Return in how many arrays the components are. */
static inline int count_arrays(const struct hierarchy *h) {
  return h->stride > 1 ? 1 : h->nparts;
}
/* Run a plan for values of nodes. */
static inline void run_plan(const struct hierarchy *h, struct plan *plan,
                            double *const v[DIM], bool add) {
  plan_run(plan, count_arrays(h), v, (int)h->stride, add);
}
/* Return the slot of child c of family k of a level. */
static inline int32_t family_slot(const struct level *level, int32_t k, int c) {
  const int black = __builtin_popcount((unsigned)c) & 1;
  return level->begin + (black * HALF + (c >> 1)) * level->nfamilies + k;
}
/* Return the child whose slots are number q of the NCHILD runs of a level: red
 * ones first, HALF of each. */
static inline int run_child(int q) {
  const int j = q % HALF;
  return 2 * j + ((__builtin_popcount((unsigned)j) & 1) ^ q / HALF);
}
/* First slot of run q of a level. */
static inline int32_t run_begin(const struct level *level, int q) {
  return level->begin + q * level->nfamilies;
}
/* Number of the pair of axes a < b: 01, 02, 12. */
static inline int pair_number(int a, int b) { return a + b - 1; }
/* Return the entry of `corner` for the node one step along axes a != b. */
static inline int corner_entry(int a, int upper_a, int b, int upper_b) {
  return a < b ? 4 * pair_number(a, b) + upper_a + 2 * upper_b
               : 4 * pair_number(b, a) + upper_b + 2 * upper_a;
}

/* Give the conductance of a side of leaf i for a coefficient of 1: factor times
 * area over distance. */
static inline double conductance(const struct mesh *mesh, int32_t i,
                                 double factor) {
  const double width = mesh_width(mesh, i);
  return factor * mesh_volume(mesh, i) / (width * width);
}

/* Set the two-point operator (coefficients.c): conductances factor * alpha_f
 * area / distance, mass [nleaves] per volume or NULL, walls by bc[nparts].
 * nparts is 1, or DIM for the components of a velocity, whose normal stress
 * is twice as stiff. Leaves krylov weights in h->weight. Collective. */
void coefficients_set(struct hierarchy *h, int nparts, const double *alpha_f,
                      double factor, const double *mass,
                      const struct bc *const bc[]);
/* Set the conductances of lambda, kappa_f NULL: none, before coefficients_set.
 * Collective. */
void bulk_set(struct hierarchy *h, const double *eta_f, const double *kappa_f,
              double factor);
/* Relax the runs [first, end) of a level (sweep.c), those of one colour: all
 * see what the others were before. */
void sweep_relax(struct hierarchy *h, const struct level *level, int first,
                 int end);
/* Relax the nodes of theirs that are near jumps of the coefficient. */
void sweep_relax_rough(struct hierarchy *h, int l, int first, int end);
/* Count the runs whose nodes have a residual after a sweep. Those relaxed last
 * have none: black nodes of a single component; of a velocity the last child,
 * but for what its image beyond a wall has changed since. */
static inline int sweep_residual_runs(int nparts) {
  return nparts > 1 ? NCHILD - 1 : HALF;
}
/* Add the residuals of n nodes of such a run, from number `first` on, to sum[c]
 * [n * stride]. */
void sweep_add_residuals(const struct hierarchy *h, const struct level *level,
                         int q, int32_t first, int32_t n,
                         double *const sum[DIM]);
/* Return what lambda adds to the flux out of node i through its face f. */
double sweep_bulk_flux(const struct hierarchy *h, int32_t i, int f);
/* Find e = A^-1 r, roughly (cycle.c): r [nparts * nleaves] per volume, times
 * `factor`; e likewise. Collective. */
void cycle_run(struct hierarchy *h, double factor, const double *r, double *e);
/* Watch the residual before each cycle: if the first one has raised it, the
 * others relax nodes near jumps of the coefficient more often (rough.c). Uses
 * h->e. Collective. */
void rough_watch(struct hierarchy *h, double residual);
/* Find the nodes of a skin (skin_nodes.c), NULL: none, after coefficients_set.
 */
void skin_nodes_set(struct hierarchy *h, const struct skin *skin);
/* Relax those of the runs [first, end) of level l, of one colour, which have
 * just been relaxed without weights. */
void skin_nodes_relax(struct hierarchy *h, int l, int first, int end);
/* Add to r of parents what the weights change in the residual of level l. */
void skin_nodes_restrict(struct hierarchy *h, int l);
/* Solve on the trees alone (coarse.c): from h->r to h->e. */
void coarse_solve(struct hierarchy *h);

#endif
