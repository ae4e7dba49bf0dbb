/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Small four-state simulations for tests: a box of 0.16 m of glass beads. */
#ifndef TALUS_TESTS_FOUR_STATE_H
#define TALUS_TESTS_FOUR_STATE_H

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "talus/error.h"
#include "talus/four_state/measure.h"
#include "talus/four_state/start.h"
#include "talus/four_state/state.h"
#include "talus/four_state/step.h"
#include "talus/model.h"

/* Give keys their defaults, all of which are numbers. */
static inline struct four_state_keys four_state_defaults(void) {
  struct four_state_keys keys;
  memset(&keys, 0, sizeof keys);
  for (int k = 0; k < four_state_model_keys.nkeys; k++) {
    const struct key *key = &four_state_model_keys.keys[k];
    if (key->type != KEY_NUMBER) continue;
    *(double *)(void *)((char *)&keys + key->offset) =
        strtod(key->fallback, NULL);
  }
  return keys;
}

/* Describe a closed box of edge 0.16 m, slip sides, no-slip floor, on one
 * level. */
static inline struct params beads_params(struct four_state_keys *keys,
                                         int level) {
  struct params p = {.dimension = DIM,
                     .own = keys,
                     .size = 0.16,
                     .trees = {1, 1, 1},
                     .level_min = level,
                     .level_max = level,
                     .nboundaries = 6,
                     .cfl = 0.45,
                     .dt_max = 1,
                     .tolerance_pressure = 1e-4,
                     .tolerance_viscous = 1e-4,
                     .max_iterations = 200,
                     .max_cells = 1000000,
                     .stop = 1,
                     .length_scale = 1};
  p.gravity[DIM - 1] = -9.81;
  for (int side = 0; side < 6; side++) p.boundary[side].type = BOUNDARY_SLIP;
  p.boundary[2 * (DIM - 1)].type = BOUNDARY_NO_SLIP;
  return p;
}

static inline struct four_state *beads_new(const struct params *params) {
  const struct model_start start = {.most_leaves = 0};
  struct four_state *sim = four_state_new(params, &start);
  sim->initial = four_state_energy(sim);
  return sim;
}

/* Advance to a time, or for so many steps; returns whether all went well. */
static inline bool beads_run(struct four_state *sim, double time, int steps) {
  for (int k = 0; k < steps && sim->model.time < time * (1 - 1e-12); k++) {
    if (four_state_step(sim, time - sim->model.time) != EXIT_DONE) return false;
  }
  return true;
}

/* Return the largest speed of leaves with grains. */
static inline double beads_speed(const struct four_state *sim) {
  double most = 0;
  for (int32_t i = 0; i < sim->grid.mesh->nleaves; i++) {
    if (!four_state_has_grains(sim, i)) continue;
    for (int d = 0; d < DIM; d++) most = fmax(most, fabs(sim->u[d]->v[i]));
  }
  return mesh_max(sim->grid.mesh, most);
}

/* Return the level set of grains between two heights, context[0] and [1]. */
static inline double slab(void *context, const double x[3]) {
  const double *z = context;
  return fmin(z[1] - x[DIM - 1], x[DIM - 1] - z[0]);
}

#endif
