/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Conditions: what a restart may have changed under the state of a checkpoint:
 * gravity, densities, which faces are open, pressure and velocity at the
 * boundaries.
 *
 * A case holds functions, so its text does not tell. Instead a checkpoint keeps
 * four sums over the state, and a restart takes the same sums with the
 * conditions as they are now.
 *   energy  kinetic + potential of the grains at `time`, J/m (J in 3D)
 *   gas     the same of the gas
 *   force   sum (g_x^2 + g_y^2 + g_z^2)^(1/2) V, g: gravity less pressure
 *           gradient over density of the stored p, m^(DIM+1)/s^2
 *   inflow  sum |u_f| A over the faces whose velocity is given, m^DIM/s
 * The scheme has not made a jump of energy, so `changed` of struct energy books
 * it. With another force or inflow the flow starts anew from c and u: c, which
 * lags half a step, is brought to `time` with the old u_f; u_f takes the new
 * values of the boundaries; pressure and g become those of rest (step_start);
 * and dt is found as at t = 0. Where nothing has changed, not a bit of the
 * state changes.
 */
#ifndef TALUS_TWO_PHASE_CONDITIONS_H
#define TALUS_TWO_PHASE_CONDITIONS_H

struct two_phase;

struct conditions {
  double energy, gas, force, inflow;
};

/* Measure the sums; the state stays as it is. Collective. */
void conditions_measure(struct two_phase *sim, struct conditions *conditions);
/* Compare with sim->conditions of the checkpoint, do what a change asks for,
 * and say so in the log. Collective. */
void conditions_renew(struct two_phase *sim);

#endif
