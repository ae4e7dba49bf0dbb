/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Skin: the faces of the grains beside their surface, and derivatives along
 * them.
 *
 * The derivative of u along axis t at a face of axis d is the mean over four
 * lines: from each of the two nodes of the face to both neighbours along t.
 * Beside the surface some lines end in gas, whose velocity does not continue
 * the velocity of the grains. The face has the viscosity of the grains, so such
 * a line makes a stress that neither phase has: at the ends of the surface a
 * force of eta du / 4 is left, however small the cells.
 *
 * Therefore the lines have weights. A node with the fraction c has the part
 *   m = c / (c + (1 - c) rho_gas / rho_grains)
 * of its mass, and so of its velocity, from the grains. With m_k at the far end
 * of line k, and M the smaller m of the two nodes of the face,
 *   h du/dx_t = sum_k w_k du_k / sum_k w_k,   w_k = 1 - M (1 - m_k).
 * In grains (M = 1) lines into gas (m_k = 0) do not count: the derivative is
 * exact for grains that move linearly, whatever the gas does. In gas (M = 0)
 * all lines count. A film one cell thick has less than one whole line: its
 * shear stress is reduced by the factor sum_k w_k, down to 0. All of this is
 * continuous in c.
 *
 * The convergence case dense_square shows the effect (docs/notes/solver.md).
 */
#ifndef TALUS_SKIN_H
#define TALUS_SKIN_H

#include <stdbool.h>
#include <stdint.h>

#include "talus/mesh.h"

struct skin_face {
  int32_t face;
  int8_t axis;           /* of the face */
  int32_t node[DIM][4];  /* along each axis, the far ends of the lines */
  double weight[DIM][4]; /* along each axis, of the lines of nodes 0, 0, 1, 1
                           down and up; their sum is 1 */
  double part[DIM];      /* of the shear stress that is left, 1: all */
};

/* A leaf whose faces may be of the skin. */
struct skin_leaf {
  int32_t leaf;
  double grains[NSTENCIL]; /* m of its stencil */
};

struct skin {
  bool grains_only; /* w_k = (c c_k)^2 of both ends of line k, no stress is left
                       out: what grains do depends on grains alone, and traces
                       of them that a gas carries have nothing to say */
  double slight;    /* multigrid cycles leave out what is less than this part
                       of the diagonal; 0: nothing */
  int32_t n, room;
  struct skin_face *face; /* [n], those with weights; owned */
  int32_t nleaves, leaf_room;
  struct skin_leaf
      *leaf; /* [nleaves], all that are beside the surface; owned */
};

/* Give the weight of a line at a face between nodes of which the smaller part
 * of grains is `grains`, from a node with the part `near` to one with `far`. */
static inline double skin_weight(bool grains_only, double grains, double near,
                                 double far) {
  const double both = near * far;
  return grains_only ? both * both : 1 - grains * (1 - far);
}

/* Make a skin, owned by the caller. NULL is a skin without faces. */
struct skin *skin_new(void);
void skin_destroy(struct skin *skin);

/* Find the faces. c [ncells] filled; ratio: of the densities, gas / grains. */
void skin_find(const struct mesh *mesh, const double *c, double ratio,
               struct skin *skin);

/* Return h du/dx_t at a face, t not its axis. u filled. */
double skin_difference(const struct mesh *mesh, const struct skin_face *face,
                       int t, const double *u);

#endif
