/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Faces. A face belongs to the finer of two leaves, at equal level to the lower
 * one, on a boundary to the only one; the rank of that leaf computes the face.
 */
#include "builder.h"
#include "talus/error.h"
#include "talus/memory.h"

/* Does leaf i own its face f, given the node beyond it? */
static bool owns_face(const struct mesh *mesh, int32_t i, int f) {
  const int32_t node = mesh->stencil[i][stencil_face(f)];
  if (node >= mesh->begin_virtual) return true;  /* coarser, or a boundary */
  if (node >= mesh->begin_average) return false; /* finer */
  return f & 1;
}

static void set_face(struct mesh *mesh, int32_t face, int32_t i, int f) {
  const int32_t node = mesh->stencil[i][stencil_face(f)];
  const int side = f & 1; /* 1: the other node is on the upper side */
  mesh->face_node[face][side] = node;
  mesh->face_node[face][1 - side] = i;
  mesh->face_leaf[face][1 - side] = i;
  mesh->face_owner[face] = i;
  mesh->face_h[face] = mesh->h[i];
  mesh->face_patch[face] = -1;
  int32_t leaf = node;
  if (node >= mesh->begin_boundary) {
    leaf = -1;
    mesh->face_patch[face] =
        mesh->boundary_patch[node - mesh->begin_boundary][f >> 1];
  } else if (node >= mesh->begin_virtual) {
    leaf = mesh->virtual_leaf[(node - mesh->begin_virtual) / NCHILD];
  }
  mesh->face_leaf[face][side] = leaf;
  mesh->cell_face[i][f] = face;
}

static void number_own_faces(struct mesh *mesh) {
  size_t n = 0;
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    for (int f = 0; f < NFACE; f++) n += owns_face(mesh, i, f);
  }
  /* ours, copies of others' and averages */
  count_index(2 * (int64_t)NFACE * ((int64_t)mesh->nleaves + mesh->nghosts),
              "faces");
  mesh->cell_face = mem_alloc((size_t)mesh->nleaves, sizeof *mesh->cell_face);
  mesh->face_node = mem_alloc(n, sizeof *mesh->face_node);
  mesh->face_leaf = mem_alloc(n, sizeof *mesh->face_leaf);
  mesh->face_owner = MEM_NEW(int32_t, n);
  mesh->face_patch = MEM_NEW(int8_t, n);
  mesh->face_h = MEM_NEW(double, n);
  int32_t face = 0;
  for (int d = 0; d < DIM; d++) {
    mesh->face_begin[d] = face;
    for (int32_t i = 0; i < mesh->nleaves; i++) {
      for (int f = 2 * d; f < 2 * d + 2; f++) {
        mesh->cell_face[i][f] = -1;
        if (owns_face(mesh, i, f)) set_face(mesh, face++, i, f);
      }
    }
  }
  mesh->face_begin[DIM] = mesh->nfaces = face;
}

/* Return face f of a leaf of another rank: numbered after those of this rank,
 * asked for later. */
static int32_t ghost_face(struct builder *b, int32_t leaf, int f,
                          int32_t *nghost) {
  const struct mesh *mesh = b->mesh;
  const uint64_t key = (uint64_t)leaf * NFACE + (uint64_t)f;
  int32_t face = hash_find(&b->hash, key, TAG_FACE);
  if (face < 0) {
    face = mesh->nfaces + (*nghost)++;
    hash_insert(&b->hash, key, TAG_FACE, face);
    request_add(b, mesh->key[leaf], f, key_rank(b, mesh->key[leaf]), face);
  }
  return face;
}

/* List the faces on the fine side of face f of leaf i, which touches finer
 * leaves. */
static void fine_faces(struct builder *b, int32_t i, int f,
                       int32_t fine[NCHILD / 2], int32_t *nghost) {
  const struct mesh *mesh = b->mesh;
  const int d = f >> 1, side = f & 1, level = mesh->level[i];
  int64_t x[DIM];
  morton_coordinates(b->brick, mesh->key[i], x);
  const int64_t extent = (int64_t)b->layout->trees[d] * morton_edge(0);
  x[d] += (side ? 1 : -1) * morton_edge(level);
  if (x[d] < 0) x[d] += extent;
  if (x[d] >= extent) x[d] -= extent;
  const uint64_t key = morton_key(b->brick, x);
  int n = 0;
  for (int c = 0; c < NCHILD; c++) {
    if ((c >> d & 1) == side) continue; /* not on our side */
    uint64_t child = key + (uint64_t)c * morton_span(level + 1);
    int32_t leaf = leaf_at(b, child);
    CHECK(leaf >= 0 && mesh->level[leaf] == level + 1, "no finer leaf");
    fine[n++] = leaf < mesh->nleaves ? mesh->cell_face[leaf][f ^ 1]
                                     : ghost_face(b, leaf, f ^ 1, nghost);
  }
}

static void ask_faces(struct builder *b) {
  struct mesh *mesh = b->mesh;
  struct plan *plan = &mesh->exchange->face;
  int64_t nasked;
  struct plan_request *asked =
      plan_ask(plan, b->nrequests, b->request, &nasked);
  for (int64_t k = 0; k < nasked; k++) {
    int32_t leaf = leaf_at(b, asked[k].key);
    CHECK(leaf >= 0 && leaf < mesh->nleaves, "asked for an unknown face");
    int32_t face = mesh->cell_face[leaf][asked[k].tag];
    CHECK(face >= 0 && face < mesh->nfaces, "asked for a face of another");
    plan->send_index[k] = face;
  }
  mem_free(asked);
}

void build_faces(struct builder *b) {
  struct mesh *mesh = b->mesh;
  int32_t nghost = 0, ncoarse = 0;
  number_own_faces(mesh);
  b->nrequests = 0;
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    for (int f = 0; f < NFACE; f++) {
      const int32_t node = mesh->stencil[i][stencil_face(f)];
      ncoarse += node >= mesh->begin_average && node < mesh->begin_virtual;
      if (mesh->cell_face[i][f] >= 0 || node >= mesh->begin_average) continue;
      mesh->cell_face[i][f] = node < mesh->nleaves
                                  ? mesh->cell_face[node][f ^ 1]
                                  : ghost_face(b, node, f ^ 1, &nghost);
    }
  }
  mesh->average_face = mem_alloc((size_t)ncoarse, sizeof *mesh->average_face);
  int32_t k = 0;
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    for (int f = 0; f < NFACE; f++) {
      const int32_t node = mesh->stencil[i][stencil_face(f)];
      if (node < mesh->begin_average || node >= mesh->begin_virtual) continue;
      fine_faces(b, i, f, mesh->average_face[k], &nghost);
      mesh->cell_face[i][f] = k++; /* offset below */
    }
  }
  mesh->begin_face_average = mesh->nfaces + nghost;
  mesh->nfaces_all = mesh->begin_face_average + ncoarse;
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    for (int f = 0; f < NFACE; f++) {
      const int32_t node = mesh->stencil[i][stencil_face(f)];
      if (node < mesh->begin_average || node >= mesh->begin_virtual) continue;
      mesh->cell_face[i][f] += mesh->begin_face_average;
    }
  }
  plan_begin(&mesh->exchange->face, mesh->comm);
  if (mesh->nranks > 1) ask_faces(b);
}
