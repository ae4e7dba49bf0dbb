/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Invariants
 * 1. Nodes [0, nleaves) are the leaves; inner nodes follow, parents before
 *    their children.
 * 2. A straddling node has leaves on several ranks. All ranks that hold part
 *    of it know the net outflow of all its children before it is treated,
 *    and treat it alike.
 */
#include "talus/clean.h"

#include <math.h>
#include <string.h>

#include "talus/error.h"
#include "talus/forest.h"
#include "talus/memory.h"
#include "talus/minmax.h"
#include "talus/morton.h"

struct clean {
  uint64_t revision;
  int32_t ninner, capacity;
  int32_t (*child)[NCHILD]; /* [ninner] nodes, -1: on another rank */
  int8_t *level;            /* [ninner] */
  uint64_t *key;            /* [ninner] */
  double *slant;            /* [ninner] of rings (mesh.h), NULL in a plane */
  int32_t *slot;            /* [ninner] place in `shared`, -1: all ours */
  int32_t *root;            /* [ntrees] node, -1: on another rank */
  int32_t ntrees;
  int trees[DIM];
  uint64_t tree_span;
  int32_t *tree_number; /* [ntrees] number of the tree at a place */
  uint8_t *owned;    /* [nleaves] bit f: the leaf changes face f of its own */
  int32_t *boundary; /* [nboundary] faces on patches */
  int32_t nboundary;
  int32_t nslots;
  double *shared;          /* [nslots NCHILD] */
  double *net;             /* [nleaves + ninner] outflow, m^DIM/s */
  double (*change)[NFACE]; /* [ninner] change of face fluxes */
  double *tree_net;        /* [ntrees] */
  double (*tree_change)[NFACE];
};

static int32_t add_inner(struct clean *clean, uint64_t key, int level) {
  if (clean->ninner == clean->capacity) {
    clean->capacity = 2 * clean->capacity + 64;
    const size_t n = (size_t)clean->capacity;
    clean->child = mem_resize(clean->child, n, sizeof *clean->child);
    clean->level = mem_resize(clean->level, n, sizeof *clean->level);
    clean->key = mem_resize(clean->key, n, sizeof *clean->key);
  }
  const int32_t k = clean->ninner++;
  for (int c = 0; c < NCHILD; c++) clean->child[k][c] = -1;
  clean->level[k] = (int8_t)level;
  clean->key[k] = key;
  return k;
}

/* Link the nodes by one walk over the sorted leaves, with the open path from
 * the root. */
static void link_nodes(struct clean *clean, const struct mesh *mesh) {
  int32_t path[FOREST_MAX_LEVEL + 1];
  uint64_t path_key[FOREST_MAX_LEVEL + 1];
  int open = 0; /* levels [0, open) of the path are valid */
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    const int level = mesh->level[i];
    int l = 0;
    while (l < open && l < level &&
           (mesh->key[i] & ~(mesh_key_span(l) - 1)) == path_key[l]) {
      l++;
    }
    for (open = l; open <= level; open++) {
      const uint64_t key = mesh->key[i] & ~(mesh_key_span(open) - 1);
      int32_t node = i;
      if (open < level) {
        path[open] = add_inner(clean, key, open);
        path_key[open] = key;
        node = mesh->nleaves + path[open];
      }
      if (open == 0) {
        clean->root[key / clean->tree_span] = node;
      } else {
        const int c = (int)(key / mesh_key_span(open)) & (NCHILD - 1);
        clean->child[path[open - 1]][c] = node;
      }
    }
    open = level;
  }
}

/* Mark the nodes that straddle ranks, as a rank's share begins inside them;
 * such a node is named by its level and the first such rank. */
static void mark_straddling(struct clean *clean, const struct mesh *mesh) {
  clean->slot = MEM_NEW(int32_t, clean->ninner);
  clean->nslots = mesh->nranks * (FOREST_MAX_LEVEL + 1);
  for (int32_t k = 0; k < clean->ninner; k++) {
    const uint64_t key = clean->key[k];
    const uint64_t end = key + mesh_key_span(clean->level[k]);
    clean->slot[k] = -1;
    if (key >= mesh->first_keys[mesh->rank] &&
        end <= mesh->first_keys[mesh->rank + 1]) {
      continue;
    }
    for (int r = 1; r < mesh->nranks; r++) {
      if (mesh->first_keys[r] > key && mesh->first_keys[r] < end) {
        clean->slot[k] = r * (FOREST_MAX_LEVEL + 1) + clean->level[k];
        break;
      }
    }
  }
  clean->shared = MEM_NEW(double, (size_t)clean->nslots *NCHILD);
}

