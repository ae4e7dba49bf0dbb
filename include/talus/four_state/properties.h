/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Properties of grains in leaves and at faces, from nu, T and u.
 *
 * Masses. A leaf gives its mass to its two faces along an axis, the parts
 * 1 - s to the lower and s to the upper one,
 *   s = w_upper/(w_lower + w_upper),   w = min(nu, nu of the neighbour),
 * half to each within the grains, and all to the one that leads to grains where
 * the other leads to none. A face so has the mass
 *   M = max(s_0 nu_0 + (1 - s_1) nu_1, 1/2 max(nu_0, nu_1)),
 * and the weight that it carries is that of all grains above it, a part-filled
 * leaf of the surface included. With the same parts
 *   u_f = (s_0 nu_0 u_0 + (1 - s_1) nu_1 u_1)/(s_0 nu_0 + (1 - s_1) nu_1)
 *   a   = (1 - s) a_lower + s a_upper,   a_f = g - grad p/(rho_d M)
 * go from leaves to faces and back. Walls do not accelerate: a_f = 0. A face at
 * the surface may have more mass than its leaves lend; they share the rest of
 * the force of its pressure by their mass, so that none is lost. The side of a
 * coarse leaf has the mean by mass of its finer faces.
 *
 * Skin. Leaves touch by min(1, p/(h/2 rho_d nu |g|)); around those that do,
 * tangential differences hardly read those that do not (skin.h): grains that
 * slide on a heap would shear it with them, and so would the vacuum.
 */
#ifndef TALUS_FOUR_STATE_PROPERTIES_H
#define TALUS_FOUR_STATE_PROPERTIES_H

struct four_state;

/* Set p and p_E of leaves, and the skin. Collective. */
void four_state_contacts(struct four_state *sim);
/* Fill nu and set p, p_E, mu_K, lambda_K (filled), the masses and the skin.
 * Collective. */
void four_state_properties(struct four_state *sim);
/* Set eta_f, kappa_f and shear_f of a velocity u, filled: friction
 * p_E eta_S (1 - exp(-n gamma/2))/gamma and mu_K. On no-slip walls p_E is with
 * the weight w of the grains of the leaf, of which the part s is nearer to the
 * wall: p_E + s w + max((1 - s) w - p, 0), as p carries what lies above the
 * middle of the leaf. With an exact yield eta_f is mu_K and yield.tau_y is
 * p_E eta_S. Collective. */
void four_state_viscosity(struct four_state *sim, double *const u[]);
/* Set shear_f, on all faces. u filled. Collective. */
void four_state_shear(struct four_state *sim, double *const u[]);
/* Set a_f [nfaces_all] and thrust_f of a pressure p, filled. Collective. */
void four_state_face_acceleration(struct four_state *sim, const double *p,
                                  double *a_f);
/* Set a[d] [nleaves] of a_f and thrust_f. */
void four_state_acceleration(const struct four_state *sim, const double *a_f,
                             double *const a[]);
/* Set u_f [nfaces_all] to the mean of u, filled, and 0 on walls; faces of other
 * ranks are not set. */
void four_state_face_velocity(const struct four_state *sim, double *const u[],
                              double *u_f);
/* Advance u_f from F(u*) by dt a_f. Grains that set off from start_f = F(u^n)
 * as gravity pulls pass faces with the mean of both ends of the step, so that
 * free fall is exact: with the velocity of the end they fall by t dt g/2 too
 * far and lose that energy. All [nfaces_all]; a_f is 0 on walls, and faces of
 * other ranks are not set. */
void four_state_accelerate_faces(const struct four_state *sim, double dt,
                                 const double *a_f, const double *start_f,
                                 double *u_f);

#endif
