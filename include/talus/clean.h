/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Cleaning: face velocities made solenoidal to round-off, without a solve.
 *
 * An iterative projection leaves a divergence of the size of its tolerance,
 * which VOF would turn into a drift of volume. Here every cell of the tree,
 * from the root down, shares the excess of its children out across the faces
 * between the children: with N_a the net outflow of child a, the smallest
 * change of the inner fluxes is dF_ab = psi_a - psi_b,   sum_b (psi_a - psi_b)
 * = -N_a, a Laplacian on the 2^DIM children, diagonal in the Walsh-Hadamard
 * basis with eigenvalues 2 x (number of set bits). A change of a face is shared
 * evenly by the finer faces that make it up. The trees of a brick pass on
 * their excess along the axes; the total leaves through the open boundaries.
 * The change is of the size of the divergence, cost O(leaves).
 */
#ifndef TALUS_CLEAN_H
#define TALUS_CLEAN_H

#include <stdbool.h>

#include "talus/mesh.h"

struct clean;

/* Make the tree above the leaves of `mesh`. Collective. */
struct clean *clean_new(const struct mesh *mesh);
void clean_destroy(struct clean *clean);

/* Make u_f [nfaces_all] solenoidal. open [MESH_MAX_PATCHES]: patches that
 * fluid may cross freely. Without any, the net flux through the boundaries
 * must vanish, and what it lacks stays in the first tree. Collective. */
void clean_face_velocity(struct clean *clean, const struct mesh *mesh,
                         const bool *open, double *u_f);

/* Make div u_f = source [nleaves], 1/s, whose integral must vanish where no
 * patch is open; NULL: 0. Collective. */
void clean_to_source(struct clean *clean, const struct mesh *mesh,
                     const bool *open, const double *source, double *u_f);

/* Return the largest |div u_f| over the leaves. Collective. */
double clean_divergence(const struct mesh *mesh, const double *u_f);

#endif
