/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Viscous work: what viscosity takes from the grains, and from the gas.
 *
 *   sum c rho_1 V dt v.(u^{n+1} - dt/2 (g + v)),
 * v the acceleration that the solve has made, times the mean of the velocities
 * before and after all forces of the step; of the gas with (1 - c) rho_2. With
 * the work of boundaries that move, 2 eta D n.u_wall A dt, it is dissipated.
 *
 * eta 2 D:D at the start of a step is not what the solve takes where they
 * change fast, beside a moving surface most: by that, -0.003, -0.05, -0.18 of
 * the 19.6 of `column` were missed at levels 9, 10, 11.
 */
#ifndef TALUS_TWO_PHASE_VISCOUS_WORK_H
#define TALUS_TWO_PHASE_VISCOUS_WORK_H

struct two_phase;

/* Add the work of a step of dt, which has its new u, g and viscous_g, to
 * energy.dissipated and energy.gas_dissipated. Collective. */
void viscous_work_add(struct two_phase *sim, double dt);

#endif
