/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Conditions: what a restart may have changed under a state that was made with
 * others: gravity, densities, which faces are open, pressure and velocity at
 * the boundaries.
 *
 * A case holds functions, so its text does not tell. Instead the state itself
 * is asked: a checkpoint keeps three sums over it, and a restart finds them
 * anew under its own conditions.
 *   energy  kinetic + potential of the grains at `time`, J/m (J in 3D)
 *   gas     the same of the gas
 *   force   sum (g_x^2 + g_y^2 + g_z^2)^(1/2) V, g: gravity less pressure
 *           gradient over density of the stored p, m^(DIM+1)/s^2
 *   inflow  sum |u_f| A over the faces whose velocity is given, m^DIM/s
 * A jump of an energy is not of the scheme: `energy` books it. With
 * another force or inflow the flow starts anew from c and u: c, which lags half
 * a step, is brought to `time` with the u_f it has, the boundaries give u_f
 * what is now theirs, pressure and g become those of rest (step_start), and dt
 * is found as at t = 0. Where nothing has changed not a bit of the state does.
 */
#ifndef TALUS_TWO_PHASE_CONDITIONS_H
#define TALUS_TWO_PHASE_CONDITIONS_H

struct two_phase;

struct conditions {
  double energy, gas, force, inflow;
};

/* Measure the sums; of the state nothing changes. Collective. */
void conditions_measure(struct two_phase *sim, struct conditions *conditions);
/* Compare with sim->conditions, those of the checkpoint, and do what the
 * change asks for; the log says it. Collective. */
void conditions_renew(struct two_phase *sim);

#endif
