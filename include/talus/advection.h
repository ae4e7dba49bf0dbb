/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Bell-Colella-Glaz unsplit upwind advection of momentum.
 *
 * Velocity at faces and half steps, from the upwind cell
 * [bell_colella_glaz_1989; popinet_2003]:
 *   u^{n+1/2} = u + (h/2) (s - u_n dt/h) du/dn - dt/2 sum_t u_t d^up u/dt
 *               + dt/2 g,
 * s the sign of the face velocity u_n, t the directions along the face with
 * upwind differences, g the mean acceleration of the two cells. du/dn is
 * central, or limited where velocities are steep: with minmod a velocity that
 * is only carried, on one level, gets no new extrema, with the generalised form
 * next to none; but smooth ones are carried to order 1.6 instead of 2 (`make
 * convergence CASE=advection`, docs/notes/limiter.md). At fixed h the order in
 * dt is one, with an error h dt, as the derivatives in time are taken upwind.
 * Then u <- u - dt/h sum_d [u_f (u^{n+1/2} - u)]_d, which is the conservative
 * form as long as u_f is solenoidal, and keeps a uniform velocity with any u_f.
 */
#ifndef TALUS_ADVECTION_H
#define TALUS_ADVECTION_H

#include "talus/mesh.h"
#include "talus/params.h"

struct advection_work {
  enum limiter limiter;    /* of slopes; transverse terms need none */
  double *slope[DIM];      /* [>= nleaves + nghosts] differences along d */
  double *transverse[DIM]; /* [>= nleaves + nghosts] sum_t u_t d^up u/dt */
  double *flux[DIM];       /* [nfaces_all] */
  double *volume;          /* [nfaces_all] */
};

/* Set u_f [nfaces_all] to the normal velocity at faces and half steps (0
 * through walls, whose patches are closed). u[e], g[e] filled. closed
 * [MESH_MAX_PATCHES]. Collective. */
void advection_predict(const struct mesh *mesh, double dt, double *const u[DIM],
                       double *const g[DIM], const bool *closed,
                       struct advection_work *work, double *u_f);

/* Add -dt div(u_f u) to `out` [DIM][nleaves] with face values predicted from
 * u, g (filled); faces of the band are left out (momentum.h). band may be
 * NULL. Collective. */
void advection_momentum(const struct mesh *mesh, double dt,
                        double *const u[DIM], double *const g[DIM],
                        const double *u_f, const double *band,
                        struct advection_work *work, double *const out[DIM]);

#endif
