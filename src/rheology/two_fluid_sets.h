/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Pressure and stress of each set of closures, for two_fluid_grains.c. */
#ifndef TALUS_RHEOLOGY_TWO_FLUID_SETS_H
#define TALUS_RHEOLOGY_TWO_FLUID_SETS_H

#include "talus/two_fluid_grains.h"

/* A function of phi with its derivative. */
struct two_fluid_slope {
  double value, slope;
};

static inline double two_fluid_fifth(double x) { return x * x * x * x * x; }

/* Return f at phi, and beyond `end` the line that touches f there. */
static inline struct two_fluid_slope two_fluid_beyond(
    struct two_fluid_slope (*f)(const struct two_fluid_closure *c, double phi,
                                double phi_p),
    const struct two_fluid_closure *c, double phi, double phi_p, double end) {
  struct two_fluid_slope at = f(c, phi < end ? phi : end, phi_p);
  if (phi > end) at.value += at.slope * (phi - end);
  return at;
}

/* Return P of ktgf, and of the other sets. */
struct two_fluid_slope two_fluid_ktgf_pressure(
    const struct two_fluid_closure *c, double phi,
    const struct two_fluid_frozen *with);
struct two_fluid_slope two_fluid_shearing_pressure(
    const struct two_fluid_closure *c, double phi,
    const struct two_fluid_frozen *with);

/* Return the stress as two_fluid_stress does. */
struct two_fluid_stress two_fluid_ktgf_stress(const struct two_fluid_closure *c,
                                              double phi, double p_s,
                                              double Theta);
struct two_fluid_stress two_fluid_shearing_stress(
    const struct two_fluid_closure *c, double p_s, double gamma, double eta_f);

#endif
