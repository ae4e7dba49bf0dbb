/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Volume fractions in time: c, the tracers, and the momentum that rides with c
 * near the surface. One sweep an axis, in an order that turns from step to
 * step: c <- c - dt/h [F]_d + cc dt/h [u_f]_d                          (vof.h)
 *   rho u <- rho u - dt/h [M u^up]_d + rho_cc u^n dt/h [u_f]_d     (momentum.h)
 * In 3D the vertical axis, that of gravity, comes first and last by turns, and
 * the other two in both orders, from the same start: the mean of c and of rho u
 * goes on, so that a flow that is the same in both stays so.
 *
 * A step up to the bound of Weymouth & Yue, 1/2 sum |u_f| A dt / V <= 1/2,
 * keeps all fractions in [0, 1]. Nearly always a longer step does so too: to
 * overfill a leaf, the flow within it must be compressed along one axis by as
 * much as dt exceeds the bound, and the leaf must be about half full. So a step
 * is taken whole first; where a fraction comes out of [0, 1], the sweeps are
 * repeated in parts that keep to the bound, all with the u_f of the step.
 */
#ifndef TALUS_TWO_PHASE_FRACTIONS_H
#define TALUS_TWO_PHASE_FRACTIONS_H

struct two_phase;

/* Advance c and tracers over dt with sim->u_f, and u in the band, which is set;
 * u_old becomes u as it was, filled. rate: largest 1/2 sum |u_f| A / V, 1/s;
 * where rate dt exceeds 1, as after a restart with new conditions, sweeps are
 * in parts at once. fields_save must have been called since u, c or a tracer
 * changed. Collective. */
void fractions_advance(struct two_phase *sim, double dt, double rate);

/* Sweep c and tracers, and u in the band, over dt with a velocity on faces that
 * may have a source [nleaves] = div u_f, 1/s, of gas that comes or goes; NULL:
 * it is solenoidal. Volumes of grains are kept in either case. u, c and
 * sim->band are filled. Collective. */
void fractions_carry(struct two_phase *sim, double dt, const double *u_f,
                     const double *source);

/* Make the planes of c anew if c has changed since. c is filled. Collective. */
void fractions_update_planes(struct two_phase *sim);

/* Bring c, which lags half a step behind `time`, to `time` with the present
 * velocity, so that it can be measured, and set it back to the last bit. In
 * between one array of scratch is taken; nothing else of the state changes.
 * Collective. */
void fractions_synchronise(struct two_phase *sim);
void fractions_desynchronise(struct two_phase *sim);
/* Copy tracer k as it is at `time` to value [nleaves]. The state stays as it
 * is, and c may be synchronised or not. Collective. */
void fractions_read_tracer(struct two_phase *sim, int k, double *value);

#endif
