/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Density, gravity and viscosity of the mixture from c, strain rate and p.
 *
 *   rho = c rho_1 + (1 - c) rho_2              [lagree_staron_popinet_2011,
 *   eta = 1 / (c/eta_1 + (1 - c)/eta_2)         eqs. 2.7, 2.8]
 *
 * Density of a face: the mean over its two leaves, over levels too, as a face
 * between light leaves may not be heavy (projection.h).
 *
 * Viscosity of a face: both phases in series along the line between its nodes,
 * as a layer sheared along its surface feels them,
 *   eta_f = 1 / (theta/eta_1 + (1 - theta)/eta_2),
 * theta the part of the line below the planes of the two leaves. (With the mean
 * of c, gas would lie between a cut leaf more than half full and the grains
 * below, and the top layer would slide.) A line starts in the phase that has
 * most of the mass of its leaf, for the velocity of the leaf is that of this
 * phase: at the surface if the centre is on the other side. Else cut leaves
 * less than half full would lie on a cushion of gas (docs/notes/surface.md).
 * Both parts of a line share the stress, each with a shear rate of its own.
 * eta_1 and eta_2 come from shear rate and pressure of the face itself:
 *   shear_rate = sqrt(2 D:D) (strain.h); the pressure varies along the line as
 * at rest, with slopes in proportion to the densities of the two halves; at a
 * wall dp/dn = rho g_n.
 *
 * Gravity of a face: such that the pressure balances it where the surface lies,
 * not where the face does. With p = p' + W, W = rho g.(x - Z), gravity less the
 * gradient of W is -[rho] g.(x_S - Z) grad c with x_S on the surface, which is
 * a gradient if the surface is at rest. So it is discretised as that of p is,
 * over levels too: a_f = ((W_1 - W_0) - [rho] g.(x_S - Z) (c_1 - c_0)) / (rho_f
 * h) from the nodes of the face, W and c filled as p is (mesh_fill_potential).
 * Away from the surface a_f = g_d. A flat bed at any angle with its gravity
 * then rests to round-off. Gravity along a periodic axis has no potential and
 * is added as a constant.
 *
 * x_S is the mean over the leaves of the face of the feet of their planes
 * (plane.h), or of those beside a leaf that has none. A leaf counts for
 * c (1.01 - c): a plane that comes or goes with the last of the grains or of
 * the gas moves nothing. By the even mean a leaf that took c = 3e-6 had half a
 * say, and one beside a film was driven by 0.45 g on a slope that holds 0.32 g
 * (docs/notes/yield.md).
 */
#ifndef TALUS_TWO_PHASE_PROPERTIES_H
#define TALUS_TWO_PHASE_PROPERTIES_H

#include <stdbool.h>

#include "talus/mesh.h"
#include "talus/skin.h"

struct phase;
struct rheology;

/* Set rho [nleaves], and alpha_f [nfaces_all] to 1/rho on faces, 0 on closed
 * patches. density[0]: grains, [1]: gas. c filled. Collective. */
void properties_density(const struct mesh *mesh, const double density[2],
                        const double *c, const bool *closed, double *rho,
                        double *alpha_f);

struct gravity {
  double bounded[DIM];  /* along axes that are not periodic, m/s^2 */
  double periodic[DIM]; /* along periodic axes */
  double origin[DIM];   /* Z, anywhere in the box */
  const double *rho;    /* [ncells] filled, by which p is; NULL: as if even */
  /* scratch [ncells]: W; g.(x_S - Z) and 1 in leaves with a surface, else 0;
   * with the leaves next to them, g.(x_S - Z) and what it counts */
  double *weight, *surface, *count, *near_surface, *near_weight;
};

/* Set gravity_f [nfaces_all] to a_f, m/s^2, 0 on closed patches. c filled;
 * normal, plane: the planes of cut leaves (vof_reconstruct); alpha_f as above.
 * Collective. */
void properties_gravity(const struct mesh *mesh, const double density[2],
                        const struct gravity *gravity, const double *c,
                        double *const normal[DIM], const double *plane,
                        const double *alpha_f, double *gravity_f);

/* Mix eta_f [nfaces] of the grains with that of the gas, in series on lines of
 * which the part theta_f lies in the grains; phase: grains, gas. */
void properties_mix(const struct mesh *mesh, double time,
                    const struct rheology *const phase[2],
                    const double *theta_f, const double *shear_f,
                    const double *p_f, double *eta_f);

/* Set eta_f [nfaces_all], Pa s, at a time, s. gas NULL: grains only. c, p
 * filled; normal, plane: the planes of cut leaves; shear_f: strain.h; work: two
 * scratch arrays [nfaces]. Collective. */
void properties_viscosity(const struct mesh *mesh, double time,
                          const struct phase *grains, const struct phase *gas,
                          const double gravity[DIM], const double *c,
                          double *const normal[DIM], const double *plane,
                          const double *p, const bool *closed,
                          const double *shear_f, double *const work[2],
                          double *eta_f);

/* Set theta_f, the part of the line of each face that lies in grains, and p_f,
 * the pressure at the face, Pa, both [nfaces]. c, p filled; normal, plane as
 * above. */
void properties_pressure(const struct mesh *mesh, const double density[2],
                         const double gravity[DIM], const double *c,
                         double *const normal[DIM], const double *plane,
                         const double *p, const bool *closed, double *theta_f,
                         double *p_f);

#endif
