/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Side walls: the friction of a narrow channel that is computed in its plane.
 *
 * Grains slide on two walls a distance W apart. The mean over the width of
 * the momentum equation then holds the force per unit volume
 *   f = -(2 mu_w p/W) u/|u|                                    [jop_2005]
 * besides what is in the plane. It is taken in with the implicit viscous step
 * as a drag, f = -drag u, added to the density on the diagonal:
 *   (rho + dt drag) u - ... = rho u*,    drag = c 2 mu_w p/(W speed).
 * With k = c 2 mu_w p/(W rho) and u* the velocity without friction,
 *   speed = max(|u* + dt v| - dt k, |u^n|, s),
 * v the viscous acceleration of the last step. The first is what a cell that
 * slides will have; |u^n| keeps friction from growing when v is a bad guess,
 * and makes it lag (by a part dt k/u while grains slow down); s is
 * SIDE_WALLS_CREEP of sqrt(g L), L the box: where friction could take more
 * than there is, grains are held, and creep at about s. Without v a plug would
 * creep at g dt, as friction that some of its cells do not need would not be
 * lent to the others.
 *
 * Valid while the flow varies little across the channel. Two dimensions.
 */
#ifndef TALUS_SIDE_WALLS_H
#define TALUS_SIDE_WALLS_H

#include "talus/mesh.h"
#include "talus/params.h"

#define SIDE_WALLS_CREEP 1e-6

/* drag [nleaves], kg/m^3/s, for one step dt.
 *   creep  s above, m/s, > 0
 *   rho, c, p  [nleaves], of the mixture, fraction and pressure
 *   u, u_old   [nleaves] each: u* + dt v, and u^n */
struct side_walls_state {
  const double *rho, *c, *p;
  const double *u[DIM], *u_old[DIM];
};
void side_walls_drag(const struct mesh *mesh, const struct side_walls *walls,
                     double dt, double creep,
                     const struct side_walls_state *state, double *drag);

/* Return the power, W/m, that goes into the walls: sum drag |u|^2 V.
 * Collective. */
double side_walls_power(const struct mesh *mesh, const double *drag,
                        double *const u[DIM]);

#endif
