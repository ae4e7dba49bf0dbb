/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Simulation: the state of the two-phase incompressible model.
 *
 * Staggered in time: after step n, velocity u^n at cell centres and u_f^n
 * on faces at `time`; volume fraction c and pressure p at time - dt/2.
 */
#ifndef TALUS_TWO_PHASE_STATE_H
#define TALUS_TWO_PHASE_STATE_H

#include <stdbool.h>
#include <stdint.h>

#include "talus/grid.h"
#include "talus/model.h"
#include "talus/params.h"
#include "talus/scratch.h"
#include "talus/solve.h"
#include "talus/two_phase/conditions.h"
#include "talus/two_phase/percolation.h"
#include "talus/yield.h"

enum { TWO_PHASE_MAX_KNOWN = 8 };

struct followed;
struct forest;
struct skin;

/* Energies of the grains, per unit width in 2D, in J/m (J in 3D). */
struct energy {
  double kinetic, potential;
  double dissipated; /* by viscosity since t = 0 (viscous_work.h) */
  double initial;    /* kinetic + potential at t = 0 */
  double changed;    /* added by restarts with other conditions since then */
  double gas;        /* kinetic + potential of the gas at t = 0, and what such
                      * restarts have added */
  double gas_dissipated; /* as `dissipated` */
};

/* The arrest of the grains (rest.h). */
struct arrest {
  double moved; /* the last time they did; 0: not since the start */
  int rests;    /* they have come to rest since then */
};

/* Stages of a step (step.c). */
enum step_stage {
  STAGE_FRACTION,   /* cleaning, VOF and the momentum that rides with it */
  STAGE_DENSITY,    /* density and gravity */
  STAGE_RHEOLOGY,   /* viscosity */
  STAGE_ADVECTION,  /* of momentum, with its projection */
  STAGE_VISCOUS,    /* implicit viscous solve */
  STAGE_PROJECTION, /* pressure */
  STAGE_ADAPTATION, /* grid, fields, mesh, hierarchy */
  STAGE_OTHER,      /* dt, checks, copies */
  NSTAGES
};

struct two_phase {
  struct model model;
  const struct params *params; /* borrowed */
  struct grid grid;            /* owned, as all below */

  /* State, kept over adaptation and restart */
  struct field *c; /* volume fraction of grains */
  struct field *tracer[PARAMS_MAX_TRACERS];
  struct field *u[DIM]; /* velocity, m/s */
  struct field *u_f;    /* face velocity, m/s */
  struct field *p;      /* pressure, Pa */
  struct field *g[DIM]; /* gravity minus pressure gradient over density */
  struct field *viscous_g[DIM]; /* what viscosity added in the last step,
                                 * without the friction of side walls */
  bool exact; /* the grains yield exactly, else by their viscosity */
  struct yield yield;
  struct field *wall[DIM]; /* force of side walls (side_walls.h); NULL: none */

  /* Gas that leaves through the grains (percolation.h); NULL: none may */
  struct field *source;  /* of volume, 1/s: < 0 where gas is enclosed */
  struct field *carrier; /* velocity on faces that carries c */

  /* Properties and scratch, remade every step */
  struct field *rho;                 /* leaves */
  struct field *eta;                 /* leaves, mean of the faces, for output */
  struct field *eta_f, *alpha_f;     /* face viscosity, 1/density */
  struct field *gravity_f;           /* face gravity, balanced (properties.h) */
  struct field *normal[DIM], *plane; /* planes of cut leaves */
  bool planes_hold;                  /* they are the planes of c */
  struct skin *skin;                 /* of c, none in a single phase */
  struct field *band;                /* leaves whose momentum rides with c */
  struct field *u_old[DIM];          /* u^n while u is being advanced */
  struct field *u_half;   /* u_f^{n+1/2}, then u_f^n; scratch within a step */
  struct scratch scratch; /* for stages */
  double *c_before;       /* c of before, filled, while c is synchronised
                             (fractions.h), else NULL */

  /* For output, on demand (closure_fields.h) */
  struct field *shear_rate, *stress;
  struct field *known[TWO_PHASE_MAX_KNOWN]; /* outputs of the closure */
  int nknown;

  int64_t most_leaves; /* there is memory for; 0: no bound */
  double outgrown;     /* leaves wanted when there was none, else 0 */

  double travel;    /* cells the surface may have moved since adaptation */
  double slow_time; /* that the grains have been slow (rest.h), s */
  struct arrest arrest;
  struct solve_stats carrying; /* of u_f with an exact yield */
  struct solve_stats pressure, predictor, viscous; /* of the last step, by
                              Picard repetitions all their iterations and the
                              worst residual */
  double repeat_change; /* of |u_f|, m/s, in the last Picard repetition */
  struct energy energy;
  struct percolation percolation;
  struct conditions conditions; /* of the checkpoint, on a restart */
  double scale;                 /* largest speed, of the viscous tolerance */
  double divergence_volume; /* sum over steps of sum c div u_f dt V, m^DIM */
};

/* Make a state of zeros on a forest, which it takes over; a start or a
 * checkpoint then fills the fields. Collective. The caller owns the state. */
struct two_phase *two_phase_new_on(const struct params *params,
                                   struct forest *forest);
void two_phase_destroy(struct two_phase *sim);
/* Give the densities of grains and gas, which without a surface are the
 * same. */
void two_phase_densities(const struct two_phase *sim, double density[2]);
/* Give the fields that the criteria of adaptation look at. */
struct followed two_phase_followed(const struct two_phase *sim);
/* Make one round of adaptation (adapt.h); returns whether the grid has changed.
 * Collective. */
bool two_phase_adapt(struct two_phase *sim);

#endif
