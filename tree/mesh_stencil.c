/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Stencils and helper nodes.
 *
 * 2:1 balance over faces, edges and corners makes a neighbour region of leaf
 * size either a leaf, a child of a leaf one level coarser (virtual), or
 * divided (average); outside the domain it is the mirror image of one of
 * these (boundary). Averages are nested where their far children are
 * divided again. What lies on other ranks is asked for once.
 */
#include <string.h>

#include "builder.h"
#include "talus/error.h"
#include "talus/memory.h"

static bool is_local(const struct builder *b, uint64_t key, int level) {
  const int rank = b->mesh->rank;
  return key < b->first_keys[rank + 1] &&
         key + morton_span(level) > b->first_keys[rank];
}

static int32_t average_get(struct builder *b, uint64_t key, int level);

/* Return a child of an average that this rank can add up, a leaf of its own or
 * an average with leaves of its own below; else -1. */
static int32_t average_child_get(struct builder *b, uint64_t key, int level) {
  const struct mesh *mesh = b->mesh;
  if (!is_local(b, key, level)) return -1;
  const int32_t leaf = leaf_at(b, key);
  if (leaf >= 0 && mesh->level[leaf] == level) {
    return leaf < mesh->nleaves ? leaf : -1;
  }
  return average_get(b, key, level);
}

/* Return the average node over (key, level), made on demand. */
static int32_t average_get(struct builder *b, uint64_t key, int level) {
  int32_t k = hash_find(&b->hash, key, level + 1);
  if (k >= 0) return node_name(KIND_AVERAGE, k);
  k = list_grow((void **)&b->average, &b->naverages, &b->average_capacity,
                sizeof *b->average);
  hash_insert(&b->hash, key, level + 1, k);
  b->average[k].key = key;
  b->average[k].level = level;
  for (int c = 0; c < NCHILD; c++) {
    uint64_t child_key = key + (uint64_t)c * morton_span(level + 1);
    int32_t child = average_child_get(b, child_key, level + 1);
    b->average[k].child[c] = child; /* the list may have moved */
  }
  return node_name(KIND_AVERAGE, k);
}

static int32_t virtual_get(struct builder *b, int32_t leaf, int child) {
  if (b->group_of[leaf] < 0) {
    int32_t k = list_grow((void **)&b->group_leaf, &b->ngroups,
                          &b->group_capacity, sizeof *b->group_leaf);
    b->group_leaf[k] = leaf;
    b->group_of[leaf] = k;
  }
  return node_name(KIND_VIRTUAL, (int64_t)b->group_of[leaf] * NCHILD + child);
}

/* Return the node of the given level that covers the region at `key`. */
static int32_t node_at(struct builder *b, uint64_t key, int level) {
  const struct mesh *mesh = b->mesh;
  const int32_t leaf = leaf_at(b, key);
  if (leaf >= 0 && mesh->level[leaf] == level) return leaf;
  if (leaf >= 0 && mesh->level[leaf] < level) {
    CHECK(mesh->level[leaf] == level - 1, "grid is not 2:1 balanced");
    int child = (int)(key / morton_span(level)) & (NCHILD - 1);
    return virtual_get(b, leaf, child);
  }
  return average_get(b, key, level);
}

/* Note the patches that share the face of boundary node k along axis d. */
static void add_shares(struct builder *b, int32_t k, int d,
                       const struct patch_shares *shares) {
  struct mesh *mesh = b->mesh;
  if (shares->n == 0) return;
  if (mesh->nshared == 0 || mesh->shared[mesh->nshared - 1].node != k) {
    const int32_t i = list_grow((void **)&mesh->shared, &mesh->nshared,
                                &b->shared_capacity, sizeof *mesh->shared);
    mesh->shared[i] = (struct shared_node){.node = k};
  }
  mesh->shared[mesh->nshared - 1].across[d] = *shares;
}

/* Return the mirror image of the node at integer place x across the sides in o.
 */
