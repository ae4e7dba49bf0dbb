/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Coefficients of the two-point operator on all levels: set on leaves, then
 * merged level by level from the finest one up. */
#include <float.h>
#include <math.h>
#include <string.h>

#include "levels.h"
#include "talus/forest.h"
#include "talus/memory.h"
#include "talus/minmax.h"

/* A conductance inside that is this much larger than that of the wall is the
 * edge of a body, not a gradient: to reach into a body would make the levels
 * too stiff. */
#define WALL_JUMP 100
/* Masses in a family that differ by this factor jump. */
#define MASS_JUMP 10

/* Return the conductance of a wall over that between two cells. */
static double wall_factor(const struct bc *bc, double h) {
  switch (bc->type) {
    case BC_DIRICHLET:
      return 2;
    case BC_ROBIN:
      return 1 / (0.5 + bc->length / h);
    default:
      return 0;
  }
}

/* Weigh the sides across r of leaves in rings. */
static void weigh_sides(struct hierarchy *h, const double *alpha_f,
                        double factor) {
  const struct mesh *mesh = h->mesh;
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    const double ratio = conductance(mesh, i, factor);
    for (int f = 0; f < 2; f++) {
      h->w[f][h->leaf_slot[i]] =
          (float)(ratio * mesh_side(mesh, alpha_f, i, f));
    }
  }
}

/* Set the sides and the mass [nslots] of leaves. */
static void set_leaves(struct hierarchy *h, const double *alpha_f,
                       double factor, const double *mass_density,
                       double *mass) {
  const struct mesh *mesh = h->mesh;
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    const int32_t s = h->leaf_slot[i], *face = mesh->cell_face[i];
    const double ratio = conductance(mesh, i, factor);
    for (int f = 0; f < NFACE; f++) {
      h->w[f][s] = (float)(ratio * alpha_f[face[f]]);
    }
    mass[s] = mass_density ? mass_density[i] * mesh_volume(mesh, i) : 0;
  }
  if (mesh_is_axisymmetric(mesh)) weigh_sides(h, alpha_f, factor);
}

/* Add the conductances of the walls of level l to wall[c] [nslots]. Half a cell
 * of the level above reaches from the wall to the opposite side of the node. So
 * where the wall conducts less than that side, as it does below a heap that
 * shears there, the level above gets both in series; the mean of the walls
 * alone would make every level too soft and its corrections too large. */
static void set_walls(struct hierarchy *h, int l, const struct bc *const bc[],
                      double *const wall[]) {
  const struct level *level = &h->level[l];
  const double size = ldexp(forest_layout(h->mesh->forest)->size, -l);
  for (int32_t k = level->side_begin; k < level->side_end; k++) {
    const int32_t s = h->sides[k].slot;
    for (int f = 0; f < NFACE; f++) {
      const int patch = h->sides[k].patch[f];
      if (patch < 0) continue;
      const double w = (double)h->w[f][s], inside = (double)h->w[f ^ 1][s];
      for (int c = 0; c < h->nparts; c++) {
        const int twice = h->nparts > 1 && c == f >> 1 ? 2 : 1;
        const double bulk =
            h->has_bulk && twice > 1 ? (double)h->bulk[f][s] : 0;
        wall[c][s] += (twice * w + bulk) * wall_factor(&bc[c][patch], size);
      }
      if (inside > w && inside < WALL_JUMP * w) {
        h->w[f][s] = (float)(2 * w * inside / (w + inside));
      }
    }
  }
}

/* Merge the sides of level l: those of children in parallel, over twice the
 * distance. The limit g of the prolongation (hierarchy.h) is set along with
 * them. */
static void merge_sides(struct hierarchy *h, int l) {
  const struct level *level = &h->level[l];
  const int32_t n = level->nfamilies;
  const int32_t *parent = h->family_parent + level->family_begin;
  for (int f = 0; f < NFACE; f++) {
    const int d = f >> 1;
    const float *w = h->w[f], *within = h->w[2 * d + 1];
    float *limit = h->limit[f] + level->family_begin;
    for (int32_t k = 0; k < n; k++) {
      double in = 0, out = 0;
#pragma GCC unroll 8
      for (int c = 0; c < NCHILD; c++) {
        const int32_t i = family_slot(level, k, c);
        if ((c >> d & 1) == (f & 1)) out += 0.5 * (double)w[i];
        if ((c >> d & 1) == 0) in += 0.5 * (double)within[i];
      }
      h->w[f][parent[k]] = (float)out;
      limit[k] = (float)(max2(out, 0) / max2(max2(in, out), DBL_MIN));
    }
  }
}