/* Number the trees by place, from their first leaves. */
static void number_trees(struct clean *clean, const struct mesh *mesh) {
  const struct forest_layout *layout = forest_layout(mesh->forest);
  clean->ntrees = 1;
  for (int d = 0; d < DIM; d++) {
    clean->trees[d] = layout->trees[d];
    clean->ntrees *= layout->trees[d];
  }
  clean->tree_span = mesh_key_span(0);
  clean->root = MEM_NEW(int32_t, clean->ntrees);
  clean->tree_number = MEM_NEW(int32_t, clean->ntrees);
  clean->tree_net = MEM_NEW(double, clean->ntrees);
  clean->tree_change =
      mem_alloc((size_t)clean->ntrees, sizeof *clean->tree_change);
  for (int32_t t = 0; t < clean->ntrees; t++) {
    clean->root[t] = -1;
    clean->tree_number[t] = -1;
  }
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    int32_t place = 0;
    for (int d = DIM - 1; d >= 0; d--) {
      double x = (mesh->x[i][d] - layout->origin[d]) / layout->size;
      place = place * clean->trees[d] + (int32_t)x;
    }
    clean->tree_number[place] = (int32_t)(mesh->key[i] / clean->tree_span);
  }
  MPI_CHECK(MPI_Allreduce(MPI_IN_PLACE, clean->tree_number, clean->ntrees,
                          MPI_INT32_T, MPI_MAX, mesh->comm));
}

static void set_slants(struct clean *clean, const struct mesh *mesh) {
  const struct forest_layout *layout = forest_layout(mesh->forest);
  const double unit = layout->size / (double)morton_edge(0);
  if (!mesh_is_axisymmetric(mesh)) return;
  clean->slant = MEM_NEW(double, clean->ninner);
  for (int32_t k = 0; k < clean->ninner; k++) {
    int64_t x[DIM];
    const double half = 0.5 * unit * (double)morton_edge(clean->level[k]);
    morton_coordinates(forest_brick(mesh->forest), clean->key[k], x);
    clean->slant[k] = half / (layout->origin[0] + unit * (double)x[0] + half);
  }
}

static void mark_owned(struct clean *clean, const struct mesh *mesh) {
  clean->owned = MEM_NEW(uint8_t, mesh->nleaves);
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    for (int f = 0; f < NFACE; f++) {
      const int32_t face = mesh->cell_face[i][f];
      if (face < mesh->nfaces && mesh->face_owner[face] == i &&
          mesh->face_patch[face] < 0) {
        clean->owned[i] |= (uint8_t)(1 << f);
      }
    }
  }
}

static void list_boundary(struct clean *clean, const struct mesh *mesh) {
  int32_t n = 0;
  for (int32_t f = 0; f < mesh->nfaces; f++) {
    clean->nboundary += mesh->face_patch[f] >= 0;
  }
  clean->boundary = MEM_NEW(int32_t, clean->nboundary);
  for (int32_t f = 0; f < mesh->nfaces; f++) {
    if (mesh->face_patch[f] >= 0) clean->boundary[n++] = f;
  }
}

struct clean *clean_new(const struct mesh *mesh) {
  struct clean *clean = MEM_NEW(struct clean, 1);
  clean->revision = mesh->revision;
  number_trees(clean, mesh);
  link_nodes(clean, mesh);
  mark_straddling(clean, mesh);
  set_slants(clean, mesh);
  mark_owned(clean, mesh);
  list_boundary(clean, mesh);
  const size_t n = (size_t)mesh->nleaves + (size_t)clean->ninner;
  clean->net = MEM_NEW(double, n);
  clean->change = mem_alloc((size_t)clean->ninner, sizeof *clean->change);
  return clean;
}

void clean_destroy(struct clean *clean) {
  if (!clean) return;
  void *owned[] = {clean->child,       clean->level,       clean->slant,
                   clean->key,         clean->slot,        clean->root,
                   clean->tree_number, clean->owned,       clean->boundary,
                   clean->shared,      clean->net,         clean->change,
                   clean->tree_net,    clean->tree_change, clean};
  for (size_t k = 0; k < sizeof owned / sizeof *owned; k++) mem_free(owned[k]);
}

