/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Grains of thickness 1 under a Newtonian fluid in a channel of height 2 and
 * slope 0.43 rad, examples/bagnold_two_layers.lua, for four densities of the
 * fluid. With tau_0 the stress where they meet, rho = g = 1,
 *   tau = tau_0 + (1 - y) sin(slope),  p = rho_f cos(slope)
 *         + (1 - y) cos(slope),  du/dy = sqrt(p)/d I(tau/p)     for y < 1,
 *   tau = tau_0 + rho_f (1 - y) sin(slope),  du/dy = tau/eta_f  for y > 1,
 * where I inverts mu(I) and is 0 below mu_s [lagree_staron_popinet_2011,
 * eqs. 2.30-2.32]. u is 0 on both walls; tau_0 is that which makes it
 * continuous.
 *
 * Under the heaviest with a clipped viscosity too. */
#include <gsl/gsl_errno.h>
#include <gsl/gsl_odeiv2.h>
#include <gsl/gsl_roots.h>

#include "bagnold.h"

enum { FIRST = 4, N = 3, NRATIOS = 4 };
static const double kSlope = 0.43, kDiffusivity = 0.1;

struct layers {
  double ratio, tau_0;
};

/* Return I where the friction is mu, with the sign of mu. */
static double inertial(double mu) {
  const double excess = fmax(fabs(mu) - 0.38, 0);
  return copysign(0.3 * excess / (0.26 - excess), mu);
}

/* Return du/dy at y. */
static int shear(double y, const double u[], double dudy[], void *context) {
  (void)u;
  const struct layers *layers = (const struct layers *)context;
  const double ratio = layers->ratio, depth = 1 - y;
  if (depth < 0) {
    const double tau = layers->tau_0 + ratio * depth * sin(kSlope);
    dudy[0] = tau / (ratio * kDiffusivity);
  } else {
    const double tau = layers->tau_0 + depth * sin(kSlope);
    const double p = (ratio + depth) * cos(kSlope);
    dudy[0] = sqrt(p) / 0.04 * inertial(tau / p);
  }
  return GSL_SUCCESS;
}

/* Return u at y, from one of the walls 0 and 2 in whose layer y lies. */
static double velocity_from(double wall, double y,
                            const struct layers *layers) {
  double at = wall, u = 0;
  gsl_odeiv2_system system = {shear, NULL, 1, (void *)layers};
  gsl_odeiv2_driver *driver = gsl_odeiv2_driver_alloc_y_new(
      &system, gsl_odeiv2_step_rkf45, y > wall ? 1e-4 : -1e-4, 1e-11, 0);
  const int status = gsl_odeiv2_driver_apply(driver, &at, y, &u);
  gsl_odeiv2_driver_free(driver);
  return status == GSL_SUCCESS ? u : NAN;
}

static double jump(double tau_0, void *context) {
  const struct layers *layers = (const struct layers *)context;
  const struct layers trial = {layers->ratio, tau_0};
  return velocity_from(0, 1, &trial) - velocity_from(2, 1 + 1e-15, &trial);
}

/* Find tau_0, which lies between those of grains that stick to the fluid's wall
 * and of a fluid that rests on grains at rest. */
static struct layers layers_of(double ratio) {
  struct layers layers = {ratio, 0};
  gsl_function function = {jump, &layers};
  gsl_root_fsolver *solver = gsl_root_fsolver_alloc(gsl_root_fsolver_brent);
  const double rest = 0.5 * ratio * sin(kSlope);
  const double driven = bagnold_exact(kSlope, 1) * ratio * kDiffusivity;
  gsl_root_fsolver_set(solver, &function, rest - driven, rest);
  for (int k = 0; k < 100; k++) {
    gsl_root_fsolver_iterate(solver);
    if (gsl_root_test_interval(gsl_root_fsolver_x_lower(solver),
                               gsl_root_fsolver_x_upper(solver), 0,
                               1e-12) == GSL_SUCCESS) {
      break;
    }
  }
  layers.tau_0 = gsl_root_fsolver_root(solver);
  gsl_root_fsolver_free(solver);
  return layers;
}

static double exact(const struct layers *layers, double y) {
  return velocity_from(y < 1 ? 0 : 2, y, layers);
}

/* L2 of the error of u over the largest u, and max |v|. */
struct result {
  double l2, across;
};

static struct result measure(const struct layers *layers, int level,
                             const char *regularisation) {
  struct example example = example_new(
      "bagnold_two_layers",
      "trees=%d level=1 ratio=%g start=%d regularisation=%s", 1 << (level - 1),
      layers->ratio, layers->ratio < 0.05, regularisation);
  struct two_phase *sim = example.sim;
  const struct mesh *mesh = sim->grid.mesh;
  struct result result = {NAN, NAN};
  double *error = MEM_NEW(double, mesh->nleaves), most = 0;
  if (run_steady(sim, kBagnoldSettled, 2000)) {
    for (int32_t i = 0; i < mesh->nleaves; i++) {
      const double u = exact(layers, mesh->x[i][1]);
      error[i] = sim->u[0]->v[i] - u;
      most = larger(most, u);
    }
    result.l2 = norms_of(mesh, error).l2 / most;
    result.across = norms_of(mesh, sim->u[1]->v).most;
  }
  mem_free(error);
  example_destroy(&example);
  return result;
}

static void run_ratio(struct report *report, double ratio, double surface,
                      const char *regularisation) {
  const struct layers layers = layers_of(ratio);
  struct result result[N];
  double l2[N];
  char grid[32];
  snprintf(grid, sizeof grid, "density ratio %g %s", ratio, regularisation);
  /* the reference itself, to a unit of the last digit known: 2.022646,
   * 1.735545, 0.706258, 0.042511 by another quadrature */
  report_at_most(report, grid, "u(H) of the reference less digits known", 0,
                 fabs(exact(&layers, 1 - 1e-15) - surface), 1e-4);
  for (int k = 0; k < N; k++) {
    result[k] = measure(&layers, FIRST + k, regularisation);
    l2[k] = result[k].l2;
  }
  report_errors(report, grid, "L2 of u over max u", FIRST, N, l2, NULL, 1.8);
  report_at_most(report, grid, "L2 of u over max u against its bar",
                 FIRST + N - 1, l2[N - 1], 1e-2);
  for (int k = 0; k < N; k++) {
    report_at_most(report, grid, "max |v|", FIRST + k, result[k].across, 1e-10);
  }
}

static void run(struct report *report) {
  static const double ratio[NRATIOS] = {1e-3, 1e-2, 0.1, 0.4};
  static const double surface[NRATIOS] = {2.0227, 1.7355, 0.7063, 0.0425};
  for (int k = 0; k < NRATIOS; k++) {
    run_ratio(report, ratio[k], surface[k], "exact");
  }
  run_ratio(report, ratio[3], surface[3], "clip");
}

const struct convergence_case bagnold_two_layers_case = {
    "bagnold_two_layers", "Grains under a fluid on a slope", 2, true, run};
