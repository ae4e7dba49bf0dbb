/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Pressure of a step, and what it makes of velocities; step.c has the formulas,
 * projection.h the equation. */
#ifndef TALUS_TWO_PHASE_PRESSURES_H
#define TALUS_TWO_PHASE_PRESSURES_H

#include "talus/mesh.h"
#include "talus/solve.h"

struct params;
struct two_phase;

/* Fill p as its solve does. The density is filled. Collective. */
void pressures_fill(struct two_phase *sim);
/* Find g[d] [nleaves] of the last pressure with the present density, gravity
 * and boundaries. Collective. */
void pressures_acceleration(struct two_phase *sim, double *const g[DIM]);
/* Renew g in leaves that hold grains, so that the viscous solve sees nearly the
 * g that the projection will find. Gas keeps its g: where grains have just
 * left, their pressure would accelerate gas far too much. Collective. */
void pressures_renew(struct two_phase *sim);
/* Make u_f [nfaces_all] solenoidal by a projection over dt, with a pressure
 * that starts from 0, and to round-off by cleaning. Collective. */
struct solve_stats pressures_solenoidal(struct two_phase *sim, double dt,
                                        double *u_f);
/* Find p, u_f and u at the end of the step; k counts repetitions. Collective.
 */
void pressures_project(struct two_phase *sim, double dt, int k);
/* Find pressure and acceleration of the grains at rest, without viscosity, to
 * round-off. Collective. */
struct solve_stats pressures_start(struct two_phase *sim);
/* Return the tolerance of the velocity that carries c: its errors move grains
 * at rest. */
double pressures_carrying_tolerance(const struct params *params);

#endif
