/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Poisson equation with variable coefficient, or with a mass that of Helmholtz,
 *   div(alpha grad p) - mass p = rhs.
 *
 * p lives at cell centres, mass with it, alpha at faces. The flux through a
 * face, F = alpha_f (p_upper - p_lower) / h, uses the two nodes of the face's
 * own level (face_node): on a coarse side the interpolated virtual child, at a
 * wall the boundary node. It is computed once per face, coarse sides take the
 * mean, so sum_i V_i (div F)_i = net flux through the boundary to round-off.
 * Second order, exact for linear p across levels (constant alpha).
 *
 * Solved by GCR with a multigrid cycle inside (krylov.h, hierarchy.h).
 * Without mass and without a Dirichlet or Robin face p is determined up to a
 * constant: the mean of the guess is kept, and a right-hand side whose mean is
 * neither below the tolerance nor round-off is refused (SOLVE_INCOMPATIBLE).
 */
#ifndef TALUS_POISSON_H
#define TALUS_POISSON_H

#include "talus/hierarchy.h"
#include "talus/mesh.h"
#include "talus/solve.h"

/* Solve. Collective.
 *   alpha_f  [nfaces_all] valid on all faces, >= 0 (0 on closed walls)
 *   mass     [nleaves] >= 0; NULL: none
 *   rho      [ncells] 1/alpha of cells, filled: by it p is interpolated to the
 *            children of coarse leaves (mesh_fill_potential); NULL: as if even
 *   rhs      [nleaves] density, not integrated
 *   bc       [MESH_MAX_PATCHES] of p
 *   tolerance  on max |rhs - div(alpha grad p) + mass p|
 *   p        [ncells] in: guess on leaves; out: solution, all nodes filled
 * Stats are in the units of the tolerance; when not converged p holds the
 * best iterate. */
struct solve_stats poisson_solve(const struct mesh *mesh,
                                 struct hierarchy *hierarchy,
                                 const double *alpha_f, const double *mass,
                                 const double *rho, const double *rhs,
                                 const struct bc *bc, double tolerance,
                                 int max_iterations, double *p);

/* Set flux [nfaces_all] to alpha dp/dn on all faces; p [ncells] filled.
 * Collective. */
void poisson_flux(const struct mesh *mesh, const double *alpha_f,
                  const double *p, double *restrict flux);

#endif