static int32_t boundary_get(struct builder *b, int32_t source,
                            const int64_t x[DIM], const int outside[DIM],
                            int level) {
  const double unit = b->layout->size / (double)morton_edge(0);
  const double h = unit * (double)morton_edge(level);
  uint64_t code = 0;
  for (int d = DIM - 1; d >= 0; d--) code = 3 * code + (outside[d] + 1);
  uint64_t key = code << 32 | (uint32_t)source;
  int32_t k = hash_find(&b->hash, key, TAG_BOUNDARY);
  if (k >= 0) return node_name(KIND_BOUNDARY, k);
  k = list_grow((void **)&b->boundary, &b->nboundary, &b->boundary_capacity,
                sizeof *b->boundary);
  hash_insert(&b->hash, key, TAG_BOUNDARY, k);
  b->boundary[k].source = source;
  b->boundary[k].h = h;
  for (int d = 0; d < DIM; d++) {
    b->boundary[k].patch[d] = -1;
    b->boundary[k].outside[d] = (int8_t)outside[d];
    b->boundary[k].x[d] = b->layout->origin[d] + unit * (double)x[d] + 0.5 * h;
    if (outside[d] == 0) continue;
    double face[3] = {0};
    for (int e = 0; e < DIM; e++) {
      face[e] = b->layout->origin[e] + unit * (double)x[e] + 0.5 * h;
    }
    face[d] += 0.5 * h * outside[d];
    int side = 2 * d + (outside[d] > 0);
    struct patch_shares shares = {0};
    int patch = b->layout->patch ? b->layout->patch(b->layout->patch_context,
                                                    side, face, h, &shares)
                                 : side;
    CHECK(patch >= 0 && patch < MESH_MAX_PATCHES, "patch %d", patch);
    b->boundary[k].patch[d] = (int8_t)patch;
    add_shares(b, k, d, &shares);
  }
  return node_name(KIND_BOUNDARY, k);
}

static int32_t stencil_node(struct builder *b, const int64_t place[DIM], int s,
                            int level) {
  const int o[] = {s % 3 - 1, s / 3 % 3 - 1, s / 9 - 1};
  int64_t x[DIM];
  int outside[DIM];
  bool inside = true;
  for (int d = 0; d < DIM; d++) {
    const int64_t extent = (int64_t)b->layout->trees[d] * morton_edge(0);
    x[d] = place[d] + o[d] * morton_edge(level);
    outside[d] = 0;
    if (x[d] >= 0 && x[d] < extent) continue;
    if (b->layout->periodic[d]) {
      x[d] += x[d] < 0 ? extent : -extent;
    } else {
      outside[d] = x[d] < 0 ? -1 : 1;
      x[d] = place[d];
      inside = false;
    }
  }
  int32_t node = node_at(b, morton_key(b->brick, x), level);
  return inside ? node : boundary_get(b, node, x, outside, level);
}

/* Ask other ranks for their parts of averages that our stencils read. */
static void ask_averages(struct builder *b) {
  struct mesh *mesh = b->mesh;
  struct plan *plan = &mesh->exchange->average;
  int32_t *needed = MEM_NEW(int32_t, b->naverages);
  const int32_t n = b->naverages;
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    for (int s = 0; s < NSTENCIL; s++) {
      int32_t node = mesh->stencil[i][s];
      if (node_kind(node) == KIND_BOUNDARY) {
        node = b->boundary[node_number(node)].source;
      }
      if (node_kind(node) == KIND_AVERAGE) needed[node_number(node)] = 1;
    }
  }
  b->nrequests = 0;
  for (int32_t k = 0; k < n; k++) {
    if (!needed[k]) continue;
    const struct average *a = &b->average[k];
    int last = key_rank(b, a->key + morton_span(a->level) - 1);
    for (int r = key_rank(b, a->key); r <= last; r++) {
      if (r != mesh->rank && b->first_keys[r] < b->first_keys[r + 1]) {
        request_add(b, a->key, a->level, r, k);
      }
    }
  }
  int64_t nasked;
  struct plan_request *asked =
      plan_ask(plan, b->nrequests, b->request, &nasked);
  for (int64_t k = 0; k < nasked; k++) {
    plan->send_index[k] =
        node_number(average_get(b, asked[k].key, asked[k].tag));
  }
  mem_free(asked);
  mem_free(needed);
}

/* Ask the ranks of ghosts to interpolate their virtual children. */
static void ask_virtuals(struct builder *b) {
  struct mesh *mesh = b->mesh;
  struct plan *plan = &mesh->exchange->virtual_node;
  b->nrequests = 0;
  for (int32_t k = 0; k < b->ngroups; k++) {
    int32_t leaf = b->group_leaf[k];
    if (leaf >= mesh->nleaves) {
      request_add(b, mesh->key[leaf], 0, key_rank(b, mesh->key[leaf]), k);
    }
  }
  int64_t nasked;
  struct plan_request *asked =
      plan_ask(plan, b->nrequests, b->request, &nasked);
  for (int64_t k = 0; k < nasked; k++) {
    int32_t leaf = leaf_at(b, asked[k].key);
    CHECK(leaf >= 0 && leaf < mesh->nleaves, "asked for an unknown leaf");
    plan->send_index[k] = node_number(virtual_get(b, leaf, 0)) / NCHILD;
  }
  mem_free(asked);
}

/* Give averages their final numbers, from the finest level down, so that one
 * loop can add them up; virtual groups of leaves of this rank come first. */
