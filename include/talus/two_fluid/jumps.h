/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Momentum of both phases together where the level changes.
 *
 * A face gives to its leaf i the mass m_k of each phase k times the velocity
 * v_k that it adds over dt, of which the weight W of the leaf's grains there is
 * a part and the rest is the pressure P on the face (p and p_s together): at
 * the upper side, with h the edge of the leaf,
 *
 *   h sum_k m_k v_k = - dt (P - p - p_s) + dt h W,
 *   m_s = alpha rho_s s,  m_f = (1 - alpha) rho_f/2,
 *   W = alpha (rho_s - rho_f) g s
 *
 * and with 1 - s and P's sign changed at the lower one (s: pressures.h). Both
 * leaves of a face find the same P on one level, since its acceleration is that
 * of the difference of their pressures. At the side of a coarse leaf the finer
 * faces take their slope from a pressure interpolated within that leaf, and P
 * that the coarse leaf finds is not the mean of those of its finer ones. The
 * coarse leaf takes that mean, and what it changes moves both phases alike;
 * without that waves in water lose 1.5e-5 of their momentum in a step
 * (docs/notes/two_fluid.md). In a bed at rest the difference is that of p_s,
 * which is not linear, and grains that lie still do not take it
 * (two_fluid_stillness of properties.h): it would push them for ever. */
#ifndef TALUS_TWO_FLUID_JUMPS_H
#define TALUS_TWO_FLUID_JUMPS_H

struct two_fluid;

/* Set more [nleaves] to what leaves get along axis d besides their shares of
 * v[k] [nfaces_all], which pressures, weight and drag have given faces over dt:
 * 0 but in coarse leaves at jumps. alpha, p_s and p are those that made v.
 * Collective. */
void two_fluid_jumps(struct two_fluid *sim, double dt, int d,
                     const double *const v[], double *more);

#endif
