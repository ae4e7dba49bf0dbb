/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A layer of grains, examples/bagnold.lua with cells that get coarser by two
 * levels from the plane to the surface, at a quarter and at half of the
 * thickness; this pattern refined three times.
 *
 * On 0.43 rad the grains flow as bagnold.h says. Viscosity, and so shear rate,
 * is exact on all faces, on those between levels too (a row says so). With
 * G = I/d sqrt(cos(slope)), s = 1 - y the depth, and so the shear rate
 * g = G sqrt(s), u is then g added up by the midpoint rule,
 *   u_(i+1) - u_i = h g(face) = integral of g - h^3 g''/24,
 * so that its error is
 *   e = h^2 (A - g'/24) = h^2 (A + G / (48 sqrt(s))),
 * A from the half cell at the plane (-g'(0)/8 + g'(0)/24) and, of either sign,
 * from the jumps of level. Down to the top cell, s = h/2, this adds up to
 *   L2^2 = h^4 (B + (G/48)^2 ln(1/h)),
 * and not to h^4: the order of L2 is 2 - log2(1 + 1/(l + C))/2 on level l, and
 * comes to 1.9 on level 14 only. On uniform grids a large A hides this, which
 * the refined bed has not. So the bars are these sums themselves, as
 * midpoint_errors makes them on the same cells, to 0.2 %, and order 2 in the
 * norm without the logarithm, integral of s e^2 dy = h^4 (B' + O(h)).
 *
 * On 0.35 rad they creep, at a viscosity of eta_max, in a parabola. */
#include "bagnold.h"

enum { FIRST = 4, N = 4 }; /* finest cells: 2^level over the thickness */
static const double kFlowing = 0.43, kHeld = 0.35, kEtaMax = 1e4;

/* Return the largest relative error of the viscosity on faces along the flow:
 * tan(slope) p over the exact shear rate. */
static double viscosity_error(const struct two_phase *sim) {
  const struct mesh *mesh = sim->grid.mesh;
  double most = 0;
  for (int32_t f = mesh->face_begin[1]; f < mesh->face_begin[2]; f++) {
    const int32_t i = mesh->face_owner[f];
    const double half = mesh->face_node[f][0] == i ? 0.5 : -0.5;
    const double depth = 1 - mesh->x[i][1] - half * mesh->h[i];
    if (depth < 1e-9) continue; /* the surface: both are 0 */
    const double exact =
        sin(kFlowing) * depth / bagnold_rate(kFlowing, 1 - depth);
    most = larger(most, fabs(sim->eta_f->v[f] - exact) / exact);
  }
  return most;
}

/* Return the error of u relative to the exact one of the surface. */
static double creep_error(const struct two_phase *sim) {
  double *error = MEM_NEW(double, sim->grid.mesh->nleaves);
  for (int32_t i = 0; i < sim->grid.mesh->nleaves; i++) {
    const double y = sim->grid.mesh->x[i][1];
    const double scale = kEtaMax / sin(kHeld);
    error[i] = 2 * (scale * sim->u[0]->v[i] - (y - 0.5 * y * y));
  }
  const double l2 = norms_of(sim->grid.mesh, error).l2;
  mem_free(error);
  return l2;
}

/* Return the root of the integral of s e^2, e the error of u. */
static double deep_norm(const struct two_phase *sim) {
  const struct mesh *mesh = sim->grid.mesh;
  double *e = bagnold_errors(sim, kFlowing);
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    e[i] *= sqrt(1 - mesh->x[i][1]);
  }
  const double l2 = norms_of(mesh, e).l2;
  mem_free(e);
  return l2;
}

/* Norms of the error that exact shear rates on faces leave, with finest cells
 * of 2^-level. A face between levels lies midway between the fine cell and the
 * virtual child of the coarse one, whose speed is
 *   u - (u_above - u_below)/8,  u_below the mean of the two fine cells. */
static struct midpoint { double l2, deep; } midpoint_errors(int level) {
  const double finest = ldexp(1, -level);
  double y = 0, before = 0, u[2] = {0}; /* of the cells below, nearest first */
  double sum[2] = {0};
  while (y < 1 - 0.5 * finest) {
    const double h = finest * exp2(fmin(2, floor(4 * y + 1e-9)));
    const double rate = bagnold_rate(kFlowing, y);
    double here = u[0] + h * rate;
    if (before == 0) here = 0.5 * h * rate;
    if (before > 0 && before < h) {
      const double child = u[0] + before * rate;
      const double above = h * bagnold_rate(kFlowing, y + h);
      here = (8 * child + above - 0.5 * (u[0] + u[1])) / 7;
    }
    const double e = here - bagnold_exact(kFlowing, y + 0.5 * h);
    sum[0] += h * e * e;
    sum[1] += h * e * e * (1 - y - 0.5 * h);
    u[1] = u[0], u[0] = here;
    y += h, before = h;
  }
  return (struct midpoint){sqrt(sum[0]), sqrt(sum[1])};
}

static struct example quadtree(int k, double slope) {
  return example_new("bagnold",
                     "trees=%d level=2 refined=2 start=2 slope=%g "
                     "regularisation=clip eta_max=%g",
                     1 << (FIRST + k - 2), slope, kEtaMax);
}

static void run_flowing(struct report *report) {
  static const char grid[] = "flowing";
  double l2[N], deep[N], most[N], viscosity[N];
  for (int k = 0; k < N; k++) {
    struct example example = quadtree(k, kFlowing);
    const bool good = run_steady(example.sim, kBagnoldSettled, 1000);
    const struct norms norms = bagnold_norms(example.sim, kFlowing);
    l2[k] = good ? norms.l2 : NAN;
    deep[k] = good ? deep_norm(example.sim) : NAN;
    most[k] = good ? norms.most : NAN;
    viscosity[k] = good ? viscosity_error(example.sim) : NAN;
    example_destroy(&example);
  }
  report_errors(report, grid, "L2 of u", FIRST, N, l2, NULL, 0);
  for (int k = 0; k < N; k++) {
    report_at_most(report, grid, "L2 of u off the midpoint rule's", FIRST + k,
                   fabs(l2[k] / midpoint_errors(FIRST + k).l2 - 1), 2e-3);
  }
  report_errors(report, grid, "L2 of u weighted by depth", FIRST, N, deep, NULL,
                1.9);
  report_errors(report, grid, "max of u", FIRST, N, most, NULL, 0);
  for (int k = 0; k < N; k++) {
    report_at_most(report, grid, "relative error of face viscosity", FIRST + k,
                   viscosity[k], 1e-5);
  }
}

/* Report the formulas above on levels no run reaches. */
static void report_theory(struct report *report) {
  static const char grid[] = "midpoint rule";
  enum { FINEST = 14 };
  for (int level = FIRST + N - 1; level <= FINEST; level++) {
    const struct midpoint at = midpoint_errors(level),
                          coarser = midpoint_errors(level - 1);
    const double order = log2(coarser.l2 / at.l2);
    const char *norm = "order of L2 of u";
    if (level < FINEST) report_value(report, grid, norm, level, order);
    if (level == FINEST) report_at_least(report, grid, norm, level, order, 1.9);
    report_at_least(report, grid, "order of L2 weighted by depth", level,
                    log2(coarser.deep / at.deep), 1.99);
  }
}

static void run_held(struct report *report) {
  double l2[N];
  for (int k = 0; k < N; k++) {
    struct example example = quadtree(k, kHeld);
    const bool good = run_steady(example.sim, kBagnoldSteady / kEtaMax, 1000);
    l2[k] = good ? creep_error(example.sim) : NAN;
    example_destroy(&example);
  }
  report_errors(report, "held", "L2 of u", FIRST, N, l2, NULL, 1.9);
}

static void run(struct report *report) {
  run_flowing(report);
  report_theory(report);
  run_held(report);
}

const struct convergence_case bagnold_quadtree_case = {
    "bagnold_quadtree", "Grains on an inclined plane, refined to the bed", 2,
    false, run};