static int32_t *order_averages(const struct builder *b) {
  int32_t *place = MEM_NEW(int32_t, b->naverages);
  int32_t begin[FOREST_MAX_LEVEL + 2] = {0};
  for (int32_t k = 0; k < b->naverages; k++) {
    begin[FOREST_MAX_LEVEL - b->average[k].level + 1]++;
  }
  for (int l = 0; l <= FOREST_MAX_LEVEL; l++) begin[l + 1] += begin[l];
  for (int32_t k = 0; k < b->naverages; k++) {
    place[k] = begin[FOREST_MAX_LEVEL - b->average[k].level]++;
  }
  return place;
}

static int32_t *order_groups(struct builder *b) {
  struct mesh *mesh = b->mesh;
  int32_t *place = MEM_NEW(int32_t, b->ngroups);
  int32_t n = 0;
  for (int32_t k = 0; k < b->ngroups; k++) {
    if (b->group_leaf[k] < mesh->nleaves) place[k] = n++;
  }
  mesh->nvirtual_local = n;
  for (int32_t k = 0; k < b->ngroups; k++) {
    if (b->group_leaf[k] >= mesh->nleaves) place[k] = n++;
  }
  return place;
}

static int32_t final_index(const struct mesh *mesh, const int32_t *average,
                           const int32_t *group, int32_t node) {
  const int32_t k = node < 0 ? -1 : node_number(node);
  if (k < 0) return -1;
  switch (node_kind(node)) {
    case KIND_AVERAGE:
      return mesh->begin_average + average[k];
    case KIND_VIRTUAL:
      return mesh->begin_virtual + NCHILD * group[k / NCHILD] + k % NCHILD;
    case KIND_BOUNDARY:
      return mesh->begin_boundary + k;
    default:
      return node;
  }
}

/* Set the slope of a coarse leaf along axis d: centred where both neighbours
 * are cells or averages, else one-sided. */
static void set_slope(struct mesh *mesh, int32_t group, int d) {
  const int32_t leaf = mesh->virtual_leaf[group];
  int32_t *node = mesh->virtual_slope[group][d];
  int steps = 0;
  for (int side = 0; side < 2; side++) {
    int32_t next = mesh->stencil[leaf][stencil_face(2 * d + side)];
    bool usable = next < mesh->begin_virtual;
    node[side] = usable ? next : leaf;
    steps += usable;
  }
  mesh->virtual_weight[group][d] = steps ? 0.25 / steps : 0;
}

static void set_helpers(struct builder *b, const int32_t *average,
                        const int32_t *group) {
  struct mesh *mesh = b->mesh;
  mesh->average_child =
      mem_alloc((size_t)b->naverages, sizeof *mesh->average_child);
  for (int32_t k = 0; k < b->naverages; k++) {
    for (int c = 0; c < NCHILD; c++) {
      mesh->average_child[average[k]][c] =
          final_index(mesh, average, group, b->average[k].child[c]);
    }
  }
  const size_t local = (size_t)mesh->nvirtual_local;
  mesh->virtual_leaf = MEM_NEW(int32_t, b->ngroups);
  mesh->virtual_slope = mem_alloc(local, sizeof *mesh->virtual_slope);
  mesh->virtual_weight = mem_alloc(local, sizeof *mesh->virtual_weight);
  for (int32_t k = 0; k < b->ngroups; k++) {
    mesh->virtual_leaf[group[k]] = b->group_leaf[k];
  }
  for (int32_t k = 0; k < mesh->nvirtual_local; k++) {
    for (int d = 0; d < DIM; d++) set_slope(mesh, k, d);
  }
  mesh->boundary_source = MEM_NEW(int32_t, b->nboundary);
  mesh->boundary_h = MEM_NEW(double, b->nboundary);
  mesh->boundary_patch =
      mem_alloc((size_t)b->nboundary, sizeof *mesh->boundary_patch);
  mesh->boundary_outside =
      mem_alloc((size_t)b->nboundary, sizeof *mesh->boundary_outside);
  mesh->boundary_x = mem_alloc((size_t)b->nboundary, sizeof *mesh->boundary_x);
  for (int32_t k = 0; k < b->nboundary; k++) {
    mesh->boundary_source[k] =
        final_index(mesh, average, group, b->boundary[k].source);
    mesh->boundary_h[k] = b->boundary[k].h;
    memcpy(mesh->boundary_patch[k], b->boundary[k].patch, DIM);
    memcpy(mesh->boundary_outside[k], b->boundary[k].outside, DIM);
    memcpy(mesh->boundary_x[k], b->boundary[k].x, sizeof *mesh->boundary_x);
  }
}

