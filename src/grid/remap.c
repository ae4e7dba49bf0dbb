/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Invariants
 * 1. Data travel as one array per leaf quantity: a cell field is one, a face
 *    field is 2 DIM, one for each side of a leaf, plus one that says whether
 *    the leaf is new by division (its outer sides are then less exact than
 *    those of a neighbour that was there before).
 * 2. Leaves are carried over on their old rank, then move.
 */
#include "talus/remap.h"

#include <math.h>
#include <string.h>

#include "talus/error.h"
#include "talus/forest.h"
#include "talus/memory.h"
#include "talus/plane.h"
#include "talus/two_phase/state.h"
#include "talus/vof.h"

enum { REMAP_MOST = FIELDS_MAX + NFACE + 1 };

struct carrier {
  const struct mesh *mesh; /* old */
  const struct forest_map *map;
  const double *c; /* volume fraction, filled */
  double density[2];
};

static double slope_along(const struct mesh *mesh, const double *v, int32_t i,
                          int d) {
  const int32_t lower = mesh->stencil[i][stencil_face(2 * d)];
  const int32_t upper = mesh->stencil[i][stencil_face(2 * d + 1)];
  const bool has_lower = lower < mesh->begin_virtual;
  const bool has_upper = upper < mesh->begin_virtual;
  if (has_lower && has_upper) return 0.5 * (v[upper] - v[lower]);
  if (has_lower) return v[i] - v[lower];
  if (has_upper) return v[upper] - v[i];
  return 0;
}

/* Value of a divided leaf at a child: on the parent's slopes. */
static double linear_child(const struct carrier *carrier, const double *v,
                           int32_t child) {
  const struct mesh *mesh = carrier->mesh;
  const int32_t i = carrier->map->first[child];
  double value = v[i];
  for (int d = 0; d < DIM; d++) {
    const double offset =
        (carrier->map->x[child][d] - mesh->x[i][d]) / mesh->h[i];
    value += offset * slope_along(mesh, v, i, d);
  }
  return value;
}

/* Share of a child cut by its parent's plane. */
static double vof_child(const struct carrier *carrier, const double *v,
                        int32_t child) {
  const struct mesh *mesh = carrier->mesh;
  const int32_t i = carrier->map->first[child];
  if (!vof_is_cut(v[i])) return v[i];
  double n[DIM], alpha, lo[DIM], hi[DIM];
  vof_plane(mesh, v, i, n, &alpha);
  const double half = pow(0.5, carrier->map->delta[child] + 1);
  for (int d = 0; d < DIM; d++) {
    const double offset =
        (carrier->map->x[child][d] - mesh->x[i][d]) / mesh->h[i];
    lo[d] = offset - half, hi[d] = offset + half;
  }
  return plane_box_volume(n, alpha, lo, hi);
}

static double merged(const struct carrier *carrier, const struct field *field,
                     int32_t leaf) {
  const int32_t first = carrier->map->first[leaf];
  double sum = 0, weights = 0;
  for (int32_t i = first; i < first + carrier->map->count[leaf]; i++) {
    double weight = 1;
    if (field->remap == REMAP_MOMENTUM) {
      weight = carrier->density[1] +
               carrier->c[i] * (carrier->density[0] - carrier->density[1]);
    }
    sum += weight * field->v[i];
    weights += weight;
  }
  return sum / weights;
}

static double divided(const struct carrier *carrier, const struct field *field,
                      int32_t leaf) {
  const int32_t i = carrier->map->first[leaf];
  switch (field->remap) {
    case REMAP_VOF:
      return vof_child(carrier, field->v, leaf);
    case REMAP_LINEAR:
      return linear_child(carrier, field->v, leaf);
    case REMAP_MOMENTUM:
      return vof_is_cut(carrier->c[i]) ? field->v[i]
                                       : linear_child(carrier, field->v, leaf);
    default:
      return field->v[i];
  }
}

static double *carry_cells(const struct carrier *carrier,
                           const struct field *field) {
  const struct forest_map *map = carrier->map;
  double *out = MEM_NEW(double, map->nnew);
  for (int32_t i = 0; i < map->nnew; i++) {
    if (map->count[i] > 1) {
      out[i] = merged(carrier, field, i);
    } else if (map->delta[i] > 0) {
      out[i] = divided(carrier, field, i);
    } else {
      out[i] = field->v[map->first[i]];
    }
  }
  return out;
}

