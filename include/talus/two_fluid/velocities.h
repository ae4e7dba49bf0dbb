/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Velocities of leaves: viscosity of both phases, implicit.
 *
 * Viscosity acts on velocities that pressures and weight of the last step have
 * moved already, and drag holds the phases together meanwhile. With m_s = alpha
 * rho_s, m_f = (1 - alpha) rho_f, k = dt K, theta = k/(m_f + k), and b what the
 * forces of faces give a leaf (pressures.h),
 *
 *   (m_s + theta m_f) u_s - dt div(tau_s + theta tau_f(u_s))
 *       = m_s (u_s^n + dt b_s) + theta m_f (u_f^n + dt b_f)
 *   (m_f + k) u_f - dt div tau_f(u_f) = m_f (u_f^n + dt b_f) + k u_s
 *
 * with tau_s of the shear rates of u^n and then of u_s, and with an exact yield
 * that of yield.h, solved for up to eight times until it fits. The fluid that
 * is eliminated from the first equation takes the part theta of its own
 * viscosity with it: where drag rules, both move as one, with the viscosity of
 * both; without that part tau_f would be explicit there. Kept are the viscous
 * forces alone,
 *
 *   u_s* = u_s^n + dt div tau_s/m_s
 *   u_f* = u_f^n + dt div(theta tau_f(u_s) + (1 - theta) tau_f(u_f))/m_f
 *
 * so that the sum of both has the forces that u_s was found with. Grains in a
 * viscous liquid hold still by the difference of forces that are many times
 * larger; with tau_f(u_f) alone in u_f* they flow below their slope of repose
 * (tests/mesh/test_two_fluid_slope.c). Forces are those of stresses on faces,
 * so that the momentum of the sum is kept whatever theta is; drag, pressures
 * and weight act on faces. Leaves without grains keep the velocity of the
 * grains around them (two_fluid_calm): they have no viscosity of their own, and
 * their free fall would be a part of div u_s, and of the normal stress, at
 * faces of the leaves beside them. */
#ifndef TALUS_TWO_FLUID_VELOCITIES_H
#define TALUS_TWO_FLUID_VELOCITIES_H

struct two_fluid;

/* Advance the velocities of leaves by viscosity; fields_save has kept u^n.
 * Fills p. Collective. */
void two_fluid_velocities(struct two_fluid *sim, double dt);

#endif