static void set_plans(struct mesh *mesh, const int32_t *average,
                      const int32_t *group) {
  struct plan *plan = &mesh->exchange->average;
  for (int32_t k = 0; k < plan->send_begin[plan->nranks]; k++) {
    plan->send_index[k] = mesh->begin_average + average[plan->send_index[k]];
  }
  for (int32_t k = 0; k < plan->recv_begin[plan->nranks]; k++) {
    plan->recv_index[k] = mesh->begin_average + average[plan->recv_index[k]];
  }
  plan = &mesh->exchange->virtual_node;
  for (int32_t k = 0; k < plan->send_begin[plan->nranks]; k++) {
    plan->send_index[k] = group[plan->send_index[k]];
  }
  for (int32_t k = 0; k < plan->recv_begin[plan->nranks]; k++) {
    plan->recv_index[k] = group[plan->recv_index[k]];
  }
}

/* Find the parts along each axis of the keys of a cell and those around it,
 * which are their sum; returns false if some are in another tree or outside. */
static bool find_parts(uint64_t key, int level, uint64_t part[DIM][3]) {
  const uint64_t tree = key & ~(morton_span(0) - 1);
  bool inside = true;
  for (int d = 0; d < DIM; d++) {
    const uint64_t bits = morton_spread(morton_edge(0) - 1) << d;
    const uint64_t step = morton_span(level) << d, here = key & bits;
    part[d][0] = (here - step) & bits;
    part[d][1] = here;
    part[d][2] = ((here | ~bits) + step) & bits;
    inside = inside && part[d][0] < here && part[d][2] > here;
    for (int k = 0; k < 3 && d == 0; k++) part[d][k] += tree;
  }
  return inside;
}

/* Link the NCHILD leaves from i on with each other if they are siblings. */
static void link_siblings(const struct mesh *mesh, int32_t i) {
  const int last = NCHILD - 1, level = mesh->level[i];
  if (level == 0 || i + last >= mesh->nleaves) return;
  const uint64_t span = morton_span(level), key = mesh->key[i];
  if (key % (NCHILD * span) != 0 || mesh->level[i + last] != level ||
      mesh->key[i + last] != key + (uint64_t)last * span) {
    return;
  }
  for (int a = 0; a < NCHILD; a++) {
    for (int b = 0; b < NCHILD; b++) {
      int s = STENCIL_CENTRE;
      for (int d = 0; d < DIM; d++) {
        s += stencil_step(d) * ((b >> d & 1) - (a >> d & 1));
      }
      mesh->stencil[i + a][s] = i + b;
    }
  }
}

/* Find the nodes of all stencils by name. Leaves of one size are in each
 * other's stencil, so half of them, and those between siblings, need no search.
 */
static void find_nodes(struct builder *b) {
  const struct mesh *mesh = b->mesh;
  enum { UNKNOWN = 0xff };
  memset(mesh->stencil, UNKNOWN, (size_t)mesh->nleaves * sizeof *mesh->stencil);
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    int64_t x[DIM];
    uint64_t part[DIM][3];
    int32_t *node = mesh->stencil[i];
    const bool inside = find_parts(mesh->key[i], mesh->level[i], part);
    if (!inside) morton_coordinates(b->brick, mesh->key[i], x);
    node[STENCIL_CENTRE] = i;
    link_siblings(mesh, i);
    for (int s = 0; s < NSTENCIL; s++) {
      if (node[s] >= 0) continue;
      uint64_t key = part[0][s % 3] + part[1][s / 3 % 3];
      if (DIM == 3) key += part[DIM - 1][s / 9];
      node[s] = inside ? node_at(b, key, mesh->level[i])
                       : stencil_node(b, x, s, mesh->level[i]);
      if (node[s] < mesh->nleaves) {
        mesh->stencil[node[s]][NSTENCIL - 1 - s] = i;
      }
    }
  }
}

void build_stencils(struct builder *b) {
  struct mesh *mesh = b->mesh;
  const int32_t n = mesh->nleaves + mesh->nghosts;
  b->group_of = MEM_NEW(int32_t, n);
  for (int32_t i = 0; i < n; i++) b->group_of[i] = -1;
  mesh->stencil = mem_alloc((size_t)mesh->nleaves, sizeof *mesh->stencil);
  find_nodes(b);
  plan_begin(&mesh->exchange->average, mesh->comm);
  plan_begin(&mesh->exchange->virtual_node, mesh->comm);
  if (mesh->nranks > 1) {
    ask_virtuals(b);
    ask_averages(b);
  }
  int32_t *average = order_averages(b), *group = order_groups(b);
  mesh->begin_average = n;
  mesh->begin_virtual = n + b->naverages;
  mesh->begin_boundary = mesh->begin_virtual + NCHILD * b->ngroups;
  mesh->ncells = mesh->begin_boundary + b->nboundary;
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    for (int s = 0; s < NSTENCIL; s++) {
      int32_t *node = &mesh->stencil[i][s];
      if (node_kind(*node) == KIND_LEAF) continue;
      *node = final_index(mesh, average, group, *node);
    }
  }
  set_helpers(b, average, group);
  set_plans(mesh, average, group);
  mem_free(average);
  mem_free(group);
}
