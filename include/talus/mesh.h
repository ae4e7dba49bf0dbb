/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Mesh: the forest as plain arrays, made anew whenever the forest changes.
 *
 * An array over cells has ncells entries, the nodes:
 *   [0, nleaves)                 leaves of this rank, in Morton order
 *   [nleaves, begin_average)     ghosts: leaves of other ranks that touch ours
 *   [begin_average, begin_virtual)  averages of finer leaves
 *   [begin_virtual, begin_boundary) virtual children of coarser leaves
 *   [begin_boundary, ncells)     boundary nodes
 * The last three kinds are helper nodes. Every leaf has a uniform stencil of
 * nodes of its own size: stencil[i][s], s = (i+1) + 3(j+1) + 9(k+1) for offsets
 * i, j, k in {-1, 0, 1}. In the place of finer leaves stands their average, in
 * the place of a coarser leaf one of its virtual children, interpolated
 * linearly, with one-sided slopes where need be, so that linear fields are
 * exact everywhere. A kernel reads the stencil and knows nothing of levels,
 * ranks and boundaries; before, mesh_fill must have made ghosts and helper
 * nodes from the leaves.
 *
 * An array over faces has nfaces_all entries:
 *   [0, nfaces)                  faces of this rank, sorted by direction
 *   [nfaces, begin_face_average) copies of faces of other ranks
 *   [begin_face_average, nfaces_all) averages of the finer faces that make
 *                                up one side of a coarser leaf
 * A face belongs to the finer of its two leaves, or to the one on its lower
 * side. Its value is a density (velocity, flux per area), positive towards
 * increasing coordinate. After mesh_fill_faces all sides of a leaf are valid,
 * cell_face[i][2d + (0 lower, 1 upper)], so that what leaves one leaf enters
 * another to round-off (mesh_outflow).
 */
#ifndef TALUS_MESH_H
#define TALUS_MESH_H

#include <math.h>
#include <mpi.h>
#include <stdbool.h>
#include <stdint.h>

#include "talus/forest.h"
#include "talus/poison.h"

#define MESH_TURN 6.283185307179586 /* 2 pi */

enum {
  NCHILD = 1 << DIM,
  NFACE = 2 * DIM,
  NSTENCIL = DIM == 2 ? 9 : 27,
  STENCIL_CENTRE = DIM == 2 ? 4 : 13,
  MESH_MAX_PATCHES = 32
};

/* Return the step of the stencil index along axis d: 1, 3, 9. */
static inline int stencil_step(int d) { return d == 0 ? 1 : d == 1 ? 3 : 9; }
/* Return the stencil index of the neighbour on side f = 2d + (0, 1). */
static inline int stencil_face(int f) {
  return STENCIL_CENTRE + (f & 1 ? 1 : -1) * stencil_step(f >> 1);
}

/* Condition of a field phi on a patch. The boundary node has the value
 * a inside + b, such that on the wall, with n outwards,
 *   DIRICHLET: phi = value
 *   NEUMANN:   dphi/dn = value
 *   ROBIN:     phi - value = -length dphi/dn, length >= 0 (a slip length)
 *   CARRIED:   phi = value, of what flows in
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

/* Return how many keys a cell of this level covers. Child number x + 2 y + 4 z
 * of a cell of level l has the key of the cell plus that number times
 * mesh_key_span(l + 1). */
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
  double (*boundary_x)[DIM];        /* centre of the node mirrored, m */
  int8_t (*boundary_outside)[DIM];  /* where it lies beyond: -1, 0 or 1 */
  double *boundary_h;               /* edge of the node */
  int32_t nshared;
  struct shared_node *shared; /* [nshared] */
  struct mesh_exchange *exchange;

  int level_finest;           /* over all ranks */
  const uint64_t *first_keys; /* [nranks + 1] first key of every rank's share
                                 of the leaves; borrowed from the forest */

  /* Axisymmetric coordinates, else NULL */
  double *slant;         /* [nleaves + nghosts] h/(2r) */
  double *face_radius;   /* [nfaces] r, m */
  double *average_slant; /* [nfaces_all - begin_face_average] of the mean over
                            two faces side by side along r, else 0 */
};

