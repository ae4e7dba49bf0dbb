/* SPDX-License-Identifier: GPL-3.0-or-later */
/* VOF: geometric transport of a volume fraction.
 *
 *   dc/dt + div(c u) = 0                       [lagree_staron_popinet_2011,
 *                                               eq. 2.6]
 * One sweep along axis d [weymouth_yue_2010]:
 *   c <- c - dt/h [F]_d + cc dt/h [u_f]_d,   [v]_d = v(upper) - v(lower),
 * F the part of the volume u_f dt that the plane n.x <= alpha of the upwind
 * leaf fills, cc = 1 where c > 1/2 before the first sweep, else 0. After all
 * axes the cc terms add up to cc dt div(u), zero to round-off when u_f has
 * been cleaned (clean.h): volume is kept without clipping. c stays in [0, 1]
 * for 1/2 sum |u_f| A dt / V <= 1/2. Beyond that bound a leaf in which the flow
 * is compressed along one axis may come out too full or too empty (vof_excess).
 *
 * In rings around an axis (mesh.h) planes lie in (r, z), c and F are parts of
 * the volumes that they sweep around it (ring.h), and what a radial face lets
 * through is as deep as its volume asks for: so c stays in [0, 1] at the axis
 * too, where half of a leaf's area is a quarter or three quarters of its
 * volume.
 *
 * c lives in cells; normals and alpha in leaves and ghosts, in units of the
 * leaf (plane.h); F on faces, m/s.
 */
#ifndef TALUS_VOF_H
#define TALUS_VOF_H

#include <stdbool.h>

#include "talus/field.h"

/* A leaf is cut by the surface when c lies strictly between these. */
#define VOF_EMPTY 1e-12
/* Up to this 1/2 sum |u_f| A dt / V a sweep keeps c in [0, 1]. */
#define VOF_CFL 0.5
static inline bool vof_is_cut(double c) {
  return c > VOF_EMPTY && c < 1 - VOF_EMPTY;
}

/* Find the planes of all cut leaves, and of ghosts: normal[DIM] and alpha, each
 * [>= nleaves + nghosts]. c must be filled. Collective. */
void vof_reconstruct(const struct mesh *mesh, const double *c,
                     double *const normal[DIM], double *alpha);

/* Find the plane of one leaf from the leaves, ghosts and averages in its filled
 * stencil; virtual children and boundary nodes only help to find a start. Exact
 * for a plane surface. */
void vof_plane(const struct mesh *mesh, const double *c, int32_t leaf,
               double n[DIM], double *alpha);

/* Return the part of the box lo <= x <= hi of a leaf, in its edges from its
 * centre, with n.x <= alpha, by volume. */
double vof_part(const struct mesh *mesh, int32_t leaf, const double n[DIM],
                double alpha, const double lo[DIM], const double hi[DIM]);

/* Return the part of the volume swept through face f of axis d, `swept` edges
 * of it deep, that the plane of its leaf `upwind` fills, 0 lower, 1 upper. The
 * leaf may be twice as large as the face: then the face's part of it is one of
 * its children. */
double vof_swept(const struct mesh *mesh, int d, int32_t face, int upwind,
                 double swept, double *const normal[DIM], const double *alpha);

/* Find the fluxes F of c through the faces of axis d; flux [nfaces_all] is
 * valid on all of them afterwards. u_f [nfaces_all], m/s; c filled. open
 * [MESH_MAX_PATCHES]: patches through which only gas flows in, for the grains
 * at them are not mirrored there; NULL: none. Collective. */
void vof_flux(const struct mesh *mesh, int d, double dt, const double *u_f,
              const bool *open, const double *c, double *const normal[DIM],
              const double *alpha, double *flux);

/* Set cc [nleaves] to 1 where c > 1/2, else to 0. */
void vof_freeze(const struct mesh *mesh, const double *c, double *cc);

/* Update c by the sweep along d. c [nleaves] in/out. */
void vof_update(const struct mesh *mesh, int d, double dt, const double *u_f,
                const double *flux, const double *cc, double *c);

/* Carry a volume fraction to new leaves (remap.h): a divided leaf is cut by its
 * plane, merged ones take the mean, so that volume is conserved. */
extern const struct field_rule vof_rule;

/* Return how far c lies out of [0, 1] in the leaves of this rank. */
double vof_excess(const struct mesh *mesh, const double *c);

#endif
