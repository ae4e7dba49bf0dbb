/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The two-fluid model in steady shear.
 *
 * Plates: grains of ktgf without a fluid between plates that move. The
 * velocity is linear, and Theta, p_s and tau are those of the kinetic theory.
 *
 * Suspension: grains of rauter without p_c in a viscous fluid between such
 * plates. With J = eta_f gamma/p_s the solid fraction is phi_m/(1 + sqrt(J))
 * and the stress of both phases (mu(J) + J + 2.5 phi_m sqrt(J)) p_s
 * [boyer_2011].
 *
 * Incline: such a layer of thickness H on a slope, under fluid that does not
 * slip past it. The stress of both is tan(slope) p_s in all of it, so that
 *   u = J phi (rho_s - rho_f) g cos(slope) (H z - z^2/2)/eta_f. */
#include "../mesh/grid.h"
#include "../mesh/two_fluid.h"

#include <stdio.h>

#include "report.h"
#include "talus/two_fluid/properties.h"

/* Return a column of 2 cells by n, `height` m high, along x without an end. */
static struct params column(struct two_fluid_keys *keys, double height, int n) {
  struct params p = grains_params(keys, 2 * height / n, 1);
  p.trees[1] = n / 2;
  p.boundary[0].type = p.boundary[1].type = BOUNDARY_PERIODIC;
  p.tolerance_pressure = p.tolerance_viscous = 1e-9;
  keys->start = TWO_FLUID_PATCHED;
  return p;
}

static double line(void *context, const double x[3]) {
  const double *of = context; /* gamma, height */
  return of[0] * (x[1] - 0.5 * of[1]);
}

/* Likewise of one between plates that move against each other, with a shear
 * rate gamma. */
static struct params plates(struct two_fluid_keys *keys, int n, double of[2]) {
  const double gamma = of[0], height = of[1];
  struct params p = column(keys, height, n);
  p.velocity[0] = (struct function){line, of};
  p.gravity[1] = 0;
  for (int side = 2; side < 4; side++) {
    p.boundary[side].type = BOUNDARY_NO_SLIP;
    p.boundary[side].velocity[0] = (side == 2 ? -0.5 : 0.5) * gamma * height;
  }
  grains_cap(keys, 1e6);
  return p;
}

/* Return the largest part by which u_x of the grains is off gamma (y - H/2). */
static double off_line(const struct two_fluid *sim, double height,
                       double gamma) {
  const struct mesh *mesh = sim->grid.mesh;
  double worst = 0;
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    const double exact = gamma * (mesh->x[i][1] - 0.5 * height);
    worst = larger(worst, fabs(sim->u[TWO_FLUID_S][0]->v[i] - exact));
  }
  return mesh_max(mesh, worst) / (0.5 * gamma * height);
}

/* Return the largest part by which eta gamma of faces between leaves is off. */
static double off_stress(const struct two_fluid *sim, bool both, double exact) {
  const struct mesh *mesh = sim->grid.mesh;
  double worst = 0;
  for (int32_t f = mesh->face_begin[1]; f < mesh->face_begin[2]; f++) {
    if (two_fluid_is_side(sim, f)) continue;
    double tau = 0;
    for (int k = 0; k < (both ? 2 : 1); k++)
      tau += sim->eta_f[k]->v[f] * sim->shear_f[k]->v[f];
    worst = larger(worst, fabs(tau / exact - 1));
  }
  return mesh_max(mesh, worst);
}

static double off_value(const struct two_fluid *sim, const struct field *q,
                        double exact) {
  const struct mesh *mesh = sim->grid.mesh;
  double worst = 0;
  for (int32_t i = 0; i < mesh->nleaves; i++)
    worst = larger(worst, fabs(q->v[i] / exact - 1));
  return mesh_max(mesh, worst);
}

/* alpha, Theta/(d gamma)^2, p/(rho_s d^2 gamma^2) and tau/p of the kinetic
 * theory, by an independent program. */
static const double KINETIC[][4] = {
    {0.3, 1.0492, 1.9525, 0.2908},
    {0.4, 0.93119, 4.4018, 0.2990},
};

static void report_plates(struct report *report, const double *row) {
  const double H = 0.064, gamma = 20, d = 1e-3, rho = 2560;
  double of[] = {gamma, H};
  const double p = row[2] * rho * d * d * gamma * gamma;
  char name[64];
  struct two_fluid_keys keys = grains_keys(TWO_FLUID_KTGF, TWO_FLUID_OWN);
  keys.closure.param[TWO_FLUID_FLUID_DENSITY] = 1e-4;
  keys.closure.param[TWO_FLUID_FLUID_ETA_0] = 1e-10;
  keys.alpha_start = row[0];
  struct params params = plates(&keys, 32, of);
  params.dt_max = 0.02;
  struct two_fluid *sim = grains_new(&params);
  const bool good = grains_run(sim, 0.2, 100000);
  two_fluid_properties(sim);
  two_fluid_viscosities(sim);
  snprintf(name, sizeof name, "plates, ktgf at %g", row[0]);
  report_at_most(report, name, "u on its line", 5,
                 good ? off_line(sim, H, gamma) : NAN, 5e-3);
  report_at_most(report, name, "Theta", 5,
                 off_value(sim, sim->Theta, row[1] * pow(d * gamma, 2)), 5e-3);
  report_at_most(report, name, "p_s", 5, off_value(sim, sim->p_s, p), 5e-3);
  report_at_most(report, name, "tau", 5, off_stress(sim, false, row[3] * p),
                 5e-3);
  two_fluid_destroy(sim);
}