/* Geometry. The functions below alone know how much sides and volumes weigh; a
 * length is x or h itself. With q_s the value on side s of a leaf, A the area
 * of a side, V the volume and w = V/A the width, net = sum_d (q_{2d+1} -
 * q_{2d}),   outflow = A net,   div = net/w.
 *
 * Axisymmetric, with r = x and z = y: a leaf is a ring of the volume V = 2 pi r
 * h^2 with its centre at r, A = 2 pi r h that of a side across z, and the sides
 * across r have r -+ h/2 in the place of r. So mesh_side weighs values there by
 * 1 -+ k, k = h/(2r) the slant, which is 0 on the axis, and mesh_fill_faces two
 * faces side by side along r by their radii. A tensor has one component more,
 * the hoop: D_tt = u_r/r, whose stress pulls with - tau_tt/r.
 *
 * A metric, or sides that are partly closed, multiplies the values in
 * mesh_side, the volume, the width, and the means of mesh_fill_faces. */

/* Return whether the mesh is one of rings around an axis. */
static inline bool mesh_is_axisymmetric(const struct mesh *mesh) {
  return DIM == 2 && mesh->slant != NULL;
}

/* Return the volume of leaf or ghost i, m^3 (in a plane m^2). */
static inline double mesh_volume(const struct mesh *mesh, int32_t i) {
  const double h = mesh->h[i];
  if (mesh_is_axisymmetric(mesh)) return MESH_TURN * mesh->x[i][0] * h * h;
  return DIM == 2 ? h * h : h * h * h;
}

/* Return the volume of leaf i over the area of a side, m. */
static inline double mesh_width(const struct mesh *mesh, int32_t i) {
  return mesh->h[i];
}

/* Return the area of a side of leaf i, m^2 (in a plane m). */
static inline double mesh_side_area(const struct mesh *mesh, int32_t i) {
  return mesh_volume(mesh, i) / mesh_width(mesh, i);
}

/* Return the area of face f < nfaces, m^2 (in a plane m). */
static inline double mesh_face_area(const struct mesh *mesh, int32_t f) {
  const double h = mesh->face_h[f];
  if (mesh_is_axisymmetric(mesh)) return MESH_TURN * mesh->face_radius[f] * h;
  return DIM == 2 ? h : h * h;
}

/* Return the value of a filled face array v on side s = 2d + (0 lower, 1 upper)
 * of leaf i, times the area that is open there, over A. */
static inline double mesh_side(const struct mesh *mesh, const double *v,
                               int32_t i, int s) {
  const double value = v[mesh->cell_face[i][s]];
  if (s > 1 || !mesh_is_axisymmetric(mesh)) return value;
  return (s ? 1 + mesh->slant[i] : 1 - mesh->slant[i]) * value;
}

/* Return the part of mesh_net along axis d. */
static inline double mesh_net_along(const struct mesh *mesh, const double *v,
                                    int32_t i, int d) {
  const int32_t *face = mesh->cell_face[i];
  const double lower = v[face[2 * d]], upper = v[face[2 * d + 1]];
  const double net = upper - lower;
  if (d > 0 || !mesh_is_axisymmetric(mesh)) return net;
  return net + mesh->slant[i] * (upper + lower);
}

/* Return mesh_net in rings or not, as is known of the mesh before a loop. */
static inline double mesh_net_of(const struct mesh *mesh, bool rings,
                                 const double *v, int32_t i) {
  const int32_t *face = mesh->cell_face[i];
  double net = 0;
  for (int d = 0; d < DIM; d++) net += v[face[2 * d + 1]] - v[face[2 * d]];
  return rings ? net + mesh->slant[i] * (v[face[1]] + v[face[0]]) : net;
}

/* Return the net above of a filled face array v at leaf i. */
static inline double mesh_net(const struct mesh *mesh, const double *v,
                              int32_t i) {
  return mesh_net_of(mesh, mesh_is_axisymmetric(mesh), v, i);
}

/* Return how much leaves leaf i: its outflow, in units of v times m^2 (in a
 * plane m). */
static inline double mesh_outflow(const struct mesh *mesh, const double *v,
                                  int32_t i) {
  return mesh_net(mesh, v, i) * mesh_side_area(mesh, i);
}

/* Return the divergence of a filled face array v at leaf i, in units of v/m. */
static inline double mesh_divergence(const struct mesh *mesh, const double *v,
                                     int32_t i) {
  return mesh_net(mesh, v, i) / mesh_width(mesh, i);
}

/* Return half of what crosses the sides of leaf i in either direction over its
 * volume, 1/s: how often a velocity v replaces the contents of the leaf. */
