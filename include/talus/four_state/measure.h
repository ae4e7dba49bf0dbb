/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Measures of a four-state run. */
#ifndef TALUS_FOUR_STATE_MEASURE_H
#define TALUS_FOUR_STATE_MEASURE_H

#include "talus/outline.h"

struct four_state;

struct four_state_measures {
  /* Where the contour nu = nu_surface ends along the first horizontal axis (3D:
   * its largest distance from the lower edge of the box), and its height, m */
  double front, height;
  /* Likewise of the solid volume per area over nu_start, which ends where it
   * falls below half a grain, or front_height */
  double grain_front, grain_height;
  double volume;             /* of grains, m^2 (3D: m^3) */
  double momentum[3];        /* kg/s (3D: kg m/s) */
  double kinetic, potential; /* J/m (3D: J) */
  double fluctuating, elastic;
  double max_speed;   /* of leaves beyond the contour, m/s */
  double grain_speed; /* flux of grains over nu, root of the mean
                         square by mass, m/s */
  double max_nu, max_pressure;
  double slow;            /* part of the mass below sqrt(g d)/10 */
  double part[4];         /* solid, quasi-static, dense, inertial: parts of
                             the area beyond the contour */
  struct outline outline; /* of solid volume over nu_start */
};

/* Measure; free the outline with outline_free. Collective. */
void four_state_measure(struct four_state *sim,
                        struct four_state_measures *measures);
/* Return kinetic + potential + fluctuating + elastic energy. Collective. */
double four_state_energy(const struct four_state *sim);
/* Holds what grains have, kg/m and J/m (3D: kg and J); other: elastic and
 * fluctuating energy, which may become kinetic. */
struct four_state_store {
  double mass, kinetic, other;
};
/* Sum over all ranks. Collective. */
struct four_state_store four_state_store(const struct four_state *sim);
/* Set p_E/p and the state of leaves [nleaves]; NULL: not asked for. p, p_E and
 * shear rates are made anew. Collective. */
void four_state_find_states(struct four_state *sim, double *contact,
                            double *name);

#endif