/* Set the constants of [boyer_2011], without p_c. */
static void set_boyer(struct two_fluid_keys *keys, double eta) {
  double *number = keys->closure.param;
  number[TWO_FLUID_RA_MU_1] = 0.32, number[TWO_FLUID_RA_MU_2] = 0.7;
  number[TWO_FLUID_RA_J_0] = 0.005, number[TWO_FLUID_RA_INERTIAL] = 0;
  number[TWO_FLUID_RA_PHI_M] = 0.585, number[TWO_FLUID_RA_STIFFNESS] = 1e-9;
  number[TWO_FLUID_GRAINS_D] = 1.6e-4, number[TWO_FLUID_FLUID_DENSITY] = 1041;
  number[TWO_FLUID_FLUID_ETA_0] = eta;
}

/* Return the stress of both phases over p_s. */
static double boyer(double J) {
  return 0.32 + 0.38 / (1 + 0.005 / J) + J + 2.5 * 0.585 * sqrt(J);
}

static void report_suspension(struct report *report, double J) {
  const double H = 5e-3, gamma = 2, eta = 0.096, p_s = eta * gamma / J;
  double of[] = {gamma, H};
  char name[64];
  struct two_fluid_keys keys = grains_keys(TWO_FLUID_RAUTER, TWO_FLUID_OWN);
  set_boyer(&keys, eta);
  keys.alpha_start = 0.585 / (1 + sqrt(J));
  struct params params = plates(&keys, 32, of);
  params.grains.density = 2500;
  params.dt_max = 1e-2;
  struct two_fluid *sim = grains_new(&params);
  const bool good = grains_run(sim, 1, 100000);
  two_fluid_properties(sim);
  two_fluid_viscosities(sim);
  snprintf(name, sizeof name, "suspension, J = %g", J);
  report_at_most(report, name, "u on its line", 5,
                 good ? off_line(sim, H, gamma) : NAN, 5e-3);
  report_at_most(report, name, "p_s", 5, off_value(sim, sim->p_s, p_s), 5e-3);
  report_at_most(report, name, "tau of both", 5,
                 off_stress(sim, true, boyer(J) * p_s), 5e-3);
  two_fluid_destroy(sim);
}

/* Return the error of u at 25 degrees over that of the surface. With tolerances
 * of 1e-6 what solves leave lets alpha seep, and u is off by 0.1 % on any grid.
 */
static double incline(int n) {
  const double H = 4.9e-3, g = 9.81, eta = 0.096, pi = acos(-1);
  const double slope = 25 * pi / 180, J = 0.0015073;
  const double phi = 0.585 / (1 + sqrt(J));
  struct two_fluid_keys keys = grains_keys(TWO_FLUID_RAUTER, TWO_FLUID_OWN);
  set_boyer(&keys, eta);
  keys.closure.param[TWO_FLUID_GRAINS_D] = 5e-4;
  keys.alpha_start = phi;
  struct params p = column(&keys, H, n);
  p.grains.density = 2500;
  p.tolerance_pressure = p.tolerance_viscous = 1e-9;
  p.gravity[0] = g * sin(slope), p.gravity[1] = -g * cos(slope);
  struct two_fluid *sim = grains_new(&p);
  const bool good = grains_run(sim, 60, 100000);
  const struct mesh *mesh = sim->grid.mesh;
  const double scale = J * phi * (2500 - 1041) * g * cos(slope) / eta;
  double sum = 0;
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    const double z = mesh->x[i][1];
    const double error =
        sim->u[TWO_FLUID_S][0]->v[i] / scale - (H * z - 0.5 * z * z);
    sum += error * error * mesh_volume(mesh, i);
  }
  const double volume = 2 * H * H / n;
  sum = good ? sqrt(mesh_sum(mesh, sum) / volume) / (0.5 * H * H) : NAN;
  two_fluid_destroy(sim);
  return sum;
}

/* Report it. After 10 s 32 leaves are still 0.05 % off by what seeps; where the
 * top leaf leaned by all of g on the one below, errors were 0.65, 0.33, 0.17 %
 * on 16, 32, 64. */
static void report_incline(struct report *report) {
  static const double bars[] = {INFINITY, INFINITY, 1e-2};
  double error[3];
  for (int k = 0; k < 3; k++) error[k] = incline(8 << k);
  report_errors(report, "incline", "L2 of u", 3, 3, error, bars, 1.2);
}

static void run(struct report *report) {
  for (int k = 0; k < 2; k++) report_plates(report, KINETIC[k]);
  report_suspension(report, 1e-3);
  report_suspension(report, 0.1);
  report_incline(report);
}

const struct convergence_case two_fluid_shear_case = {
    .name = "two_fluid_shear",
    .title = "two fluids in steady shear: kinetic theory, J, a slope",
    .dimension = 2,
    .in_short = false,
    .run = run};
