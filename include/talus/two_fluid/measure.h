/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Measures of a two-fluid run. */
#ifndef TALUS_TWO_FLUID_MEASURE_H
#define TALUS_TWO_FLUID_MEASURE_H

#include <stdint.h>

#include "talus/outline.h"

struct two_fluid;

struct two_fluid_measures {
  /* Where the contour alpha = alpha_surface ends along the first horizontal
   * axis (3D: its largest distance from the lower edge of the box), and its
   * height, m */
  double front, height;
  /* Likewise of the solid volume per area over alpha_start, which ends where it
   * falls below half a grain, or front_height */
  double grain_front, grain_height;
  double volume;        /* of grains, m^2 (3D: m^3) */
  double fluid_volume;  /* of the fluid */
  double momentum[3];   /* of both, kg/s (3D: kg m/s) */
  double kinetic;       /* of the grains, J/m (3D: J) */
  double fluid_kinetic; /* of the fluid */
  double potential;     /* of the grains less buoyancy */
  double max_flux;      /* largest |alpha u_s| through a face, m/s */
  double max_speed;     /* largest mean flux of a leaf over its alpha, m/s */
  double grain_speed;   /* likewise, root of the mean square by mass */
  double suspended;     /* part of the grains outside the contour */
  double mean_alpha;    /* within the contour */
  double max_alpha, max_solid_pressure;
  double least_pressure, most_pressure; /* excess of the fluid, Pa */
  struct outline outline;               /* of solid volume over alpha_start */
};

/* Measure; free the outline with outline_free. Collective. */
void two_fluid_measure(struct two_fluid *sim,
                       struct two_fluid_measures *measures);
/* Set layer[k] [columns of the outline] to the height that tracer k has of it,
 * m, owned by the caller. Collective. */
void two_fluid_measure_layers(const struct two_fluid *sim, double **layer);
/* Return kinetic energy of both phases and potential energy. Collective. */
double two_fluid_energy(const struct two_fluid *sim);
/* Return component d of the flux of the grains over alpha in leaf i, m/s. */
double two_fluid_mean_velocity(const struct two_fluid *sim, int32_t i, int d);
/* Set stress [nleaves] to that of the grains, sqrt(T:T/2), Pa, 0 where there
 * are none, after two_fluid_properties. Collective. */
void two_fluid_find_stress(const struct two_fluid *sim, double *stress);
/* Return the largest speed of leaves within the contour, by their flux, m/s.
 * Collective. */
double two_fluid_carrying_speed(const struct two_fluid *sim);

#endif
