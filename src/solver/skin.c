/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/skin.h"

#include "talus/memory.h"

enum { ALL = 15 }; /* four lines */

struct skin *skin_new(void) {
  return MEM_NEW(struct skin, 1);
}

void skin_destroy(struct skin *skin) {
  if (!skin) return;
  mem_free(skin->face);
  mem_free(skin);
}

/* Places of the nodes of face f of axis d in the stencil of its owner. */
static inline void face_places(const struct mesh *mesh, int d, int32_t f,
                               int place[2]) {
  const bool lower = mesh->face_node[f][0] == mesh->face_owner[f];
  place[0] = STENCIL_CENTRE - (lower ? 0 : stencil_step(d));
  place[1] = place[0] + stencil_step(d);
}

/* Bit k of four: the line from node k / 2 of face f of axis d, downwards along
 * t if k is even, ends in a heavy node. */
static uint8_t heavy_lines(const struct mesh *mesh, int d, int32_t f, int t,
                           const double *c, double least) {
  const int32_t *stencil = mesh->stencil[mesh->face_owner[f]];
  uint8_t lines = 0;
  int place[2];
  face_places(mesh, d, f, place);
  for (int k = 0; k < 4; k++) {
    const int end = place[k / 2] + (k & 1 ? 1 : -1) * stencil_step(t);
    if (c[stencil[end]] > least) lines |= (uint8_t)(1 << k);
  }
  return lines;
}

static void add_face(struct skin *skin, const struct skin_face *face) {
  if (skin->n == skin->room) {
    skin->room = 2 * skin->room + 64;
    skin->face = mem_resize(skin->face, (size_t)skin->room, sizeof *face);
  }
  skin->face[skin->n++] = *face;
}

void skin_find(const struct mesh *mesh, const double *c, double least,
               struct skin *skin) {
  skin->n = 0;
  for (int d = 0; d < DIM; d++) {
    for (int32_t f = mesh->face_begin[d]; f < mesh->face_begin[d + 1]; f++) {
      const int32_t *node = mesh->face_node[f];
      if (!(c[node[0]] > least && c[node[1]] > least)) continue;
      struct skin_face face = {f, (int8_t)d, {0}};
      bool complete = true;
      for (int t = 0; t < DIM; t++) {
        if (t == d) continue;
        face.lines[t] = heavy_lines(mesh, d, f, t, c, least);
        complete = complete && face.lines[t] == ALL;
      }
      if (!complete) add_face(skin, &face);
    }
  }
}

double skin_difference(const struct mesh *mesh, const struct skin_face *face,
                       int t, const double *u) {
  const int32_t *stencil = mesh->stencil[mesh->face_owner[face->face]];
  double sum = 0;
  int n = 0, place[2];
  face_places(mesh, face->axis, face->face, place);
  for (int k = 0; k < 4; k++) {
    if (!(face->lines[t] >> k & 1)) continue;
    const int sign = k & 1 ? 1 : -1;
    const int end = place[k / 2] + sign * stencil_step(t);
    sum += sign * (u[stencil[end]] - u[stencil[place[k / 2]]]);
    n++;
  }
  return n > 0 ? sum / n : 0;
}
