/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Coefficients of the two-point operator on all levels. */
#include <math.h>
#include <string.h>

#include "levels.h"
#include "talus/forest.h"
#include "talus/memory.h"

/* Conductance of a wall over that between two cells. */
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

/* Leaves: sides into w, mass and walls into arrays of slots. */
static void set_leaves(struct hierarchy *h, const double *alpha_f,
                       double factor, const double *mass_density,
                       const struct bc *const bc[], double *mass,
                       double *wall) {
  const struct mesh *mesh = h->mesh;
  const int nparts = h->nparts;
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    const int32_t s = h->leaf_slot[i];
    const double size = mesh->h[i];
    const double ratio = factor * mesh->volume[i] / (size * size);
    for (int f = 0; f < NFACE; f++) {
      const int32_t face = mesh->cell_face[i][f];
      const int patch = face < mesh->nfaces ? mesh->face_patch[face] : -1;
      const double g = ratio * alpha_f[face];
      h->w[s][f] = g;
      if (patch < 0) continue;
      for (int c = 0; c < nparts; c++) {
        const int twice = nparts > 1 && c == f >> 1 ? 2 : 1;
        wall[s * nparts + c] += twice * g * wall_factor(&bc[c][patch], size);
      }
    }
    mass[s] = mass_density ? mass_density[i] * mesh->volume[i] : 0;
  }
}

/* Level l to level l - 1: sides and walls of children in parallel, over twice
 * the distance; masses add up. */
static void merge_level(struct hierarchy *h, int l, double *mass,
                        double *wall) {
  const struct level *level = &h->level[l];
  const int nparts = h->nparts;
  for (int32_t k = 0; k < level->nfamilies; k++) {
    const int32_t p = h->family_parent[level->family_begin + k];
    for (int c = 0; c < NCHILD; c++) {
      const int32_t i = family_slot(level, k, c);
      for (int d = 0; d < DIM; d++) {
        const int f = 2 * d + (c >> d & 1);
        h->w[p][f] += 0.5 * h->w[i][f];
      }
      mass[p] += mass[i];
      for (int q = 0; q < nparts; q++) {
        wall[p * nparts + q] += 0.5 * wall[i * nparts + q];
      }
    }
  }
}

static void add_ghosts(struct hierarchy *h, int l, double *mass, double *wall) {
  double *w = &h->w[0][0];
  plan_run(&h->level[l].add, 1, &w, NFACE, true);
  plan_run(&h->level[l].add, 1, &mass, 1, true);
  plan_run(&h->level[l].add, 1, &wall, h->nparts, true);
}

/* Slopes inside a family from values outside are kept small where what is
 * inside is stiffer than the side between. */
static void set_limits(struct hierarchy *h, int l) {
  const struct level *level = &h->level[l];
  for (int32_t k = 0; k < level->nfamilies; k++) {
    const int32_t p = h->family_parent[level->family_begin + k];
    float *limit = h->limit[level->family_begin + k];
    double inside[DIM] = {0};
    for (int c = 0; c < NCHILD; c++) {
      const double *w = h->w[family_slot(level, k, c)];
      for (int d = 0; d < DIM; d++) {
        inside[d] += (c >> d & 1) ? 0 : 0.5 * w[2 * d + 1];
      }
    }
    for (int f = 0; f < NFACE; f++) {
      const double in = inside[f >> 1], out = h->w[p][f];
      limit[f] = in > out ? (float)(out / in) : 1;
    }
  }
}

/* Walls have no neighbour: they are in the diagonal. */
static void clear_sides(struct hierarchy *h) {
  for (int32_t k = 0; k < h->nsides; k++) {
    for (int f = 0; f < NFACE; f++) {
      if (h->sides[k].patch[f] >= 0) h->w[h->sides[k].slot][f] = 0;
    }
  }
}

static void set_inverse(struct hierarchy *h, const double *mass,
                        const double *wall) {
  const int nparts = h->nparts;
  for (int32_t i = 0; i < h->nowned; i++) {
    double sum = mass[i];
    for (int f = 0; f < NFACE; f++) sum += h->w[i][f];
    for (int c = 0; c < nparts; c++) {
      double diagonal = sum + wall[i * nparts + c];
      if (nparts > 1) diagonal += h->w[i][2 * c] + h->w[i][2 * c + 1];
      h->inverse[i * nparts + c] = diagonal > 0 ? 1 / diagonal : 0;
    }
  }
  for (int l = 0; l < h->nlevels; l++) {
    plan_run(&h->level[l].copy, 1, &h->inverse, nparts, false);
  }
}

/* Ghost values of corrections, for prolongation. */
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
  const int nparts = h->nparts;
  for (int c = 0; c < nparts; c++) {
    double *weight = h->weight + (int64_t)c * mesh->nleaves;
    for (int32_t i = 0; i < mesh->nleaves; i++) {
      const double d = h->inverse[h->leaf_slot[i] * nparts + c];
      weight[i] = d * d * mesh->volume[i] * mesh->volume[i];
    }
  }
}

void coefficients_set(struct hierarchy *h, int nparts, const double *alpha_f,
                      double factor, const double *mass_density,
                      const struct bc *const bc[]) {
  double *mass = h->e, *wall = h->r; /* free for now */
  h->nparts = nparts;
  h->ncycles = h->rough_sweeps = 0;
  memset(h->w, 0, (size_t)h->nslots * sizeof *h->w);
  memset(mass, 0, (size_t)h->nslots * sizeof *mass);
  memset(wall, 0, (size_t)(h->nslots * nparts) * sizeof *wall);
  set_leaves(h, alpha_f, factor, mass_density, bc, mass, wall);
  for (int l = h->nlevels - 1; l >= 0; l--) {
    add_ghosts(h, l, mass, wall);
    merge_level(h, l, mass, wall);
  }
  for (int l = 1; l < h->nlevels; l++) set_limits(h, l);
  clear_sides(h);
  /* A tree that is its own neighbour has no flux. */
  for (int32_t i = 0; i < h->level[0].nowned; i++) {
    for (int f = 0; f < NFACE; f++) {
      if (h->neighbour[i][f] == i) h->w[i][f] = 0;
    }
  }
  set_inverse(h, mass, wall);
  set_beyond(h, bc);
  set_weights(h);
}
