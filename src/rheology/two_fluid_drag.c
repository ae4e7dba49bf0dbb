/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/two_fluid_drag.h"

#include <math.h>

/* Least room for the fluid, so that nothing is divided by 0. */
static const double LEAST_ROOM = 1e-3;

double two_fluid_viscosity(const struct two_fluid_closure *c, double gamma) {
  const double *v = c->param, eta_inf = v[TWO_FLUID_FLUID_ETA_INF];
  const double rise = v[TWO_FLUID_FLUID_ETA_0] - eta_inf;
  if (rise == 0) return eta_inf;
  return eta_inf + rise / (1 + pow(v[TWO_FLUID_FLUID_LAMBDA] * gamma,
                                   v[TWO_FLUID_FLUID_N])); /* eq. 27 */
}

double two_fluid_pore_viscosity(const struct two_fluid_closure *c, double phi,
                                double eta_f) {
  if (c->set == TWO_FLUID_KTGF) return eta_f;
  const double room = fmax(1 - phi / c->by.phi_m, LEAST_ROOM);
  return eta_f * (1 + c->by.pores * phi / room) / fmax(1 - phi, LEAST_ROOM);
}

/* Return K/phi of Ergun, [busch_johansen_2020, eq. 24, dense]. */
static double ergun(const struct two_fluid_closure *c, double phi, double u_r,
                    double eta_f) {
  const double *v = c->param, d = v[TWO_FLUID_GRAINS_D];
  const double a = fmax(1 - phi, LEAST_ROOM);
  return v[TWO_FLUID_DRAG_ERGUN_VISCOUS] * phi * eta_f / (a * d * d) +
         v[TWO_FLUID_DRAG_ERGUN_INERTIAL] * v[TWO_FLUID_FLUID_DENSITY] * u_r /
             d;
}

/* Return K/phi of Wen & Yu: C_D u_r = 24 eta_f (1 + ...)/(a rho_f d), so that
 * nothing is divided by u_r. */
static double wen_yu(const struct two_fluid_closure *c, double phi, double u_r,
                     double eta_f) {
  const double *v = c->param, d = v[TWO_FLUID_GRAINS_D];
  const double rho = v[TWO_FLUID_FLUID_DENSITY];
  const double a = fmax(1 - phi, LEAST_ROOM), momentum = a * rho * d * u_r;
  const double Re = momentum > 0 ? momentum / eta_f : 0;
  const double more =
      v[TWO_FLUID_DRAG_WEN_YU_FACTOR] * pow(Re, v[TWO_FLUID_DRAG_WEN_YU_POWER]);
  const double viscous = 24 * eta_f * (1 + more) / (a * d);
  const double least = v[TWO_FLUID_DRAG_WEN_YU_LEAST] * rho * u_r;
  return 0.75 * fmax(viscous, least) / d *
         pow(a, -v[TWO_FLUID_DRAG_WEN_YU_EXPONENT]);
}

/* Return the part of Ergun, which rises smoothly from 0 to 1. */
static double dense_part(const struct two_fluid_closure *c, double phi) {
  const double low = c->param[TWO_FLUID_DRAG_BLEND_LOW];
  const double high = c->param[TWO_FLUID_DRAG_BLEND_HIGH];
  if (phi <= low) return 0;
  if (phi >= high) return 1;
  const double t = (phi - low) / (high - low);
  return t * t * (3 - 2 * t);
}

double two_fluid_drag_per_phi(const struct two_fluid_closure *c, double phi,
                              double u_r, double eta_f) {
  const double part = c->drag == TWO_FLUID_ERGUN    ? 1
                      : c->drag == TWO_FLUID_WEN_YU ? 0
                                                    : dense_part(c, phi);
  double drag = 0;
  if (part > 0) drag += part * ergun(c, phi, u_r, eta_f);
  if (part < 1) drag += (1 - part) * wen_yu(c, phi, u_r, eta_f);
  return drag;
}

double two_fluid_drag(const struct two_fluid_closure *c, double phi, double u_r,
                      double eta_f) {
  return phi * two_fluid_drag_per_phi(c, phi, u_r, eta_f);
}

double two_fluid_pore_shear_rate(double phi, double K, double u_r,
                                 double eta_f) {
  if (!(K > 0)) return 0;
  return u_r * sqrt(K / (fmax(1 - phi, LEAST_ROOM) * eta_f));
}

double two_fluid_stokes_number(const struct two_fluid_closure *c, double g) {
  const double *v = c->param, d = v[TWO_FLUID_GRAINS_D];
  const double rho_s = v[TWO_FLUID_GRAINS_DENSITY];
  const double drho = rho_s - v[TWO_FLUID_FLUID_DENSITY];
  return sqrt(0.5 * rho_s * drho * g * d * d * d) /
         (18 * v[TWO_FLUID_FLUID_ETA_0]);
}

double two_fluid_density_ratio(const struct two_fluid_closure *c) {
  return sqrt(c->param[TWO_FLUID_GRAINS_DENSITY] /
              c->param[TWO_FLUID_FLUID_DENSITY]);
}
