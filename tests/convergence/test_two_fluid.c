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

#include <stdio.h>

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

/* Return the speed of grains of alpha that settle while the fluid rises, by
 * bisection of drag against weight, m/s. */
static double hindered(const struct two_fluid *sim, double alpha) {
  const double weight = g * (two_fluid_density(sim, TWO_FLUID_S) -
                             two_fluid_density(sim, TWO_FLUID_F));
  const double eta = two_fluid_viscosity(&sim->closure, 0);
  double low = 0, high = 10;
  for (int k = 0; k < 200; k++) {
    const double slip = 0.5 * (low + high);
    const double force =
        two_fluid_drag_per_phi(&sim->closure, alpha, slip, eta) * slip;
    if (force < (1 - alpha) * weight)
      low = slip;
    else
      high = slip;
  }
  return (1 - alpha) * low;
}

/* Grains of 1 mm in water settle in the middle of a column, far from both
 * ends. */
static void report_hindered(struct report *report) {
  static const double alpha[] = {0.01, 0.1, 0.2, 0.3, 0.4, 0.5};
  double worst = 0;
  for (int k = 0; k < 6; k++) {
    struct two_fluid_keys keys = grains_keys(TWO_FLUID_KTGF, TWO_FLUID_WATER);
    keys.start = TWO_FLUID_PATCHED, keys.alpha_start = alpha[k];
    struct params p = column(&keys, 0.2, 40);
    struct two_fluid *sim = grains_new(&p);
    const bool good = grains_run(sim, 0.3, 100000);
    const double speed = hindered(sim, alpha[k]);
    const struct mesh *mesh = sim->grid.mesh;
    for (int32_t i = 0; i < mesh->nleaves; i++) {
      if (fabs(mesh->x[i][1] - 0.1) > 0.01) continue;
      const double error = two_fluid_mean_velocity(sim, i, 1) / -speed - 1;
      worst = good ? fmax(worst, fabs(error)) : NAN;
    }
    worst = mesh_max(mesh, worst);
    two_fluid_destroy(sim);
  }
  report_at_most(report, "hindered", "settling speed, relative error", 5, worst,
                 1e-3);
}

/* Make a column of water through which U flows up, half full of grains. */
static struct two_fluid *fluidised(struct two_fluid_keys *keys,
                                   struct params *p, double *z, double U) {
  *keys = grains_keys(TWO_FLUID_KTGF, TWO_FLUID_WATER);
  *p = column(keys, 0.2, 48);
  p->shape = (struct function){bed, z};
  p->tolerance_pressure = p->tolerance_viscous = 1e-7;
  p->boundary[2].type = BOUNDARY_INFLOW, p->boundary[2].velocity[1] = U;
  p->boundary[3].type = BOUNDARY_OUTFLOW;
  return grains_new(p);
}

/* Packed bed: the pressure falls as Ergun says where grains rest. */
static void report_ergun(struct report *report) {
  double z[] = {-1, 0.1}, worst = 0;
  struct two_fluid_keys keys;
  struct params p;
  const double U = 5e-3;
  struct two_fluid *sim = fluidised(&keys, &p, z, U);
  const bool good = grains_run(sim, 10, 100000);
  const struct mesh *mesh = sim->grid.mesh;
  field_fill(mesh, sim->p), field_fill(mesh, sim->alpha);
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    const int32_t up = mesh->stencil[i][stencil_face(3)];
    if (mesh->x[i][1] > 0.08 || mesh->x[i][1] < 0.01) continue;
    const double alpha = 0.5 * (sim->alpha->v[i] + sim->alpha->v[up]);
    const double a = 1 - alpha, d = 1e-3, eta = 1.002e-3;
    const double exact = 150 * alpha * alpha * eta / (a * a * a * d * d) * U +
                         1.75 * alpha * 998 / (a * a * a * d) * U * U;
    const double slope = (sim->p->v[i] - sim->p->v[up]) / mesh->h[i];
    worst = good ? fmax(worst, fabs(slope / exact - 1)) : NAN;
  }
  worst = mesh_max(mesh, worst);
  report_at_most(report, "packed bed", "pressure drop, relative error", 5,
                 worst, 1e-3);
  two_fluid_destroy(sim);
}

