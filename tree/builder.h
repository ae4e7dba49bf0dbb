/* SPDX-License-Identifier: GPL-3.0-or-later */
/* State shared by the parts of mesh_new.
 *
 * While a mesh is built, nodes are named by kind and number within the kind,
 * because the final index needs the counts of all kinds.
 */
#ifndef TALUS_TREE_BUILDER_H
#define TALUS_TREE_BUILDER_H

#include "exchange.h"
#include "talus/count.h"
#include "talus/hash.h"
#include "talus/mesh.h"
#include "talus/morton.h"

enum {
  KIND_SHIFT = 28,
  KIND_MOST = (1 << KIND_SHIFT) - 1, /* nodes of each kind */
  KIND_LEAF = 0,                     /* leaves and ghosts */
  KIND_AVERAGE = 1,
  KIND_VIRTUAL = 2,
  KIND_BOUNDARY = 3
};
static inline int node_kind(int32_t node) { return node >> KIND_SHIFT; }
static inline int32_t node_number(int32_t node) {
  return node & (((int32_t)1 << KIND_SHIFT) - 1);
}
static inline int32_t node_name(int kind, int64_t number) {
  return kind << KIND_SHIFT |
         (int32_t)(number <= KIND_MOST
                       ? number
                       : count_check(number, KIND_MOST, "nodes of a kind"));
}

/* Tags of the hash table; averages use their level + 1. */
enum { TAG_BOUNDARY = 100, TAG_FACE = 101 };

struct average {
  uint64_t key;
  int32_t level;
  int32_t child[NCHILD]; /* node names, -1: on another rank */
};

struct boundary_node {
  int32_t source; /* node name */
  int8_t patch[DIM], outside[DIM];
  double x[DIM], h;
};

/* Sorted keys, and where pieces of 2^shift of them begin. */
struct key_index {
  const uint64_t *key; /* [n], borrowed */
  int32_t n;
  int shift;
  int32_t *begin; /* [pieces + 1] */
};

struct builder {
  struct mesh *mesh;
  const struct brick *brick;
  const struct forest_layout *layout;
  const uint64_t *first_keys;
  struct key_index leaves, ghosts;
  struct hash hash; /* of nodes and faces that are no leaves' */
  struct average *average;
  int32_t naverages, average_capacity;
  int32_t *group_of;   /* [nleaves + nghosts] virtual group, -1 */
  int32_t *group_leaf; /* [ngroups] */
  int32_t ngroups, group_capacity;
  struct boundary_node *boundary;
  int32_t nboundary, boundary_capacity;
  int32_t shared_capacity;      /* of mesh->shared */
  struct plan_request *request; /* scratch */
  int64_t nrequests, request_capacity;
};

/* Add a zero element to a growing array and return its number. */
int32_t list_grow(void **list, int32_t *n, int32_t *capacity, size_t size);
/* Add a request for a node that another rank holds. */
void request_add(struct builder *b, uint64_t key, int32_t tag, int rank,
                 int32_t index);
/* Find the rank that holds `key`. */
int key_rank(const struct builder *b, uint64_t key);

/* Return the leaf or ghost that covers `key`, -1: none that is known. */
int32_t leaf_at(const struct builder *b, uint64_t key);
/* Make the index of n sorted keys, of which index_end frees the work. */
void index_begin(struct key_index *index, const uint64_t *key, int32_t n);
void index_end(struct key_index *index);

/* Build, mesh_ghost.c: leaves, ghosts, their geometry and index. */
void build_leaves(struct builder *b);
/* Build, mesh_stencil.c: stencils and helper nodes, with final indices. */
void build_stencils(struct builder *b);
/* Build, mesh_face.c: faces and their links. */
void build_faces(struct builder *b);
/* Build, mesh_rings.c: radii and slants of axisymmetric coordinates. */
void build_rings(struct builder *b);

#endif
