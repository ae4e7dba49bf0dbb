/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Leaves and ghosts.
 *
 * A leaf is sent to every rank that owns part of one of the 3^DIM - 1
 * regions of its own size around it. If A touches B on another rank, the
 * finer of the two has the other in such a region, and the coarser has the
 * finer inside one: the rule is symmetric and needs no search of the tree.
 */
#include <string.h>

#include "builder.h"
#include "talus/error.h"
#include "talus/memory.h"

struct ghost_leaf {
  uint64_t key;
  int32_t level;
  int32_t rank; /* destination while sending */
  int32_t leaf;
};

struct ghost_list {
  struct ghost_leaf *leaf;
  int32_t n, capacity;
};

/* Find the key of the region at integer offset o from x; returns false outside
 * the domain. */
static bool region_key(const struct builder *b, const int64_t x[DIM],
                       const int o[DIM], int level, uint64_t *key) {
  int64_t place[DIM];
  for (int d = 0; d < DIM; d++) {
    const int64_t extent = (int64_t)b->layout->trees[d] * morton_edge(0);
    place[d] = x[d] + o[d] * morton_edge(level);
    if (place[d] < 0 || place[d] >= extent) {
      if (!b->layout->periodic[d]) return false;
      place[d] += place[d] < 0 ? extent : -extent;
    }
  }
  *key = morton_key(b->brick, place);
  return true;
}

static void list_add(struct ghost_list *list, struct ghost_leaf leaf) {
  for (int32_t k = list->n - 1; k >= 0 && list->leaf[k].leaf == leaf.leaf;
       k--) {
    if (list->leaf[k].rank == leaf.rank) return;
  }
  int32_t k =
      list_grow((void **)&list->leaf, &list->n, &list->capacity, sizeof leaf);
  list->leaf[k] = leaf;
}

static void find_receivers(struct builder *b, int32_t i,
                           struct ghost_list *list) {
  const struct mesh *mesh = b->mesh;
  const uint64_t first = b->first_keys[mesh->rank];
  const uint64_t end = b->first_keys[mesh->rank + 1];
  const uint64_t span = morton_span(mesh->level[i]);
  int64_t x[DIM];
  morton_coordinates(b->brick, mesh->key[i], x);
  for (int s = 0; s < NSTENCIL; s++) {
    const int all[] = {s % 3 - 1, s / 3 % 3 - 1, s / 9 - 1};
    uint64_t key;
    if (s == STENCIL_CENTRE || !region_key(b, x, all, mesh->level[i], &key) ||
        (key >= first && key + span <= end)) {
      continue;
    }
    int last = key_rank(b, key + span - 1);
    for (int r = key_rank(b, key); r <= last; r++) {
      if (r == mesh->rank || b->first_keys[r] == b->first_keys[r + 1]) continue;
      list_add(list, (struct ghost_leaf){mesh->key[i], mesh->level[i], r, i});
    }
  }
}

/* Sort the list, by counting, by rank into plan->send_index and `out`. */
static struct ghost_leaf *sort_receivers(const struct ghost_list *list,
                                         struct plan *plan) {
  struct ghost_leaf *out = MEM_NEW(struct ghost_leaf, list->n);
  int32_t *next = MEM_NEW(int32_t, plan->nranks + 1);
  for (int32_t k = 0; k < list->n; k++) {
    plan->send_begin[list->leaf[k].rank + 1]++;
  }
  for (int r = 0; r < plan->nranks; r++) {
    plan->send_begin[r + 1] += plan->send_begin[r];
    next[r] = plan->send_begin[r];
  }
  plan->send_index = MEM_NEW(int32_t, list->n);
  for (int32_t k = 0; k < list->n; k++) {
    int32_t to = next[list->leaf[k].rank]++;
    out[to] = list->leaf[k];
    plan->send_index[to] = list->leaf[k].leaf;
  }
  mem_free(next);
  return out;
}

/* Swap ghost leaves; ghosts arrive sorted by rank, so by key. Counts are in
 * leaves, not in bytes, which would reach 2^31 much sooner. */
