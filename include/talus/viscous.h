/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Implicit viscosity with the full stress tensor,
 *   rho u - theta dt div tau = rhs,   D = (grad u + grad u^T) / 2
 *   tau = 2 eta D + lambda (div u) I,   lambda = kappa - 2 eta / 3
 * with the shear viscosity eta and the bulk viscosity kappa. Without kappa the
 * second term is left out: the flow is incompressible.
 *
 * u lives at cell centres, eta, kappa and the stress at faces. On a face of
 * axis d with nodes 0 (lower) and 1 (upper) of the face's own level
 *   tau_dd = 2 eta (u_d1 - u_d0) / h + lambda div u
 *   tau_de = eta [(u_e1 - u_e0) / h + du_d/dx_e],   e != d
 *   div u  = (u_d1 - u_d0) / h + sum of du_e/dx_e over e != d
 *
 * In rings around an axis div u has u_r/r besides, the mean over both nodes,
 * and tau_tt = 2 eta u_r/r + lambda div u   pulls with - tau_tt/r, the mean
 * over the sides of a leaf.
 *
 * Derivatives along the face are the mean over both nodes of the central
 * difference, read from the stencil of face_owner. Each flux is computed once,
 * coarse sides take the mean: momentum balances to round-off. Linear velocities
 * give exact stresses across levels, rigid rotation none. Beside the surface of
 * the grains du_d/dx_e is one-sided (skin.h).
 *
 * Solved by GCR with a multigrid cycle inside (krylov.h, hierarchy.h). The
 * cycle relaxes all components together, transposed gradient and lambda
 * included: with components uncoupled, a stiff body is kept from rotating. The
 * case contrast of tests/convergence counts iterations: below 40 for a disc up
 * to 1e8 times stiffer or softer than what is around it.
 */
#ifndef TALUS_VISCOUS_H
#define TALUS_VISCOUS_H

#include "talus/hierarchy.h"
#include "talus/mesh.h"
#include "talus/skin.h"
#include "talus/solve.h"

/* Viscosities on faces, and what the stress leaves out. All borrowed. */
struct viscosity {
  const double *eta_f;     /* [nfaces_all] valid on all faces, >= 0, Pa s */
  const double *kappa_f;   /* likewise; NULL: no term with div u */
  const struct skin *skin; /* of the mesh; NULL: none */
};

/* Solve. Collective.
 *   rho      [nleaves] > 0
 *   theta_dt dt for backward Euler, dt / 2 for Crank-Nicolson, >= 0
 *   rhs[d]   [nleaves], kg/m^2/s
 *   bc[d]    [MESH_MAX_PATCHES] of u[d]
 *   tolerance  on max |residual / rho|, m/s
 *   u[d]     [ncells] in: guess on leaves; out: solution, all nodes filled
 * When not converged u holds the best iterate. */
struct solve_stats viscous_solve(const struct mesh *mesh,
                                 struct hierarchy *hierarchy, const double *rho,
                                 const struct viscosity *viscosity,
                                 double theta_dt, double *const rhs[DIM],
                                 const struct bc *const bc[DIM],
                                 double tolerance, int max_iterations,
                                 double *const u[DIM]);

/* Set force[d] [nleaves] to (div tau)_d, N/m^3; u[d] [ncells] filled.
 * Collective.
 */
void viscous_force(const struct mesh *mesh, const struct viscosity *viscosity,
                   double *const u[DIM], double *const force[DIM]);

#endif
