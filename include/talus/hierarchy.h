/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Hierarchy: geometric multigrid on the trees, the preconditioner of
 * poisson_solve and viscous_solve.
 *
 * Nodes. Level l holds every cell of level l: its leaves, and merged nodes in
 * the place of finer leaves. A leaf coarser than l is not copied. All nodes
 * live in one array of slots, level after level, within a level by child
 * number, red ones (even sum of integer coordinates) before black ones, each
 * in Morton order.
 *
 * Operator. On each level lives the two-point operator
 *   (A e)_i = m_i e_i - sum_f w_if (e_n(f) - e_i),   w = alpha area / h,
 * to which velocities add the transposed gradient and the stress of the bulk
 * viscosity (viscous.h). Here m is the mass and n(f) the node beyond face f.
 * Where face f touches a coarser leaf, n is a virtual child of that leaf,
 * interpolated linearly as on the mesh. Walls are in the diagonal; the
 * transposed gradient and the prolongation see images of the nodes inside,
 * times the factor that the boundary condition makes of a correction (-1 at
 * rest).
 *
 * Coarser levels. A merged node has the mass of its children and, as parallel
 * conductors, the mean conductance of the children's sides, which is that of
 * the equation discretised anew. Walls and masses that jump are exceptions
 * (coefficients.c).
 *
 * Cycle. One cycle approximates e = A^-1 r, r integrated over cells:
 *   down  from the finest level: two sweeps of Gauss-Seidel from zero, virtual
 *         children being 0; then
 *         r_parent = sum over children (r - A e),   r_coarse leaf += w e_fine
 *   trees conjugate gradients
 *   up    e_child += e_P + 1/4 sum_d g_d (e_N(d) - e_P), then two sweeps,
 *         virtual children being known
 *
 * The restriction is conservative. In the prolongation P is the parent and N
 * its neighbour on the child's side, beyond a wall the image of P. The limit
 *   g = min(1, conductance of that side / conductance inside P)
 * keeps a stiff node from being strained by softer ones around it. A sweep
 * relaxes red nodes, then black ones. For velocities, which are coupled across
 * edges, each child number is a colour of its own; leaves beside the surface of
 * the grains have rows of their own (skin_nodes.c). The result does not depend
 * on the order of nodes, nor, but for a few of those rows, on the number of
 * ranks.
 *
 * Jumps. Where a coefficient jumps and the guess is poor, the first cycle of a
 * solve raises the maximum of the residual. The cycles after it then sweep more
 * often over the nodes near the jump (rough.c).
 *
 * Ranks. The children of a node belong to the rank that holds the Morton
 * position of the node's first corner, whoever has the leaves; levels of few
 * nodes are gathered on rank 0. Message plans are made once.
 *
 * docs/notes/solver.md has the trials. Sources: [brandt_1977] for the composite
 * grid, [wesseling_1988] for cell-centred transfer.
 */
#ifndef TALUS_HIERARCHY_H
#define TALUS_HIERARCHY_H

#include <stdint.h>

#include "talus/mesh.h"

struct hierarchy;

/* Make the levels above the leaves of `mesh`, which must outlive the hierarchy.
 * Build it anew when the mesh changes. The caller owns it. Collective. */
struct hierarchy *hierarchy_new(const struct mesh *mesh);
/* Follow mesh_renew_patches. Collective. */
void hierarchy_renew_patches(struct hierarchy *hierarchy);
void hierarchy_destroy(struct hierarchy *hierarchy);

#endif
