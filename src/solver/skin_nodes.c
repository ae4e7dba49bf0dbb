/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Nodes beside the surface of the grains in the cycle, where the transposed
 * gradient has weights (skin.h).
 *
 * A cycle that does not know the weights leaves max |r/rho| there ten times as
 * large, at light nodes whose face has the viscosity of the grains. So after
 * each run of nodes those of the skin in it are relaxed once more, from what
 * that has left, with their own rows; they are few. Each is solved as a block,
 * as the weights couple the components of one node. Merged nodes have no
 * weights: a smooth correction has the same differences on all lines. Nor have
 * the few leaves whose family is another rank's. */
#include <math.h>
#include <string.h>

#include "levels.h"
#include "talus/memory.h"
#include "talus/minmax.h"

/* Faces whose weights are all nearer than this to 1/4 are left as they are. */
#define ODD_WEIGHT 0.01

/* List the nodes around node i in the plane of axes a < b. */
static void list_plane(const struct hierarchy *h, int32_t i, int a, int b,
                       int32_t around[9]) {
  around[4] = i;
  for (int s = 0; s < 2; s++) {
    const int up_a = s ? 1 : -1, up_b = s ? 3 : -3;
    around[4 + up_a] = h->neighbour[2 * a + s][i];
    around[4 + up_b] = h->neighbour[2 * b + s][i];
    for (int t = 0; t < 2; t++) {
      around[4 + up_a + (t ? 3 : -3)] = h->corner[corner_entry(a, s, b, t)][i];
    }
  }
}

/* Add to a row what the weights change at the face of conductance w beyond
 * which lies node 4 + `over`, unless all is less than `least`; the lines go
 * along `step`. */
static bool add_face(const double m[9], bool grains_only, double w,
                     double least, int over, int step, double row[9]) {
  const double grains = min2(m[4], m[4 + over]);
  double weight[4], sum = 0, most = 0;
  if (!(w > least)) return false;
  for (int k = 0; k < 4; k++) {
    const int end = 4 + (k < 2 ? 0 : over) + (k & 1 ? step : -step);
    const int base = 4 + (k < 2 ? 0 : over);
    weight[k] = skin_weight(grains_only, grains, m[base], m[end]);
    sum += weight[k];
  }
  const double scale = sum > 0 ? 1 / sum : 0;
  for (int k = 0; k < 4; k++) {
    weight[k] = weight[k] * scale - 0.25;
    most = max2(most, fabs(weight[k]));
  }
  if (most < ODD_WEIGHT || w * most < least) return false;
  for (int k = 0; k < 4; k++) {
    const int base = 4 + (k < 2 ? 0 : over);
    const double a = ((over > 0) == (k & 1) ? w : -w) * weight[k];
    row[base + (k & 1 ? step : -step)] += a;
    row[base] -= a;
  }
  return true;
}

/* Fill the diagonal and rows of a node, m being that of its stencil; false if
 * nothing changes. */
static bool set_rows(const struct hierarchy *h, const double *m,
                     const struct skin *skin, struct skin_node *node) {
  const bool grains_only = skin->grains_only;
  bool odd = false;
  double least[DIM];
  for (int c = 0; c < DIM; c++) {
    const double inverse = h->inverse[c][node->slot * h->stride];
    node->diagonal[c] = inverse > 0 ? 1 / inverse : 1;
    least[c] = skin->slight * node->diagonal[c];
  }
  memset(node->row, 0, sizeof node->row);
  for (int a = 0; a < DIM; a++) {
    for (int b = a + 1; b < DIM; b++) {
      const int p = pair_number(a, b);
      double near[9];
      for (int k = 0; k < 9; k++) {
        near[k] = m[STENCIL_CENTRE + (k % 3 - 1) * stencil_step(a) +
                    (k / 3 - 1) * stencil_step(b)];
      }
      list_plane(h, node->slot, a, b, node->around[p]);
      for (int s = -1; s <= 1; s += 2) {
        const double wa = (double)h->w[2 * a + (s > 0)][node->slot];
        const double wb = (double)h->w[2 * b + (s > 0)][node->slot];
        odd = add_face(near, grains_only, wb, least[a], 3 * s, 1,
                       node->row[p][0]) ||
              odd;
        odd =
            add_face(near, grains_only, wa, least[b], s, 3, node->row[p][1]) ||
            odd;
      }
    }
  }
  return odd;
}

/* Invert a, by elimination. */
static void invert(double a[DIM][DIM], double inverse[DIM][DIM]) {
  for (int c = 0; c < DIM; c++) {
    for (int d = 0; d < DIM; d++) inverse[c][d] = c == d;
  }
  for (int p = 0; p < DIM; p++) {
    const double pivot = 1 / a[p][p];
    for (int d = 0; d < DIM; d++) a[p][d] *= pivot, inverse[p][d] *= pivot;
    for (int c = 0; c < DIM; c++) {
      const double factor = c == p ? 0 : a[c][p];
      for (int d = 0; d < DIM; d++) {
        a[c][d] -= factor * a[p][d];
        inverse[c][d] -= factor * inverse[p][d];
      }
    }
  }
}

/* Invert the block of a node, once its rows are known. */
static void set_block(struct skin_node *node) {
  double block[DIM][DIM];
  for (int c = 0; c < DIM; c++) block[c][c] = node->diagonal[c];
  for (int a = 0; a < DIM; a++) {
    for (int b = a + 1; b < DIM; b++) {
      block[a][b] = -node->row[pair_number(a, b)][0][4];
      block[b][a] = -node->row[pair_number(a, b)][1][4];
    }
  }
  invert(block, node->inverse);
}