/* Return the mass that node i gives to its parent. A node so heavy that its
 * value is 0 is a wall for its siblings, and the sum of masses would put that
 * wall too near. So the mass of a heavy node counts in series with its sides.
 */
static double given_mass(const struct hierarchy *h, const double *mass,
                         int32_t i, double least) {
  double sides = 0;
  if (!(mass[i] > MASS_JUMP * least)) return mass[i];
  for (int f = 0; f < NFACE; f++) sides += (double)h->w[f][i];
  return sides > 0 ? mass[i] * sides / (mass[i] + sides) : mass[i];
}

/* Merge the masses of level l: they add up. */
static void merge_masses(struct hierarchy *h, int l, double *mass) {
  const struct level *level = &h->level[l];
  const int32_t *parent = h->family_parent + level->family_begin;
  for (int32_t k = 0; k < level->nfamilies; k++) {
    double sum = 0;
    for (int c = 0; c < NCHILD; c++) sum += mass[family_slot(level, k, c)];
    mass[parent[k]] = sum;
  }
}

/* Merge them for a single component: a mass that jumps counts less. */
static void merge_jumping_masses(struct hierarchy *h, int l, double *mass) {
  const struct level *level = &h->level[l];
  const int32_t *parent = h->family_parent + level->family_begin;
  for (int32_t k = 0; k < level->nfamilies; k++) {
    double sum = 0, least = HUGE_VAL;
    for (int c = 0; c < NCHILD; c++) {
      least = min2(least, mass[family_slot(level, k, c)]);
    }
    for (int c = 0; c < NCHILD; c++) {
      sum += given_mass(h, mass, family_slot(level, k, c), least);
    }
    mass[parent[k]] = sum;
  }
}

/* Set the hoop stress [nslots] of leaves that move outward at r, over r: 2
 * alpha V / r, whose sum is that of a merged node. Returns it, NULL in a plane.
 */
static double *set_hoops(struct hierarchy *h, const double *alpha_f,
                         double factor, double *hoop) {
  const struct mesh *mesh = h->mesh;
  if (!mesh_is_axisymmetric(mesh) || h->nparts == 1) return NULL;
  memset(hoop, 0, (size_t)h->nslots * sizeof *hoop);
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    hoop[h->leaf_slot[i]] = 2 * factor * mesh_mean(mesh, alpha_f, i) *
                            mesh_volume(mesh, i) / mesh->x[i][0];
  }
  return hoop;
}

/* Merge the hoop stresses of level l, NULL: none. */
static void merge_hoops(struct hierarchy *h, int l, double *hoop) {
  if (!hoop) return;
  plan_run(&h->level[l].add, 1, &hoop, 1, true);
  merge_masses(h, l, hoop);
}

/* Add the hoop stresses to the diagonal of the radial velocity. */
static void add_hoops(const struct hierarchy *h, const double *hoop,
                      double *diagonal) {
  for (int32_t i = 0; i < h->nowned && hoop; i++) {
    diagonal[i] += hoop[i] / h->radius[i];
  }
}

static void add_ghosts(struct hierarchy *h, int l, double *mass) {
  plan_run_float(&h->level[l].add, NFACE, h->w, true);
  plan_run(&h->level[l].add, 1, &mass, 1, true);
}

/* Clear the sides without a neighbour, once walls are in the diagonal. */
static void clear_sides(struct hierarchy *h) {
  for (int32_t k = 0; k < h->nsides; k++) {
    for (int f = 0; f < NFACE; f++) {
      if (h->sides[k].patch[f] < 0) continue;
      h->w[f][h->sides[k].slot] = 0;
      if (h->has_bulk) h->bulk[f][h->sides[k].slot] = 0;
    }
  }
  /* A tree that is its own neighbour has no flux. */
  for (int32_t i = 0; i < h->level[0].nowned; i++) {
    for (int f = 0; f < NFACE; f++) {
      if (h->neighbour[f][i] != i) continue;
      h->w[f][i] = 0;
      if (h->has_bulk) h->bulk[f][i] = 0;
    }
  }
}

/* Add the sides of lambda to the diagonal of component c. */
static void add_bulk(const struct hierarchy *h, int c, double *diagonal) {
  const float *lower = h->bulk[2 * c], *upper = h->bulk[2 * c + 1];
  for (int32_t i = 0; i < h->nowned; i++) {
    diagonal[i] += (double)lower[i] + (double)upper[i];
  }
}

/* Set the inverse of the diagonal from mass, which is overwritten, walls and
 * sides. */
