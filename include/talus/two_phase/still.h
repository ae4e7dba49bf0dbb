/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Grains at rest under an exact yield (yield.h), and what the approximate
 * projection would make them feel.
 *
 * The viscous solve holds a plug at u* = 0; what the projection then adds is
 * dt (g^{n+1} - g^n), as p of a plug, which only the difference between its
 * wide and narrow gradients fixes, has not settled. It settles like diffusion
 * by h^2/4 a step, over N cells in N^2 steps, and shakes the plug meanwhile. So
 * leaves that are held, no wet side of them being at its yield stress, and
 * slower than a tenth of what gravity gives in a step,
 *   |u^n| < 0.1 dt |gravity|,
 * are still, and there
 *   the viscous solve takes g^n + b e^n, e^n = g^n - g^{n-1} + b e^{n-1}, b =
 *     0.9, the heavy ball of Polyak, so that p settles in about N steps;
 *   u^{n+1} = u* is kept;
 *   the predictor of advection knows what viscosity does, as they do not fall.
 * Grains that move are not still, whatever holds them together.
 */
#ifndef TALUS_TWO_PHASE_STILL_H
#define TALUS_TWO_PHASE_STILL_H

struct two_phase;

/* Find which leaves are still, for a step of dt. Collective. */
void still_find(struct two_phase *sim, double dt);
/* Forget the change of g. */
void still_forget(struct two_phase *sim);
/* Add to g, which is that of p^n, what is guessed of its change. */
void still_guess(struct two_phase *sim);
/* Count the change of g, over dt, from that of the solve to that of the
 * projection: before and after it is set. u [nleaves] lacks dt g in `before`
 * and has it from `after`. */
void still_before(struct two_phase *sim, double dt);
void still_after(struct two_phase *sim, double dt);

#endif
