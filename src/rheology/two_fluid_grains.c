/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/two_fluid_grains.h"

#include <float.h>
#include <math.h>
#include <stddef.h>

#include "talus/roots.h"
#include "two_fluid_sets.h"

double two_fluid_pressure(const struct two_fluid_closure *c, double phi,
                          const struct two_fluid_frozen *with, double *slope) {
  const struct two_fluid_slope p =
      c->set == TWO_FLUID_KTGF ? two_fluid_ktgf_pressure(c, phi, with)
                               : two_fluid_shearing_pressure(c, phi, with);
  if (slope != NULL) *slope = p.slope;
  return p.value;
}

/* Holds what P(phi) is taken with, for root_of_rising. */
struct question {
  const struct two_fluid_closure *c;
  const struct two_fluid_frozen *with;
};

static double pressure_of(double phi, double *slope, const void *context) {
  const struct question *of = context;
  return two_fluid_pressure(of->c, phi, of->with, slope);
}

double two_fluid_solid_fraction(const struct two_fluid_closure *c, double p,
                                const struct two_fluid_frozen *with,
                                double from, double guess) {
  const struct question of = {c, with};
  return root_of_rising(pressure_of, &of, p, from, guess);
}

double two_fluid_loosest(const struct two_fluid_closure *c, double phi_p) {
  switch (c->set) {
    case TWO_FLUID_CRITICAL_STATE:
      return phi_p;
    case TWO_FLUID_RAUTER:
    case TWO_FLUID_MU_I_PHI_I:
      return c->by.low;
    case TWO_FLUID_KTGF:
      break;
  }
  return c->param[c->frictional_pressure == TWO_FLUID_SYAMLAL
                      ? TWO_FLUID_KT_PHI_STAR
                      : TWO_FLUID_KT_PHI_FR];
}

double two_fluid_densest(const struct two_fluid_closure *c) {
  return c->set == TWO_FLUID_KTGF ? c->param[TWO_FLUID_KT_PHI_MAX] : c->by.pole;
}

double two_fluid_settled(const struct two_fluid_closure *c, double p,
                         double phi_p) {
  const struct two_fluid_frozen rest = {.phi_p = phi_p};
  const double low = two_fluid_loosest(c, phi_p);
  if (!(p > 0)) return low;
  return two_fluid_solid_fraction(c, p, &rest, low, two_fluid_densest(c));
}

struct two_fluid_stress two_fluid_stress(const struct two_fluid_closure *c,
                                         double phi, double p_s, double gamma,
                                         double eta_f, double Theta) {
  return c->set == TWO_FLUID_KTGF
             ? two_fluid_ktgf_stress(c, phi, p_s, Theta)
             : two_fluid_shearing_stress(c, p_s, gamma, eta_f);
}

double two_fluid_capped(const struct two_fluid_stress *stress, double gamma,
                        double gamma_r, double eta_max) {
  const double rate = gamma_r > 0 ? sqrt(gamma * gamma + gamma_r * gamma_r)
                                  : fmax(gamma, stress->tau_y / eta_max);
  return fmin(stress->eta + stress->tau_y / fmax(rate, DBL_MIN), eta_max);
}
