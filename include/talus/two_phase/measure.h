/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Diagnostics: what series.csv and profile.csv say of the state.
 *
 *   volume     sum c V                          all grains, m^DIM
 *   kinetic    sum 1/2 rho_grains c |u|^2 V     J/m (2D), J (3D)
 *   potential  -sum rho_grains c V g.x          x: centre of the grains in a
 *              cell, for cut cells the centroid below their plane
 *   gas        kinetic and potential energy of the rest of the box
 *   max_speed  |u| of cells with c > 1/2, m/s
 *   shear_rate mean over the grains, 1/s (closure_fields.h)
 *   flowing    part of the volume of the grains that is at its yield stress,
 *              sum c V yield_state/sum c V (yield.h); 1 if it is not exact, as
 *              what is below it creeps then
 *   layer      int min(tracer, c) dz of the heap per column, m
 *
 * In axisymmetric coordinates sums are those of the whole turn around the axis,
 * in m^3 and J.
 *
 * Sums are compensated [neumaier_1974, doi:10.1002/zamm.19740540106] and added
 * over ranks in rank order, so that the volume is good to a few 1e-16 and the
 * same from run to run.
 */
#ifndef TALUS_TWO_PHASE_MEASURE_H
#define TALUS_TWO_PHASE_MEASURE_H

#include "talus/droplets.h"
#include "talus/outline.h"
#include "talus/params.h"

struct two_phase;

struct diagnostics {
  double volume;
  double kinetic, potential, gas;
  double max_speed, shear_rate;
  double front, height;     /* of the outline, m */
  struct droplets droplets; /* not in the outline */
  struct outline outline;
  bool *heap;                        /* [nleaves] in the outline, owned */
  double *layer[PARAMS_MAX_TRACERS]; /* as outline.height, owned; or NULL */
};

/* Return the part of the grains that flows. Collective. */
double diagnostics_flowing(struct two_phase *sim);
/* Return the energy of the gas alone. Collective. */
double diagnostics_gas(const struct two_phase *sim);
/* Measure the state, which is left as it is but for scratch. Collective; the
 * same on all ranks. Free with diagnostics_free. */
void diagnostics_measure(const struct two_phase *sim,
                         struct diagnostics *diagnostics);
/* Measure the energies alone. Collective. */
void diagnostics_energy(const struct two_phase *sim, double *kinetic,
                        double *potential);
/* Measure the layers of the tracers at the time of u, within the heap that
 * diagnostics_measure has found; c is synchronised (fractions.h). Collective.
 */
void diagnostics_measure_layers(struct two_phase *sim,
                                struct diagnostics *diagnostics);
void diagnostics_free(struct diagnostics *diagnostics);

#endif
