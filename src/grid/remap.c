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
#include "talus/grid.h"
#include "talus/memory.h"
#include "talus/minmax.h"

enum { REMAP_MOST = FIELDS_MAX * (NFACE + 1) };

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

double remap_value(const struct remap *remap, const struct field *field,
                   int32_t leaf) {
  return field->v[remap->map->first[leaf]];
}

double remap_on_slopes(const struct remap *remap, const struct field *field,
                       int32_t leaf) {
  const struct mesh *mesh = remap->mesh;
  const int32_t i = remap->map->first[leaf];
  double value = field->v[i];
  for (int d = 0; d < DIM; d++) {
    const double offset =
        mesh_edges(mesh, i, remap->map->x[leaf][d] - mesh->x[i][d]);
    value += offset * slope_along(mesh, field->v, i, d);
  }
  return value;
}

double remap_mean(const struct remap *remap, const struct field *field,
                  int32_t leaf) {
  const int32_t first = remap->map->first[leaf];
  const int32_t count = remap->map->count[leaf];
  double sum = 0;
  for (int32_t i = first; i < first + count; i++) sum += field->v[i];
  return sum / count;
}

double remap_weight(const struct remap *remap, int32_t leaf, int32_t child) {
  const struct mesh *mesh = remap->mesh;
  if (!mesh_is_axisymmetric(mesh)) return 1;
  return mesh->x[child][0] / remap->map->x[leaf][0];
}

/* Return how far the centre of the volume of a leaf lies from its middle, less
 * that of the volume of a new leaf in it, along r in edges; 0 in a plane. */
static double ring_centre(const struct remap *remap, int32_t leaf) {
  const double parts = pow(0.25, remap->map->delta[leaf]);
  return mesh_slant(remap->mesh, remap->map->first[leaf]) / 6 * (1 - parts);
}

double remap_on_ring_slopes(const struct remap *remap,
                            const struct field *field, int32_t leaf) {
  const struct mesh *mesh = remap->mesh;
  const int32_t i = remap->map->first[leaf];
  const double value = remap_on_slopes(remap, field, leaf);
  if (!mesh_is_axisymmetric(mesh)) return value;
  return value - ring_centre(remap, leaf) * slope_along(mesh, field->v, i, 0);
}

double remap_on_limited_slopes(const struct remap *remap,
                               const struct field *field, int32_t leaf) {
  const struct mesh *mesh = remap->mesh;
  const int32_t i = remap->map->first[leaf], *node = mesh->stencil[i];
  const double *v = field->v, centre = ring_centre(remap, leaf);
  double value = v[i];
  for (int d = 0; d < DIM; d++) {
    const double lower = v[i] - v[node[stencil_face(2 * d)]];
    const double upper = v[node[stencil_face(2 * d + 1)]] - v[i];
    const double offset =
        mesh_edges(mesh, i, remap->map->x[leaf][d] - mesh->x[i][d]);
    value += (offset - (d == 0 ? centre : 0)) * minmod(lower, upper);
  }
  return value;
}

double remap_content(const struct remap *remap, const struct field *field,
                     int32_t leaf) {
  const int32_t first = remap->map->first[leaf];
  const int32_t count = remap->map->count[leaf];
  double sum = 0;
  for (int32_t i = first; i < first + count; i++) {
    sum += remap_weight(remap, leaf, i) * field->v[i];
  }
  return sum / count;
}

double remap_shared(const struct remap *remap, const struct field *field,
                    int32_t leaf,
                    double (*part)(const void *context, int32_t i),
                    const void *context) {
  const int32_t first = remap->map->first[leaf];
  double sum = 0, mass = 0;
  for (int32_t i = first; i < first + remap->map->count[leaf]; i++) {
    const double m = part(context, i) * remap_weight(remap, leaf, i);
    sum += m * field->v[i];
    mass += m;
  }
  return mass > 0 ? sum / mass : field->v[first];
}

int32_t remap_box(const struct remap *remap, int32_t leaf, double lo[DIM],
                  double hi[DIM]) {
  const struct mesh *mesh = remap->mesh;
  const int32_t i = remap->map->first[leaf];
  const double half = pow(0.5, remap->map->delta[leaf] + 1);
  for (int d = 0; d < DIM; d++) {
    const double offset =
        mesh_edges(mesh, i, remap->map->x[leaf][d] - mesh->x[i][d]);
    lo[d] = offset - half, hi[d] = offset + half;
  }
  return i;
}

