/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Side walls: the friction of a narrow channel that is computed in its plane.
 *
 * Grains slide on two walls a distance W apart. The mean over the width of the
 * momentum equation then holds the force per unit volume
 *   f = -F u/|u|,   F = c 2 mu_w p/W                           [jop_2005]
 * besides what is in the plane. Where grains rest f is what holds them, |f| <=
 * F. As the stress of an exact yield (yield.h) it is a field, kept from step to
 * step:
 *   f^{n+1} = P(f^n - r u^{n+1}),   P(f) = f min(1, F/|f|),
 * for any r; here r = 100 rho/dt, with which a plug that is held loses nine
 * tenths of its speed in a step, and one that is to be held gains a hundredth
 * of g dt. The implicit viscous step has of it
 *   (rho + dt r) u - ... = rho u* + dt f^n       where grains are held,
 *   rho u - ...          = rho u* + dt F f'/|f'| where they slide.
 * They slide if |f'| > F: f' = f^n - r u' foretells f^{n+1}, from the u' that a
 * leaf would have by itself, (rho + dt r) u' = rho (u* + dt v) + dt f^n, v the
 * viscous acceleration of the last step.
 *
 * Valid while the flow varies little across the channel. Two dimensions.
 */
#ifndef TALUS_SIDE_WALLS_H
#define TALUS_SIDE_WALLS_H

#include "talus/mesh.h"
#include "talus/params.h"

/* Where grains are, arrays [nleaves]: density of the mixture, fraction,
 * pressure, kg/m^3, 1, Pa. */
struct side_walls_state {
  const double *rho, *c, *p;
};

/* Set what a step of dt takes into its solve, [nleaves] each: mass to rho or
 * rho + dt r, f from f^n to the force on the right, N/m^3. u: u* + dt v. */
void side_walls_foretell(const struct mesh *mesh,
                         const struct side_walls *walls, double dt,
                         const struct side_walls_state *state,
                         double *const u[DIM], double *const f[DIM],
                         double *mass);

/* Set f, as side_walls_foretell left it, to f^{n+1} from the u that was solved
 * for with this mass. */
void side_walls_advance(const struct mesh *mesh, const struct side_walls *walls,
                        double dt, const struct side_walls_state *state,
                        const double *mass, double *const u[DIM],
                        double *const f[DIM]);

/* Return the power, W/m, that goes into the walls: -sum f.u V. Collective. */
double side_walls_power(const struct mesh *mesh, double *const f[DIM],
                        double *const u[DIM]);

#endif
