/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/skin.h"

#include <stdbool.h>

#include "talus/memory.h"
#include "talus/minmax.h"

/* A weight or a part m this close to 1 is whole, to 0 nothing. */
#define WHOLE 1e-9

struct skin *skin_new(void) {
  return MEM_NEW(struct skin, 1);
}

void skin_destroy(struct skin *skin) {
  if (!skin) return;
  mem_free(skin->face);
  mem_free(skin->leaf);
  mem_free(skin);
}

/* Give the places of the nodes of face f of axis d in the stencil of its owner.
 */
static inline void face_places(const struct mesh *mesh, int d, int32_t f,
                               int place[2]) {
  const bool lower = mesh->face_node[f][0] == mesh->face_owner[f];
  place[0] = STENCIL_CENTRE - (lower ? 0 : stencil_step(d));
  place[1] = place[0] + stencil_step(d);
}

/* Return the part of the mass of a node that is grains. Round-off of a leaf
 * without any must not decide which of its lines count. */
static inline double grain_part(double c, double ratio) {
  c = min2(max2(c, 0), 1);
  const double part = c / (c + (1 - c) * ratio);
  return part < WHOLE ? 0 : part;
}

/* Weigh the lines along t of face f of axis d, `grains` being M and m that of
 * the stencil; returns false if all are whole. */
static bool weigh_lines(const struct mesh *mesh, int d, int32_t f, int t,
                        const double *m, double grains, bool grains_only,
                        struct skin_face *face) {
  double weight[4], sum = 0, least = 1;
  int place[2];
  face_places(mesh, d, f, place);
  for (int k = 0; k < 4; k++) {
    const int end = place[k / 2] + (k & 1 ? 1 : -1) * stencil_step(t);
    weight[k] = skin_weight(grains_only, grains, m[place[k / 2]], m[end]);
    sum += weight[k];
    least = min2(least, weight[k]);
  }
  for (int k = 0; k < 4; k++) {
    const int end = place[k / 2] + (k & 1 ? 1 : -1) * stencil_step(t);
    face->node[t][k] = mesh->stencil[mesh->face_owner[f]][end];
    face->weight[t][k] = sum > 0 ? weight[k] / sum : 0;
  }
  face->part[t] = grains_only ? 1 : min2(sum, 1);
  return least < 1 - WHOLE;
}

static void add_face(struct skin *skin, const struct skin_face *face) {
  if (skin->n == skin->room) {
    skin->room = 2 * skin->room + 64;
    skin->face = mem_resize(skin->face, (size_t)skin->room, sizeof *face);
  }
  skin->face[skin->n++] = *face;
}

/* Return whether leaf i holds grains and sees something else in its stencil. */
static bool is_beside(const struct mesh *mesh, const double *c, double ratio,
                      int32_t i) {
  const int32_t *stencil = mesh->stencil[i];
  double least = c[i];
  if (grain_part(c[i], ratio) < WHOLE) return false;
#pragma GCC unroll 27
  for (int k = 0; k < NSTENCIL; k++) least = min2(least, c[stencil[k]]);
  return grain_part(least, ratio) < 1 - WHOLE;
}

static void add_leaf(const struct mesh *mesh, const double *c, double ratio,
                     int32_t i, struct skin *skin) {
  if (skin->nleaves == skin->leaf_room) {
    skin->leaf_room = 2 * skin->leaf_room + 64;
    skin->leaf =
        mem_resize(skin->leaf, (size_t)skin->leaf_room, sizeof *skin->leaf);
  }
  struct skin_leaf *leaf = &skin->leaf[skin->nleaves++];
  leaf->leaf = i;
  for (int k = 0; k < NSTENCIL; k++) {
    leaf->grains[k] = grain_part(c[mesh->stencil[i][k]], ratio);
  }
}

/* Weigh the lines of face f of axis d, m being that of the stencil of its
 * owner, and keep it if some are not whole. */
static void find_face(const struct mesh *mesh, int d, int32_t f,
                      const double *m, struct skin *skin) {
  struct skin_face face = {.face = f, .axis = (int8_t)d};
  bool found = false;
  int place[2];
  face_places(mesh, d, f, place);
  const double grains = min2(m[place[0]], m[place[1]]);
  if (grains < WHOLE) return;
  for (int t = 0; t < DIM; t++) {
    found = (t != d &&
             weigh_lines(mesh, d, f, t, m, grains, skin->grains_only, &face)) ||
            found;
  }
  if (found) add_face(skin, &face);
}

void skin_find(const struct mesh *mesh, const double *c, double ratio,
               struct skin *skin) {
  skin->nleaves = skin->n = 0;
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    if (is_beside(mesh, c, ratio, i)) add_leaf(mesh, c, ratio, i, skin);
  }
  for (int32_t k = 0; k < skin->nleaves; k++) {
    const struct skin_leaf *leaf = &skin->leaf[k];
    for (int s = 0; s < NFACE; s++) {
      const int32_t f = mesh->cell_face[leaf->leaf][s];
      if (f < mesh->nfaces && mesh->face_owner[f] == leaf->leaf) {
        find_face(mesh, s >> 1, f, leaf->grains, skin);
      }
    }
  }
}

double skin_difference(const struct mesh *mesh, const struct skin_face *face,
                       int t, const double *u) {
  const int32_t *node = mesh->face_node[face->face], *end = face->node[t];
  const double *weight = face->weight[t];
  return weight[1] * (u[end[1]] - u[node[0]]) -
         weight[0] * (u[end[0]] - u[node[0]]) +
         weight[3] * (u[end[3]] - u[node[1]]) -
         weight[2] * (u[end[2]] - u[node[1]]);
}
