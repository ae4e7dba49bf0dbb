/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Making a hierarchy from the sorted leaves.
 *
 * A leaf whose first corner is the first corner of coarser nodes opens the
 * families below them, so one pass over the leaves lists all families in
 * Morton order. Parents are found by merging two sorted lists, neighbours from
 * the parents' neighbours (links.c); keys are searched for only next to other
 * ranks (ghosts.c). */
#include "talus/hierarchy.h"

#include <string.h>

#include "linking.h"
#include "talus/count.h"
#include "talus/error.h"
#include "talus/memory.h"

/* Return the coarsest level of which a node has its first corner at `key`. */
static int coarsest_at(uint64_t key) {
  const uint64_t morton = key & (morton_span(0) - 1);
  if (morton == 0) return 0;
  return FOREST_MAX_LEVEL - __builtin_ctzll(morton) / DIM;
}

/* Make lists of families, by the leaves of this rank. */
static void list_families(struct linking *k) {
  struct hierarchy *h = k->h;
  const struct mesh *mesh = h->mesh;
  for (int pass = 0; pass < 2; pass++) {
    for (int l = 0; l < h->nlevels; l++) {
      if (pass) k->parent_key[l] = MEM_NEW(uint64_t, h->level[l].nfamilies);
      h->level[l].nfamilies = 0;
    }
    for (int32_t i = 0; i < mesh->nleaves; i++) {
      for (int l = coarsest_at(mesh->key[i]); l < mesh->level[i]; l++) {
        const int32_t n = h->level[l + 1].nfamilies++;
        if (pass) k->parent_key[l + 1][n] = mesh->key[i];
      }
    }
  }
}

static void gather_level(struct linking *k, int l) {
  struct level *level = &k->h->level[l];
  const MPI_Comm comm = k->h->mesh->comm;
  int *count = MEM_NEW(int, 2 * k->nranks), *begin = count + k->nranks;
  int mine = level->nfamilies, total = 0;
  MPI_CHECK(MPI_Gather(&mine, 1, MPI_INT, count, 1, MPI_INT, 0, comm));
  for (int r = 0; r < k->nranks; r++) {
    begin[r] = total;
    total += count[r];
  }
  uint64_t *all = MEM_NEW(uint64_t, total);
  MPI_CHECK(MPI_Gatherv(k->parent_key[l], mine, MPI_UINT64_T, all, count, begin,
                        MPI_UINT64_T, 0, comm));
  mem_free(k->parent_key[l]);
  mem_free(count);
  k->parent_key[l] = all;
  level->nfamilies = total;
}

/* Give small levels, from the coarsest on, to rank 0. */
static void gather_levels(struct linking *k) {
  struct hierarchy *h = k->h;
  int64_t n[FOREST_MAX_LEVEL + 1] = {0};
  for (int l = 0; l < h->nlevels; l++) n[l] = h->level[l].nfamilies;
  MPI_CHECK(MPI_Allreduce(MPI_IN_PLACE, n, h->nlevels, MPI_INT64_T, MPI_SUM,
                          h->mesh->comm));
  for (int l = 1; l < h->nlevels && n[l] * NCHILD <= LEVEL_GATHERED; l++) {
    k->gathered = l;
    gather_level(k, l);
  }
}

static void number_slots(struct linking *k) {
  struct hierarchy *h = k->h;
  int64_t slots = 0, families = 0;
  for (int l = 0; l < h->nlevels; l++) {
    struct level *level = &h->level[l];
    level->begin = (int32_t)slots;
    level->family_begin = (int32_t)families;
    level->nowned =
        count_index(NCHILD * (int64_t)level->nfamilies, "nodes of a level");
    if (l == 0 && k->rank == 0) level->nowned = k->brick->ntrees;
    slots += level->nowned;
    families += level->nfamilies;
    /* with ghosts, virtual children and images, of which each has a slot */
    count_check(slots, INT32_MAX / (2 * DIM), "nodes of the hierarchy");
  }
  h->nowned = h->nactive = (int32_t)slots;
  h->family_parent = MEM_NEW(int32_t, families);
}