double clean_divergence(const struct mesh *mesh, const double *u_f) {
  double most = 0;
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    most = max2(most, fabs(mesh_divergence(mesh, u_f, i)));
  }
  return mesh_max(mesh, most);
}

/* Return the net outflow of leaf i beyond what `source`, 1/s, asks for; NULL:
 * none. */
static inline double net_excess(const struct mesh *mesh, const double *source,
                                const double *u_f, int32_t i) {
  return mesh_outflow(mesh, u_f, i) -
         (source ? source[i] * mesh_volume(mesh, i) : 0);
}

/* Let the total excess of the leaves out through the open boundary faces. */
static void balance_boundaries(struct clean *clean, const struct mesh *mesh,
                               const bool *open, const double *source,
                               double excess, double *u_f) {
  double sum[2] = {excess, 0}; /* net outflow, open area */
  for (int32_t k = 0; k < clean->nboundary; k++) {
    const int32_t f = clean->boundary[k];
    if (open[mesh->face_patch[f]]) sum[1] += mesh_face_area(mesh, f);
  }
  MPI_CHECK(
      MPI_Allreduce(MPI_IN_PLACE, sum, 2, MPI_DOUBLE, MPI_SUM, mesh->comm));
  if (sum[1] == 0) return;
  for (int32_t k = 0; k < clean->nboundary; k++) {
    const int32_t f = clean->boundary[k], i = mesh->face_owner[f];
    if (!open[mesh->face_patch[f]]) continue;
    u_f[f] -= (mesh->face_leaf[f][1] < 0 ? 1 : -1) * sum[0] / sum[1];
    clean->net[i] = net_excess(mesh, source, u_f, i);
  }
}

/* Gather the net outflow of every node, from the leaves (in) up; the parts of
 * straddling nodes are added over ranks. */
static void gather_net(struct clean *clean, const struct mesh *mesh) {
  const int32_t n = mesh->nleaves;
  if (mesh->nranks > 1) {
    memset(clean->shared, 0,
           (size_t)clean->nslots * NCHILD * sizeof *clean->shared);
  }
  memset(clean->tree_net, 0, (size_t)clean->ntrees * sizeof *clean->tree_net);
  for (int32_t k = clean->ninner - 1; k >= 0; k--) {
    double sum = 0;
    for (int c = 0; c < NCHILD; c++) {
      const int32_t child = clean->child[k][c];
      if (child < 0) continue;
      sum += clean->net[child];
      if (clean->slot[k] >= 0) {
        clean->shared[clean->slot[k] * NCHILD + c] = clean->net[child];
      }
    }
    clean->net[n + k] = sum;
  }
  for (int32_t t = 0; t < clean->ntrees; t++) {
    if (clean->root[t] >= 0) clean->tree_net[t] = clean->net[clean->root[t]];
  }
  if (mesh->nranks > 1) {
    MPI_CHECK(MPI_Allreduce(MPI_IN_PLACE, clean->shared, clean->nslots * NCHILD,
                            MPI_DOUBLE, MPI_SUM, mesh->comm));
    MPI_CHECK(MPI_Allreduce(MPI_IN_PLACE, clean->tree_net, clean->ntrees,
                            MPI_DOUBLE, MPI_SUM, mesh->comm));
  }
}

/* Let trees hand their excess down along the last axis first, towards place 0.
 */
static void balance_trees(struct clean *clean) {
  memset(clean->tree_change, 0,
         (size_t)clean->ntrees * sizeof *clean->tree_change);
  int32_t stride = clean->ntrees, rows = clean->ntrees;
  for (int d = DIM - 1; d >= 0; d--) {
    stride /= clean->trees[d];
    for (int32_t place = rows - 1; place >= stride; place--) {
      const int32_t from = clean->tree_number[place];
      const int32_t to = clean->tree_number[place - stride];
      const double excess = clean->tree_net[from];
      clean->tree_change[from][2 * d] += excess;
      clean->tree_change[to][2 * d + 1] += excess;
      clean->tree_net[to] += excess;
      clean->tree_net[from] = 0;
    }
    rows = stride;
  }
}

