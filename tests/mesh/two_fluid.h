/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Small two-fluid simulations for tests: a box of grains of 1 mm in water. */
#ifndef TALUS_TESTS_TWO_FLUID_H
#define TALUS_TESTS_TWO_FLUID_H

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "talus/error.h"
#include "talus/model.h"
#include "talus/two_fluid/measure.h"
#include "talus/two_fluid/start.h"
#include "talus/two_fluid/state.h"
#include "talus/two_fluid/step.h"
#include "talus/two_fluid_drag.h"
#include "talus/two_fluid_grains.h"

/* Return the place of the default of a key among its choices. */
static inline int choice_of(const struct key *key) {
  int k = 0;
  while (strcmp(key->choices[k], key->fallback) != 0) k++;
  return k;
}

/* Give keys their defaults, with a set of closures in a fluid. */
static inline struct two_fluid_keys grains_keys(enum two_fluid_set set,
                                                enum two_fluid_fluid fluid) {
  struct two_fluid_keys keys;
  memset(&keys, 0, sizeof keys);
  const struct key *key;
  for (int k = 0; (key = model_key(&two_fluid_model_keys, k)) != NULL; k++) {
    void *at = (char *)&keys + key->offset;
    if (key->type == KEY_NUMBER) *(double *)at = strtod(key->fallback, NULL);
    if (key->type == KEY_CHOICE) *(int *)at = choice_of(key);
  }
  keys.closure.set = set;
  keys.fluid = fluid;
  return keys;
}

/* Let the viscosity of the grains be at most eta_max, Pa s. */
static inline void grains_cap(struct two_fluid_keys *keys, double eta_max) {
  keys->regularisation = TWO_FLUID_CLIP;
  keys->eta_max = eta_max;
}

/* Describe a closed box of edge `size`, slip sides, no-slip floor, on one
 * level. */
static inline struct params grains_params(struct two_fluid_keys *keys,
                                          double size, int level) {
  struct params p = {.dimension = DIM,
                     .own = keys,
                     .size = size,
                     .trees = {1, 1, 1},
                     .level_min = level,
                     .level_max = level,
                     .nboundaries = 6,
                     .grains = {.density = 2560},
                     .cfl = 0.5,
                     .dt_max = INFINITY,
                     .tolerance_pressure = 1e-6,
                     .tolerance_viscous = 1e-6,
                     .max_iterations = 200,
                     .max_cells = 1000000,
                     .stop = 1,
                     .length_scale = 1};
  p.gravity[DIM - 1] = -9.81;
  for (int side = 0; side < 6; side++) p.boundary[side].type = BOUNDARY_SLIP;
  p.boundary[2 * (DIM - 1)].type = BOUNDARY_NO_SLIP;
  return p;
}

static inline struct two_fluid *grains_new(const struct params *params) {
  const struct model_start start = {.most_leaves = 0};
  struct two_fluid *sim = two_fluid_new(params, &start);
  sim->initial = two_fluid_energy(sim);
  return sim;
}

/* Advance to a time, or for so many steps; returns whether all went well. */
static inline bool grains_run(struct two_fluid *sim, double time, int steps) {
  for (int k = 0; k < steps && sim->model.time < time * (1 - 1e-12); k++) {
    if (two_fluid_step(sim, time - sim->model.time) != EXIT_DONE) return false;
  }
  return true;
}

/* Return the largest volume flux of grains through a face. */
static inline double grains_flux(const struct two_fluid *sim) {
  double most = 0;
  for (int32_t f = 0; f < sim->grid.mesh->nfaces; f++)
    most = fmax(most, fabs(sim->flux->v[f]));
  return mesh_max(sim->grid.mesh, most);
}

/* Return the level set of grains between two heights, context[0] and [1]. */
static inline double bed(void *context, const double x[3]) {
  const double *z = context;
  return fmin(z[1] - x[DIM - 1], x[DIM - 1] - z[0]);
}

#endif