/* Side f of every new leaf: the old one, the mean of the children's, or
 * interpolated between the parent's two sides, which keeps the children
 * solenoidal. */
static double *carry_side(const struct carrier *carrier, const double *v,
                          int f) {
  const struct forest_map *map = carrier->map;
  const struct mesh *mesh = carrier->mesh;
  const int d = f >> 1, side = f & 1;
  double *out = MEM_NEW(double, map->nnew);
  for (int32_t i = 0; i < map->nnew; i++) {
    const int32_t first = map->first[i];
    const int32_t *face = mesh->cell_face[first];
    if (map->count[i] > 1) {
      for (int c = 0; c < NCHILD; c++) {
        if ((c >> d & 1) == side) out[i] += v[mesh->cell_face[first + c][f]];
      }
      out[i] /= NCHILD / 2;
    } else if (map->delta[i] > 0) {
      const double h = pow(0.5, map->delta[i]);
      const double t = (map->x[i][d] - mesh->x[first][d]) / mesh->h[first] +
                       0.5 + (side ? 0.5 * h : -0.5 * h);
      out[i] = (1 - t) * v[face[2 * d]] + t * v[face[2 * d + 1]];
    } else {
      out[i] = v[face[f]];
    }
  }
  return out;
}

/* Face values from the sides of the leaves around them. */
static void sides_to_faces(const struct mesh *mesh, double *data[], double *v) {
  const size_t n = (size_t)mesh->nleaves + (size_t)mesh->nghosts;
  for (int k = 0; k <= NFACE; k++) {
    data[k] = mem_resize(data[k], n, sizeof(double));
  }
  mesh_fill_ghosts(mesh, NFACE + 1, data);
  const double *is_new = data[NFACE];
  for (int d = 0; d < DIM; d++) {
    for (int32_t f = mesh->face_begin[d]; f < mesh->face_begin[d + 1]; f++) {
      const int32_t owner = mesh->face_owner[f];
      const int upper = mesh->face_leaf[f][0] == owner; /* side of owner */
      const int32_t other = mesh->face_leaf[f][upper];
      const bool use_other = other >= 0 && is_new[owner] > 0 &&
                             is_new[other] == 0 &&
                             mesh->level[other] == mesh->level[owner];
      v[f] = use_other ? data[2 * d + 1 - upper][other]
                       : data[2 * d + upper][owner];
    }
  }
  mesh_fill_faces(mesh, 1, &v);
}

void remap_fields(struct two_phase *sim, const struct forest_map *map) {
  struct carrier carrier = {.mesh = sim->mesh, .map = map, .c = sim->c->v};
  double *data[REMAP_MOST];
  int n = 0;
  fields_release(&sim->fields, false);
  carrier.density[0] = sim->params->grains.density;
  carrier.density[1] = sim->params->gas.density;
  for (int k = 0; k < sim->fields.n; k++) {
    struct field *field = sim->fields.field[k];
    if (field->remap == REMAP_NONE) continue;
    CHECK(n + NFACE + 1 < REMAP_MOST, "too many fields");
    if (field->location == FIELD_CELL) {
      field_fill(sim->mesh, field);
      data[n++] = carry_cells(&carrier, field);
    } else {
      field_fill_faces(sim->mesh, field);
      for (int f = 0; f < NFACE; f++) {
        data[n++] = carry_side(&carrier, field->v, f);
      }
      data[n] = MEM_NEW(double, map->nnew);
      for (int32_t i = 0; i < map->nnew; i++) data[n][i] = map->delta[i] > 0;
      n++;
    }
  }
  forest_partition(sim->forest, n, data);
  two_phase_remesh(sim);
  double **next = data;
  for (int k = 0; k < sim->fields.n; k++) {
    struct field *field = sim->fields.field[k];
    if (field->remap == REMAP_NONE) continue;
    if (field->location == FIELD_CELL) {
      memcpy(field->v, *next, (size_t)sim->mesh->nleaves * sizeof(double));
      next++;
    } else {
      sides_to_faces(sim->mesh, next, field->v);
      next += NFACE + 1;
    }
  }
  for (int k = 0; k < n; k++) mem_free(data[k]);
}
