/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Fluctuating grains of the four-state model that flow down an incline, under a
 * lid on which they slip, far from rest: the kinetic part of the closures.
 *
 * A steady flow along x that varies with z has
 *   dp/dz = -rho_d nu g cos(theta),  dtau/dz = -rho_d nu g sin(theta),
 *   dq/dz = mu_K u'^2 - B T^(3/2),   tau = mu_K u',
 *   q = -kappa T' + delta nu',       p = P(nu, T),
 * with q = 0 on floor and lid, u = 0 on the floor, tau = 0 on the lid. With m
 * the mass above, p = p_H + g cos(theta) m and tau = g sin(theta) m, and as
 *   p' = P_nu nu' + P_T T',
 * this is a system of first order for m, T, q that is integrated downwards from
 * a pressure and a temperature on the lid, which are such that there is no flux
 * of heat through the floor and all grains have been met. p_E is 0 all the way.
 *
 * The run begins with that flow, seen by one who moves along at 4 m/s so that
 * steps are longer, and ends when what the scheme makes of it is steady. Leaves
 * of 1/32, 1/64, 1/128 of the depth, which is 8 grains; errors in the L2 norm
 * over the largest value. */
#include "../mesh/four_state.h"

#include "report.h"
#include "talus/four_state_closure.h"
#include "talus/memory.h"

enum { STEPS = 4096, FIRST = 5, N = 3 };
static const double kDepth = 0.16, kGrain = 0.02, kMean = 0.25, kAngle = 35,
                    kG = 9.81, kFrame = 4, kTime = 0.8;

/* The flow at STEPS + 1 depths below the lid. */
struct incline {
  const struct four_state_closure *c;
  double m[STEPS + 1], T[STEPS + 1], q[STEPS + 1], nu[STEPS + 1],
      shear[STEPS + 1], u[STEPS + 1];
};

/* Set rate to d(m, T, q)/ds at the depth s where these are y; returns nu, and
 * the shear rate in *shear. */
static double rates(const struct four_state_closure *c, double p_H,
                    const double y[3], double rate[3], double *shear) {
  const double rho = c->param[LEE_HUANG_RHO_D], d = c->param[LEE_HUANG_D];
  const double pull = kG * cos(kAngle * acos(-1) / 180);
  const double along = kG * sin(kAngle * acos(-1) / 180);
  const double T = fmax(y[1], 1e-12), s = sqrt(T), p = p_H + pull * y[0];
  double P_nu;
  const double nu = four_state_solid_fraction(c, p, T, 0, 0.45);
  four_state_pressure(c, nu, T, &P_nu);
  const double P_T = four_state_pressure(c, nu, T, NULL) / T; /* p_ES = 0 */
  const struct four_state_numbers k = four_state_numbers(c, nu);
  const double kappa = rho * d * s * k.kappa;
  const double delta = rho * d * s * T * k.delta;
  const double mu = rho * d * s * k.mu;
  *shear = along * y[0] / mu;
  const double lost =
      9 * (1 - c->param[LEE_HUANG_E_EFF]) * k.lambda * rho / d * s * T;
  /* along z, against s */
  const double slope =
      (-delta * rho * nu * pull / P_nu - y[2]) / (kappa + delta * P_T / P_nu);
  rate[0] = rho * nu;
  rate[1] = -slope;
  rate[2] = -(mu * *shear * *shear - lost);
  return nu;
}

/* Integrate from the lid by the classical method of Runge and Kutta; sets how
 * much heat the floor takes and how much mass is missing. */
static void integrate(struct incline *flow, double p_H, double T_H,
                      double missing[2]) {
  const double ds = kDepth / STEPS;
  double y[3] = {0, T_H, 0};
  for (int k = 0;; k++) {
    double rate[4][3], at[3];
    flow->nu[k] = rates(flow->c, p_H, y, rate[0], &flow->shear[k]);
    flow->m[k] = y[0], flow->T[k] = y[1], flow->q[k] = y[2];
    if (k == STEPS) break;
    for (int j = 1; j < 4; j++) {
      double unused;
      for (int e = 0; e < 3; e++)
        at[e] = y[e] + (j == 3 ? ds : 0.5 * ds) * rate[j - 1][e];
      rates(flow->c, p_H, at, rate[j], &unused);
    }
    for (int e = 0; e < 3; e++)
      y[e] +=
          ds / 6 * (rate[0][e] + 2 * rate[1][e] + 2 * rate[2][e] + rate[3][e]);
  }
  missing[0] = y[2];
  missing[1] = y[0] / (kMean * kDepth * flow->c->param[LEE_HUANG_RHO_D]) - 1;
}

/* Find pressure and temperature of the lid by Newton's method in their
 * logarithms; returns whether it has. */
