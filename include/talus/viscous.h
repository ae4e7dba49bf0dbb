/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Implicit viscosity with the full stress tensor,
 *   rho u - theta dt div(2 eta D(u)) = rhs,   D = (grad u + grad u^T) / 2.
 *
 * u lives at cell centres, eta and the stress at faces. On a face of
 * direction d with nodes 0 (lower) and 1 (upper) of the face's own level
 *   tau_dd = 2 eta (u_d1 - u_d0) / h
 *   tau_de = eta [(u_e1 - u_e0) / h + du_d/dx_e],   e != d,
 * du_d/dx_e being the mean over both nodes of the central difference along e,
 * read from the stencil of face_owner. Each flux is computed once, coarse
 * sides take the mean: momentum balances to round-off. Linear velocities give
 * exact stresses across levels, rigid rotation none. Beside the surface of the
 * grains du_d/dx_e is one-sided (skin.h).
 *
 * Solved by GCR with a multigrid cycle inside. The cycle relaxes all
 * components together, transposed gradient included: with components
 * uncoupled, a stiff body is kept from rotating.
 *
 * Iterations from zero to 1e-8 of the first residual, no-slip unit box with
 * a disc of radius 1/4 (2D, levels 5 to 9; 2 to 10 more if the levels jump
 * around the disc), eta_disc / eta_around across and rho h^2 / (eta_soft dt)
 * down:
 *              1e8     1e4      1     1e-4    1e-8
 *   1        12-17   10-11   5-6     7-9    10-13
 *   1e-4     14-20   11-17   7-8     8-12   10-15
 */
#ifndef TALUS_VISCOUS_H
#define TALUS_VISCOUS_H

#include "talus/hierarchy.h"
#include "talus/mesh.h"
#include "talus/skin.h"
#include "talus/solve.h"

/* Solve. Collective.
 *   rho      [nleaves] > 0
 *   eta_f    [nfaces_all] valid on all faces, >= 0
 *   skin     of the mesh, or NULL
 *   theta_dt dt for backward Euler, dt / 2 for Crank-Nicolson, >= 0
 *   rhs[d]   [nleaves], kg/m^2/s
 *   bc[d]    [MESH_MAX_PATCHES] of u[d]
 *   tolerance  on max |residual / rho|, m/s
 *   u[d]     [ncells] in: guess on leaves; out: solution, all nodes filled
 * When not converged u holds the best iterate. */
struct solve_stats viscous_solve(const struct mesh *mesh,
                                 struct hierarchy *hierarchy, const double *rho,
                                 const double *eta_f, const struct skin *skin,
                                 double theta_dt, double *const rhs[DIM],
                                 const struct bc *const bc[DIM],
                                 double tolerance, int max_iterations,
                                 double *const u[DIM]);

/* Set force[d] [nleaves] to (div 2 eta D(u))_d; u[d] [ncells] filled.
 * Collective. */
void viscous_force(const struct mesh *mesh, const double *eta_f,
                   const struct skin *skin, double *const u[DIM],
                   double *const force[DIM]);

#endif
