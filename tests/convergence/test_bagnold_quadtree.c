/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A layer of grains, examples/bagnold.lua with cells that get coarser by two
 * levels from the plane to the surface, at a quarter and at half of the
 * thickness; this pattern refined three times.
 *
 * On 0.43 rad the grains flow as bagnold.h says. The order of the L2 norm
 * cannot reach 1.9 here: viscosity, and so shear rate, is exact on all faces,
 * on those between levels too (a row says so), and what is left is the
 * midpoint rule for u = integral of the shear rate, which at the surface goes
 * like sqrt(1 - y): h^2 sqrt(log(1/h)). On uniform grids the plain h^2 of the
 * lowest cell hides this, which the refined bed has not. Adding up the exact
 * shear rates of the faces gives the same errors within 1 %, and orders 1.74,
 * 1.79, 1.83 on the next levels.
 *
 * On 0.35 rad they creep, at a viscosity of eta_max, in a parabola. */
#include "bagnold.h"

enum { FIRST = 4, N = 4 }; /* finest cells: 2^level over the thickness */
static const double kFlowing = 0.43, kHeld = 0.35, kEtaMax = 1e4;

/* Largest relative error of the viscosity on faces along the flow:
 * tan(slope) p over the exact shear rate. */
static double viscosity_error(const struct simulation *sim) {
  const struct mesh *mesh = sim->mesh;
  double most = 0;
  for (int32_t f = mesh->face_begin[1]; f < mesh->face_begin[2]; f++) {
    const int32_t i = mesh->face_owner[f];
    const double half = mesh->face_node[f][0] == i ? 0.5 : -0.5;
    const double depth = 1 - mesh->x[i][1] - half * mesh->h[i];
    if (depth < 1e-9) continue; /* the surface: both are 0 */
    const double exact =
        sin(kFlowing) * depth /
        (bagnold_inertial(kFlowing) / 0.04 * sqrt(cos(kFlowing) * depth));
    most = fmax(most, fabs(sim->eta_f->v[f] - exact) / exact);
  }
  return most;
}

/* Error of u relative to the exact one of the surface. */
static double creep_error(const struct simulation *sim) {
  double *error = sim->frozen->v;
  for (int32_t i = 0; i < sim->mesh->nleaves; i++) {
    const double y = sim->mesh->x[i][1];
    const double scale = kEtaMax / sin(kHeld);
    error[i] = 2 * (scale * sim->u[0]->v[i] - (y - 0.5 * y * y));
  }
  return norms_of(sim->mesh, error).l2;
}

static struct example quadtree(int k, double slope) {
  return example_new("bagnold",
                     "trees=%d level=2 refined=2 start=2 slope=%g eta_max=%g",
                     1 << (FIRST + k - 2), slope, kEtaMax);
}

static void run_flowing(struct report *report) {
  static const char grid[] = "flowing";
  double l2[N], most[N], viscosity[N];
  for (int k = 0; k < N; k++) {
    struct example example = quadtree(k, kFlowing);
    const bool good = run_steady(example.sim, kBagnoldSettled, 1000);
    const struct norms norms = bagnold_norms(example.sim, kFlowing);
    l2[k] = good ? norms.l2 : NAN;
    most[k] = good ? norms.most : NAN;
    viscosity[k] = good ? viscosity_error(example.sim) : NAN;
    example_destroy(&example);
  }
  report_errors(report, grid, "L2 of u", FIRST, N, l2, NULL, 1.9);
  report_errors(report, grid, "max of u", FIRST, N, most, NULL, 0);
  for (int k = 0; k < N; k++) {
    report_at_most(report, grid, "relative error of face viscosity", FIRST + k,
                   viscosity[k], 1e-5);
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
  run_held(report);
}

const struct convergence_case bagnold_quadtree_case = {
    "bagnold_quadtree", "Grains on an inclined plane, refined to the bed", 2,
    false, run};