/* Find the changes on the faces between the children whose net outflows are N.
 */
static void share_out(const double net[NCHILD], double change[NCHILD][NFACE]) {
  double psi[NCHILD];
  memcpy(psi, net, sizeof psi);
  for (int pass = 0; pass < 2; pass++) { /* transform, divide, transform */
    for (int d = 0; d < DIM; d++) {
      for (int a = 0; a < NCHILD; a++) {
        if (a >> d & 1) continue;
        const int b = a | 1 << d;
        const double low = psi[a], high = psi[b];
        psi[a] = low + high, psi[b] = low - high;
      }
    }
    for (int k = 0; k < NCHILD && pass == 0; k++) {
      int bits = 0;
      for (int d = 0; d < DIM; d++) bits += k >> d & 1;
      psi[k] = bits ? -psi[k] / (2.0 * bits * NCHILD) : 0;
    }
  }
  for (int a = 0; a < NCHILD; a++) {
    for (int d = 0; d < DIM; d++) {
      if (a >> d & 1) continue;
      const int b = a | 1 << d;
      change[a][2 * d + 1] = change[b][2 * d] = psi[a] - psi[b];
    }
  }
}

/* Tell a node how its face fluxes change; a leaf changes the velocities of the
 * faces it owns. */
static void tell_node(struct clean *clean, const struct mesh *mesh,
                      int32_t node, const double change[NFACE], double *u_f) {
  if (node >= mesh->nleaves) {
    memcpy(clean->change[node - mesh->nleaves], change, sizeof *clean->change);
    return;
  }
  for (int f = 0; f < NFACE; f++) {
    if (clean->owned[node] >> f & 1) {
      const int32_t face = mesh->cell_face[node][f];
      const double per_area = 1 / mesh_face_area(mesh, face);
      u_f[face] += change[f] * per_area;
    }
  }
}

/* Return the part that child c has of face f of node k. */
static double face_part(const struct clean *clean, int32_t k, int c, int f) {
  if (!clean->slant || f >> 1 == 0) return 1. / (NCHILD / 2);
  return 0.5 + (c & 1 ? 0.25 : -0.25) * clean->slant[k];
}

static void treat_node(struct clean *clean, const struct mesh *mesh, int32_t k,
                       double *u_f) {
  double net[NCHILD], change[NCHILD][NFACE];
  const double *above = clean->change[k];
  for (int c = 0; c < NCHILD; c++) {
    const int32_t child = clean->child[k][c];
    net[c] = clean->slot[k] >= 0 ? clean->shared[clean->slot[k] * NCHILD + c]
                                 : clean->net[child];
    for (int f = 0; f < NFACE; f++) {
      if ((c >> (f >> 1) & 1) != (f & 1)) continue; /* an inner face */
      change[c][f] = above[f] * face_part(clean, k, c, f);
      net[c] += f & 1 ? change[c][f] : -change[c][f];
    }
  }
  share_out(net, change);
  for (int c = 0; c < NCHILD; c++) {
    const int32_t child = clean->child[k][c];
    if (child >= 0) tell_node(clean, mesh, child, change[c], u_f);
  }
}

void clean_face_velocity(struct clean *clean, const struct mesh *mesh,
                         const bool *open, double *u_f) {
  clean_to_source(clean, mesh, open, NULL, u_f);
}

void clean_to_source(struct clean *clean, const struct mesh *mesh,
                     const bool *open, const double *source, double *u_f) {
  CHECK(clean->revision == mesh->revision, "tree of another mesh");
  mesh_fill_faces(mesh, 1, &u_f);
  double excess = 0;
  const struct mesh view = *mesh; /* which no net[i] can change */
  for (int32_t i = 0; i < view.nleaves; i++) {
    clean->net[i] = net_excess(&view, source, u_f, i);
    excess += clean->net[i];
  }
  balance_boundaries(clean, mesh, open, source, excess, u_f);
  gather_net(clean, mesh);
  balance_trees(clean);
  for (int32_t t = 0; t < clean->ntrees; t++) {
    if (clean->root[t] < 0) continue;
    tell_node(clean, mesh, clean->root[t], clean->tree_change[t], u_f);
  }
  for (int32_t k = 0; k < clean->ninner; k++) treat_node(clean, mesh, k, u_f);
  mesh_fill_faces(mesh, 1, &u_f);
}