static inline double mesh_turnover(const struct mesh *mesh, const double *v,
                                   int32_t i) {
  const int32_t *face = mesh->cell_face[i];
  double sum = 0;
  for (int s = 0; s < NFACE; s++) sum += fabs(v[face[s]]);
  if (mesh_is_axisymmetric(mesh)) {
    sum += mesh->slant[i] * (fabs(v[face[1]]) - fabs(v[face[0]]));
  }
  return 0.5 * sum / mesh_width(mesh, i);
}

/* Return the mean of the values on both sides of leaf i along axis d. */
static inline double mesh_mean_along(const struct mesh *mesh, const double *v,
                                     int32_t i, int d) {
  const int32_t *face = mesh->cell_face[i];
  return 0.5 * (v[face[2 * d]] + v[face[2 * d + 1]]);
}

/* Return the mean of the values on all sides of leaf i. */
static inline double mesh_mean(const struct mesh *mesh, const double *v,
                               int32_t i) {
  double sum = 0;
  for (int s = 0; s < NFACE; s++) sum += v[mesh->cell_face[i][s]];
  return sum / NFACE;
}

/* Faces begin[d] to end[d] of each axis whose owners are in one piece of the
 * leaves. Loops over faces read the stencils of their owners, which in small
 * pieces are still in cache when the next axis wants them. */
struct mesh_piece {
  int32_t leaf; /* behind its last one */
  int32_t begin[DIM], end[DIM];
};
enum { MESH_PIECE_LEAVES = 256 };

/* Return an empty piece before the first one. */
static inline struct mesh_piece mesh_no_piece(const struct mesh *mesh) {
  struct mesh_piece piece = {.leaf = 0};
  for (int d = 0; d < DIM; d++) piece.end[d] = mesh->face_begin[d];
  return piece;
}

/* Go on to the next piece; returns false behind the last one. */
static inline bool mesh_next_piece(const struct mesh *mesh,
                                   struct mesh_piece *piece) {
  if (piece->leaf >= mesh->nleaves) return false;
  piece->leaf += MESH_PIECE_LEAVES;
  for (int d = 0; d < DIM; d++) {
    int32_t f = piece->begin[d] = piece->end[d];
    /* faces of an axis are in the order of their owners */
    while (f < mesh->face_begin[d + 1] && mesh->face_owner[f] < piece->leaf) {
      f++;
    }
    piece->end[d] = f;
  }
  return true;
}

/* Return the slope across face f < nfaces, from the difference between its
 * nodes. */
static inline double mesh_slope(const struct mesh *mesh, int32_t f,
                                double difference) {
  return difference / mesh->face_h[f];
}

/* Return the slope across face f < nfaces of a filled cell array v. */
static inline double mesh_gradient(const struct mesh *mesh, const double *v,
                                   int32_t f) {
  const int32_t *node = mesh->face_node[f];
  return mesh_slope(mesh, f, v[node[1]] - v[node[0]]);
}

/* Return the slope in leaf or ghost i, from the difference over an edge. */
static inline double mesh_leaf_slope(const struct mesh *mesh, int32_t i,
                                     double difference) {
  return difference / mesh->h[i];
}

/* Return a length in edges of leaf or ghost i: how many cells a front moves. */
static inline double mesh_edges(const struct mesh *mesh, int32_t i,
                                double length) {
  return length / mesh->h[i];
}

/* Return a length in edges of face f < nfaces. */
static inline double mesh_face_edges(const struct mesh *mesh, int32_t f,
                                     double length) {
  return length / mesh->face_h[f];
}

/* Return u_r/r in leaf i, D_tt of the radial velocity u; 0 in a plane. */
static inline double mesh_hoop(const struct mesh *mesh, const double *u,
                               int32_t i) {
  return mesh_is_axisymmetric(mesh) ? u[i] / mesh->x[i][0] : 0;
}

/* Return u_r/r at face f < nfaces of axis d, the mean over its nodes, of the
 * filled radial velocity u; axisymmetric only. Beyond the axis r < 0. */
static inline double mesh_face_hoop(const struct mesh *mesh, const double *u,
                                    int32_t f, int d) {
  const int32_t *node = mesh->face_node[f];
  const double r = mesh->face_radius[f];
  const double half = d == 0 ? 0.5 * mesh->face_h[f] : 0;
  return 0.5 * (u[node[0]] / (r - half) + u[node[1]] / (r + half));
}

/* Return the force of the hoop stress in leaf i, of the filled face array
 * stress; axisymmetric only. */
static inline double mesh_hoop_force(const struct mesh *mesh,
                                     const double *stress, int32_t i) {
  return -mesh_mean(mesh, stress, i) / mesh->x[i][0];
}

