/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A dense square or cube of edge D = 1 that moves at U = 1 along an axis
 * through light gas at rest, in a periodic box of 4 D: see test_dense_square.c
 * for what must come out. */
#ifndef TALUS_TESTS_DENSE_BODY_H
#define TALUS_TESTS_DENSE_BODY_H

#include "../mesh/transport.h"
#include "report.h"
#include "runs.h"

static const double kBox = 4, kTravel = 3;

/* Grains `ratio` times as dense as the gas; exact: with a yield stress of 1e-9
 * rho U^2. Cells of 4 D/2^level everywhere or (quarter) beside the surface of a
 * quarter of the body, between mirrors along the other two axes. */
struct dense_body {
  double ratio, eta_gas;
  bool exact;
  int axis, level;
  bool quarter;
};

static inline struct body dense_start(const struct dense_body *b) {
  struct body start = {{2, 2, 2}, 0.5};
  start.centre[b->axis] = 1;
  return start;
}

static inline double dense_speed(void *context, const double x[3]) {
  return cube(context, x) > 0;
}

static inline struct params dense_params(const struct dense_body *b,
                                         struct body *start) {
  struct params params = periodic_params(b->level);
  params.size = kBox;
  params.single_phase = false;
  params.pressure_level_given = true;
  params.shape = (struct function){cube, start};
  params.velocity[b->axis] = (struct function){dense_speed, start};
  params.grains.rheology = newtonian(1e-2);
  if (b->exact) {
    rheology_set(&params.grains.rheology, "cohesion", 1e-9);
    rheology_set_regularisation(&params.grains.rheology, "exact");
  }
  params.gas = (struct phase){1 / b->ratio, newtonian(b->eta_gas)};
  params.tolerance_pressure = params.tolerance_viscous = 1e-6;
  if (b->quarter) {
    params.size = 0.5 * kBox;
    params.trees[b->axis] = 2;
    params.level_max = b->level - 1;
    params_follow_surface(&params, 2, 3);
    for (int side = 0; side < 6; side++) {
      if (side / 2 != b->axis) params.boundary[side].type = BOUNDARY_SLIP;
    }
  }
  return params;
}

/* Where the centre of the body is along its axis, as c says: half a step behind
 * the velocity. */
struct track {
  double time, centre;
};

/* Find the centre of volume, found from the last one, as the box is periodic.
 */
static inline void dense_follow(const struct two_phase *sim, int axis,
                                struct track *track) {
  double shift = 0, volume = integral(sim->grid.mesh, sim->c->v);
  for (int32_t i = 0; i < sim->grid.mesh->nleaves; i++) {
    const double from =
        remainder(sim->grid.mesh->x[i][axis] - track->centre, kBox);
    shift += sim->c->v[i] * mesh_volume(sim->grid.mesh, i) * from / volume;
  }
  track->centre += shift;
  track->time = sim->model.time - 0.5 * sim->model.dt;
}

/* Return the mean velocity of the grains along the axis. */
static inline double dense_mean_speed(const struct two_phase *sim, int axis) {
  double sum = 0;
  for (int32_t i = 0; i < sim->grid.mesh->nleaves; i++) {
    sum += sim->c->v[i] * mesh_volume(sim->grid.mesh, i) * sim->u[axis]->v[i];
  }
  return sum / integral(sim->grid.mesh, sim->c->v);
}

/* Return the level set of the body at *context, periodic. */
static inline double dense_wrapped(void *context, const double x[3]) {
  const struct body *body = (const struct body *)context;
  double y[3] = {0};
  for (int d = 0; d < DIM; d++) {
    y[d] = body->centre[d] + remainder(x[d] - body->centre[d], kBox);
  }
  return cube(context, y);
}

/* Return the part of the body that is not where it should be. */
static inline double dense_shape_error(const struct two_phase *sim,
                                       const struct dense_body *b,
                                       double centre) {
  struct body body = dense_start(b);
  double *error = MEM_NEW(double, sim->grid.mesh->nleaves);
  body.centre[b->axis] = centre;
  fill_shape(sim->grid.mesh, dense_wrapped, &body, error);
  for (int32_t i = 0; i < sim->grid.mesh->nleaves; i++) {
    error[i] = fabs(sim->c->v[i] - error[i]);
  }
  const double sum =
      integral(sim->grid.mesh, error) / integral(sim->grid.mesh, sim->c->v);
  mem_free(error);
  return sum;
}

/* Report a run from step 2 on, when the start by a jolt is over. */
static inline void dense_report(struct report *report, const char *grid,
                                const struct dense_body *b) {
  struct body start = dense_start(b);
  const struct params params = dense_params(b, &start);
  struct two_phase *sim = sim_start(&params);
  struct track now = {.centre = start.centre[b->axis]};
  bool good = true;
  double fastest = 0;
  for (int k = 0; k < 2; k++) good = good && step_advance(sim, 1) == EXIT_DONE;
  dense_follow(sim, b->axis, &now);
  const struct track from = now;
  const double speed = dense_mean_speed(sim, b->axis);
  while (good && now.centre - from.centre < kTravel && sim->model.step < 2000) {
    good = step_advance(sim, 1) == EXIT_DONE;
    dense_follow(sim, b->axis, &now);
    fastest = larger(fastest, largest(sim, sim->u));
  }
  const double mean = (now.centre - from.centre) / (now.time - from.time);
  report_value(report, grid, "speed at step 2 / U", b->level, speed);
  report_at_most(report, grid, "|speed / at step 2 - 1|", b->level,
                 good ? fabs(mean / speed - 1) : NAN, 0.01);
  report_at_most(report, grid, "mean |c - c0|", b->level,
                 good ? dense_shape_error(sim, b, now.centre) : NAN,
                 0.005 + 3.5 / b->ratio * kTravel * kTravel);
  report_value(report, grid, "largest |u|", b->level, fastest);
  report_value(report, grid, "steps", b->level, (double)sim->model.step);
  two_phase_destroy(sim);
}

#endif