static bool solve(struct incline *flow) {
  double x[2] = {log(200), log(0.03)}, f[2], size = HUGE_VAL;
  for (int k = 0; k < 60; k++) {
    double J[2][2], g[2];
    integrate(flow, exp(x[0]), exp(x[1]), f);
    size = fabs(f[0]) + fabs(f[1]);
    if (size < 1e-9) break;
    for (int e = 0; e < 2; e++) {
      double moved[2] = {x[0], x[1]};
      moved[e] += 1e-6;
      integrate(flow, exp(moved[0]), exp(moved[1]), g);
      for (int r = 0; r < 2; r++) J[r][e] = (g[r] - f[r]) / 1e-6;
    }
    const double det = J[0][0] * J[1][1] - J[0][1] * J[1][0];
    const double step[2] = {(J[1][1] * f[0] - J[0][1] * f[1]) / det,
                            (J[0][0] * f[1] - J[1][0] * f[0]) / det};
    const double most = fmax(fabs(step[0]), fabs(step[1]));
    for (int e = 0; e < 2; e++) x[e] -= step[e] * fmin(1, 0.3 / most);
  }
  flow->u[STEPS] = 0;
  for (int k = STEPS; k > 0; k--)
    flow->u[k - 1] = flow->u[k] + 0.5 * kDepth / STEPS *
                                      (flow->shear[k] + flow->shear[k - 1]);
  return size < 1e-6;
}

/* Return the value of v at the depth s below the lid. */
static double at_depth(const double v[STEPS + 1], double s) {
  const double at = s / kDepth * STEPS;
  const int k = (int)fmin(at, STEPS - 1);
  return v[k] + (at - k) * (v[k + 1] - v[k]);
}

/* Describe a stack of 8 trees, 2^level leaves each in depth. */
static struct params incline_params(struct four_state_keys *keys, int level) {
  struct params p = beads_params(keys, level);
  const double angle = kAngle * acos(-1) / 180;
  p.size = kDepth / 8;
  p.trees[DIM - 1] = 8;
  p.gravity[0] = kG * sin(angle), p.gravity[DIM - 1] = -kG * cos(angle);
  p.cfl = 0.9;
  p.tolerance_viscous = 1e-8, p.tolerance_pressure = 1e-6;
  p.boundary[0].type = p.boundary[1].type = BOUNDARY_PERIODIC;
  p.boundary[2 * (DIM - 1)].velocity[0] = -kFrame;
  return p;
}

/* Set the state to that of the flow. */
static void fill(struct four_state *sim, const struct incline *flow) {
  const struct mesh *mesh = sim->grid.mesh;
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    const double s = kDepth - mesh->x[i][DIM - 1];
    sim->nu->v[i] = at_depth(flow->nu, s);
    sim->T->v[i] = at_depth(flow->T, s);
    sim->u[0]->v[i] = at_depth(flow->u, s) - kFrame;
  }
  mesh_touch(mesh, sim->nu->v), mesh_touch(mesh, sim->T->v);
  mesh_touch(mesh, sim->u[0]->v);
}

/* Find the errors of u, nu, T once the flow is steady. */
static void run_flow(const struct incline *flow, struct four_state_keys *keys,
                     int level, double error[3]) {
  const struct params p = incline_params(keys, level);
  struct four_state *sim = beads_new(&p);
  const struct mesh *mesh = sim->grid.mesh;
  double sum[3] = {0}, most[3] = {0};
  fill(sim, flow);
  const bool good = beads_run(sim, kTime, 1000000);
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    const double s = kDepth - mesh->x[i][DIM - 1];
    const double exact[] = {at_depth(flow->u, s), at_depth(flow->nu, s),
                            at_depth(flow->T, s)};
    const double found[] = {sim->u[0]->v[i] + kFrame, sim->nu->v[i],
                            sim->T->v[i]};
    for (int e = 0; e < 3; e++) {
      sum[e] += (found[e] - exact[e]) * (found[e] - exact[e]);
      most[e] = fmax(most[e], exact[e]);
    }
  }
  for (int e = 0; e < 3; e++)
    error[e] = good ? sqrt(sum[e] / mesh->nleaves) / most[e] : NAN;
  four_state_destroy(sim);
}

static void run(struct report *report) {
  static const char *const norm[] = {"L2 of u", "L2 of nu", "L2 of T"};
  struct four_state_keys keys = four_state_defaults();
  struct four_state_closure c;
  double error[3][N];
  keys.start = FOUR_STATE_UNIFORM, keys.nu_start = kMean;
  keys.param[LEE_HUANG_D] = kGrain;
  keys.knudsen = INFINITY, keys.T_max = 1e6;
  CHECK(!four_state_closure_init(&c, keys.param, INFINITY), "closure");
  struct incline *flow = MEM_NEW(struct incline, 1);
  flow->c = &c;
  const bool solved = solve(flow);
  for (int k = 0; k < N; k++) {
    double of[3] = {NAN, NAN, NAN};
    if (solved) run_flow(flow, &keys, FIRST - 3 + k, of);
    for (int e = 0; e < 3; e++) error[e][k] = of[e];
  }
  for (int e = 0; e < 3; e++)
    report_errors(report, "uniform", norm[e], FIRST, N, error[e], NULL, 1.9);
  mem_free(flow);
  four_state_closure_release(&c);
}

const struct convergence_case incline_case = {
    .name = "incline",
    .title = "fluctuating grains of four states down an incline",
    .dimension = 2,
    .in_short = false,
    .run = run};