/* Return the slot of the node at `key` of a level, by moving `cursor` up the
 * sorted list of families. */
static int32_t find_next(const struct linking *k, int l, uint64_t key,
                         int32_t *cursor) {
  if (l == 0) return linking_find(k, 0, key);
  const struct level *level = &k->h->level[l];
  const uint64_t parent = key_align(key, l - 1);
  while (*cursor < level->nfamilies && k->parent_key[l][*cursor] < parent) {
    ++*cursor;
  }
  if (*cursor == level->nfamilies || k->parent_key[l][*cursor] != parent) {
    return SLOT_UNKNOWN;
  }
  return family_slot(level, *cursor, key_child(key, l));
}

static void find_parents(struct linking *k) {
  struct hierarchy *h = k->h;
  for (int l = 1; l < h->nlevels; l++) {
    const struct level *level = &h->level[l];
    int32_t cursor = 0;
    for (int32_t n = 0; n < level->nfamilies; n++) {
      const uint64_t key = k->parent_key[l][n];
      int32_t slot = find_next(k, l - 1, key, &cursor);
      if (slot == SLOT_UNKNOWN) slot = ghosts_get(k, key, l - 1);
      h->family_parent[level->family_begin + n] = slot;
    }
  }
  h->nactive = h->nowned + k->nghosts;
  k->slot_family = MEM_NEW(int32_t, h->nactive);
  for (int32_t i = 0; i < h->nactive; i++) k->slot_family[i] = -1;
  for (int l = 1; l < h->nlevels; l++) {
    const struct level *level = &h->level[l];
    for (int32_t n = 0; n < level->nfamilies; n++) {
      k->slot_family[h->family_parent[level->family_begin + n]] = n;
    }
  }
}

static void find_leaves(struct linking *k) {
  struct hierarchy *h = k->h;
  const struct mesh *mesh = h->mesh;
  int32_t cursor[FOREST_MAX_LEVEL + 1] = {0};
  h->leaf_slot = MEM_NEW(int32_t, mesh->nleaves);
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    const int l = mesh->level[i];
    int32_t slot = find_next(k, l, mesh->key[i], &cursor[l]);
    if (slot == SLOT_UNKNOWN) slot = ghosts_get(k, mesh->key[i], l);
    h->leaf_slot[i] = slot;
  }
}

/* Divide the list of sides of owned nodes, which are in the order of levels. */
static void divide_sides(struct hierarchy *h) {
  int32_t k = 0;
  for (int l = 0; l < h->nlevels; l++) {
    struct level *level = &h->level[l];
    level->side_begin = k;
    while (k < h->nsides && h->sides[k].slot < level->begin + level->nowned) {
      k++;
    }
    level->side_end = k;
  }
}

/* Find the patches of walls, from the leaves up; of several patches on the side
 * of a merged node one is taken. They travel in h->w, which is not needed
 * before the next coefficients, plus one. */
static void carry_patches(struct hierarchy *h) {
  const struct mesh *mesh = h->mesh;
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    for (int f = 0; f < NFACE; f++) {
      const int32_t face = mesh->cell_face[i][f];
      if (face < mesh->nfaces) {
        h->w[f][h->leaf_slot[i]] = (float)(mesh->face_patch[face] + 1);
      }
    }
  }
  for (int l = h->nlevels - 1; l >= 0; l--) {
    const struct level *level = &h->level[l];
    plan_run_float(&h->level[l].add, NFACE, h->w, true);
    for (int32_t k = 0; k < level->nfamilies; k++) {
      const int32_t parent = h->family_parent[level->family_begin + k];
      for (int c = 0; c < NCHILD; c++) {
        for (int d = 0; d < DIM; d++) {
          const int f = 2 * d + (c >> d & 1);
          h->w[f][parent] = h->w[f][family_slot(level, k, c)];
        }
      }
    }
  }
  for (int l = 0; l < h->nlevels; l++) {
    plan_run_float(&h->level[l].copy, NFACE, h->w, false);
  }
}

