/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Volume fractions of a simulation in time: c, its tracers, and the momentum
 * that rides with c near the interface (vof.h, momentum.h).
 *
 * A step up to the bound of Weymouth & Yue, 1/2 sum |u_f| A dt / V <= 1/2,
 * keeps all fractions in [0, 1]. A longer one nearly always does so too, for
 * only flow compressed along one axis, by as much as the excess, within a cell
 * that is about half full can overfill it. So it is taken whole first; should
 * a fraction come out of [0, 1], its sweeps are repeated in parts that keep to
 * the bound, all with the velocity u_f of the step.
 */
#ifndef TALUS_TWO_PHASE_FRACTIONS_H
#define TALUS_TWO_PHASE_FRACTIONS_H

struct two_phase;

/* c and tracers over dt, and u where c's sweeps carry it; u_old and its helper
 * nodes keep what u was. rate: largest 1/2 sum |u_f| A / V, 1/s; where rate dt
 * exceeds 1, as a restart with new conditions may have it, sweeps are in parts
 * from the first. fields_save has been called since u, c or tracers changed.
 * Collective. */
void fractions_advance(struct two_phase *sim, double dt, double rate);

/* Carry c and tracers, and u near the interface, with a face velocity over dt,
 * axis by axis, in an order that alternates from step to step. source
 * [nleaves]: div u_f, 1/s, of gas that comes or goes, NULL where it is
 * solenoidal; volumes are kept all the same. u, c and sim->band are filled.
 * Collective. */
void fractions_carry(struct two_phase *sim, double dt, const double *u_f,
                     const double *source);

/* Make the planes of c those of what it is now. c is filled. Collective. */
void fractions_update_planes(struct two_phase *sim);

/* c lags half a step behind `time`. The first call takes it to `time` with
 * the present velocity, in parts where c would leave [0, 1], so that it can be
 * measured; the second sets back what it was, to the last bit. In between it
 * takes an array of scratch. Nothing else of the state changes. Collective. */
void fractions_synchronise(struct two_phase *sim);
void fractions_desynchronise(struct two_phase *sim);
/* Copy tracer k as it is at `time` to value [nleaves]. The state stays as it
 * is; c may be synchronised or not. Collective. */
void fractions_read_tracer(struct two_phase *sim, int k, double *value);

#endif
