/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The two-fluid model where one phase is alone, against the models of that
 * phase.
 *
 * Fluid: no grains, against the two-phase model on the same 64 leaves, with
 * steps of its own: the flow between two plates that a pressure sets going,
 * halfway to steady, and vortices of Taylor and Green that have lost a third.
 *
 * Grains: rho_f = 1e-6 rho_s and no drag, against the four-state model with the
 * same steps and the same pressure, without friction and kinetic parts,
 *   p = A (nu - nu_min)^10                                  (syamlal of ktgf)
 *   p = 2 K nu (nu - nu_min)^chi sin^2(pi (nu - nu_min)/2R) (p_ES)
 * with K and chi such that both have one value and one slope at nu = 0.59.
 * Grains that fill a box swing up and down, for 7/8 of a period. Without
 * gravity both models have the same scheme. */
#include <math.h>
#include <stdio.h>

#include "../mesh/four_state.h"
#include "../mesh/two_fluid.h"
#include "report.h"
#include "runs.h"

static const double kPi = 3.14159265358979323846;
static const double kHeight = 0.16; /* of the grains, m */

/* Return the norm of the difference of a [nleaves] and b over that of b. */
static double difference(const struct mesh *mesh, const double *a,
                         const double *b) {
  double sum[2] = {0, 0};
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    sum[0] += (a[i] - b[i]) * (a[i] - b[i]);
    sum[1] += b[i] * b[i];
  }
  return sqrt(mesh_sum(mesh, sum[0]) / mesh_sum(mesh, sum[1]));
}

/* Carry one fluid of density 1 by both models to a time; returns how far their
 * velocities along x are apart. Both have the box of `p`. */
static double fluids_apart(struct params p, double eta, double time) {
  double none[] = {-2, -1};
  struct two_fluid_keys keys = grains_keys(TWO_FLUID_KTGF, TWO_FLUID_OWN);
  keys.closure.param[TWO_FLUID_FLUID_DENSITY] = 1;
  keys.closure.param[TWO_FLUID_FLUID_ETA_0] = eta;
  p.grains.rheology = newtonian(eta);
  struct two_phase *alone = sim_start(&p);
  bool good = run_to(alone, time);
  p.own = &keys;
  p.grains.density = 2560;
  p.shape = (struct function){bed, none};
  struct two_fluid *sim = grains_new(&p);
  good = grains_run(sim, time, 100000) && good;
  const double apart =
      difference(sim->grid.mesh, sim->u[TWO_FLUID_F][0]->v, alone->u[0]->v);
  two_fluid_destroy(sim);
  two_phase_destroy(alone);
  return good ? apart : NAN;
}

static double rolling(void *context, const double x[3]) {
  const int d = *(const int *)context;
  return (d == 0 ? 1 : -1) * sin(2 * kPi * x[d]) * cos(2 * kPi * x[1 - d]);
}

static void report_fluid(struct report *report) {
  static int axis[] = {0, 1};
  enum { LEVEL = 6 };
  struct params vortices = periodic_params(LEVEL), plates = vortices;
  for (int d = 0; d < 2; d++)
    vortices.velocity[d] = (struct function){rolling, &axis[d]};
  plates.boundary[0].type = plates.boundary[1].type = BOUNDARY_OUTFLOW;
  plates.boundary[0].pressure = 1;
  plates.boundary[2].type = plates.boundary[3].type = BOUNDARY_NO_SLIP;
  report_at_most(report, "fluid alone", "between plates against two_phase",
                 LEVEL, fluids_apart(plates, 0.1, 0.7), 1e-2);
  report_at_most(report, "fluid alone", "vortices against two_phase", LEVEL,
                 fluids_apart(vortices, 0.01, 0.5), 1e-2);
}

static double swing(void *context, const double x[3]) {
  (void)context;
  return 0.01 * sin(kPi * x[1] / kHeight);
}

/* Describe grains that fill a column of 2 leaves by 64. */
static struct params grains_alone(struct params p) {
  p.trees[1] = 32;
  p.size = kHeight / p.trees[1];
  p.level_min = p.level_max = 1;
  p.boundary[0].type = p.boundary[1].type = BOUNDARY_PERIODIC;
  p.gravity[1] = 0;
  p.velocity[1] = (struct function){swing, NULL};
  p.dt_max = 1e-4;
  p.tolerance_pressure = p.tolerance_viscous = 1e-6;
  return p;
}

