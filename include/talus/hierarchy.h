/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Hierarchy: geometric multigrid on the tree, the preconditioner of the
 * Poisson and the viscous solver.
 *
 * Level l holds every node of level l of the tree: leaves of level l and
 * merged nodes; a leaf coarser than l is not copied. All nodes live in one
 * array of slots, level after level, within a level by child number, red ones
 * (even sum of integer coordinates) before black ones, each in Morton order.
 *
 * On a level lives the two-point operator
 *   (A e)_i = m_i e_i - sum_f w_if (e_n(f) - e_i),  w = alpha area / h,
 * for velocities with the stress of the transposed gradient added (viscous.h).
 * Beyond a face that touches a coarser leaf, n is a virtual child of that
 * leaf, interpolated linearly as on the mesh. Walls are in the diagonal; the
 * transposed gradient and the prolongation see images of the nodes inside,
 * times what the boundary condition makes of a correction (-1 at rest). The
 * coefficient of a merged node's side is the mean of its children's sides
 * (parallel conductors), so that coarse operators are the rediscretised ones;
 * at a wall of the children's sides in series with the opposite ones where that
 * is more (coefficients.c).
 *
 * One cycle approximates e = A^-1 r (r integrated over cells): on each level
 * from the finest, two sweeps of Gauss-Seidel from zero, virtual children
 * being 0, then
 *   r_parent = sum over children (r - A e),   r_coarse leaf += w e_fine
 * (conservative); conjugate gradients on the trees; on the way up
 *   e_child += e_P + 1/4 sum_d g_d (e_N(d) - e_P),  N the parent's neighbour
 *   on the child's side, beyond a wall its mirror image, and
 *   g = min(1, conductance across that side / across the faces inside P),
 * which keeps a stiff node from being strained by what is outside; and two
 * sweeps again, virtual children being valid by then. The colours are red and
 * black; for velocities, which are coupled across edges, each child number is
 * one. So the result depends on neither the order of nodes nor the number of
 * ranks.
 *
 * If the first cycle of a solve raises the maximum of the residual, as it does
 * where a coefficient jumps and the guess is poor, the other cycles sweep 20
 * times more over the nodes within 10 of a jump (rough.c). Poisson with 1 :
 * 1000 across a circle, to 1e-8 on levels 5 to 10: 6 to 10 iterations instead
 * of 9 to 18, at level 10 in 2/3 of the time; time steps of a collapse, whose
 * guesses are good, are as before.
 *
 * What was tried and left: g = 1 (a third more iterations in a collapse, and
 * stiff bodies do not converge next to walls), piecewise constant prolongation
 * (Poisson the same, viscous 10 % more iterations), linear restriction
 * (diverges beyond a contrast of 100), harmonic coarse coefficients (the same),
 * conductances over 1.5 h across jumps of level (10 % more), one sweep (30 %
 * more iterations for 25 % less time each), velocity components uncoupled
 * (twice the iterations, none converge at a contrast of 1e8 on fine grids). For
 * jumps: the sweeps near them in every solve (5 % fewer iterations in a
 * collapse at 1e-8, for twice the time), W cycles (8 to 13 on the levels
 * above), more sweeps on all coarser levels (8 to 13, and slower), coarse
 * conductances of half cells in series (10 to 24), g for each child, and above
 * 1 (the same). At walls: images of the nodes inside without the factor (15 to
 * 20 % more viscous iterations in a collapse).
 *
 * Parallel: the children of a node belong to the rank that holds the
 * Morton key of the node's first corner, whoever has the leaves; levels of few
 * nodes are gathered on rank 0. Message plans are made once.
 *
 * Sources: [brandt_1977] for the composite grid, [wesseling_1988] for
 * cell-centred transfer.
 */
#ifndef TALUS_HIERARCHY_H
#define TALUS_HIERARCHY_H

#include <stdint.h>

#include "talus/mesh.h"

struct hierarchy;

/* Make the levels above the leaves of `mesh`, which must outlive the hierarchy.
 * Build it anew when the mesh changes. The caller owns it. Collective. */
struct hierarchy *hierarchy_new(const struct mesh *mesh);
void hierarchy_destroy(struct hierarchy *hierarchy);

#endif
