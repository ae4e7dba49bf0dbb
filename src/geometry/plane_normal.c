/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <math.h>
#include <stdbool.h>

#include "cut.h"
#include "talus/plane.h"

static const int STRIDE[3] = {1, 3, 9};

/* Misfit of the mixed normal from which on the fit is taken as it is. */
static const double ROUGH = DIM == 2 ? 0.1 : 1.;

/* Add the two paired neighbours of cell i at distance s. */
static inline double pair(const double *c, int i, int s) {
  return c[i - s] + c[i + s];
}

/* Sum of a column of three cells along stride s, centred on cell i. */
static inline double column(const double *c, int i, int s) {
  return c[i] + pair(c, i, s);
}

/* Return the weighted sum (1 2 1 in each direction) over the layer through cell
 * i. */
static inline double layer(const double *c, int i, int d) {
  int e = STRIDE[(d + 1) % DIM];
#if DIM == 2
  return 2. * c[i] + pair(c, i, e);
#else
  int f = STRIDE[(d + 2) % DIM];
  double edges = pair(c, i, e) + pair(c, i, f);
  double corners = pair(c, i, e + f) + pair(c, i, e - f);
  return 4. * c[i] + 2. * edges + corners;
#endif
}

/* Scale n to |n|_1 = 1; a zero vector stays. */
static inline void normalise(double n[DIM]) {
  double norm = norm1(n);
  if (norm > 0.)
    for (int d = 0; d < DIM; d++) n[d] /= norm;
}

/* Find Youngs' normal, minus the weighted gradient of c, with |n|_1 = 1. */
static inline void youngs_normal(const double *c, double n[DIM]) {
  const int centre = PLANE_STENCIL / 2;
  for (int d = 0; d < DIM; d++)
    n[d] = layer(c, centre - STRIDE[d], d) - layer(c, centre + STRIDE[d], d);
  normalise(n);
}

/*
 * Find the centred normal from the columns along d, with |n|_1 = 1; side is the
 * sign of its component d, 0 for a stencil that does not tell the two sides
 * apart.
 */
static inline void column_normal(const double *c, int d, double side,
                                 double n[DIM]) {
  const int centre = PLANE_STENCIL / 2;
  for (int k = 1; k < DIM; k++) {
    int e = (d + k) % DIM, s = STRIDE[e];
    n[e] = 0.5 * (column(c, centre - s, STRIDE[d]) -
                  column(c, centre + s, STRIDE[d]));
  }
  n[d] = (side > 0.) - (side < 0.);
  normalise(n);
}

/* Find the mixed Youngs-centred normal, the start of the fit. */
static void mixed_normal(const double c[PLANE_STENCIL], double n[DIM]) {
  const double tie = 1. - 1e-10;
  double youngs[DIM], centred[DIM][DIM], largest = 0., youngs_largest = 0.;
  youngs_normal(c, youngs);
  for (int d = 0; d < DIM; d++) {
    column_normal(c, d, youngs[d], centred[d]);
    largest = max2(largest, fabs(centred[d][d]));
    youngs_largest = max2(youngs_largest, fabs(youngs[d]));
  }
  if (tie * largest > youngs_largest || largest <= 0.) {
    for (int d = 0; d < DIM; d++) n[d] = youngs[d];
    return;
  }
  for (int d = 0; d < DIM; d++) n[d] = 0.;
  for (int d = 0; d < DIM; d++)
    if (fabs(centred[d][d]) >= tie * largest)
      for (int e = 0; e < DIM; e++) n[e] += centred[d][e];
  normalise(n);
}

/* Sums over the stencil: misfit, half its gradient, and half its Gauss-Newton
 * Hessian, the lower triangle row by row. */
enum { GRADIENT = 1, HESSIAN = 1 + DIM, TERMS = HESSIAN + DIM * (DIM + 1) / 2 };

/*
 * Add the share of one cell to the sums, from its residual r = V - c and the
 * derivative
 *
 *   dV/dn = dV/dalpha (x_0 - x_k),   x the centroids of the plane's cuts,
 *
 * where alpha follows n such that cell 0 keeps its volume: dalpha/dn = x_0.
 * local is alpha as seen from the cell.
 */
static inline void add_cell(const struct cut *cut, const double n[DIM],
                            double local, const double origin[DIM],
                            const double offset[DIM], double c,
                            double sum[TERMS]) {
  double a = 0.5 - fabs(local), derivative[DIM], x[DIM];
  if (a <= 0.) {
    double r = (local > 0. ? 1. : 0.) - c;
    sum[0] += r * r;
    return;
  }
  double v = small_volume(cut->m, a), slope = small_slope(cut->m, a);
  double r = (local > 0. ? 1. - v : v) - c;
  sum[0] += r * r;
  cut_centroid(cut, n, local, x);
  for (int d = 0; d < DIM; d++)
    derivative[d] = slope * (origin[d] - (offset[d] + x[d]));
  for (int d = 0, t = HESSIAN; d < DIM; d++) {
    sum[GRADIENT + d] += r * derivative[d];
    for (int e = 0; e <= d; e++) sum[t++] += derivative[d] * derivative[e];
  }
}

/*
 * Measure the misfit over the known cells of the plane with normal n, |n|_1 =
 * 1, and its derivatives. Sums run over -1, 1, 0 along each axis, rows first: a
 * reflection changes no bit of them.
 */
