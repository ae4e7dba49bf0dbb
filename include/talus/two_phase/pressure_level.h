/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The constant that a box without an opening leaves free in the pressure.
 *
 * Closures need p, not only its gradient, so the case gives it somewhere:
 *   PRESSURE_AT_GAS    mean of p - rho_2 g.(x - Z) over leaves that hold gas
 *                      only, Z the highest corner of the box
 *   PRESSURE_AT_POINT  value at x, linear in the leaf that holds x
 *   PRESSURE_AT_BOX    mean over the box
 * The mean over the box contains the weight of the grains, about rho g H/2
 * times the part of the box that they fill, and changes as they fall: a column
 * that collapses is then too stiff or too loose throughout. Gas is under one
 * pressure but for its own weight; with that taken off, a closed box is one
 * that is open at the top with the same pressure. Even the weight of the gas
 * counts, as a front is thin (docs/notes/pressure_level.md).
 */
#ifndef TALUS_TWO_PHASE_PRESSURE_LEVEL_H
#define TALUS_TWO_PHASE_PRESSURE_LEVEL_H

struct two_phase;

/* Add to p on leaves the constant that the case asks for; do nothing where a
 * boundary sets the pressure. Where no leaf holds gas only, the gas in mixed
 * leaves counts, and without any gas the mean over the box, with a warning. p
 * is left valid on leaves only. Collective. */
void pressure_level_set(struct two_phase *sim);

#endif
