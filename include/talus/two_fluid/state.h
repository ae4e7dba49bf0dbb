/* SPDX-License-Identifier: GPL-3.0-or-later */
/* State of the two-fluid model: solid fraction and the velocities of grains (s)
 * and fluid (f) in leaves, all at the same time.
 *
 * Pressure p is that of the fluid less rho_f g.x: a fluid at rest has p = 0
 * everywhere, and grains at rest in it too. */
#ifndef TALUS_TWO_FLUID_STATE_H
#define TALUS_TWO_FLUID_STATE_H

#include "talus/adapt.h"
#include "talus/granular_pressure.h"
#include "talus/grid.h"
#include "talus/model.h"
#include "talus/params.h"
#include "talus/scratch.h"
#include "talus/solve.h"
#include "talus/two_fluid/keys.h"
#include "talus/yield.h"

struct skin;

/* Stages of a step (step.c). */
enum two_fluid_stage {
  TWO_FLUID_CLOSURES,
  TWO_FLUID_VISCOUS,
  TWO_FLUID_PRESSURE,
  TWO_FLUID_PROJECTION,
  TWO_FLUID_TRANSPORT,
  TWO_FLUID_ADAPTATION,
  TWO_FLUID_OTHER,
  TWO_FLUID_NSTAGES
};

enum two_fluid_phase { TWO_FLUID_S, TWO_FLUID_F, TWO_FLUID_NPHASES };

/* Solid fractions below this are none: grains there move with the fluid. */
#define TWO_FLUID_NONE 1e-6

struct two_fluid {
  struct model model;
  const struct params *params;       /* borrowed */
  const struct two_fluid_keys *keys; /* borrowed */
  struct two_fluid_closure closure;
  struct grid grid; /* owned, as all below */

  /* State, kept over adaptation and restart */
  struct field *alpha;                     /* solid fraction */
  struct field *u[TWO_FLUID_NPHASES][DIM]; /* velocities, m/s */
  struct field *p;                         /* pressure, Pa */
  struct field *phi_p;                     /* plastic packing */
  struct field *X;                         /* of two_fluid_grains.h, Pa */
  struct field *bed;                       /* packing of a bed; surface.h */
  /* part of the grains of a leaf that a tracer marks; slopes let it pass 0 and
   * 1 by a hundredth */
  struct field *tracer[PARAMS_MAX_TRACERS];
  struct field *flux; /* alpha u_s through faces, m/s, in the last step */
  struct field *j;    /* alpha u_s + (1 - alpha) u_f, likewise */

  bool exact; /* the grains yield exactly, else by their viscosity */
  struct yield yield;
  struct skin *skin;     /* with an exact yield, of leaves that touch */
  struct field *touches; /* the part of a leaf in which grains touch, from which
                            its weight in tangential differences */

