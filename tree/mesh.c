/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Making and unmaking a mesh; the parts are in mesh_ghost.c (leaves),
 * mesh_stencil.c (helper nodes) and mesh_face.c. */
#include "talus/mesh.h"

#include "builder.h"
#include "talus/error.h"
#include "talus/memory.h"

uint64_t mesh_key_span(int level) { return morton_span(level); }

struct mesh *mesh_new(struct forest *forest) {
  struct mesh *mesh = MEM_NEW(struct mesh, 1);
  mesh->forest = forest;
  mesh->revision = forest_revision(forest);
  mesh->comm = forest_comm(forest);
  MPI_CHECK(MPI_Comm_rank(mesh->comm, &mesh->rank));
  MPI_CHECK(MPI_Comm_size(mesh->comm, &mesh->nranks));
  mesh->level_finest = forest_finest_level(forest);
  mesh->first_keys = forest_first_keys(forest);
  mesh->exchange = MEM_NEW(struct mesh_exchange, 1);
  struct builder b = {.mesh = mesh,
                      .brick = forest_brick(forest),
                      .layout = forest_layout(forest),
                      .first_keys = mesh->first_keys};
  build_leaves(&b);
  build_stencils(&b);
  build_faces(&b);
  if (b.layout->axisymmetric) build_rings(&b);
  hash_end(&b.hash);
  index_end(&b.leaves);
  index_end(&b.ghosts);
  mem_free(b.average);
  mem_free(b.group_of);
  mem_free(b.group_leaf);
  mem_free(b.boundary);
  mem_free(b.request);
  return mesh;
}

void mesh_renew_patches(struct mesh *mesh,
                        int (*patch)(const void *context, int side,
                                     const double x[DIM], double h, int now),
                        const void *context) {
  const int32_t n = mesh->ncells - mesh->begin_boundary;
  for (int32_t k = 0; k < n; k++) {
    const double h = mesh->boundary_h[k];
    for (int d = 0; d < DIM; d++) {
      double x[DIM];
      const int outside = mesh->boundary_outside[k][d];
      if (outside == 0) continue;
      for (int e = 0; e < DIM; e++) x[e] = mesh->boundary_x[k][e];
      x[d] += 0.5 * h * outside;
      const int now = mesh->boundary_patch[k][d];
      mesh->boundary_patch[k][d] =
          (int8_t)patch(context, 2 * d + (outside > 0), x, h, now);
    }
  }
  for (int d = 0; d < DIM; d++) {
    for (int32_t f = mesh->face_begin[d]; f < mesh->face_begin[d + 1]; f++) {
      const int32_t *node = mesh->face_node[f];
      const int32_t beyond = node[mesh->face_leaf[f][1] < 0];
      if (mesh->face_patch[f] < 0) continue;
      mesh->face_patch[f] =
          mesh->boundary_patch[beyond - mesh->begin_boundary][d];
    }
  }
}

void mesh_destroy(struct mesh *mesh) {
  if (!mesh) return;
  plan_end(&mesh->exchange->ghost);
  plan_end(&mesh->exchange->average);
  plan_end(&mesh->exchange->virtual_node);
  plan_end(&mesh->exchange->face);
  void *owned[] = {mesh->exchange,
                   mesh->x,
                   mesh->h,
                   mesh->level,
                   mesh->key,
                   mesh->stencil,
                   mesh->face_node,
                   mesh->face_leaf,
                   mesh->face_owner,
                   mesh->face_patch,
                   mesh->face_h,
                   mesh->cell_face,
                   mesh->average_face,
                   mesh->average_child,
                   mesh->virtual_leaf,
                   mesh->virtual_slope,
                   mesh->virtual_weight,
                   mesh->boundary_source,
                   mesh->boundary_patch,
                   mesh->boundary_x,
                   mesh->boundary_outside,
                   mesh->boundary_h,
                   mesh->slant,
                   mesh->face_radius,
                   mesh->average_slant,
                   mesh->shared};
  for (size_t k = 0; k < sizeof owned / sizeof *owned; k++) mem_free(owned[k]);
  mem_free(mesh);
}

double mesh_sum(const struct mesh *mesh, double local) {
  double total = local;
  if (mesh->nranks > 1) {
    MPI_CHECK(
        MPI_Allreduce(&local, &total, 1, MPI_DOUBLE, MPI_SUM, mesh->comm));
  }
  return total;
}

double mesh_max(const struct mesh *mesh, double local) {
  double total = local;
  if (mesh->nranks > 1) {
    MPI_CHECK(
        MPI_Allreduce(&local, &total, 1, MPI_DOUBLE, MPI_MAX, mesh->comm));
  }
  return total;
}
