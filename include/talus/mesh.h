/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Mesh: the forest flattened into plain arrays.
 *
 * Index space of a cell array, length ncells:
 *   [0, nleaves)                 leaves of this rank, in Morton order
 *   [nleaves, begin_average)     ghosts: leaves of other ranks that touch ours
 *   [begin_average, begin_virtual)  averages of finer leaves
 *   [begin_virtual, begin_boundary) virtual children of coarser leaves
 *   [begin_boundary, ncells)     boundary nodes
 * The last three are helper nodes. Every leaf sees a uniform stencil at its
 * own level: stencil[i][s], s = (i+1) + 3(j+1) + 9(k+1) for offsets i, j, k
 * in {-1, 0, 1}, is the index of a node of the same size. A leaf that
 * touches a finer one sees the average of the finer cells; one that touches
 * a coarser leaf sees a child of it, interpolated linearly with one-sided
 * slopes where needed, so that linear fields are exact everywhere.
 * mesh_fill makes ghosts and helper nodes valid from leaf values.
 *
 * Index space of a face array, length nfaces_all:
 *   [0, nfaces)                  faces computed here, sorted by direction
 *   [nfaces, begin_face_average) copies of faces that other ranks compute
 *   [begin_face_average, nfaces_all) averages of the finer faces that make
 *                                up one side of a coarser leaf
 * A face belongs to the finer of its two leaves, or to the one on its lower
 * side. Face values are densities (velocity, flux per area), positive
 * towards increasing coordinate. cell_face[i][2d + side] is valid for every
 * leaf after mesh_fill_faces, so that what leaves one cell enters another to
 * round-off (mesh_outflow).
 */
#ifndef TALUS_MESH_H
#define TALUS_MESH_H

#include <math.h>
#include <mpi.h>
#include <stdbool.h>
#include <stdint.h>

#include "talus/forest.h"

enum {
  NCHILD = 1 << DIM,
  NFACE = 2 * DIM,
  NSTENCIL = DIM == 2 ? 9 : 27,
  STENCIL_CENTRE = DIM == 2 ? 4 : 13,
  MESH_MAX_PATCHES = 32
};

/* Step of the stencil index along axis d: 1, 3, 9. */
static inline int stencil_step(int d) { return d == 0 ? 1 : d == 1 ? 3 : 9; }
/* Stencil index of the face neighbour on face f = 2d + side. */
static inline int stencil_face(int f) {
  return STENCIL_CENTRE + (f & 1 ? 1 : -1) * stencil_step(f >> 1);
}

/* Value of a field at a boundary, per patch. The ghost value is
 *   a inner + b, chosen so that at the wall
 *   DIRICHLET: phi = value; NEUMANN: dphi/dn = value (n outwards);
 *   ROBIN: phi - value = -length dphi/dn (slip length, >= 0);
 *   CARRIED: phi = value, of what flows in.
 * On a face that patches share (forest.h) the value is their mean; patches with
 * NEUMANN add nothing to it. */
enum bc_type { BC_NEUMANN, BC_DIRICHLET, BC_ROBIN, BC_CARRIED };
struct bc {
  enum bc_type type;
  double value;
  double length;
};

/* A boundary node beyond faces that patches share. */
struct shared_node {
  int32_t node;                    /* less begin_boundary */
  struct patch_shares across[DIM]; /* of the face along each axis */
};

struct mesh_exchange; /* private: message plans */

/* Keys covered by a cell of level l; children follow one another in steps of
 * mesh_key_span(l + 1), child number = x + 2 y + 4 z. */
uint64_t mesh_key_span(int level);

struct mesh {
  uint64_t revision;     /* of the forest it was made from */
  struct forest *forest; /* borrowed */
  MPI_Comm comm;
  int rank, nranks;

  int32_t nleaves, nghosts, ncells;
  int32_t begin_average, begin_virtual, begin_boundary;
  double (*x)[DIM]; /* [nleaves + nghosts] centres, m */
  double *h;        /* [nleaves + nghosts] edge, m */
  int8_t *level;    /* [nleaves + nghosts] */
  uint64_t *key;    /* [nleaves + nghosts] Morton key of first corner */
  int32_t (*stencil)[NSTENCIL]; /* [nleaves] */

