/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Slip strip: a floor that is rough, but for a smooth strip ahead of the grains
 * that moves along with them [valette_2019, section 3.1 and fig. 2].
 *
 * Grains that advance over a rough floor must displace gas that sticks to it.
 * On a side with the boundary "slip_strip" the gas slips up to `length`, a few
 * grain diameters, ahead of the grains: a place of the floor is smooth if
 * the leaf on it holds no grains (c <= PARAMS_GAS) and one that holds some is
 * nearer than that, from edge to edge, so that at least the next place is
 * smooth. All others are rough; with an endless strip those below grains alone.
 * Grains themselves never slide without friction: a film of them would run
 * away.
 *
 * Places are squares of the finest level (or of the finest that makes no more
 * than SLIP_STRIP_PLACES). The smooth ones move with c from step to step. Their
 * faces belong to the patch of params.smooth, the others to that of their side.
 *
 * The floor is a function of c, so that a checkpoint need not hold it.
 */
#ifndef TALUS_SLIP_STRIP_H
#define TALUS_SLIP_STRIP_H

struct grid;
struct slip_strip;

enum { SLIP_STRIP_PLACES = 1 << 22 };

/* Let the floors of the grid, mesh and hierarchy, follow c [nleaves]; to be
 * called when c or the mesh have changed. Collective. */
void slip_strip_renew(struct grid *grid, const double *c);
void slip_strip_destroy(struct slip_strip *strip);

#endif
