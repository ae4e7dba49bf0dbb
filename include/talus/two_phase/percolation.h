/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Percolation: gas that grains enclose leaves through them.
 *
 * Dry grains let gas pass, a mixture of one velocity does not: gas between
 * grains that land and the floor, or between two blocks that meet, would stay
 * there, and as a film thinner than a leaf it is a lubricant. So after the
 * sweeps of a step such gas moves to the free gas. The face velocity
 *   w = grad psi,   div w = q,   w.n = 0 on walls,
 *   q = -min((1 - c)/(2 dt), (U + sqrt(|g| h))/h)  in enclosed leaves,
 *   q = +(1 - c) Q  in the free gas, Q such that the integral of q vanishes,
 * carries c, its tracers and the momentum near the surface over dt. U is the
 * largest speed of the grains around: a gap closes as fast as grains come, and
 * where grains rest, as fast as they would fall through a leaf. A leaf gives at
 * most the gas that w leaves in it, so that c stays in [0, 1]. Grains keep
 * their volume to round-off; a closed box stays solvable.
 *
 * Free gas: face-connected sets of leaves with c < PERCOLATION_PURE that reach
 * an open boundary; in a box without one the set of the lowest pressure that
 * has a tenth of the gas. Sets are found anew every PERCOLATION_EVERY steps, or
 * each step while there are sets that are not free; in other steps all leaves
 * with c < PERCOLATION_PURE count as free. The gas of a leaf meets the free gas
 * if a leaf of free gas is in its stencil or, as at the bottom of a valley, in
 * that of a face neighbour with c < 1/2. A leaf is enclosed if it is next to
 * grains, its gas does not meet the free gas, it is not at an open boundary,
 * and its pressure is above that of the free gas, both less the weight of the
 * gas (so a gap that opens is not sucked shut).
 *
 * The work of the weight of the grains on w is lost to the drag of the gas and
 * counts as dissipated. With the gas passing at speed w = |q| h under the
 * weight of the grains, Darcy's law w = K rho_1 |g|/eta_2 names the
 * permeability K that the flow stands for; w is set by the grid, not by the
 * grains.
 */
#ifndef TALUS_TWO_PHASE_PERCOLATION_H
#define TALUS_TWO_PHASE_PERCOLATION_H

#include <stdint.h>

struct two_phase;

/* Leaves with fewer grains hold nothing but gas. */
#define PERCOLATION_PURE 1e-3
/* Steps between two searches for sets of gas, and for the last traces. */
enum { PERCOLATION_EVERY = 8 };

/* Gas that has left through grains since t = 0. */
struct percolation {
  double volume;   /* m^DIM */
  double flow;     /* sum of volumes times their speeds, m^(DIM + 1)/s */
  int64_t pockets; /* sets of gas that is not free, when last searched for */
};

/* Let enclosed gas out over dt. After fractions_advance, whose sim->band it
 * uses; sim->p is of the last step. Nothing happens where the grains are not
 * permeable. Collective. */
void percolation_advance(struct two_phase *sim, double dt);

/* Return the permeability K above, m^2, a mean over all gas that has passed; 0:
 * none has. */
double percolation_permeability(const struct two_phase *sim);

#endif
