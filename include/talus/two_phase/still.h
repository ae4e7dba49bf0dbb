/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Grains that hardly move under an exact yield (yield.h), and what the
 * approximate projection would make them feel.
 *
 * It gives faces u_f = m(u* - dt g^n) + dt (a^n + alpha_f grad p^n) before
 * pressure, m the mean by mass, a = gravity_f - alpha_f grad p and g its mean
 * in a leaf, A(a). In a flow that goes on, it asks of u that div m(u) = -dt
 * div(a - m(g)), which is small where p is smooth, but does not vanish. Grains
 * that are held bear that: s makes up for p until it does. Grains at their
 * yield stress have no choice, and sink at a speed in proportion to dt.
 * Besides, m lets the gas blow into grains at rest with rho_gas/rho_grains of
 * its speed.
 *
 * Therefore the faces of slow grains are told of the change of p alone,
 *   u_f = (1 - w) [m(u* - dt g^n) + dt (a^n + alpha_f grad p^n)]
 *             + w [m_c(u*) + dt alpha_f grad p^n],
 * m_c the mean by mass with a gas that weighs nothing, and of leaves with
 * grains beside the face, c > min(0.01, rho_gas/rho_grains), w is the least
 *   w = max(0, 1 - |u^n|/(0.1 dt |gravity|)),
 * and at least 1 - c/(0.01 c') where that of the other leaf is c' > 100 c.
 * Grains that fall freely pass that speed in a tenth of a step. Of grains that
 * move it would leave odd and even pressures apart, which u does not feel.
 *
 * After the projection their c is carried by the solenoidal part of
 *   (1 - w) u_f^{n+1} + w m_c(u^{n+1}),
 * made so with a gas that weighs nothing, which vanishes where grains rest.
 *
 * Held grains, whose sides that are at their yield stress have less than a
 * hundredth of that of all, keep the velocity that their springs leave them,
 *   u^{n+1} = u* + (1 - w) dt (g^{n+1} - g^n),
 * under a gas only, as a single phase meets a new load in the new g first, and
 * the predictor of advection knows w times what viscosity did in the last step,
 * as grains at rest do not fall.
 */
#ifndef TALUS_TWO_PHASE_STILL_H
#define TALUS_TWO_PHASE_STILL_H

struct projection;
struct two_phase;

/* Set w of leaves and ghosts for a step of dt; 0 in gas. Collective. */
void still_find(struct two_phase *sim, double dt);
/* Change u_f [nfaces_all], the mean of u* - dt g, + dt gravity_f, at faces of
 * slow grains. rho [ncells]: density of m_c, filled, as p is.
 * Collective. */
void still_face_velocity(struct two_phase *sim,
                         const struct projection *projection, const double *rho,
                         double dt, double *u_f);
/* Let faces of slow grains have w of `slowly`, 1 - w of u_f. Collective. */
void still_blend(const struct two_phase *sim, const double *slowly,
                 double *u_f);
/* Take scratch for g [nleaves] of the viscous solve, and copy it there. */
void still_remember(struct two_phase *sim, double *g[DIM]);
/* Take from u^{n+1} of leaves that are held w times what the new g has added to
 * u*; g: of still_remember, gives its scratch back. Collective. */
void still_keep(struct two_phase *sim, double dt, double *const g[DIM]);

#endif