/* Fluidised bed, without friction: the alpha whose drag carries it, in the
 * lower part while it is uniform. Waves grow upwards through the bed, and those
 * of 16 mm/s are at 5 cm after 6 s, at 3 cm after 7 s. */
static void report_expansion(struct report *report) {
  static const double U[] = {0.014, 0.016}, exact[] = {0.5411, 0.5198};
  static const double time[] = {10, 5};
  for (int k = 0; k < 2; k++) {
    double z[] = {-1, 0.1}, sum = 0, count = 0;
    char norm[64];
    struct two_fluid_keys keys;
    struct params p;
    struct two_fluid *sim = fluidised(&keys, &p, z, U[k]);
    sim->closure.param[TWO_FLUID_KT_ANGLE] = 0;
    const bool good = grains_run(sim, time[k], 100000);
    const struct mesh *mesh = sim->grid.mesh;
    for (int32_t i = 0; i < mesh->nleaves; i++) {
      if (mesh->x[i][1] > 0.04 || mesh->x[i][1] < 0.01) continue;
      sum += sim->alpha->v[i], count += 1;
    }
    const double alpha = mesh_sum(mesh, sum) / mesh_sum(mesh, count);
    snprintf(norm, sizeof norm, "solid fraction at %g mm/s, relative error",
             1e3 * U[k]);
    report_at_most(report, "fluidised", norm, 5,
                   good ? fabs(alpha / exact[k] - 1) : NAN, 5e-3);
    two_fluid_destroy(sim);
  }
}

/* Consolidation between a floor and a plate that holds the grains: with c_v =
 * alpha a^2 p_s'/K, T = c_v t/H^2 and W the weight of the grains, gravity that
 * sets in at T = 0 makes of a uniform p_0
 *   (p_s - p_0)/W = 1/2 - z/H - sum of 4/(n pi)^2 cos(n pi z/H) e^{-n^2 pi^2 T}
 * over odd n. */
static double consolidation(int n, double T) {
  const double H = 0.1, alpha = 0.59, low_g = 0.05, pi = acos(-1);
  struct two_fluid_keys keys = grains_keys(TWO_FLUID_KTGF, TWO_FLUID_WATER);
  keys.start = TWO_FLUID_PATCHED, keys.alpha_start = alpha;
  keys.closure.param[TWO_FLUID_GRAINS_D] = 1e-4;
  keys.closure.param[TWO_FLUID_KT_ANGLE] = 0;
  struct params p = column(&keys, H, n);
  p.gravity[1] = -low_g;
  p.tolerance_pressure = p.tolerance_viscous = 1e-9;
  const struct two_fluid_frozen with = {.phi_p = 0};
  double slope, worst = 0;
  struct two_fluid *sim;
  p.dt_max = 1e-3;
  sim = grains_new(&p);
  const double p_0 = two_fluid_pressure(&sim->closure, alpha, &with, &slope);
  const double K = two_fluid_drag(&sim->closure, alpha, 0, 1.002e-3);
  const double c_v = alpha * (1 - alpha) * (1 - alpha) * slope / K;
  const double weight = alpha * (2560 - 998) * low_g * H;
  p.dt_max = 0.5 / n * H * H / c_v;
  const bool good = grains_run(sim, T * H * H / c_v, 1000000);
  const struct mesh *mesh = sim->grid.mesh;
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    const double z = mesh->x[i][1] / H;
    double exact = 0.5 - z;
    for (int k = 1; k < 200; k += 2)
      exact -=
          4 / (k * k * pi * pi) * cos(k * pi * z) * exp(-k * k * pi * pi * T);
    const double p_s =
        two_fluid_pressure(&sim->closure, sim->alpha->v[i], &with, NULL);
    worst = fmax(worst, fabs((p_s - p_0) / weight - exact));
  }
  worst = good ? mesh_max(mesh, worst) : NAN;
  two_fluid_destroy(sim);
  return worst;
}

static void report_consolidation(struct report *report) {
  static const double bars[] = {INFINITY, 1.5e-2};
  const double error[] = {consolidation(50, 0.05), consolidation(100, 0.05)};
  report_errors(report, "consolidation", "p_s over the weight", 6, 2, error,
                bars, 0.9);
}

/* Fluid alone between two plates, driven by a pressure: u = G y (H - y)/(2
 * eta). */
