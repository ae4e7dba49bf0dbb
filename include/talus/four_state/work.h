/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Work of the forces of a step on the grains, J/m (3D: J). Within a step one
 * force after the other changes u of a leaf, each from some u_0 to u_1, and its
 * work is
 *   rho_d nu (u_1 - u_0) . (u_0 + u_1)/2,
 * by which the kinetic energy changes.
 *
 *   dissipated  friction and viscosity, by their impulse and the u they leave,
 *               and collisions (temperature.h)
 *   impact      what grains lose to their pressure and do not store,
 *               g (work of gravity, by the mean of u at both ends) - (work of p
 *               and g) - (change of the elastic energy) + (what friction takes
 *               from the velocity that p gives leaves at the start of a step)
 *
 * Grains that land on others lose to pressure whatever h and dt are: behind a
 * shock p times the change of volume is twice the kinetic energy that was, and
 * with p_ES ~ (nu - nu_min)^3.5 at most 1/4.5 of that product is stored. Steps
 * that are longer than a shock takes, and the first order in time of p, are in
 * impact, too. p_K and p_D do work that T does not pay for, as eq. 3 of
 * [lee_huang_chiew_2015] has no -p div u: impact may fall where grains spread.
 * Neither holds what the scheme loses or makes by carrying mass and momentum.
 */
#ifndef TALUS_FOUR_STATE_WORK_H
#define TALUS_FOUR_STATE_WORK_H

struct four_state;

/* Return the work on grains that change from u + dt a_0 to u + dt a_1, all
 * [DIM][nleaves]; a_0: 0 if NULL. Collective. */
double four_state_work(const struct four_state *sim, double dt,
                       double *const a_0[], double *const a_1[],
                       double *const u[]);
/* Return rho_d nu g . u, the power of gravity, W/m (3D: W). Collective. */
double four_state_fall(const struct four_state *sim, double *const u[]);
/* Book what friction and viscosity do to grains of mass [nleaves], kg/m^3,
 * whose velocity they change from rhs/mass to u. Collective. */
void four_state_book_friction(struct four_state *sim, const double *mass,
                              double *const rhs[], double *const u[]);
/* Return the elastic energy of solid fractions nu [nleaves]. Collective. */
double four_state_stored(const struct four_state *sim, const double *nu);

#endif
