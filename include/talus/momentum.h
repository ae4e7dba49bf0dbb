/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Momentum carried with the volume fraction near the surface.
 *
 * In leaves near the surface (the band) the momentum rho u rides in the
 * sweeps of vof.h, with the mass flux that moves c:
 *   M = rho_1 F + rho_2 (u_f - F),
 *   rho* u* = rho u - dt/h [M u^up]_d + rho_cc u_0 dt/h [u_f]_d,
 *   rho* = rho - dt/h [M]_d + rho_cc dt/h [u_f]_d,
 * rho_cc the density of cc and u_0 the velocity before the first sweep, so
 * that these terms add up to zero over the axes; u^up is the upwind velocity
 * with a limited slope. Cut leaves have no slope: nearly all grains of a leaf
 * may go in one sweep, and the rest must keep a velocity between those of the
 * neighbours. A uniform velocity is kept to round-off whatever the density
 * ratio. A face next to a leaf of the band carries this one flux. A pure leaf
 * on the other side takes it as u* = u - dt/(h rho) [M u^up - M u]_d, and the
 * Bell-Colella-Glaz step (advection.h) serves the other faces of the pure leaf,
 * so that momentum crosses each face once.
 */
#ifndef TALUS_MOMENTUM_H
#define TALUS_MOMENTUM_H

#include "talus/mesh.h"

/* Set band [ncells] to 1 in leaves with anything but one pure phase in their
 * stencil and in rings - 1 layers of leaves around them, else to 0; it is
 * filled, helper nodes made from a leaf of the band being > 0. A ring is as far
 * as the surface may move in the sweeps along all axes, each of less than a
 * cell. c filled. Collective. */
void momentum_mark_band(const struct mesh *mesh, const double *c, int rings,
                        double *band);
/* Does the face carry momentum in the sweeps? */
static inline bool momentum_face_in_band(const struct mesh *mesh,
                                         const double *band, int32_t face) {
  const int32_t *leaf = mesh->face_leaf[face];
  return (leaf[0] >= 0 && band[leaf[0]] > 0) ||
         (leaf[1] >= 0 && band[leaf[1]] > 0);
}

struct momentum_flux {
  double *mass;         /* [nfaces_all] M, kg/m^2/s, 0 out of the band */
  double *carried[DIM]; /* [nfaces_all] M u^up */
  double *slope[DIM];   /* [>= nleaves + nghosts] scratch */
};

/* Find the fluxes of the sweep along d. c before the sweep; flux: of c
 * (vof_flux); u[e] filled. Collective. */
void momentum_flux(const struct mesh *mesh, int d, double dt,
                   const double density[2], const double *u_f, const double *c,
                   const double *flux, const double *band, double *const u[DIM],
                   struct momentum_flux *out);

/* Update of u in the leaves the fluxes touch. c_old: before the sweep;
 * u_start: before the first; density[0]: grains, [1]: gas. */
void momentum_update(const struct mesh *mesh, int d, double dt,
                     const double density[2], const double *u_f,
                     const double *c_old, const double *cc, const double *band,
                     double *const u_start[DIM],
                     const struct momentum_flux *flux, double *const u[DIM]);

#endif
