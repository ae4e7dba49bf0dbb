/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Shows deformation and closure in snapshots and series.csv.
 *
 *   shear_rate  sqrt(2 D:D) of a leaf, 1/s, from central differences. Leaves
 *               of grains (c >= 1/2) look at other such leaves only, on one
 *               side where there is gas on the other: gas slides over grains
 *               at rest.
 *   stress      sqrt(T:T/2) of the deviatoric stress T of the grains, Pa: eta
 *               shear_rate with the viscosity of the closure; with an exact
 *               yield the plastic one, and the mean of the kept stress s over
 *               the sides that have a yield stress is added (yield.h). 0 in the
 *               gas.
 *   outputs     what the closure of the grains knows besides its viscosity
 *               (rheology.h: solid fraction, state, ...), from shear_rate and
 *               the pressure of the leaf; 0 in the gas.
 */
#ifndef TALUS_TWO_PHASE_CLOSURE_FIELDS_H
#define TALUS_TWO_PHASE_CLOSURE_FIELDS_H

struct two_phase;

/* Return the mean of the present shear rate over the grains, sum c shear_rate V
 * / sum c V; helper nodes of u and c are filled. Collective. */
double closure_fields_shear_rate(const struct two_phase *sim);

/* Make sim->shear_rate, sim->stress and sim->known, for as long as they are
 * wanted; helper nodes of u and c are filled. Collective. */
void closure_fields_update(const struct two_phase *sim);
void closure_fields_release(const struct two_phase *sim);

#endif
