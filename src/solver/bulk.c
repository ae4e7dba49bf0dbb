/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The stress lambda (div u) I in the cycle, lambda = kappa - 2 eta / 3.
 *
 * On a face of axis c it adds to the normal stress
 *   lambda (u_c1 - u_c0) / h + lambda sum_(d != c) du_d/dx_d,
 * du_d/dx_d being the mean over both nodes as in viscous.h. Conductances l are
 * to lambda what w are to eta, merged in the same way; the first part is in the
 * diagonal, and no node couples to itself by the second. */
#include <string.h>

#include "levels.h"
#include "talus/memory.h"

/* Set those of leaves. */
static void set_leaves(struct hierarchy *h, const double *eta_f,
                       const double *kappa_f, double factor) {
  const struct mesh *mesh = h->mesh;
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    const int32_t s = h->leaf_slot[i];
    const double ratio = conductance(mesh, i, factor);
    for (int f = 0; f < NFACE; f++) {
      const double lambda = mesh_side(mesh, kappa_f, i, f) -
                            2. / 3 * mesh_side(mesh, eta_f, i, f);
      h->bulk[f][s] = (float)(ratio * lambda);
    }
  }
}

/* Merge level l to level l - 1: sides of children in parallel. */
static void merge_sides(struct hierarchy *h, int l) {
  const struct level *level = &h->level[l];
  const int32_t *parent = h->family_parent + level->family_begin;
  for (int f = 0; f < NFACE; f++) {
    for (int32_t k = 0; k < level->nfamilies; k++) {
      double out = 0;
      for (int c = 0; c < NCHILD; c++) {
        if ((c >> (f >> 1) & 1) != (f & 1)) continue;
        out += 0.5 * (double)h->bulk[f][family_slot(level, k, c)];
      }
      h->bulk[f][parent[k]] = (float)out;
    }
  }
}

void bulk_set(struct hierarchy *h, const double *eta_f, const double *kappa_f,
              double factor) {
  const size_t n = (size_t)h->nslots;
  h->has_bulk = kappa_f != NULL;
  if (!h->has_bulk) return;
  for (int f = 0; f < NFACE; f++) {
    if (!h->bulk[f]) h->bulk[f] = MEM_NEW(float, n);
    memset(h->bulk[f], 0, n * sizeof *h->bulk[f]);
  }
  set_leaves(h, eta_f, kappa_f, factor);
  for (int l = h->nlevels - 1; l >= 0; l--) {
    plan_run_float(&h->level[l].add, NFACE, h->bulk, true);
    merge_sides(h, l);
  }
}