static void set_inverse(struct hierarchy *h, double *restrict mass,
                        double *const wall[]) {
  const int64_t stride = h->stride;
  for (int32_t i = 0; i < h->nowned; i++) {
    double sum = mass[i];
#pragma GCC unroll 6
    for (int f = 0; f < NFACE; f++) sum += (double)h->w[f][i];
    mass[i] = sum;
  }
  for (int c = 0; c < h->nparts; c++) {
    const double twice = h->nparts > 1 ? 1 : 0; /* the normal stress */
    const float *lower = h->w[2 * c], *upper = h->w[2 * c + 1];
    double *restrict inverse = h->inverse[c];
    if (h->has_bulk) add_bulk(h, c, wall[c]);
    for (int32_t i = 0; i < h->nowned; i++) {
      const double diagonal =
          mass[i] + wall[c][i] + twice * ((double)lower[i] + (double)upper[i]);
      const double a = 1 / max2(diagonal, DBL_MIN);
      inverse[i * stride] = diagonal > 0 ? a : 0;
    }
  }
  for (int l = 0; l < h->nlevels; l++) {
    run_plan(h, &h->level[l].copy, h->inverse, false);
  }
}

/* Set what a correction is beyond walls, for the prolongation. */
static void set_beyond(struct hierarchy *h, const struct bc *const bc[]) {
  const double size = forest_layout(h->mesh->forest)->size;
  for (int l = 0; l < h->nlevels; l++) {
    for (int c = 0; c < h->nparts; c++) {
      for (int k = 0; k < MESH_MAX_PATCHES; k++) {
        double b;
        bc_ghost(&bc[c][k], ldexp(size, -l), &h->beyond[l][c][k], &b);
      }
    }
  }
}

static void set_weights(struct hierarchy *h) {
  const struct mesh *mesh = h->mesh;
  for (int c = 0; c < h->nparts; c++) {
    const double *inverse = h->inverse[c];
    float *weight = h->weight + (int64_t)c * mesh->nleaves;
    for (int32_t i = 0; i < mesh->nleaves; i++) {
      weight[i] = (float)(inverse[(int64_t)h->leaf_slot[i] * h->stride] *
                          mesh_volume(mesh, i));
    }
  }
}

/* Arrange e, r and the inverse for so many components. */
static void lay_out(struct hierarchy *h, int nparts) {
  const int64_t n = h->nslots;
  h->nparts = nparts;
  h->stride = nparts > 1 ? LANES : 1;
  set_parts(h, h->e[0], n + h->njumps + h->nmirrors, h->e);
  set_parts(h, h->r[0], n, h->r);
  set_parts(h, h->inverse[0], n, h->inverse);
  for (int64_t i = 0; i < n && LANES > 1 && nparts > 1; i++) {
    h->inverse[0][LANES * i + DIM] = 0;
  }
}

void coefficients_set(struct hierarchy *h, int nparts, const double *alpha_f,
                      double factor, const double *mass_density,
                      const struct bc *const bc[]) {
  const size_t size = (size_t)h->nslots * sizeof(double);
  double *mass = h->arena, *wall[DIM]; /* free for now, as e and r are */
  for (int c = 0; c < DIM; c++) wall[c] = mass + (1 + c) * (int64_t)h->nslots;
  lay_out(h, nparts);
  h->has_mass = mass_density != NULL;
  h->nskin = h->ncycles = h->rough_sweeps = 0;
  for (int c = 0; c < nparts; c++) memset(wall[c], 0, size);
  /* what other ranks have merged is added */
  for (int f = 0; f < NFACE && h->nranks > 1; f++) {
    memset(h->w[f], 0, (size_t)h->nslots * sizeof *h->w[f]);
  }
  if (h->nranks > 1) memset(mass, 0, size);
  set_leaves(h, alpha_f, factor, mass_density, mass);
  double *hoop =
      set_hoops(h, alpha_f, factor, mass + (1 + DIM) * (int64_t)h->nslots);
  for (int l = h->nlevels - 1; l >= 0; l--) {
    add_ghosts(h, l, mass);
    set_walls(h, l, bc, wall);
    merge_sides(h, l);
    merge_hoops(h, l, hoop);
    if (h->has_mass && h->nparts == 1) {
      merge_jumping_masses(h, l, mass);
    } else {
      merge_masses(h, l, mass);
    }
  }
  clear_sides(h);
  add_hoops(h, hoop, wall[0]);
  set_inverse(h, mass, wall);
  set_beyond(h, bc);
  set_weights(h);
}
