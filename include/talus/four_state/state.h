/* SPDX-License-Identifier: GPL-3.0-or-later */
/* State of the four-state model: solid fraction, velocity and granular
 * temperature in leaves, all at the same time. */
#ifndef TALUS_FOUR_STATE_STATE_H
#define TALUS_FOUR_STATE_STATE_H

#include "talus/adapt.h"
#include "talus/four_state/keys.h"
#include "talus/four_state_closure.h"
#include "talus/granular_pressure.h"
#include "talus/grid.h"
#include "talus/model.h"
#include "talus/params.h"
#include "talus/scratch.h"
#include "talus/solve.h"
#include "talus/yield.h"

/* Stages of a step (step.c). */
enum four_state_stage {
  FOUR_STATE_CLOSURES,
  FOUR_STATE_VISCOUS,
  FOUR_STATE_PRESSURE,
  FOUR_STATE_TRANSPORT,
  FOUR_STATE_TEMPERATURE,
  FOUR_STATE_ADAPTATION,
  FOUR_STATE_OTHER,
  FOUR_STATE_NSTAGES
};

struct four_state {
  struct model model;
  const struct params *params;        /* borrowed */
  const struct four_state_keys *keys; /* borrowed */
  struct four_state_closure closure;
  struct grid grid; /* owned, as all below */

  /* State, kept over adaptation and restart */
  struct field *nu;         /* solid fraction */
  struct field *u[DIM];     /* velocity, m/s */
  struct field *trend[DIM]; /* du/dt of the last prediction, m/s^2 */
  struct field *T;          /* granular temperature, m^2/s^2 */

  /* Remade in every step */
  struct field *p, *p_E;    /* pressure, and by contact, Pa */
  struct field *weight;     /* nu, but nowhere 0: p is interpolated by it */
  struct field *mu_K;       /* kinetic viscosity, Pa s */
  struct field *lambda_K;   /* kinetic bulk viscosity, Pa s */
  struct field *upper[DIM]; /* part of the mass of a leaf that counts for its
                               upper face along an axis; properties.h */
  struct field *mobility_f; /* 1/(rho_d M) */
  struct field *thrust_f;   /* acceleration that surfaces add, m/s^2 */
  struct field *eta_f, *kappa_f; /* viscosities of faces, Pa s */
  struct field *shear_f;         /* shear rate at faces, 1/s */
  struct field *u_f, *flux;      /* face velocity, and nu_f times it, m/s */
  struct field *c;               /* what adaptation follows: nu over that of
                                    grains that touch, at most 1 */
  bool exact;                    /* the grains yield exactly, else by n */
  struct yield yield;
  struct skin *skin;      /* of leaves in which grains touch */
  struct field *touches;  /* how well they do, 1 within a bed */
  struct field *known[2]; /* nu and T of p, p_E, touches and skin */
  uint64_t known_on;      /* mesh of these, 0: p is another */
  struct field *still;    /* 1 in leaves at rest, 0 in those that move */
  struct scratch scratch;

  /* For output, on demand */
  struct field *contact, *name;

  double travel;    /* cells that grains may have moved since adaptation */
  double slow_time; /* that the grains have been slow, s */
  double scale;     /* speed that viscous tolerances refer to */
  struct granular_stats pressure;
  struct solve_stats viscous, conduction;
  double initial;    /* energy at t = 0, J/m (3D: J) */
  double changed;    /* that restarts with other conditions have added */
  double energy;     /* when the checkpoint was written */
  double dissipated; /* since the start, by friction and collisions */
  double impact;     /* work against pressure that is not stored (work.h) */
};

/* Prepare the closures for keys; refuses those that cannot be. The caller
 * releases it. */
void four_state_closures(const struct four_state_keys *keys,
                         struct four_state_closure *closure);
/* Make a state of zeros on a forest, which it takes over. Collective. */
struct four_state *four_state_new_on(const struct params *params,
                                     struct forest *forest);
void four_state_destroy(struct four_state *sim);
/* Make one round of adaptation; returns whether the grid has changed.
 * Collective. */
bool four_state_adapt(struct four_state *sim);
/* Is there anything to speak of in a leaf? */
static inline bool four_state_has_grains(const struct four_state *sim,
                                         int32_t i) {
  return sim->nu->v[i] >= sim->keys->nu_vacuum;
}

#endif
