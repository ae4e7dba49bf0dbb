/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Exact yield: grains that come to rest and stay there.
 *
 * Their stress is 2 eta D + s with a yield stress s that is a field on faces,
 *   |s| <= tau_y, and s = tau_y D/|D| where D does not vanish,  |T|^2 = T:T/2,
 * which is the same as s = P(s + 2 r D) for any r > 0, P the projection on
 * |s| <= tau_y. A step makes it so with one solve as a rule:
 *   D* = D^n + dt/dt_last (D^n - D^{n-1}), bounded, where the last two changes
 *        of D have the same direction; else D^n
 *   q  = s^n + 2 r D*,  m = min(1, tau_y/|q|)
 *   rho u - dt div(2 (eta + m r) D(u)) = rho (u + dt g) + dt div(m s^n)
 *   s^{n+1} = P(s^n + 2 r D(u))
 * and with a new D* = D(u) again, up to 32 times in all, while the stress that
 * this would exert at the same D differs from that of the solve,
 *   T = P(s^{n+1} + 2 r D) - m (s^n + 2 r D),
 *   mismatch = (sum |T| / sum tau_y) (sum |T|/(2 r) / sum |D|) > 0.0005,
 * sums over wet faces by volume, the second factor being 1 at most: where loads
 * come or change at once. In a flow the second factor is small, as springs
 * hardly move there, and at rest the first. D is that of u before the
 * projection, as the solve leaves it. Where it has left out a jolt, that of u^n
 * being larger by more than the rate of the flow and the double, m is that of
 * u^n instead: grains that land yield under the pressure of that step, and
 * would be held by it else.
 *
 * It is the method of multipliers [bermudez_moreno_1981] with one step of
 * Picard's in it. Grains at rest have D = 0 whatever r is: r is no viscosity,
 * only the stiffness r/dt of a spring that holds them while s builds up. It is
 *   r = tau_y/(gamma_r + G),  gamma_r = 5e-4 max(R/10, min(R, F)),
 *   R = max(sqrt(g/H), U/L),  F = sum tau_y |D^n|^2 / sum tau_y |D^n|,
 * H = max tau_y/(rho_1 g), U the largest speed, L the length of the domain, F
 * the rate where grains flow, sums over wet faces by volume, and G the mean
 * |D^n| around the face. Springs get stiffer as a flow dies, for a soft one
 * rings before it holds. Grains that flow past a face in which D happens to
 * vanish need no spring so stiff: alone among soft faces, it would cost the
 * solver many iterations.
 *
 * D is that of a flow that keeps its volume, or its deviator where grains
 * change theirs. A model sets eta and tau_y of faces and what the struct below
 * borrows. */
#ifndef TALUS_YIELD_H
#define TALUS_YIELD_H

#include <stdbool.h>

#include "talus/field.h"
#include "talus/strain.h"

struct params;
struct scratch;
struct skin;

struct yield {
  /* Borrowed */
  struct mesh *const *mesh;  /* that of the fields */
  struct scratch *scratch;   /* nrows + 1 arrays on faces */
  struct skin *const *skin;  /* beside the surface (skin.h); NULL: none */
  const struct field *eta;   /* plastic viscosity of faces, Pa s, filled */
  const struct field *shear; /* sqrt(2 D:D) of u^n on faces, 1/s */

  bool compressible;            /* D is the deviator */
  int nrows;                    /* of the tensors below (strain.h) */
  struct field *s[STRAIN_ROWS]; /* yield stress, Pa; kept */
  struct field *strain[STRAIN_ROWS], *trend[STRAIN_ROWS]; /* D, 1/s, and its
                                  change, 1/s^2; kept */
  struct field *tau_y;                                    /* Pa; kept */
  struct field *still; /* 1 in leaves at rest, 0 in those that move
                          (two_phase/still.h) */
  struct field *state; /* yield_state of snapshots, on demand */
  double gamma_r;      /* 5e-4 R, 1/s */
  int misfits;         /* steps whose solves ended above 0.02 */
};

/* Add the fields that are kept, on *mesh. */
void yield_add(struct yield *yield, struct fields *fields,
               struct mesh *const *mesh, bool compressible);
/* Return the least shear rate, 1/s, that closures are to be asked for, for a
 * flow whose fastest speed is `speed`, m/s. */
double yield_least_rate(const struct params *params, double speed);
/* Set gamma_r from tau_y of grains of a density less buoyancy, kg/m^3, and the
 * fastest speed of all ranks. Collective. */
void yield_set_rate(struct yield *yield, const struct params *params,
                    double density, double speed);
/* Let D and s be those of the velocity u that a run begins with, which is
 * filled; after yield_set_rate. Collective. */
void yield_start(const struct yield *yield, double *const u[DIM]);
/* Set r [nfaces_all], the viscosity eta [nfaces_all] of a solve over dt and the
 * force div(m s^n) that it needs besides, force[e] [nleaves]. Collective. */
void yield_linearise(const struct yield *yield, double dt, double *r,
                     double *eta, double *const force[DIM]);
/* Return whether the stress at face f of axis d has reached a yield stress. */
bool yield_is_reached(const struct yield *yield, int d, int32_t f);
/* Set state [nleaves] to the part of the sides of a leaf whose stress has
 * reached the yield stress: 0 where grains are held, 1 where they flow, 0 where
 * grains fill less than half, part [nleaves]. Collective. */
void yield_find_state(const struct yield *yield, const double *part,
                      double *state);
/* Take D of the solution u, which is filled, and the stress that goes with it;
 * r, eta: of yield_linearise. again: the step has had a solve before. Returns
 * the mismatch, 0 of a flow that goes on. Collective. */
double yield_advance(const struct yield *yield, double dt, const double *r,
                     const double *eta, double *const u[DIM], bool again);
/* Return whether so many solves of a step, the last of which has left this
 * mismatch, are enough: it is at most 0.0005, or they are 32. In the second
 * case run.log has it, and above 0.02 the user is told, once in a run. */
bool yield_fits(struct yield *yield, long long step, int solves,
                double mismatch);

#endif
