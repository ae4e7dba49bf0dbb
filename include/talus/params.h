/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Plain description of a run: what a case file says, after checking.
 *
 * `case` fills it, and everybody else reads; nothing changes during a run.
 * Units are those of the case (any consistent set). Vectors have room for
 * three components; in 2D the third is unused. Strings and functions are
 * owned by whoever made the struct (the case) and outlive the run.
 */
#ifndef TALUS_PARAMS_H
#define TALUS_PARAMS_H

#include <math.h>
#include <stdbool.h>
#include <stdint.h>

#include "talus/rheology.h"

struct side_map;

/* Fractions of a phase below this are none, for properties and refinement. */
#define PARAMS_GAS 1e-6

enum {
  PARAMS_MAX_BOUNDARIES = 16, /* 6 sides, then patches named by the case */
  PARAMS_MAX_TRACERS = 8,
  PARAMS_MAX_TIMES = 256,
  PARAMS_MAX_CRITERIA = 8,
  PARAMS_NAME_LENGTH = 64,
  PARAMS_LINE_LENGTH = 512
};

/* A scalar function of position, eval == NULL when absent. */
struct function {
  double (*eval)(void *context, const double x[3]);
  void *context;
};

enum boundary_type {
  BOUNDARY_NO_SLIP, /* u = velocity (a moving wall moves tangentially) */
  BOUNDARY_SLIP,    /* u.n = 0, no tangential stress; also "symmetry" */
  BOUNDARY_NAVIER,  /* u.n = 0, u_t = slip_length du_t/dn */
  BOUNDARY_STRIP,   /* no slip, but slip ahead of the grains (slip_strip.h) */
  BOUNDARY_OUTFLOW, /* p = pressure, du/dn = 0 */
  BOUNDARY_INFLOW,  /* u = velocity, c = fraction */
  BOUNDARY_PERIODIC
};

struct boundary {
  char name[PARAMS_NAME_LENGTH]; /* of a patch */
  enum boundary_type type;
  double velocity[3];
  double pressure;
  double slip_length;
  double strip;    /* m of the floor that are smooth, ahead of the grains */
  double fraction; /* volume fraction of grains carried in by an inflow */
};

/* Axisymmetric: x is the distance r from an axis and y lies along it, z in
 * papers; nothing moves around it. */
enum coordinates { COORDINATES_CARTESIAN, COORDINATES_AXISYMMETRIC };

/* Where boundary.pressure_level holds, see pressure_level.h */
enum pressure_at { PRESSURE_AT_BOX, PRESSURE_AT_GAS, PRESSURE_AT_POINT };

struct phase {
  double density; /* kg/m^3, > 0 */
  struct rheology rheology;
};

/* Friction of the walls of a narrow channel (side_walls.h), 2D. */
struct side_walls {
  double mu;    /* friction coefficient, 0: no walls */
  double width; /* m between the walls */
};

struct tracer {
  char name[PARAMS_NAME_LENGTH];
  struct function shape; /* positive inside, at t = 0 */
};

/* One adaptation criterion; a leaf takes the finest level asked for. */
enum criterion_type {
  CRITERION_INTERFACE, /* within `width` cells of the surface of the grains */
  CRITERION_INSIDE,    /* inside the grains */
  CRITERION_ESTIMATE,  /* wavelet estimate of velocity above `threshold` */
  CRITERION_FUNCTION   /* level returned by a function of position */
};

/* The phase that a criterion minds: a leaf counts when the leaf itself, or one
 * beside it, holds more than PARAMS_GAS of that phase. */
enum criterion_phase { CRITERION_BOTH, CRITERION_GRAINS, CRITERION_GAS };

struct criterion {
  enum criterion_type type;
  enum criterion_phase only;
  int level;        /* finest level asked for */
  double width;     /* INTERFACE: finest cells on either side of the surface */
  double threshold; /* ESTIMATE: in units of velocity */
  struct function function; /* FUNCTION: level as a real number */
};

/* Passage of gas that grains enclose (percolation.h). */
enum permeability {
  PERMEABLE_AUTO, /* if the viscosity of the grains depends on pressure */
  PERMEABLE_NO,
  PERMEABLE_YES
};

/* Limiter of the slopes that advection predicts face values with, from the
 * differences a, b to the two sides (0 where they differ in sign). */
enum limiter {
  LIMITER_NONE,       /* (a + b) / 2 always */
  LIMITER_MINMOD,     /* the smaller one */
  LIMITER_GENERALISED /* at most 1.3 times that and (a + b) / 2 */
};