/* Set the patches of all sides to what has been carried. */
static void set_patches(struct hierarchy *h) {
  for (int32_t k = 0; k < h->nsides; k++) {
    struct side *side = &h->sides[k];
    const int32_t i = side->slot;
    for (int f = 0; f < NFACE; f++) {
      side->patch[f] = (int8_t)(h->wall[i] >> f & 1 ? h->w[f][i] - 1 : -1);
    }
  }
}

static void find_patches(struct hierarchy *h) {
  int32_t n = 0;
  carry_patches(h);
  for (int32_t i = 0; i < h->nactive; i++) h->nsides += h->wall[i] != 0;
  h->sides = MEM_NEW(struct side, h->nsides);
  for (int32_t i = 0; i < h->nactive; i++) {
    if (h->wall[i]) h->sides[n++].slot = i;
  }
  set_patches(h);
}

void hierarchy_renew_patches(struct hierarchy *h) {
  for (int f = 0; f < NFACE && h->nranks > 1; f++) { /* others add to these */
    memset(h->w[f], 0, (size_t)h->nslots * sizeof *h->w[f]);
  }
  carry_patches(h);
  set_patches(h);
  for (int32_t k = 0; k < h->nmirrors; k++) {
    struct mirror *mirror = &h->mirror[k];
    mirror->patch = h->sides[mirror->side].patch[mirror->face];
  }
}

static void allocate_sides(struct hierarchy *h) {
  const struct level *last = &h->level[h->nlevels - 1];
  const size_t nfamilies = (size_t)(last->family_begin + last->nfamilies);
  for (int f = 0; f < NFACE; f++) {
    h->w[f] = MEM_NEW(float, h->nslots);
    h->limit[f] = MEM_NEW(float, nfamilies);
  }
}

/* Return the number of values beyond the slots: virtual children, then images.
 */
static int64_t nvalues(const struct hierarchy *h) {
  return (int64_t)h->nslots + h->njumps + h->nmirrors;
}

static int64_t arena_length(const struct hierarchy *h) {
  const struct mesh *mesh = h->mesh;
  const int64_t inner = nvalues(h) + h->nslots + h->apart_room;
  const int64_t hoop = mesh_is_axisymmetric(mesh) ? mesh->nfaces_all : 0;
  const int64_t outer = DIM * ((int64_t)mesh->ncells + mesh->nfaces_all) + hoop;
  return NODE_ROOM * inner > outer ? NODE_ROOM * inner : outer;
}

/* Return how many nodes of a level wait for others of their colour. */
static int64_t most_apart(const struct hierarchy *h) {
  int64_t most = 0;
  for (int l = 0; l < h->nlevels; l++) {
    const int64_t n = h->level[l].nfamilies;
    most = n > most ? n : most;
  }
  return DIM == 2 ? 0 : most;
}

static void allocate(struct hierarchy *h) {
  const struct mesh *mesh = h->mesh;
  const size_t nleaves = (size_t)mesh->nleaves * DIM;
  h->beyond = mem_alloc((size_t)h->nlevels, sizeof *h->beyond);
  h->apart_room = most_apart(h);
  h->arena = MEM_NEW(double, arena_length(h));
  h->inverse[0] = MEM_NEW(double, (int64_t)NODE_ROOM * h->nslots);
  h->e[0] = h->arena;
  h->r[0] = h->e[0] + NODE_ROOM * nvalues(h);
  h->apart = h->r[0] + NODE_ROOM * (int64_t)h->nslots;
  h->work_cells = h->arena;
  h->work_faces = h->arena + (int64_t)DIM * mesh->ncells;
  for (int k = 0; k < 3; k++) {
    h->coarse[k] = MEM_NEW(double, h->level[0].nowned);
  }
  h->residual = MEM_NEW(double, nleaves);
  h->weight = MEM_NEW(float, nleaves);
  h->krylov = krylov_space_new();
}

/* Return the radius of the node of a level at `key`. */
static double radius_at(const struct linking *k, int l, uint64_t key) {
  const double unit = k->layout->size / (double)morton_edge(0);
  int64_t x[DIM];
  morton_coordinates(k->brick, key, x);
  return k->layout->origin[0] +
         unit * ((double)x[0] + 0.5 * (double)morton_edge(l));
}