static double poiseuille(int level) {
  const double H = 0.1, drop = 1e-3, eta = 1.002e-3;
  double z[] = {-2, -1}, worst = 0;
  struct two_fluid_keys keys = grains_keys(TWO_FLUID_KTGF, TWO_FLUID_WATER);
  struct params p = grains_params(&keys, H, level);
  p.shape = (struct function){bed, z};
  p.gravity[1] = 0;
  p.cfl = 1, p.dt_max = 1;
  p.tolerance_pressure = p.tolerance_viscous = 1e-9;
  p.boundary[0].type = p.boundary[1].type = BOUNDARY_OUTFLOW;
  p.boundary[0].pressure = drop;
  p.boundary[3].type = BOUNDARY_NO_SLIP;
  struct two_fluid *sim = grains_new(&p);
  const bool good = grains_run(sim, 8000, 100000);
  const struct mesh *mesh = sim->grid.mesh;
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    const double y = mesh->x[i][1];
    const double exact = drop / H * y * (H - y) / (2 * eta);
    worst = fmax(worst, fabs(sim->u[TWO_FLUID_F][0]->v[i] - exact));
  }
  worst = good ? mesh_max(mesh, worst) / (drop * H / (8 * eta)) : NAN;
  two_fluid_destroy(sim);
  return worst;
}

static double vortex_x(void *context, const double x[3]) {
  (void)context;
  return sin(2 * acos(-1) * x[0]) * cos(2 * acos(-1) * x[1]);
}
static double vortex_y(void *context, const double x[3]) {
  (void)context;
  return -cos(2 * acos(-1) * x[0]) * sin(2 * acos(-1) * x[1]);
}

/* Fluid alone in vortices of Taylor and Green until they have lost a third; dt
 * falls as h^2. Returns the mean error of u. */
static double taylor_green(int level) {
  const double eta = 0.01, time = 0.5, pi = acos(-1);
  double z[] = {-2, -1}, sum = 0;
  struct two_fluid_keys keys = grains_keys(TWO_FLUID_KTGF, TWO_FLUID_OWN);
  keys.closure.param[TWO_FLUID_FLUID_DENSITY] = 1;
  keys.closure.param[TWO_FLUID_FLUID_ETA_0] = eta;
  struct params p = grains_params(&keys, 1, level);
  p.shape = (struct function){bed, z};
  p.gravity[1] = 0;
  p.dt_max = 0.2 / exp2(2 * level - 4);
  p.tolerance_pressure = p.tolerance_viscous = 1e-8;
  for (int side = 0; side < 4; side++)
    p.boundary[side].type = BOUNDARY_PERIODIC;
  p.velocity[0] = (struct function){vortex_x, NULL};
  p.velocity[1] = (struct function){vortex_y, NULL};
  struct two_fluid *sim = grains_new(&p);
  const bool good = grains_run(sim, time, 100000);
  const double left = exp(-8 * pi * pi * eta * time);
  const struct mesh *mesh = sim->grid.mesh;
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    double x[3] = {mesh->x[i][0], mesh->x[i][1], 0};
    const double error =
        sim->u[TWO_FLUID_F][0]->v[i] - left * vortex_x(NULL, x);
    sum += error * error * mesh_volume(mesh, i);
  }
  sum = good ? sqrt(mesh_sum(mesh, sum)) : NAN;
  two_fluid_destroy(sim);
  return sum;
}

static void report_fluid(struct report *report) {
  double plates[3], vortices[3];
  for (int k = 0; k < 3; k++) {
    plates[k] = poiseuille(3 + k);
    vortices[k] = taylor_green(4 + k);
  }
  report_errors(report, "fluid alone", "Poiseuille, max of u", 3, 3, plates,
                NULL, 1.9);
  report_errors(report, "fluid alone", "Taylor and Green, L2 of u", 4, 3,
                vortices, NULL, 1.9);
}

static void run(struct report *report) {
  report_bed(report, TWO_FLUID_WATER, "water", 1e-8);
  report_bed(report, TWO_FLUID_AIR, "air", 1e-8);
  report_kynch(report);
  report_hindered(report);
  report_ergun(report);
  report_expansion(report);
  report_consolidation(report);
  report_fluid(report);
}

const struct convergence_case two_fluid_case = {
    .name = "two_fluid",
    .title = "grains in a fluid: bed at rest, settling of Kynch",
    .dimension = 2,
    .in_short = false,
    .run = run};