/* Does the flow carry momentum, rho u.grad u? */
enum momentum_advection {
  ADVECTION_ON,
  ADVECTION_OFF /* no: unsteady Stokes flow, whose surface still moves */
};

struct params {
  char name[256]; /* of the case, gives the output directory */
  char title[256];
  int dimension; /* 2 or 3 */
  enum coordinates coordinates;
  int model; /* number in the list of models (src/models.c) */
  void *own; /* values of the model's own keys (key.h), or NULL */

  /* Domain: a brick of trees, each a square or cube of edge `size`. */
  double size;
  double origin[3];
  int trees[3];
  int level_min, level_max; /* of refinement within a tree */
  struct boundary boundary[PARAMS_MAX_BOUNDARIES]; /* side 2d: lower side of
                               axis d, 2d+1: upper; then patches from 6 on */
  int nboundaries;                                 /* at least 6 */
  int smooth; /* of these the one that is the slip of strips; 0: no strips */
  /* Which boundary holds at a boundary face: returns an index into boundary
   * (>= 6 for a patch, or `side`); NULL: every face takes its side's. */
  int (*boundary_select)(void *context, int side, const double x[3]);
  void *boundary_context;
  /* Where they hold, on sides that are divided (side_map.h); NULL: one boundary
   * all over. Owned by whoever made the struct. */
  const struct side_map *side_map[6];
  /* Parts of each side that the patches cover, in words */
  char cover[PARAMS_MAX_BOUNDARIES][PARAMS_LINE_LENGTH];
  int ncovers;

  /* Physics */
  double gravity[3];
  struct phase grains, gas;
  struct side_walls side_walls; /* that the grains slide on */
  enum permeability permeability;
  bool permeable;              /* what it comes to for these grains */
  bool single_phase;           /* grains fill the box; no VOF, no gas */
  struct function shape;       /* level set of the grains, positive inside */
  struct function velocity[3]; /* initial velocity, absent: rest */
  struct tracer tracer[PARAMS_MAX_TRACERS]; /* passive VOF tracers */
  int ntracers;
  bool pressure_level_given;    /* by the case */
  double pressure_level;        /* Pa, when no boundary sets the pressure */
  enum pressure_at pressure_at; /* where it holds */
  double pressure_point[3];     /* m, PRESSURE_AT_POINT */

  /* Numerics */
  double cfl;                /* 1/2 sum |u_f| A dt / V, in (0, 1] */
  double dt_max;             /* user cap, > 0 */
  double tolerance_pressure; /* max |div u| dt */
  double tolerance_viscous;  /* max |dt r / rho| / velocity scale */
  int max_iterations;        /* of one linear solve */
  int picard;                /* repetitions of viscosity and projection */
  double theta;              /* 1: backward Euler, 1/2: Crank-Nicolson */
  enum momentum_advection advection;
  enum limiter limiter; /* of momentum advection away from the surface */
  struct criterion criterion[PARAMS_MAX_CRITERIA];
  int ncriteria;     /* 0: uniform at level_max */
  int adapt_every;   /* at most this many steps; 0: when needed */
  int opening_level; /* of the faces of openings, at least (openings.h) */
  int64_t max_cells;

  /* Output */
  double stop;         /* end time */
  double rest_speed;   /* the run ends before that if its grains have been */
  double rest_time;    /* slower for this time; 0: it does not */
  double length_scale; /* for reading only: L0, or 1 */
  double front_height; /* of the heap at its front (outline.h); 0: default */
  double profile_times[PARAMS_MAX_TIMES];
  int nprofile_times;
  double snapshot_every;   /* interval of time; 0: only first and last */
  int series_every;        /* steps between rows of series.csv */
  double checkpoint_every; /* wall-clock seconds; 0: only at the end */
};

static inline bool params_axisymmetric(const struct params *params) {
  return params->coordinates == COORDINATES_AXISYMMETRIC;
}

/* Does an inflow carry grains into the box? */
static inline bool params_bring_grains(const struct params *params) {
  for (int b = 0; b < params->nboundaries; b++) {
    const struct boundary *boundary = &params->boundary[b];
    if (boundary->type == BOUNDARY_INFLOW && boundary->fraction > 0) {
      return true;
    }
  }
  return false;
}

/* Return |gravity|. */
static inline double params_gravity(const struct params *params) {
  double g2 = 0;
  for (int d = 0; d < DIM; d++) g2 += params->gravity[d] * params->gravity[d];
  return sqrt(g2);
}

#endif
