/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Small simulations for tests: parameters of a box of grains under gas, and a
 * start on any communicator. */
#ifndef TALUS_TESTS_SIM_H
#define TALUS_TESTS_SIM_H

#include "bench.h"
#include "narrow.h"
#include "talus/adapt.h"
#include "talus/model.h"
#include "talus/two_phase/start.h"
#include "talus/two_phase/state.h"
#include "talus/two_phase/step.h"

static inline struct rheology newtonian(double eta) {
  struct rheology r;
  rheology_init(&r, rheology_find("newtonian"));
  rheology_set(&r, "eta", eta);
  return r;
}

/* Describe a unit box with closed slip sides on one level, gravity 1 downwards
 * along the last axis, grains of density 1 and viscosity 0.01 under a thousand
 * times lighter and a hundred times less viscous gas. No shape yet: all grains.
 */
static inline struct params box_params(int level) {
  struct params p = {.dimension = DIM,
                     .size = 1,
                     .trees = {1, 1, 1},
                     .level_min = level,
                     .level_max = level,
                     .nboundaries = 6,
                     .grains = {1, newtonian(1e-2)},
                     .gas = {1e-3, newtonian(1e-4)},
                     .cfl = 0.5,
                     .dt_max = 1,
                     .tolerance_pressure = 1e-8,
                     .tolerance_viscous = 1e-8,
                     .max_iterations = 200,
                     .theta = 1,
                     .max_cells = 1000000,
                     .stop = 1,
                     .length_scale = 1};
  p.gravity[DIM - 1] = -1;
  for (int side = 0; side < 6; side++) p.boundary[side].type = BOUNDARY_SLIP;
  return p;
}

/* Describe a periodic box without gravity and gas. */
static inline struct params periodic_params(int level) {
  struct params p = box_params(level);
  p.gravity[DIM - 1] = 0;
  p.single_phase = true;
  for (int side = 0; side < 6; side++) {
    p.boundary[side].type = BOUNDARY_PERIODIC;
  }
  return p;
}

/* Refine from level_min to level_max within `width` leaves of the surface. */
static inline void params_follow_surface(struct params *p, int level_min,
                                         double width) {
  p->level_min = level_min;
  p->criterion[p->ncriteria++] = (struct criterion){
      .type = CRITERION_INTERFACE, .level = p->level_max, .width = width};
}

/* Return the level set of the grains below the height *context along the last
 * axis. */
static inline double below(void *context, const double x[3]) {
  return *(const double *)context - x[DIM - 1];
}

/* Return the level set of grains in [0, 0.4]^DIM: a column about to fall. */
static inline double column(void *context, const double x[3]) {
  (void)context;
  double outside = x[0];
  for (int d = 1; d < DIM; d++) outside = larger(outside, x[d]);
  return 0.4 - outside;
}

static inline void sim_fill(struct two_phase *sim) {
  const struct params *params = sim->params;
  for (int32_t i = 0; i < sim->grid.mesh->nleaves; i++) {
    const double *centre = sim->grid.mesh->x[i];
    double x[3] = {0};
    for (int d = 0; d < DIM; d++) x[d] = centre[d];
    sim->c->v[i] =
        params->shape.eval
            ? shape_fraction(params->shape.eval, params->shape.context, centre,
                             sim->grid.mesh->h[i], 4)
            : 1;
    for (int d = 0; d < DIM; d++) {
      const struct function *u = &params->velocity[d];
      sim->u[d]->v[i] = u->eval ? u->eval(u->context, x) : 0;
    }
  }
}

/* Make the initial state of a case as a run does, but nobody is told. */
static inline struct two_phase *sim_start(const struct params *params) {
  const struct model_start start = {.most_leaves = 0};
  return two_phase_new(params, &start);
}

/* Make a state as sim_start, on a communicator, with face velocities the
 * means of the cells'. The grid follows the criteria. */
static inline struct two_phase *sim_new(const struct params *params,
                                        MPI_Comm comm) {
  struct forest_layout layout;
  grid_layout(params, &layout);
  const int start =
      params->ncriteria > 0 ? params->level_min : params->level_max;
  struct two_phase *sim =
      two_phase_new_on(params, forest_new(comm, &layout, start));
  sim_fill(sim);
  for (int k = 0; k < 20 && params->ncriteria > 0; k++) {
    if (!two_phase_adapt(sim)) break;
    sim_fill(sim);
  }
  field_fill_many(sim->grid.mesh, DIM, sim->u);
  for (int d = 0; d < DIM; d++) {
    for (int32_t f = sim->grid.mesh->face_begin[d];
         f < sim->grid.mesh->face_begin[d + 1]; f++) {
      const int32_t *node = sim->grid.mesh->face_node[f];
      sim->u_f->v[f] = 0.5 * (sim->u[d]->v[node[0]] + sim->u[d]->v[node[1]]);
    }
  }
  clean_face_velocity(sim->grid.clean, sim->grid.mesh, sim->grid.open,
                      sim->u_f->v);
  step_start(sim);
  return sim;
}

/* Return the largest |v| of a vector over the leaves, component by component.
 */
static inline double largest(const struct two_phase *sim,
                             struct field *const v[DIM]) {
  double most = 0;
  for (int d = 0; d < DIM; d++) {
    for (int32_t i = 0; i < sim->grid.mesh->nleaves; i++) {
      most = larger(most, fabs(v[d]->v[i]));
    }
  }
  return mesh_max(sim->grid.mesh, most);
}

/* Return the momentum along d, or (d < 0) the mass. */
static inline double sim_momentum(const struct two_phase *sim, int d) {
  const double grains = sim->params->grains.density;
  const double gas = sim->params->gas.density;
  long double sum = 0;
  for (int32_t i = 0; i < sim->grid.mesh->nleaves; i++) {
    const double rho = gas + sim->c->v[i] * (grains - gas);
    sum += (long double)rho * mesh_volume(sim->grid.mesh, i) *
           (d < 0 ? 1 : sim->u[d]->v[i]);
  }
  return mesh_sum(sim->grid.mesh, (double)sum);
}

#endif
