/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The sets of closures that know one number of shear: critical_state, rauter
 * and mu_i_phi_i (two_fluid_grains.h). */
#include <math.h>

#include "two_fluid_sets.h"

/* Distances from the poles at which functions go on linearly. */
static const double MARGIN = 1e-3, MARGIN_FIRST_ORDER = 1e-6;
/* Least distance of the plastic packing from the densest. */
static const double PLASTIC_ROOM = 1e-2;

/* Return (phi/(phi_m - phi))^2. */
static struct two_fluid_slope crowding(const struct two_fluid_closure *c,
                                       double phi, double unused) {
  const double phi_m = c->by.phi_m, room = phi_m - phi, x = phi / room;
  (void)unused;
  return (struct two_fluid_slope){x * x, 2 * x * phi_m / (room * room)};
}

/* Return p_c of [rauter_2021]. */
static struct two_fluid_slope forgetful(const struct two_fluid_closure *c,
                                        double phi, double unused) {
  const struct two_fluid_shearing *by = &c->by;
  const double x = phi - by->low, room = by->pole - phi;
  (void)unused;
  if (x <= 0) return (struct two_fluid_slope){0, 0};
  return (struct two_fluid_slope){
      by->stiffness * x / room,
      by->stiffness * (by->pole - by->low) / (room * room)};
}

/* Return p_c of [montella_2021]. */
static struct two_fluid_slope remembering(const struct two_fluid_closure *c,
                                          double phi, double phi_p) {
  const struct two_fluid_shearing *by = &c->by;
  const double x = phi - fmin(phi_p, by->pole - PLASTIC_ROOM);
  const double room = by->pole - phi;
  if (x <= 0) return (struct two_fluid_slope){0, 0};
  const double p = by->stiffness * x * x * x / two_fluid_fifth(room);
  return (struct two_fluid_slope){p, p * (3 / x + 5 / room)};
}

/* Return p_c of a plastic packing. */
static struct two_fluid_slope contact(const struct two_fluid_closure *c,
                                      double phi, double phi_p) {
  if (c->set == TWO_FLUID_CRITICAL_STATE)
    return two_fluid_beyond(remembering, c, phi, phi_p, c->by.pole - MARGIN);
  return two_fluid_beyond(forgetful, c, phi, phi_p,
                          c->by.pole - MARGIN_FIRST_ORDER);
}

struct two_fluid_slope two_fluid_shearing_pressure(
    const struct two_fluid_closure *c, double phi,
    const struct two_fluid_frozen *with) {
  struct two_fluid_slope p = contact(c, phi, with->phi_p);
  if (with->X > 0) {
    const struct two_fluid_slope crowd =
        two_fluid_beyond(crowding, c, phi, 0, c->by.phi_m - MARGIN);
    p.value += with->X * crowd.value;
    p.slope += with->X * crowd.slope;
  }
  return p;
}

double two_fluid_shear(const struct two_fluid_closure *c, double gamma,
                       double eta_f) {
  const struct two_fluid_shearing *by = &c->by;
  const double d_gamma = c->param[TWO_FLUID_GRAINS_D] * gamma;
  const double rho = c->param[TWO_FLUID_GRAINS_DENSITY];
  if (c->set == TWO_FLUID_KTGF) return 0;
  return by->viscous * eta_f * gamma + by->inertial * rho * d_gamma * d_gamma;
}

double two_fluid_relaxed_shear(const struct two_fluid_closure *c, double before,
                               double gamma, double eta_f, double phi,
                               double dt) {
  const double X = two_fluid_shear(c, gamma, eta_f);
  const double viscous = c->by.viscous * eta_f * gamma;
  const double from =
      c->set == TWO_FLUID_CRITICAL_STATE ? before : fmax(before, viscous);
  if (X <= from) return X;
  return from - (X - from) * expm1(-c->by.relax * phi * gamma * dt);
}

struct two_fluid_stress two_fluid_shearing_stress(
    const struct two_fluid_closure *c, double p_s, double gamma, double eta_f) {
  const struct two_fluid_shearing *by = &c->by;
  const double d = c->param[TWO_FLUID_GRAINS_D];
  const double rho = c->param[TWO_FLUID_GRAINS_DENSITY];
  const double more = by->mu_2 - by->mu_1, tau_y = by->mu_1 * p_s;
  if (!(p_s > 0)) return (struct two_fluid_stress){0, 0, 0};
  if (c->set ==
      TWO_FLUID_MU_I_PHI_I) { /* (mu - mu_1) p/gamma, I/gamma finite */
    const double root = sqrt(rho * p_s);
    const double I = d * gamma * rho / root;
    return (struct two_fluid_stress){more * d * root / (I + by->number_0),
                                     tau_y, 0};
  }
  /* (mu - mu_1) p/gamma = more p (X/gamma)/(X + J_0 p) */
  const double per_rate =
      by->viscous * eta_f + by->inertial * rho * d * d * gamma;
  return (struct two_fluid_stress){
      more * per_rate * p_s / (gamma * per_rate + by->number_0 * p_s), tau_y,
      0};
}

double two_fluid_plastic_of(const struct two_fluid_closure *c, double phi,
                            double p) {
  if (c->set != TWO_FLUID_CRITICAL_STATE) return phi;
  const double room = fmax(c->by.pole - phi, MARGIN);
  return fmax(phi - cbrt(p * two_fluid_fifth(room) / c->by.stiffness), 0);
}

double two_fluid_plastic_rate(const struct two_fluid_closure *c, double phi,
                              double p_s, double gamma, double eta_f) {
  const double *v = c->param;
  if (c->set != TWO_FLUID_CRITICAL_STATE) return 0;
  const double J =
      two_fluid_shear(c, gamma, eta_f) / fmax(p_s, v[TWO_FLUID_CS_P_LEAST]);
  const double phi_eq = v[TWO_FLUID_CS_PHI_C] / (1 + sqrt(J));
  const double most = v[TWO_FLUID_CS_DILATANCY_MAX];
  const double delta = v[TWO_FLUID_CS_DILATANCY] * (phi - phi_eq);
  return -fmin(fmax(delta, -most), most) * gamma;
}

double two_fluid_plastic(const struct two_fluid_closure *c, double phi_p,
                         double rate, double dt) {
  const double low = fmin(phi_p, c->param[TWO_FLUID_CS_PHI_P_LOW]);
  const double high = fmax(phi_p, c->param[TWO_FLUID_CS_PHI_P_HIGH]);
  return fmin(fmax(phi_p * exp(fmin(rate * dt, 100)), low), high);
}
