/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Projection: face velocities made divergence-free by a pressure.
 *
 *   div(alpha grad p) = div(u_f*) / dt,   u_f = u_f* - dt alpha grad p,
 *                                         [lagree_staron_popinet_2011,
 *                                          eqs. 2.11-2.13]
 * alpha = 1/rho on faces. MAC projection: u_f* is predicted at half steps.
 * Approximate projection: u_f* is the mean of the momentum of two cells over
 * the mean of density, plus gravity; a cell then receives the mean over its
 * faces of gravity - alpha grad p, so that a pressure that balances gravity
 * does so to round-off.
 *
 * With rho_f = (rho_0 + rho_1)/2 on faces, cells to faces by mean momentum and
 * faces to cells by the plain mean are adjoint to each other in the norm
 * sum rho u^2 / 2, so on one level the approximate projection adds no energy.
 * Over levels this asks that rho_f come from the leaves. A coarse leaf whose
 * density varies over its virtual children gives faces the velocity of the
 * leaf: with an interpolated velocity gas next to grains would move the mass of
 * the grains.
 */
#ifndef TALUS_PROJECTION_H
#define TALUS_PROJECTION_H

#include <stdbool.h>

#include "talus/mesh.h"
#include "talus/solve.h"

struct hierarchy;

struct projection {
  const struct mesh *mesh;
  struct hierarchy *hierarchy;
  const double *rho;       /* [ncells] density, filled */
  const double *alpha_f;   /* [nfaces_all], 0 on closed patches */
  const double *gravity_f; /* [nfaces_all], 0 on closed patches */
  const struct bc *bc;     /* of the pressure, [MESH_MAX_PATCHES] */
  double tolerance;        /* on max |div u_f| dt */
  int max_iterations;
  double *rhs;  /* [nleaves] scratch */
  double *flux; /* [nfaces_all] alpha grad p afterwards */
};

/* Project u_f [nfaces_all] in place; p [ncells] guess in, solution out. The
 * residuals of the result are max |div u_f| dt. Collective. */
struct solve_stats projection_project(const struct projection *projection,
                                      double dt, double *u_f, double *p);

/* Set u_f [nfaces_all] to the mean velocity of the nodes, weighted by density,
 * + dt gravity, and to the boundary value on closed patches. u[d] filled.
 * Collective. The plain mean would give a light cell's velocity half the say in
 * what the projection then makes a heavy one do: grains that move through gas
 * at rest would be thrown forward at their sides (test_step.c). */
void projection_face_velocity(const struct projection *projection, double dt,
                              double *const u[DIM], double *u_f);

/* Set g[d] [nleaves] to the mean over the faces of gravity - alpha grad p, from
 * the flux of the last projection; face [nfaces_all] scratch. */
void projection_acceleration(const struct projection *projection, double *face,
                             double *const g[DIM]);

#endif
