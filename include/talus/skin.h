/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Skin: the faces of the grains beside their surface, and derivatives along
 * them.
 *
 * The derivative of u along axis t at a face of axis d is the mean over four
 * lines, from each of its two nodes to both neighbours along t. Beside the
 * surface some of them end in gas, whose velocity does not continue that of
 * the grains. With the viscosity of the grains, which the face has, such a line
 * makes a stress that neither phase has, over one cell, whatever its size: at
 * the ends of the surface it leaves a force of eta du / 4. So at a face between
 * two heavy nodes, those with more mass of grains than of gas, whose velocity
 * is that of the grains, the lines between heavy nodes alone count:
 *   h du/dx_t = mean over these lines of their differences,
 * exact for grains that move linearly, whatever the gas does. Where there is
 * no such line, in a film one cell thick, the shear stress is 0.
 *
 * A dense square that moves through gas 1e5 times lighter (dense_square of
 * tests/convergence) changes its shape by 1.7e-3 of its area, with lines into
 * the gas by 2.3e-2.
 */
#ifndef TALUS_SKIN_H
#define TALUS_SKIN_H

#include <stdint.h>

#include "talus/mesh.h"

struct skin_face {
  int32_t face;
  int8_t axis;        /* of the face */
  uint8_t lines[DIM]; /* along each axis, in the order of skin_difference */
};

struct skin {
  int32_t n, room;
  struct skin_face *face; /* [n], those with lines to leave out; owned */
};

/* Owned by the caller. NULL is a skin without faces. */
struct skin *skin_new(void);
void skin_destroy(struct skin *skin);

/* Find the faces; c [ncells] filled, heavy where c > least. */
void skin_find(const struct mesh *mesh, const double *c, double least,
               struct skin *skin);

/* h du/dx_t at a face, t not its axis; 0 without a line. u filled. */
double skin_difference(const struct mesh *mesh, const struct skin_face *face,
                       int t, const double *u);

#endif