/* Advance both by the same steps; returns whether all went well. */
static bool step_both(struct two_fluid *sim, struct four_state *beads,
                      double time) {
  bool good = true;
  while (good && beads->model.time < time * (1 - 1e-12)) {
    good = four_state_step(beads, time - beads->model.time) == EXIT_DONE &&
           two_fluid_step(sim, beads->model.dt) == EXIT_DONE &&
           sim->model.dt == beads->model.dt;
  }
  return good;
}

static void report_grains(struct report *report) {
  static const double NU = 0.59, LOW = 0.57, RANGE = 0.42, A = 3e20;
  enum { LEVEL = 6 };
  const double x = NU - LOW, y = kPi * x / (2 * RANGE);
  const double p_0 = A * pow(x, 10), c = sqrt(10 * p_0 / x / 2560);
  const double chi = 10 - x / NU - 2 * y / tan(y);
  struct four_state_keys own = four_state_defaults();
  own.start = FOUR_STATE_UNIFORM, own.nu_start = NU;
  own.param[LEE_HUANG_RHO_D] = 2560, own.param[LEE_HUANG_D] = 1e-9;
  own.param[LEE_HUANG_NU_MIN] = LOW, own.param[LEE_HUANG_NU_0] = 0.65;
  own.param[LEE_HUANG_NU_MAX] = LOW + RANGE;
  own.param[LEE_HUANG_CHI] = chi, own.param[LEE_HUANG_ETA_S] = 0;
  own.param[LEE_HUANG_K] = p_0 / (2 * NU * pow(x, chi) * sin(y) * sin(y));
  const struct params p = grains_alone(beads_params(&own, 1));
  struct four_state *beads = beads_new(&p);

  struct two_fluid_keys keys = grains_keys(TWO_FLUID_KTGF, TWO_FLUID_OWN);
  keys.start = TWO_FLUID_PATCHED, keys.alpha_start = NU;
  grains_cap(&keys, 1);
  keys.closure.frictional_pressure = TWO_FLUID_SYAMLAL;
  double *v = keys.closure.param;
  v[TWO_FLUID_FLUID_DENSITY] = 2560e-6, v[TWO_FLUID_FLUID_ETA_0] = 1e-12;
  v[TWO_FLUID_DRAG_ERGUN_VISCOUS] = v[TWO_FLUID_DRAG_ERGUN_INERTIAL] = 0;
  v[TWO_FLUID_GRAINS_D] = 1e-9, v[TWO_FLUID_KT_ANGLE] = 0;
  v[TWO_FLUID_KT_SYAMLAL] = A, v[TWO_FLUID_KT_PHI_STAR] = LOW;
  v[TWO_FLUID_KT_PHI_MAX] = LOW + RANGE;
  const struct params q = grains_alone(grains_params(&keys, 1, 1));
  struct two_fluid *sim = grains_new(&q);
  const bool good = step_both(sim, beads, 7. / 8 * 2 * kHeight / c);
  const struct mesh *mesh = sim->grid.mesh;
  for (int32_t i = 0; i < mesh->nleaves; i++)
    sim->p_s->v[i] -= p_0, beads->p->v[i] -= p_0;
  report_at_most(
      report, "grains alone", "velocity against four_state", LEVEL,
      good ? difference(mesh, sim->u[TWO_FLUID_S][1]->v, beads->u[1]->v) : NAN,
      1e-3);
  report_at_most(report, "grains alone", "p - p_0 against four_state", LEVEL,
                 good ? difference(mesh, sim->p_s->v, beads->p->v) : NAN, 1e-3);
  four_state_destroy(beads);
  two_fluid_destroy(sim);
}

static void run(struct report *report) {
  report_fluid(report);
  report_grains(report);
}

const struct convergence_case two_fluid_limits_case = {
    .name = "two_fluid_limits",
    .title = "two fluids: one phase alone is what its own model has",
    .dimension = 2,
    .in_short = true,
    .run = run};