  /* Remade in every step */
  struct field *alpha_new; /* at its end */
  struct field *pushed;    /* with an exact yield: by p_s and weight along an
                              axis, m/s^2 */
  struct field *gain[DIM]; /* of u_f by what the fluid carries; transport.h */
  struct field *load;      /* p_s at its beginning, Pa */
  struct field *hardening; /* what shear by 1 adds to p_s by dilatancy, Pa */
  struct field *p_s;       /* pressure of the grains, Pa */
  struct field *weight;    /* alpha, but nowhere 0: p_s is interpolated by it */
  struct field *inertia;   /* by which p is interpolated, kg/m^3 */
  struct field *upper[DIM]; /* part of the grains of a leaf that counts for its
                               upper face along an axis; pressures.h */
  struct field *Theta;      /* granular temperature, m^2/s^2 */
  struct field *shear;      /* shear rate of the grains, 1/s */
  struct field *eta;        /* viscosity of the fluid alone, Pa s */
  struct field *drag;       /* K/alpha of leaves, kg/m^3/s */
  struct field *drag_f;     /* of faces */
  struct field *shear_f[TWO_FLUID_NPHASES];
  struct field *eta_f[TWO_FLUID_NPHASES]; /* viscosities of faces, Pa s, that of
                                             the fluid times 1 - alpha */
  struct field *kappa_f[TWO_FLUID_NPHASES]; /* bulk viscosities, Pa s */
  struct field *w_f[TWO_FLUID_NPHASES]; /* face velocities without pressure and
                                           weight, m/s */
  struct field *v_f[TWO_FLUID_NPHASES]; /* what these add, m/s */
  struct field *mobility_f;             /* m of granular_pressure.h, m^3/kg */
  struct field *lambda_f;               /* mobility of the mixture, m^3/kg */
  struct field *force_f;                /* lambda grad p, m/s^2 */
  struct field *c;       /* part of a leaf that grains fill, for planes and for
                            adaptation, which follows it */
  struct field *phi;     /* solid fraction of the bed in a leaf; surface.h */
  struct field *rest;    /* s of surface.h, 0 but at the surface, Pa */
  struct field *burden;  /* W of surface.h, Pa */
  struct field *borne;   /* m of surface.h */
  struct field *lack;    /* p_s less its mean over a leaf, Pa; surface.h */
  struct field *carried; /* load over half the weight of a leaf, at most 1 */
  struct field *normal[DIM]; /* planes of c */
  struct field *plane;
  struct scratch scratch;

  /* For output, on demand */
  struct field *mean[DIM]; /* flux of the grains over alpha, m/s */
  struct field *stress;    /* of the grains, Pa */

  double travel;    /* cells that grains may have moved since adaptation */
  double slow_time; /* that the grains have been slow, s */
  double scale;     /* speed that viscous tolerances refer to */
  double dt;        /* of the step under way, s */
  double eta_max;   /* cap on the viscosity of the grains, Pa s */
  int passes;       /* of granular pressure and projection */
  struct granular_stats pressure;
  struct solve_stats viscous[TWO_FLUID_NPHASES], projection;
  double initial; /* energy at t = 0, J/m (3D: J) */
  double changed; /* that restarts with other conditions have added */
  double energy;  /* when the checkpoint was written */
};

/* Set the closures that a case asks for; a USER_ERROR says what is wrong with
 * their numbers. */
void two_fluid_closures(const struct params *params,
                        struct two_fluid_closure *c);
/* Make a state of zeros on a forest, which it takes over. Collective. */
struct two_fluid *two_fluid_new_on(const struct params *params,
                                   struct forest *forest);
void two_fluid_destroy(struct two_fluid *sim);
/* Make one round of adaptation; returns whether the grid has changed.
 * Collective. */
bool two_fluid_adapt(struct two_fluid *sim);

/* Note the time since the last lap as that of a stage. */
static inline void two_fluid_lap(struct two_fluid *sim,
                                 enum two_fluid_stage stage) {
  stopwatch_lap(&sim->model.stopwatch, stage);
}
/* Do walls, a given flow or a pressure drive the phases? */
bool two_fluid_is_driven(const struct two_fluid *sim);
/* Return density rho_s or rho_f. */
static inline double two_fluid_density(const struct two_fluid *sim, int phase) {
  return sim->closure.param[phase == TWO_FLUID_S ? TWO_FLUID_GRAINS_DENSITY
                                                 : TWO_FLUID_FLUID_DENSITY];
}
/* Return alpha or 1 - alpha. */
static inline double two_fluid_part(int phase, double alpha) {
  return phase == TWO_FLUID_S ? alpha : 1 - alpha;
}
static inline bool two_fluid_has_grains(const struct two_fluid *sim,
                                        int32_t i) {
  return sim->alpha->v[i] >= TWO_FLUID_NONE;
}
/* Is face f a wall to the grains? All sides of the box that are not periodic
 * are; the side of a leaf that is several faces (mesh.h) is none. */
static inline bool two_fluid_is_side(const struct two_fluid *sim, int32_t f) {
  const struct mesh *mesh = sim->grid.mesh;
  return f < mesh->nfaces && mesh->face_patch[f] >= 0;
}

#endif
