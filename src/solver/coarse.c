/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The coarsest level, the trees of the brick: conjugate gradients, scaled by
 * the diagonal. Components are not coupled here. */
#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "levels.h"
#include "talus/forest.h"

/* Set q = A p for component c. */
static void apply(const struct hierarchy *h, int c, const double *p,
                  double *q) {
  for (int32_t i = 0; i < h->level[0].nowned; i++) {
    const double inverse = h->inverse[c][i * h->stride];
    double sum = inverse > 0 ? p[i] / inverse : 0;
    for (int f = 0; f < NFACE; f++) {
      if (h->wall[i] >> f & 1) continue; /* p has no images */
      const bool normal = h->nparts > 1 && c == f >> 1;
      double pull = (normal ? 2 : 1) * (double)h->w[f][i];
      if (h->has_bulk && normal) pull += (double)h->bulk[f][i];
      sum -= pull * p[h->neighbour[f][i]];
    }
    q[i] = sum;
  }
}

static void solve(struct hierarchy *h, int c) {
  const int32_t n = h->level[0].nowned;
  const int64_t stride = h->stride;
  const struct forest_layout *layout = forest_layout(h->mesh->forest);
  int most = 8;
  for (int d = 0; d < DIM; d++) most += 2 * layout->trees[d];
  double *e = h->e[c], *r = h->r[c]; /* trees have the first slots */
  double *z = h->coarse[0], *p = h->coarse[1], *q = h->coarse[2];
  double rz_old = 0, rz_first = 0;
  memset(p, 0, (size_t)n * sizeof *p);
  for (int32_t k = 0; k < n; k++) e[k * stride] = 0;
  for (int iteration = 0; iteration < most; iteration++) {
    double rz = 0, pq = 0;
    for (int32_t k = 0; k < n; k++) {
      z[k] = h->inverse[c][k * stride] * r[k * stride];
      rz += r[k * stride] * z[k];
    }
    if (iteration == 0) rz_first = rz;
    if (!(rz > 1e-6 * rz_first)) break;
    const double beta = iteration > 0 ? rz / rz_old : 0;
    for (int32_t k = 0; k < n; k++) p[k] = z[k] + beta * p[k];
    apply(h, c, p, q);
    for (int32_t k = 0; k < n; k++) pq += p[k] * q[k];
    /* Only the constant is left; with mass it may be all there is. */
    if (!(pq > (h->has_mass ? 1e-14 : 1e-11) * rz)) break;
    const double a = rz / pq;
    for (int32_t k = 0; k < n; k++) {
      e[k * stride] += a * p[k];
      r[k * stride] -= a * q[k];
    }
    rz_old = rz;
  }
}

void coarse_solve(struct hierarchy *h) {
  for (int c = 0; c < h->nparts; c++) solve(h, c);
}