  int32_t nfaces, begin_face_average, nfaces_all;
  int32_t face_begin[DIM + 1]; /* faces of direction d: face_begin[d] .. */
  int32_t (*face_node)[2];     /* [nfaces] nodes of the face's level on the
                                  lower and the upper side */
  int32_t (*face_leaf)[2];     /* [nfaces] leaves (or ghosts) there; on a
                                  boundary the missing one is -1 */
  int32_t *face_owner;         /* [nfaces] leaf whose stencil holds both
                                  face nodes and their neighbours */
  int8_t *face_patch;          /* [nfaces] -1 inside, else patch */
  double *face_h;              /* [nfaces] edge of the face, m */
  int32_t (*cell_face)[NFACE]; /* [nleaves] into a face array */
  int32_t (*average_face)[NCHILD / 2]; /* [nfaces_all - begin_face_average] */

  /* Helper nodes; how mesh_fill makes them */
  int32_t (*average_child)[NCHILD]; /* finest first; -1: on another rank */
  int32_t nvirtual_local; /* groups of NCHILD interpolated here; the groups
                             after them come from other ranks */
  int32_t *virtual_leaf;  /* coarse leaf of each group */
  int32_t (*virtual_slope)[DIM][2]; /* [nvirtual_local] nodes whose difference
                                       gives the slope along each axis */
  double (*virtual_weight)[DIM];    /* 1/4 over their distance in h */
  int32_t *boundary_source;         /* node mirrored */
  int8_t (*boundary_patch)[DIM];    /* patch crossed along each axis, or -1 */
  double *boundary_h;               /* edge of the node */
  int32_t nshared;
  struct shared_node *shared; /* [nshared] */
  struct mesh_exchange *exchange;

  int level_finest;           /* over all ranks */
  const uint64_t *first_keys; /* [nranks + 1] first key of every rank's share
                                 of the leaves; borrowed from the forest */
};

/* Geometry. The functions below alone know how much sides and volumes weigh;
 * a length is x or h itself. With q_s the value on side s of a leaf, A the
 * area of a side, V the volume and w = V/A,
 *   net = sum_d (q_{2d+1} - q_{2d}),  outflow = A net,  div = outflow/V =
 * net/w. A metric, or sides that are partly closed, multiply the values on
 * sides in mesh_side, the volume and the width, and the means of
 * mesh_fill_faces. */

/* Volume of leaf or ghost i, m^3 (in 2D m^2). */
static inline double mesh_volume(const struct mesh *mesh, int32_t i) {
  const double h = mesh->h[i];
  return DIM == 2 ? h * h : h * h * h;
}

/* Volume of leaf i over the area of a side, m. */
static inline double mesh_width(const struct mesh *mesh, int32_t i) {
  return mesh->h[i];
}

/* Area of a side of leaf i, m^2 (in 2D m). */
static inline double mesh_side_area(const struct mesh *mesh, int32_t i) {
  return mesh_volume(mesh, i) / mesh_width(mesh, i);
}

/* Area of face f < nfaces, m^2 (in 2D m). */
static inline double mesh_face_area(const struct mesh *mesh, int32_t f) {
  const double h = mesh->face_h[f];
  return DIM == 2 ? h : h * h;
}

/* Value of a filled face array v on side s = 2d + (0 lower, 1 upper) of leaf i,
 * weighted by the area that is open there, over A. */
static inline double mesh_side(const struct mesh *mesh, const double *v,
                               int32_t i, int s) {
  return v[mesh->cell_face[i][s]];
}

/* Part of the net that leaves along axis d. */
static inline double mesh_net_along(const struct mesh *mesh, const double *v,
                                    int32_t i, int d) {
  return mesh_side(mesh, v, i, 2 * d + 1) - mesh_side(mesh, v, i, 2 * d);
}

static inline double mesh_net(const struct mesh *mesh, const double *v,
                              int32_t i) {
  double net = 0;
  for (int d = 0; d < DIM; d++) net += mesh_net_along(mesh, v, i, d);
  return net;
}

static inline double mesh_outflow(const struct mesh *mesh, const double *v,
                                  int32_t i) {
  return mesh_net(mesh, v, i) * mesh_side_area(mesh, i);
}

static inline double mesh_divergence(const struct mesh *mesh, const double *v,
                                     int32_t i) {
  return mesh_net(mesh, v, i) / mesh_width(mesh, i);
}

/* Half of what crosses the sides of leaf i in either direction, over its
 * volume: the volumes of itself that a velocity replaces per time, 1/s. */
