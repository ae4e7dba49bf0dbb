/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Pressure of grains that are compressible, together with their mass.
 *
 *   nu^{n+1} + dt div(nu_f u_f) = nu^n,   p = P(nu^{n+1})
 *   u_f = u_f* - dt m_f grad(p - p^n)
 *
 * with P a rising function of nu in each leaf, m_f the mobility 1/(rho M) of a
 * face and nu_f the donor's nu there, with a limited slope. Newton's method in
 * q, the change of p: with R the residual of the first equation,
 *
 *   div(alpha grad q) - q/P' = R,   alpha = dt^2 m_f d(nu_f u_f)/d(u_f)
 *
 * symmetric and an M-matrix, solved by poisson_solve. Where q < 0 grains
 * expand and nu <- nu + q/P'; where q > 0 they are compressed and nu <- P^-1(p
 * + q): P is convex, so nu never crosses a pole and no damping is needed. Where
 * grains begin to touch, P' is 0 and rises with a power of p: then p grows by a
 * factor per iteration only, and P' is taken ahead (`ahead`); as R vanishes it
 * is P' of nu again. After the last solve of a step granular_carry takes nu
 * from the fluxes, so that mass is kept to round-off.
 */
#ifndef TALUS_GRANULAR_PRESSURE_H
#define TALUS_GRANULAR_PRESSURE_H

#include <stdbool.h>

#include "talus/mesh.h"
#include "talus/solve.h"

struct hierarchy;
struct scratch;

/* Tells what grains are made of, leaf by leaf. */
struct granular_material {
  const void *context;
  /* Return P(nu), Pa, and its slope. */
  double (*pressure)(const void *context, int32_t leaf, double nu,
                     double *slope);
  /* Return the nu of a pressure p above that of `from`, which lies below
   * `guess`. */
  double (*solid_fraction)(const void *context, int32_t leaf, double p,
                           double from, double guess);
};

/* Tells what passes faces where a surface cuts leaves. */
struct granular_surface {
  const void *context;
  /* Return nu of what passes face f of axis d with u_f over dt; otherwise:
   * what a leaf without a surface would let through. */
  double (*passing)(const void *context, int d, int32_t f, double dt,
                    double u_f, double otherwise);
};

struct granular_pressure {
  const struct mesh *mesh;
  struct hierarchy *hierarchy;
  struct granular_material material;
  const double *mobility_f; /* [nfaces_all] m_f, m^3/kg, 0 on closed patches */
  const double *nu_old;     /* [ncells] nu^n, filled */
  const double *p_old;      /* [ncells] p^n, filled as p will be */
  const double *rho;        /* [ncells] filled, > 0: by it p is interpolated to
                               the children of coarse leaves
                               (mesh_fill_potential) */
  double least_slope;       /* of P that is taken for P', Pa, > 0 */
  double ahead;             /* part of the rise of p that would hold R of a leaf
                               back alone, by which P' is taken ahead where
                               grains are compressed; 0: P' of nu */
  double tolerance;         /* on max |R|; round-off passes */
  int max_newton, max_iterations;
  bool guessed; /* nu and p are near the solution; else it begins with those of
                   before */
  const struct granular_surface *surface; /* NULL: none */
  double *slope[DIM];                     /* [>= nleaves + nghosts] scratch */
  double *change, *mass, *rhs;            /* [ncells] scratch */
  double *u_start, *alpha;                /* [nfaces_all] scratch */
};

/* Take the scratch of `by` from a pool, for `taker` to give back. */
void granular_pressure_take(struct granular_pressure *by,
                            struct scratch *scratch, const char *taker);

struct granular_stats {
  int newton;          /* iterations */
  int iterations;      /* of the linear solver, over all of them */
  int most_iterations; /* in one of them */
  double residual;     /* max |R| at the end */
  enum solve_status status;
};

/* Find nu, p, u_f and the flux nu_f u_f at the end of dt, P(nu) = p.
 *   u_f   [nfaces_all] in: u_f*; out: with the new pressure
 *   p     [ncells] in: a guess, if by->guessed; out: P(nu), filled
 *   nu    [nleaves] in: a guess likewise; out: that of p
 *   flux  [nfaces_all] out: nu_f u_f, valid on all faces
 * Collective. */
struct granular_stats granular_pressure_solve(
    const struct granular_pressure *by, double dt, double *u_f, double *p,
    double *nu, double *flux);

/* Set nu [nleaves] to what the flux makes of nu_old over dt. */
void granular_carry(const struct mesh *mesh, double dt, const double *nu_old,
                    const double *flux, double *nu);

/* Set limited differences of v along d over a leaf, and fill their ghosts.
 * slope [>= nleaves + nghosts]; v filled. Collective. */
void granular_slopes(const struct mesh *mesh, int d, const double *v,
                     double *slope);
/* Return the value of v that passes a face of axis d with the velocity u_f over
 * dt: that of the donor at the face, half a step earlier. slope: along d. */
double granular_donor(const struct mesh *mesh, int32_t f, double dt, double u_f,
                      const double *v, const double *slope);

#endif