/* Number of the run of leaf i among those of all levels, -1: it is another
 * rank's. */
static int run_number(const struct hierarchy *h, int32_t i) {
  const int l = h->mesh->level[i];
  const struct level *level = &h->level[l];
  const int32_t slot = h->leaf_slot[i];
  if (l == 0 || slot >= h->nowned) return -1;
  return l * NCHILD + (slot - level->begin) / level->nfamilies;
}

/* Sort the leaves of the skin by runs; sorted [nleaves], end [nlevels * NCHILD
 * + 1] of each run. */
static void sort_leaves(const struct hierarchy *h, const struct skin *skin,
                        int32_t *end, const struct skin_leaf **sorted) {
  const int n = h->nlevels * NCHILD;
  memset(end, 0, (size_t)(n + 1) * sizeof *end);
  for (int32_t k = 0; k < skin->nleaves; k++) {
    end[run_number(h, skin->leaf[k].leaf) + 1]++;
  }
  end[0] = 0; /* where the first begins */
  for (int q = 0; q < n; q++) end[q + 1] += end[q];
  for (int32_t k = 0; k < skin->nleaves; k++) {
    const int q = run_number(h, skin->leaf[k].leaf);
    if (q >= 0) sorted[end[q]++] = &skin->leaf[k];
  }
}

/* Add the node of a leaf if it has a face with odd weights. */
static void add_node(struct hierarchy *h, const struct skin_leaf *leaf,
                     const struct skin *skin) {
  const struct level *level = &h->level[h->mesh->level[leaf->leaf]];
  struct skin_node *node = &h->skin_node[h->nskin];
  node->slot = h->leaf_slot[leaf->leaf];
  const int32_t family = (node->slot - level->begin) % level->nfamilies;
  node->parent = h->family_parent[level->family_begin + family];
  if (!set_rows(h, leaf->grains, skin, node)) return;
  set_block(node);
  h->nskin++;
}

static void make_room(struct hierarchy *h, int32_t n) {
  if (!h->skin_begin) {
    h->skin_begin = MEM_NEW(int32_t, h->nlevels * NCHILD + 1);
  }
  if (n <= h->skin_room) return;
  mem_free(h->skin_node);
  h->skin_room = n + n / 2;
  h->skin_node = MEM_NEW(struct skin_node, h->skin_room);
}

void skin_nodes_set(struct hierarchy *h, const struct skin *skin) {
  const int nruns = h->nlevels * NCHILD;
  h->nskin = 0;
  if (!skin || skin->nleaves == 0) return;
  make_room(h, skin->nleaves);
  const struct skin_leaf **sorted =
      MEM_NEW(const struct skin_leaf *, skin->nleaves);
  sort_leaves(h, skin, h->skin_begin, sorted);
  int32_t k = 0;
  for (int q = 0; q < nruns; q++) {
    const int32_t end = h->skin_begin[q];
    h->skin_begin[q] = h->nskin;
    for (; k < end; k++) add_node(h, sorted[k], skin);
  }
  h->skin_begin[nruns] = h->nskin;
  mem_free(sorted);
}

/* Add the rows of a node, times e, to sum. */
static inline void add_rows(const struct hierarchy *h,
                            const struct skin_node *node, double sum[DIM]) {
  for (int a = 0; a < DIM; a++) {
    for (int b = a + 1; b < DIM; b++) {
      const int p = pair_number(a, b);
      const double *first = node->row[p][0], *second = node->row[p][1];
      for (int k = 0; k < 9; k++) {
        sum[a] += first[k] * h->e[b][node->around[p][k] * h->stride];
        sum[b] += second[k] * h->e[a][node->around[p][k] * h->stride];
      }
    }
  }
}

/* Find e of a node with weights, the relaxation without having left e = pull /
 * diagonal. */
static void relax_again(struct hierarchy *h, struct skin_node *node) {
  double pull[DIM], before[DIM];
  const int64_t i = node->slot * h->stride;
  for (int c = 0; c < DIM; c++) {
    before[c] = h->e[c][i];
    pull[c] = before[c] * node->diagonal[c];
    h->e[c][i] = 0;
  }
  add_rows(h, node, pull);
  for (int c = 0; c < DIM; c++) {
    h->e[c][i] = before[c];
    node->next[c] = 0;
    for (int d = 0; d < DIM; d++) {
      node->next[c] += node->inverse[c][d] * pull[d];
    }
  }
}

void skin_nodes_relax(struct hierarchy *h, int l, int first, int end) {
  if (h->nskin == 0) return;
  const int32_t *begin = h->skin_begin + l * NCHILD;
  for (int32_t k = begin[first]; k < begin[end]; k++) {
    relax_again(h, &h->skin_node[k]);
  }
  for (int32_t k = begin[first]; k < begin[end]; k++) {
    const struct skin_node *node = &h->skin_node[k];
    for (int c = 0; c < DIM; c++) {
      h->e[c][node->slot * h->stride] = node->next[c];
    }
  }
}

/* Add what the weights change; the last run, relaxed last, has no residual. */
void skin_nodes_restrict(struct hierarchy *h, int l) {
  if (h->nskin == 0) return;
  const int32_t *begin = h->skin_begin + l * NCHILD;
  for (int32_t k = begin[0]; k < begin[NCHILD - 1]; k++) {
    const struct skin_node *node = &h->skin_node[k];
    double sum[DIM] = {0};
    add_rows(h, node, sum);
    for (int c = 0; c < DIM; c++) {
      h->r[c][node->parent * h->stride] += sum[c];
    }
  }
}
