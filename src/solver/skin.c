/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/skin.h"

#include <stdbool.h>

#include "talus/memory.h"
#include "talus/minmax.h"

/* Weights so close to 1 count as that. */
#define WHOLE 1e-9

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

/* Part of the mass of a node that is grains. */
static inline double grain_part(double c, double ratio) {
  c = min2(max2(c, 0), 1);
  return c / (c + (1 - c) * ratio);
}

/* Weights of the lines along t of face f of axis d, `grains` being M; false if
 * all are whole. */
static bool weigh_lines(const struct mesh *mesh, int d, int32_t f, int t,
                        const double *c, double ratio, double grains,
                        struct skin_face *face) {
  const int32_t *stencil = mesh->stencil[mesh->face_owner[f]];
  double weight[4], sum = 0, least = 1;
  int place[2];
  face_places(mesh, d, f, place);
  for (int k = 0; k < 4; k++) {
    const int end = place[k / 2] + (k & 1 ? 1 : -1) * stencil_step(t);
    weight[k] = 1 - grains * (1 - grain_part(c[stencil[end]], ratio));
    sum += weight[k];
    least = min2(least, weight[k]);
  }
  for (int k = 0; k < 4; k++) {
    face->weight[t][k] = sum > 0 ? weight[k] / sum : 0;
  }
  face->part[t] = min2(sum, 1);
  return least < 1 - WHOLE;
}

static void add_face(struct skin *skin, const struct skin_face *face) {
  if (skin->n == skin->room) {
    skin->room = 2 * skin->room + 64;
    skin->face = mem_resize(skin->face, (size_t)skin->room, sizeof *face);
  }
  skin->face[skin->n++] = *face;
}

void skin_find(const struct mesh *mesh, const double *c, double ratio,
               struct skin *skin) {
  skin->n = 0;
  for (int d = 0; d < DIM; d++) {
    for (int32_t f = mesh->face_begin[d]; f < mesh->face_begin[d + 1]; f++) {
      const int32_t *node = mesh->face_node[f];
      const double grains = grain_part(min2(c[node[0]], c[node[1]]), ratio);
      if (grains < WHOLE) continue;
      struct skin_face face = {.face = f, .axis = (int8_t)d};
      bool found = false;
      for (int t = 0; t < DIM; t++) {
        found =
            (t != d && weigh_lines(mesh, d, f, t, c, ratio, grains, &face)) ||
            found;
      }
      if (found) add_face(skin, &face);
    }
  }
}

double skin_difference(const struct mesh *mesh, const struct skin_face *face,
                       int t, const double *u) {
  const int32_t *stencil = mesh->stencil[mesh->face_owner[face->face]];
  double sum = 0;
  int place[2];
  face_places(mesh, face->axis, face->face, place);
  for (int k = 0; k < 4; k++) {
    const int sign = k & 1 ? 1 : -1;
    const int end = place[k / 2] + sign * stencil_step(t);
    sum += face->weight[t][k] * sign *
           (u[stencil[end]] - u[stencil[place[k / 2]]]);
  }
  return sum;
}