static void set_radii(struct linking *k) {
  struct hierarchy *h = k->h;
  h->radius = MEM_NEW(double, h->nowned);
  for (int32_t i = 0; i < h->level[0].nowned; i++) {
    h->radius[i] = radius_at(k, 0, (uint64_t)i << MORTON_BITS);
  }
  for (int l = 1; l < h->nlevels; l++) {
    const struct level *level = &h->level[l];
    for (int32_t n = 0; n < level->nfamilies; n++) {
      for (int c = 0; c < NCHILD; c++) {
        const uint64_t offset = (uint64_t)c * morton_span(l);
        h->radius[family_slot(level, n, c)] =
            radius_at(k, l, k->parent_key[l][n] + offset);
      }
    }
  }
}

struct hierarchy *hierarchy_new(const struct mesh *mesh) {
  struct hierarchy *h = MEM_NEW(struct hierarchy, 1);
  h->mesh = mesh;
  h->revision = mesh->revision;
  h->nlevels = mesh->level_finest + 1;
  h->nranks = mesh->nranks;
  h->nleaves = mesh->nleaves;
  h->level = MEM_NEW(struct level, h->nlevels);
  struct linking k = {.h = h,
                      .brick = forest_brick(mesh->forest),
                      .layout = forest_layout(mesh->forest),
                      .first_keys = mesh->first_keys,
                      .rank = mesh->rank,
                      .nranks = mesh->nranks};
  k.parent_key = MEM_NEW(uint64_t *, h->nlevels);
  hash_begin(&k.ghosts, 0);
  list_families(&k);
  if (k.nranks > 1) gather_levels(&k);
  number_slots(&k);
  find_parents(&k);
  find_leaves(&k);
  links_make(&k);
  for (int l = 0; l < h->nlevels; l++) {
    plan_begin(&h->level[l].copy, mesh->comm);
    plan_begin(&h->level[l].add, mesh->comm);
  }
  if (k.nranks > 1) ghosts_make(&k);
  h->nslots = h->nowned + k.nghosts;
  jumps_make(&k);
  allocate_sides(h);
  find_patches(h);
  divide_sides(h);
  mirrors_make(&k);
  allocate(h);
  if (mesh_is_axisymmetric(mesh)) set_radii(&k);
  for (int l = 0; l < h->nlevels; l++) mem_free(k.parent_key[l]);
  mem_free(k.parent_key);
  mem_free(k.slot_family);
  mem_free(k.key);
  mem_free(k.level_of);
  mem_free(k.wanted);
  mem_free(k.ghost_key);
  mem_free(k.ghost_level);
  hash_end(&k.ghosts);
  return h;
}

void hierarchy_destroy(struct hierarchy *h) {
  if (!h) return;
  for (int l = 0; l < h->nlevels; l++) {
    struct plan *add = &h->level[l].add, *copy = &h->level[l].copy;
    if (add->send_begin == copy->recv_begin) { /* borrowed */
      add->send_begin = add->recv_begin = NULL;
      add->send_index = add->recv_index = NULL;
    }
    plan_end(add);
    plan_end(copy);
  }
  krylov_space_destroy(h->krylov);
  void *owned[] = {h->mirror,     h->sides,        h->beyond,
                   h->level,      h->leaf_slot,    h->family_parent,
                   h->wall,       h->jump,         h->coarse[0],
                   h->coarse[1],  h->coarse[2],    h->arena,
                   h->radius,     h->residual,     h->weight,
                   h->rough,      h->rough_begin,  h->skin_node,
                   h->skin_begin, h->mirror_order, h->mirror_run};
  for (size_t k = 0; k < sizeof owned / sizeof *owned; k++) mem_free(owned[k]);
  for (int f = 0; f < NFACE; f++) {
    mem_free(h->neighbour[f]);
    mem_free(h->w[f]);
    mem_free(h->bulk[f]);
    mem_free(h->limit[f]);
  }
  for (int e = 0; e < NCORNER; e++) mem_free(h->corner[e]);
  mem_free(h->inverse[0]);
  mem_free(h);
}