/* Return the slant of leaf or ghost i, 0 in a plane. */
static inline double mesh_slant(const struct mesh *mesh, int32_t i) {
  return mesh_is_axisymmetric(mesh) ? mesh->slant[i] : 0;
}

/* Return how deep, in edges of face f of axis d, the volume reaches that
 * crosses it from `side` (0 lower, 1 upper) when everything there moves by
 * `length` on the face: in rings as deep as their volume needs. */
static inline double mesh_swept(const struct mesh *mesh, int32_t f, int d,
                                int side, double length) {
  const double edges = mesh_face_edges(mesh, f, length);
  if (d > 0 || !mesh_is_axisymmetric(mesh)) return edges;
  const double r = mesh_face_edges(mesh, f, mesh->face_radius[f]);
  if (r == 0) return 0;
  const double square = 1 + (side ? 2 : -2) * edges / r;
  return fmin(2 * edges / (1 + sqrt(fmax(square, 0))), side ? HUGE_VAL : r);
}

/* Make the mesh of a forest, which must outlive it. Collective; the caller owns
 * the mesh. */
struct mesh *mesh_new(struct forest *forest);
void mesh_destroy(struct mesh *mesh);

/* Say that leaf values of a cell array [ncells] have been written, so that its
 * ghosts and helper nodes are no longer valid: whoever writes leaves of an
 * array that others fill and read calls it. Debug builds poison them
 * (poison.h), to stop a stage that reads nodes it has not filled; release
 * builds do nothing. */
static inline void mesh_touch(const struct mesh *mesh, double *v) {
  poison(v + mesh->nleaves, mesh->ncells - mesh->nleaves);
}

/* Fill ghosts and helper nodes of n cell arrays from their leaves. v[k]
 * [ncells]; bc[k] [MESH_MAX_PATCHES] holds the conditions; homogeneous: their
 * values are taken as 0 (for corrections). Collective. */
void mesh_fill(const struct mesh *mesh, int n, double *const v[],
               const struct bc *const bc[], bool homogeneous);
/* Fill arrays of which dv/dx / rho, not dv/dx, is continuous through a face, as
 * the pressure at the surface of the grains: on a slope taken across the
 * surface the children of a leaf of gas would get the pressure of grains, too
 * much by rho_1/rho_2. rho [ncells] filled, NULL: as mesh_fill. Linear v is
 * still exact where rho is even. Collective. */
void mesh_fill_potential(const struct mesh *mesh, const double *rho, int n,
                         double *const v[], const struct bc *const bc[],
                         bool homogeneous);
/* Give boundary nodes and faces other patches: `patch` returns that of a face
 * with centre x and edge h on a side of the box that belongs to `now`, the same
 * on all ranks. No face may be shared (forest.h). The hierarchy must follow
 * (hierarchy_renew_patches). */
void mesh_renew_patches(struct mesh *mesh,
                        int (*patch)(const void *context, int side,
                                     const double x[DIM], double h, int now),
                        const void *context);
/* Spread a mark, 0 or more on leaves, by one leaf in every direction: set it to
 * 1 in leaves with a mark anywhere in the stencil, else to 0. Virtual
 * children have the mark of their leaf, boundary nodes none. mark [ncells],
 * valid on leaves. Collective. */
void mesh_spread(const struct mesh *mesh, double *mark);
/* Fill the ghosts only. v[k] [>= nleaves + nghosts]. Collective. */
void mesh_fill_ghosts(const struct mesh *mesh, int n, double *const v[]);
/* Fill n face arrays from the faces of this rank: copy from other ranks, and
 * average onto the sides of coarse leaves. v[k] [nfaces_all]. Collective. */
void mesh_fill_faces(const struct mesh *mesh, int n, double *const v[]);

/* Give the coefficients of a boundary node, h/2 beyond the wall: its value is
 * a inside + b. */
static inline void bc_ghost(const struct bc *bc, double h, double *a,
                            double *b) {
  if (bc->type == BC_NEUMANN) {
    *a = 1, *b = bc->value * h;
  } else { /* Robin with length 0 is Dirichlet */
    double l = bc->type == BC_ROBIN ? bc->length : 0;
    *a = (2 * l - h) / (2 * l + h), *b = 2 * h * bc->value / (2 * l + h);
  }
}

/* Return the sum or the maximum over ranks. Collective. */
double mesh_sum(const struct mesh *mesh, double local);
double mesh_max(const struct mesh *mesh, double local);

#endif
