/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Energy that a restart with other conditions brings, such as another gravity:
 * the scheme has neither made nor lost it, so a model books it apart. */
#ifndef TALUS_CHANGED_ENERGY_H
#define TALUS_CHANGED_ENERGY_H

/* Return the energy now less that of the checkpoint, J/m (3D: J), and say so in
 * the log; 0 where both agree but for the order of sums, which hangs on the
 * number of ranks. */
double changed_energy(double checkpoint, double now);

#endif
