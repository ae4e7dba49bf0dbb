/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Velocities of grains after friction, before the pressure of the new step:
 *   rho_d nu u* - dt div tau(u*) = rho_d nu (u^n + dt A(a_f)),
 *   u* <- u* - dt A(a_f)
 * with A of properties.h. tau is that of eta_f and kappa_f of properties.h, or
 * with an exact yield that of yield.h, |s| <= eta_S p_E, which is that of the
 * deviator of D. eta_f is that of gamma of the guess
 *   u^n + dt du/dt,   du/dt = (u* - u^(n-1))/dt_old
 * with the right hand side and dt of the last step, before A was taken off. The
 * solve begins with it, too: one finds friction as well as two after each other
 * do that begin with gamma of u^n, which alone lags (docs/notes/four_state.md).
 * du/dt of the whole step would have the noise of its pressure. */
#ifndef TALUS_FOUR_STATE_VELOCITIES_H
#define TALUS_FOUR_STATE_VELOCITIES_H

struct four_state;

/* Find u*, a_f [nfaces_all] of the pressure p, and start_f [nfaces_all], which
 * is F(u^n). Collective. */
void four_state_predict(struct four_state *sim, double dt, double *a_f,
                        double *start_f);
/* Let what p and weight give the leaves of still grains cancel with what they
 * give the face: F(u*) of grains that friction holds lacks dt F A a_f, and dt
 * (a_f - F A a_f) would go through their faces. By the part
 *   1 - |u^n|/(0.1 dt |g|) >= 0
 * of the leaf that moves more, and as well as its grains touch. u_f
 * [nfaces_all] is F(u*) before dt a_f. Collective. */
void four_state_hold(struct four_state *sim, double dt, const double *a_f,
                     double *u_f);
/* Give leaves without grains the velocity of the grains around them, for
 * differences across the surface, and fill u. nu is filled. Collective. */
void four_state_calm(struct four_state *sim);

#endif
