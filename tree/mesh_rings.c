/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Rings around an axis: radii and slants of a mesh (mesh.h, Geometry). */
#include "builder.h"
#include "talus/memory.h"

static void set_slants(struct mesh *mesh) {
  const int32_t n = mesh->nleaves + mesh->nghosts;
  mesh->slant = MEM_NEW(double, n);
  for (int32_t i = 0; i < n; i++) {
    mesh->slant[i] = 0.5 * mesh->h[i] / mesh->x[i][0];
  }
}

static void set_face_radii(struct mesh *mesh) {
  mesh->face_radius = MEM_NEW(double, mesh->nfaces);
  for (int32_t f = 0; f < mesh->nfaces; f++) {
    const int32_t i = mesh->face_owner[f];
    const double half = 0.5 * mesh->h[i];
    const double away = mesh->face_node[f][0] == i ? half : -half;
    mesh->face_radius[f] = mesh->x[i][0] + (f < mesh->face_begin[1] ? away : 0);
  }
}

static void set_average_slants(struct mesh *mesh) {
  const int32_t n = mesh->nfaces_all - mesh->begin_face_average;
  mesh->average_slant = MEM_NEW(double, n);
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    for (int s = 2; s < NFACE; s++) {
      const int32_t k = mesh->cell_face[i][s] - mesh->begin_face_average;
      if (k >= 0) mesh->average_slant[k] = 0.5 * mesh->slant[i];
    }
  }
}

void build_rings(struct builder *b) {
  set_slants(b->mesh);
  set_face_radii(b->mesh);
  set_average_slants(b->mesh);
}