static void measure_misfit(const double *c, const bool *known,
                           const double n[DIM], double sum[TERMS]) {
  static const int order[] = {0, 2, 1};
  const int centre = PLANE_STENCIL / 2;
  const struct cut cut = cut_sorted(n, 1.);
  double origin[DIM], alpha = plane_alpha(n, c[centre]);
  cut_centroid(&cut, n, alpha, origin);
  for (int t = 0; t < TERMS; t++) sum[t] = 0.;
  for (int k = 0; k < (DIM == 3 ? 3 : 1); k++) {
    double layer[TERMS] = {0.};
#pragma GCC unroll 3
    for (int j = 0; j < 3; j++) {
      double row[TERMS] = {0.};
#pragma GCC unroll 3
      for (int i = 0; i < 3; i++) {
        int at[3] = {order[i], order[j], order[k]}, s = 0;
        double offset[DIM], local = alpha;
        for (int d = 0; d < DIM; d++) {
          s += STRIDE[d] * at[d];
          offset[d] = at[d] - 1;
          local -= n[d] * offset[d];
        }
        if (!known || known[s])
          add_cell(&cut, n, local, origin, offset, c[s], row);
      }
      for (int t = 0; t < TERMS; t++) layer[t] += row[t];
    }
    for (int t = 0; t < TERMS; t++) sum[t] += layer[t];
  }
}

/* Solve h x = x for a symmetric positive h, given and changed as its lower
 * triangle: h = L D L^T. */
static inline void solve_symmetric(double h[DIM][DIM], double x[DIM]) {
  for (int d = 0; d < DIM; d++)
    for (int e = d + 1; e < DIM; e++) {
      double factor = h[e][d] / h[d][d];
      for (int f = e; f < DIM; f++) h[f][e] -= factor * h[f][d];
      x[e] -= factor * x[d];
    }
  for (int d = DIM - 1; d >= 0; d--) {
    for (int e = d + 1; e < DIM; e++) x[d] -= h[e][d] * x[e];
    x[d] /= h[d][d];
  }
}

/*
 * Find a Gauss-Newton step. The Hessian H takes n to 0, as the length of n does
 * not matter: tr(H) n n^T is added, and the step is orthogonal to n. Damping in
 * proportion to the misfit holds it where few cells are cut, and lets it
 * converge quadratically to a plane. Returns the expected fall of the misfit.
 */
static double newton_step(const double sum[TERMS], const double n[DIM],
                          double step[DIM]) {
  const double damping = 1e-8 + 1e-2 * min2(sum[0], 1.);
  double h[DIM][DIM], trace = 0., square = 0., fall = 0.;
  for (int d = 0, t = HESSIAN; d < DIM; d++) {
    for (int e = 0; e <= d; e++) h[d][e] = sum[t++];
    trace += h[d][d];
    square += n[d] * n[d];
    step[d] = -sum[GRADIENT + d];
  }
  for (int d = 0; d < DIM; d++) {
    for (int e = 0; e <= d; e++) h[d][e] += trace / square * (n[d] * n[e]);
    h[d][d] += damping * trace + 1e-300; /* H = 0 gives no step */
  }
  solve_symmetric(h, step);
  for (int d = 0; d < DIM; d++) fall -= sum[GRADIENT + d] * step[d];
  return fall;
}

/* Lower the misfit from that of n, sum[0], and leave the best n and its sums.
 */
static void fit_normal(const double *c, const bool *known, double n[DIM],
                       double sum[TERMS]) {
  const double exact = 1e-26, enough = 1e-3, longest = 0.5;
  double part = 1.;
  for (int i = 0; i < 8 && sum[0] > exact; i++) {
    double step[DIM], trial[DIM], trial_sum[TERMS];
    if (!(newton_step(sum, n, step) > enough * sum[0])) return;
    double scale = part * min2(1., longest / norm1(step));
    for (int d = 0; d < DIM; d++) trial[d] = n[d] + scale * step[d];
    normalise(trial);
    measure_misfit(c, known, trial, trial_sum);
    if (trial_sum[0] < sum[0]) {
      for (int d = 0; d < DIM; d++) n[d] = trial[d];
      for (int t = 0; t < TERMS; t++) sum[t] = trial_sum[t];
      part = 1.;
    } else {
      part *= 0.5;
    }
  }
}

void plane_normal(const double c[PLANE_STENCIL],
                  const bool known[PLANE_STENCIL], double n[DIM]) {
  const double own = c[PLANE_STENCIL / 2];
  mixed_normal(c, n);
  if (!(own > 0. && own < 1.) || norm1(n) <= 0.) return;
  double fit[DIM], sum[TERMS], along = 0.;
  measure_misfit(c, known, n, sum);
  const double start = sum[0];
  for (int d = 0; d < DIM; d++) fit[d] = n[d];
  fit_normal(c, known, fit, sum);
  for (int d = 0; d < DIM; d++) along += fit[d] * n[d];
  if (!(sum[0] < start) || along <= 0.) return; /* no better; turned over */
  const double gain = 1. - sum[0] / start, misfit = start / ROUGH;
  const double weight = gain > misfit ? gain : min2(1., misfit); /* eq. (4) */
  for (int d = 0; d < DIM; d++) n[d] += weight * (fit[d] - n[d]);
  normalise(n);
}