static inline double mesh_turnover(const struct mesh *mesh, const double *v,
                                   int32_t i) {
  double sum = 0;
  for (int s = 0; s < NFACE; s++) sum += fabs(mesh_side(mesh, v, i, s));
  return 0.5 * sum / mesh_width(mesh, i);
}

/* Mean of the face values on both sides of leaf i along axis d. */
static inline double mesh_mean_along(const struct mesh *mesh, const double *v,
                                     int32_t i, int d) {
  const int32_t *face = mesh->cell_face[i];
  return 0.5 * (v[face[2 * d]] + v[face[2 * d + 1]]);
}

/* Mean of the face values on all sides of leaf i. */
static inline double mesh_mean(const struct mesh *mesh, const double *v,
                               int32_t i) {
  double sum = 0;
  for (int s = 0; s < NFACE; s++) sum += v[mesh->cell_face[i][s]];
  return sum / NFACE;
}

/* Slope across face f < nfaces of what differs by this much between its nodes,
 * 1/m. */
static inline double mesh_slope(const struct mesh *mesh, int32_t f,
                                double difference) {
  return difference / mesh->face_h[f];
}

/* Slope across face f < nfaces of a filled cell array v, 1/m. */
static inline double mesh_gradient(const struct mesh *mesh, const double *v,
                                   int32_t f) {
  const int32_t *node = mesh->face_node[f];
  return mesh_slope(mesh, f, v[node[1]] - v[node[0]]);
}

/* Slope of what differs by this much over an edge of leaf or ghost i, 1/m. */
static inline double mesh_leaf_slope(const struct mesh *mesh, int32_t i,
                                     double difference) {
  return difference / mesh->h[i];
}

/* Length in edges of leaf or ghost i: how many cells a front moves. */
static inline double mesh_edges(const struct mesh *mesh, int32_t i,
                                double length) {
  return length / mesh->h[i];
}

/* Length in edges of face f < nfaces. */
static inline double mesh_face_edges(const struct mesh *mesh, int32_t f,
                                     double length) {
  return length / mesh->face_h[f];
}

/* Flatten the forest. Collective; the forest must outlive the mesh. */
struct mesh *mesh_new(struct forest *forest);
void mesh_destroy(struct mesh *mesh);

/* Make ghosts and helper nodes of n cell fields valid. v[k] [ncells];
 * bc[k] [MESH_MAX_PATCHES] says what holds on each patch; homogeneous: the
 * values at the boundary are taken as 0 (for corrections). Collective. */
void mesh_fill(const struct mesh *mesh, int n, double *const v[],
               const struct bc *const bc[], bool homogeneous);
/* Fill potentials of forces per mass: not dv/dx but dv/dx / rho goes on
 * through a face, rho [ncells] filled. Pressure at an interface is one: a slope
 * taken across it would give the children of a gas leaf the pressure of grains,
 * which is rho_1/rho_2 too much for gas. Linear v is still exact where rho is
 * even. NULL: mesh_fill. */
void mesh_fill_potential(const struct mesh *mesh, const double *rho, int n,
                         double *const v[], const struct bc *const bc[],
                         bool homogeneous);
/* Spread a mark, 0 or more on leaves, by a leaf in every direction: 1 in those
 * that had it anywhere in their stencil, else 0. Children of a coarser leaf
 * have its mark, what lies beyond a boundary none. mark [ncells], valid on
 * leaves. Collective. */
void mesh_spread(const struct mesh *mesh, double *mark);
/* Only copy leaf values to the ghosts of other ranks. v[k] [>= nleaves +
 * nghosts]. Collective. */
void mesh_fill_ghosts(const struct mesh *mesh, int n, double *const v[]);
/* Copy face values to other ranks and average onto coarse sides. v[k]
 * [nfaces_all]. Collective. */
void mesh_fill_faces(const struct mesh *mesh, int n, double *const v[]);

/* Coefficients of a boundary node at distance h/2 from the wall. */
static inline void bc_ghost(const struct bc *bc, double h, double *a,
                            double *b) {
  if (bc->type == BC_NEUMANN) {
    *a = 1, *b = bc->value * h;
  } else { /* Robin with length 0 is Dirichlet */
    double l = bc->type == BC_ROBIN ? bc->length : 0;
    *a = (2 * l - h) / (2 * l + h), *b = 2 * h * bc->value / (2 * l + h);
  }
}

/* Sum, maximum over ranks. Collective. */
double mesh_sum(const struct mesh *mesh, double local);
double mesh_max(const struct mesh *mesh, double local);

#endif
