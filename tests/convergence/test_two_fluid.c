/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The two-fluid model against exact solutions in columns.
 *
 * Rest: a bed 0.3 m high, in balance at the start, in water and in air, after
 * ten seconds. Its solid fraction is that of dp_s/dz = -(rho_s - rho_f) alpha g
 * in the middle of each leaf, integrated here.
 *
 * Kynch: grains settle from alpha_0 = 0.1 with the drag of Stokes' limit, where
 * one grain alone sinks at w_0 and many at w_0 (1 - alpha)^4.65 [kynch_1952,
 * richardson_zaki_1954]. The clear fluid above ends at H - t w; the bed below
 * at the height where the volume of grains is right, its own solid fraction
 * that of the balance of its weight. */
#include "../mesh/two_fluid.h"

#include "report.h"

static const double g = 9.81;

/* Return the params of a column `height` m high of 2 cells by n, with walls at
 * its ends. */
static struct params column(struct two_fluid_keys *keys, double height, int n) {
  struct params p = grains_params(keys, 2 * height / n, 1);
  p.trees[1] = n / 2;
  p.boundary[0].type = p.boundary[1].type = BOUNDARY_PERIODIC;
  return p;
}

/* Return the solid fraction at a depth, m, by the trapezoidal rule. */
static double settled(const struct two_fluid *sim, double depth) {
  enum { N = 20000 };
  const double weight = g *
                        (two_fluid_density(sim, TWO_FLUID_S) -
                         two_fluid_density(sim, TWO_FLUID_F)) *
                        depth / N;
  double p = 0;
  for (int k = 0; k < N; k++) {
    const double half =
        p + 0.5 * weight * two_fluid_settled(&sim->closure, p, 0);
    p += weight * two_fluid_settled(&sim->closure, half, 0);
  }
  return two_fluid_settled(&sim->closure, p, 0);
}

static void report_bed(struct report *report, enum two_fluid_fluid fluid,
                       const char *name, double bar) {
  double z[] = {-1, 0.3}, worst = 0;
  struct two_fluid_keys keys = grains_keys(TWO_FLUID_KTGF, fluid);
  struct params p = column(&keys, 0.36, 60);
  p.shape = (struct function){bed, z};
  p.tolerance_pressure = p.tolerance_viscous = 1e-8;
  struct two_fluid *sim = grains_new(&p);
  const bool good = grains_run(sim, 10, 100000);
  const struct mesh *mesh = sim->grid.mesh;
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    const double depth = 0.3 - mesh->x[i][1];
    const double exact = depth > 0 ? settled(sim, depth) : 0;
    worst = fmax(worst, fabs(sim->alpha->v[i] - exact));
  }
  worst = mesh_max(mesh, worst);
  report_at_most(report, name, "error of the solid fraction", 6,
                 good ? worst : NAN, 2e-3);
  report_at_most(report, name, "solid flux after 10 s, m/s", 6,
                 good ? grains_flux(sim) : NAN, bar);
  two_fluid_destroy(sim);
}

/* Return the volume of grains per area below a height z, m. */
static double volume_below(const struct two_fluid *sim, double z) {
  const struct mesh *mesh = sim->grid.mesh;
  double sum = 0;
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    const double low = mesh->x[i][1] - 0.5 * mesh->h[i];
    const double part = fmin(fmax((z - low) / mesh->h[i], 0), 1);
    sum += part * sim->alpha->v[i] * mesh->h[i];
  }
  return mesh_sum(mesh, sum) / 2; /* two columns */
}

/* Return the height at which the solid fraction falls below `alpha`, going up
 * from the floor, m. */
static double height_of(const struct two_fluid *sim, double alpha) {
  const struct mesh *mesh = sim->grid.mesh;
  double top = 0, here = 0, there = 0, h = 0;
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    if (sim->alpha->v[i] < alpha || mesh->x[i][1] < top) continue;
    top = mesh->x[i][1], here = sim->alpha->v[i], h = mesh->h[i];
    there = sim->alpha->v[mesh->stencil[i][stencil_face(3)]];
  }
  return top + h * (here - alpha) / (here - there);
}

/* Return the height of a bed under a suspension of alpha_0 that ends at `top`,
 * such that both hold alpha_0 H. */
static double exact_bed(const struct two_fluid *sim, double alpha_0, double H,
                        double top) {
  enum { N = 400 };
  const double dz = 0.2 * H / N;
  double bed_volume = 0, depth = 0;
  while (bed_volume + alpha_0 * (top - depth) < alpha_0 * H) {
    bed_volume += dz * settled(sim, depth + 0.5 * dz);
    depth += dz;
  }
  return depth;
}

/* Holds the errors of one run. */
struct kynch {
  double top, bed, mass;
};

static struct kynch kynch(int n) {
  const double H = 0.1, d = 1e-3, eta = 0.03, alpha_0 = 0.1, part = 0.5;
  struct two_fluid_keys keys = grains_keys(TWO_FLUID_KTGF, TWO_FLUID_OWN);
  keys.closure.param[TWO_FLUID_FLUID_DENSITY] = 1000;
  keys.closure.param[TWO_FLUID_FLUID_ETA_0] = eta;
  keys.closure.param[TWO_FLUID_DRAG_WEN_YU_FACTOR] = 0;
  keys.closure.param[TWO_FLUID_DRAG_WEN_YU_LEAST] = 0;
  keys.closure.drag = TWO_FLUID_WEN_YU;
  keys.start = TWO_FLUID_PATCHED, keys.alpha_start = alpha_0;
  struct params p = column(&keys, H, n);
  const double w_0 = (2560 - 1000) * g * d * d / (18 * eta);
  struct two_fluid *sim = grains_new(&p);
  const bool good = grains_run(sim, part * H / w_0, 100000);
  /* the clear fluid: the height at which what is below would fill alpha_0 */
  const double middle = 0.4 * H, top = H - part * H * pow(1 - alpha_0, 4.65);
  const double above = volume_below(sim, 2 * H) - volume_below(sim, middle);
  const struct kynch error = {
      .top = good ? fabs(middle + above / alpha_0 - top) / H : NAN,
      .bed = fabs(height_of(sim, 0.35) - exact_bed(sim, alpha_0, H, top)) / H,
      .mass = fabs(volume_below(sim, 2 * H) / (alpha_0 * H) - 1)};
  two_fluid_destroy(sim);
  return error;
}

static void report_kynch(struct report *report) {
  static const double bars[] = {INFINITY, 5e-3};
  double top = 0, bed_error[2], mass = 0;
  for (int k = 0; k < 2; k++) {
    const struct kynch error = kynch(50 << k);
    top = fmax(top, error.top), mass = fmax(mass, error.mass);
    bed_error[k] = error.bed;
  }
  report_at_most(report, "kynch", "upper front over H", 7, top, 5e-3);
  report_errors(report, "kynch", "lower front over H", 6, 2, bed_error, bars,
                0);
  report_at_most(report, "kynch", "change of mass", 7, mass, 1e-12);
}

static void run(struct report *report) {
  report_bed(report, TWO_FLUID_WATER, "water", 1e-8);
  report_bed(report, TWO_FLUID_AIR, "air", 1e-8);
  report_kynch(report);
}

const struct convergence_case two_fluid_case = {
    .name = "two_fluid",
    .title = "grains in a fluid: bed at rest, settling of Kynch",
    .dimension = 2,
    .in_short = false,
    .run = run};
