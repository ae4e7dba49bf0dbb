/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Density, gravity and viscosity of the mixture from c, strain rate and p.
 *
 *   rho = c rho_1 + (1 - c) rho_2              [lagree_staron_popinet_2011,
 *   eta = 1 / (c/eta_1 + (1 - c)/eta_2)         eqs. 2.7, 2.8]
 * The density of a face takes for c the mean of the two nodes. The viscosity
 * of a face takes the part theta of the line between its nodes that lies
 * below the planes of the two leaves: phases in series, as a layer sheared
 * along its surface feels them. The mean of c would put gas between a cut
 * cell more than half full and the grains below it, and the top layer would
 * slide. eta of each phase comes from the face's own strain rate and pressure:
 *   shear_rate = sqrt(2 D:D), normal derivatives from the two nodes,
 *   tangential ones the mean of central differences at both; the pressure
 *   varies along the line as it does at rest, with slopes in proportion to
 *   the densities of the two halves; at a wall dp/dn = rho g_n.
 *
 * Gravity on faces is balanced by the pressure where the surface lies, not
 * where the face does. With p = p' + rho g.x the force that is left, -[rho]
 * (g.x_S) grad c with x_S on the surface, is a gradient for a surface at
 * rest, so it is discretised as the gradient of p is; in terms of p itself,
 *   a_f = g_d + (c_1 - c_0)/h [rho]/rho_f g.(x_f - x_S),
 * c_0, c_1 at the nodes of the face, x_f half-way between them, x_S the mean
 * of the centroids of the planes in its leaves. A flat bed tilted with its
 * gravity is then at rest to the accuracy of the planes.
 */
#ifndef TALUS_PROPERTIES_H
#define TALUS_PROPERTIES_H

#include <stdbool.h>

#include "talus/mesh.h"

struct phase;

/* Fractions below this count as gas for properties and refinement. */
#define PROPERTIES_GAS 1e-6

/* rho [nleaves] of leaves; alpha_f [nfaces_all] = 1/rho on faces, 0 on closed
 * patches. density[0]: grains, [1]: gas. c filled. Collective. */
void properties_density(const struct mesh *mesh, const double density[2],
                        const double *c, const bool *closed, double *rho,
                        double *alpha_f);

/* Gravity a_f on faces [nfaces_all], m/s^2, 0 on closed patches. c filled;
 * normal, plane: the planes of cut leaves (vof_reconstruct); alpha_f as
 * above. Collective. */
void properties_gravity(const struct mesh *mesh, const double density[2],
                        const double gravity[DIM], const double *c,
                        double *const normal[DIM], const double *plane,
                        const double *alpha_f, double *gravity_f);

/* shear_f [nfaces] = sqrt(2 D:D) on our own faces; u[e] filled. */
void properties_shear_rate(const struct mesh *mesh, double *const u[DIM],
                           double *shear_f);

/* eta_f [nfaces_all], Pa s. gas NULL: grains only. c, p filled; normal,
 * plane: the planes of cut leaves; shear_f as above; work: two scratch arrays
 * [nfaces]. Collective. */
void properties_viscosity(const struct mesh *mesh, const struct phase *grains,
                          const struct phase *gas, const double gravity[DIM],
                          const double *c, double *const normal[DIM],
                          const double *plane, const double *p,
                          const bool *closed, const double *shear_f,
                          double *const work[2], double *eta_f);

#endif
