/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Viscous work: what viscosity takes from the grains, and from the gas.
 *
 *   grains: sum c rho_1 V dt v.(u^{n+1} - dt/2 (g + v))
 *   gas:    the same with (1 - c) rho_2
 * v is the acceleration that the viscous solve has made; the factor behind it
 * is the mean of the velocities before and after all forces of the step. The
 * energy dissipated is this with the sign changed, plus the work of boundaries
 * that move, 2 eta D n.u_wall A dt.
 *
 * The product 2 eta D:D at the start of a step is not what the solve takes
 * where eta and D change fast (docs/notes/viscous_work.md).
 */
#ifndef TALUS_TWO_PHASE_VISCOUS_WORK_H
#define TALUS_TWO_PHASE_VISCOUS_WORK_H

struct two_phase;

/* Add the work of a step of dt, which has its new u, g and viscous_g, to
 * energy.dissipated and energy.gas_dissipated. Collective. */
void viscous_work_add(struct two_phase *sim, double dt);

#endif
