/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Two phases of the two-fluid model that drag each other over a step dt:
 *
 *   rho_s (u_s - a_s) = c_s (u_f - u_s),  rho_f (u_f - a_f) = c_f (u_s - u_f)
 *   c_s = dt K/phi,  c_f = dt K/(1 - phi)
 *
 * which is each momentum over its own volume fraction, so that all is finite at
 * phi = 0, where grains move as a single one would. a_s, a_f are the velocities
 * that all other forces make. With m_s = phi rho_s, m_f = (1 - phi) rho_f, k =
 * dt K the determinant m_s m_f + k (m_s + m_f) is phi (1 - phi) times ours. */
#ifndef TALUS_TWO_FLUID_PAIR_H
#define TALUS_TWO_FLUID_PAIR_H

struct two_fluid_pair {
  double phi, rho_s, rho_f; /* phi < 1 */
  double drag;              /* dt K/phi, kg/m^3 */
};

/* Replace u[0] = a_s, u[1] = a_f by u_s, u_f. A phase without density moves
 * with the other, or as it did if nothing drags it. */
void two_fluid_pair_solve(const struct two_fluid_pair *pair, double u[2]);
/* Return the mobility lambda of the mixture, m^3/kg, of the common pressure:
 * (phi^2 m_f + (1 - phi)^2 m_s + k)/(m_s m_f + k (m_s + m_f)). */
double two_fluid_pair_mobility(const struct two_fluid_pair *pair);
/* Return dt M, kg/m^3, of the grains where the total flux j is held:
 * rho_s + rho_f phi/(1 - phi) + dt K/(phi (1 - phi)^2). */
double two_fluid_pair_inertia(const struct two_fluid_pair *pair);

#endif