static struct ghost_leaf *swap_ghosts(struct plan *plan,
                                      const struct ghost_leaf *out) {
  const int nranks = plan->nranks;
  int *nsend = MEM_NEW(int, 2 * nranks), *nrecv = nsend + nranks;
  for (int r = 0; r < nranks; r++) {
    nsend[r] = plan->send_begin[r + 1] - plan->send_begin[r];
  }
  MPI_CHECK(MPI_Alltoall(nsend, 1, MPI_INT, nrecv, 1, MPI_INT, plan->comm));
  for (int r = 0; r < nranks; r++) {
    plan->recv_begin[r + 1] =
        count_index((int64_t)plan->recv_begin[r] + nrecv[r], "ghosts");
  }
  struct ghost_leaf *in = MEM_NEW(struct ghost_leaf, plan->recv_begin[nranks]);
  MPI_Datatype type = plan_type_new(sizeof *out);
  MPI_CHECK(MPI_Alltoallv(out, nsend, plan->send_begin, type, in, nrecv,
                          plan->recv_begin, type, plan->comm));
  MPI_CHECK(MPI_Type_free(&type));
  mem_free(nsend);
  return in;
}

static void add_ghosts(struct builder *b) {
  struct mesh *mesh = b->mesh;
  struct plan *plan = &mesh->exchange->ghost;
  struct ghost_list list = {0};
  for (int32_t i = 0; i < mesh->nleaves; i++) find_receivers(b, i, &list);
  struct ghost_leaf *out = sort_receivers(&list, plan);
  struct ghost_leaf *in = swap_ghosts(plan, out);
  const int32_t n = mesh->nleaves;
  mesh->nghosts = plan->recv_begin[mesh->nranks];
  count_check((int64_t)n + mesh->nghosts, KIND_MOST, "leaves and ghosts");
  const size_t total = (size_t)n + (size_t)mesh->nghosts;
  plan->recv_index = MEM_NEW(int32_t, mesh->nghosts);
  mesh->key = mem_resize(mesh->key, total, sizeof *mesh->key);
  mesh->level = mem_resize(mesh->level, total, sizeof *mesh->level);
  for (int32_t g = 0; g < mesh->nghosts; g++) {
    plan->recv_index[g] = n + g;
    mesh->key[n + g] = in[g].key;
    mesh->level[n + g] = (int8_t)in[g].level;
  }
  mem_free(out);
  mem_free(in);
  mem_free(list.leaf);
}

static void set_geometry(struct builder *b) {
  struct mesh *mesh = b->mesh;
  const int32_t n = mesh->nleaves + mesh->nghosts;
  const double unit = b->layout->size / (double)morton_edge(0);
  mesh->x = mem_alloc((size_t)n, sizeof *mesh->x);
  mesh->h = MEM_NEW(double, n);
  index_begin(&b->leaves, mesh->key, mesh->nleaves);
  index_begin(&b->ghosts, mesh->key + mesh->nleaves, mesh->nghosts);
  hash_begin(&b->hash, n / 8);
  for (int32_t i = 0; i < n; i++) {
    int64_t x[DIM];
    const double edge = (double)morton_edge(mesh->level[i]);
    morton_coordinates(b->brick, mesh->key[i], x);
    mesh->h[i] = unit * edge;
    for (int d = 0; d < DIM; d++) {
      mesh->x[i][d] = b->layout->origin[d] + unit * ((double)x[d] + 0.5 * edge);
    }
  }
}

void build_leaves(struct builder *b) {
  struct mesh *mesh = b->mesh;
  plan_begin(&mesh->exchange->ghost, mesh->comm);
  mesh->nleaves = forest_nleaves(mesh->forest);
  count_check(mesh->nleaves, KIND_MOST, "leaves");
  mesh->key = MEM_NEW(uint64_t, mesh->nleaves);
  mesh->level = MEM_NEW(int8_t, mesh->nleaves);
  forest_keys(mesh->forest, mesh->key);
  forest_levels(mesh->forest, mesh->level);
  if (mesh->nranks > 1) add_ghosts(b);
  set_geometry(b);
}