const struct field_rule remap_average = {remap_value, remap_mean};
const struct field_rule remap_linear = {remap_on_slopes, remap_mean};
const struct field_rule remap_limited = {remap_on_limited_slopes,
                                         remap_content};
const struct field_rule remap_faces = {NULL, NULL};
const struct field_rule remap_flux = {NULL, NULL};

static double *carry_cells(const struct remap *remap,
                           const struct field *field) {
  const struct forest_map *map = remap->map;
  double *out = MEM_NEW(double, map->nnew);
  for (int32_t i = 0; i < map->nnew; i++) {
    if (map->count[i] > 1) {
      out[i] = field->rule->merge(remap, field, i);
    } else if (map->delta[i] > 0) {
      out[i] = field->rule->divide(remap, field, i);
    } else {
      out[i] = field->v[map->first[i]];
    }
  }
  return out;
}

/* Interpolate between the two sides of axis d of leaf i, a and b, at the part t
 * of the way. A flux is linear along z and, times r, in r^2 along r: what
 * leaves every part of the leaf is then its share. */
static double between(const struct mesh *mesh, int d, bool is_flux, int32_t i,
                      double t, double a, double b) {
  if (d > 0 || !is_flux || !mesh_is_axisymmetric(mesh)) {
    return (1 - t) * a + t * b;
  }
  const double r = mesh->x[i][0], half = 0.5 * mesh->h[i];
  const double low = r - half, high = r + half, at = low + 2 * t * half;
  const double share = (at * at - low * low) / (high * high - low * low);
  return at > 0 ? ((1 - share) * low * a + share * high * b) / at : a;
}

/* Carry side f to every new leaf: the old value, the mean of the children's, or
 * interpolated between the parent's two sides, which keeps the children
 * solenoidal. */
static double *carry_side(const struct remap *remap, const double *v, int f,
                          bool is_flux) {
  const struct forest_map *map = remap->map;
  const struct mesh *mesh = remap->mesh;
  const int d = f >> 1, side = f & 1;
  double *out = MEM_NEW(double, map->nnew);
  for (int32_t i = 0; i < map->nnew; i++) {
    const int32_t first = map->first[i];
    const int32_t *face = mesh->cell_face[first];
    if (map->count[i] > 1) {
      for (int c = 0; c < NCHILD; c++) {
        if ((c >> d & 1) != side) continue;
        const double weight = d > 0 ? remap_weight(remap, i, first + c) : 1;
        out[i] += weight * v[mesh->cell_face[first + c][f]];
      }
      out[i] /= NCHILD / 2;
    } else if (map->delta[i] > 0) {
      const double h = pow(0.5, map->delta[i]);
      const double away = map->x[i][d] - mesh->x[first][d];
      const double t =
          mesh_edges(mesh, first, away) + 0.5 + (side ? 0.5 * h : -0.5 * h);
      out[i] = between(mesh, d, is_flux, first, t, v[face[2 * d]],
                       v[face[2 * d + 1]]);
    } else {
      out[i] = v[face[f]];
    }
  }
  return out;
}

/* Set face values from the sides of the leaves around them. */
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

void remap_fields(struct grid *grid, const struct forest_map *map) {
  const struct remap remap = {.mesh = grid->mesh, .map = map};
  double *data[REMAP_MOST];
  int n = 0;
  fields_release(&grid->fields, false);
  for (int k = 0; k < grid->fields.n; k++) {
    struct field *field = grid->fields.field[k];
    if (!field->rule) continue;
    CHECK(n + NFACE + 1 < REMAP_MOST, "too many fields");
    if (field->location == FIELD_CELL) {
      field_fill(grid->mesh, field);
      data[n++] = carry_cells(&remap, field);
    } else {
      field_fill_faces(grid->mesh, field);
      for (int f = 0; f < NFACE; f++) {
        data[n++] = carry_side(&remap, field->v, f, field->rule == &remap_flux);
      }
      data[n] = MEM_NEW(double, map->nnew);
      for (int32_t i = 0; i < map->nnew; i++) data[n][i] = map->delta[i] > 0;
      n++;
    }
  }
  forest_partition(grid->forest, n, data);
  grid_remesh(grid);
  double **next = data;
  for (int k = 0; k < grid->fields.n; k++) {
    struct field *field = grid->fields.field[k];
    if (!field->rule) continue;
    if (field->location == FIELD_CELL) {
      memcpy(field->v, *next, (size_t)grid->mesh->nleaves * sizeof(double));
      next++;
    } else {
      sides_to_faces(grid->mesh, next, field->v);
      next += NFACE + 1;
    }
  }
  for (int k = 0; k < n; k++) mem_free(data[k]);
}
