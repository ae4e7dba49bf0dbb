/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/two_phase/pressures.h"

#include <math.h>
#include <string.h>

#include "talus/clean.h"
#include "talus/log.h"
#include "talus/minmax.h"
#include "talus/poisson.h"
#include "talus/projection.h"
#include "talus/two_phase/pressure_level.h"
#include "talus/two_phase/properties.h"
#include "talus/two_phase/state.h"
#include "talus/two_phase/still.h"

/* Leaves with more grains than this take their g from the last pressure; in the
 * others the pressure of grains that have just left would do too much
 * (docs/notes/surface.md). */
#define HOLDS_GRAINS 0.01

/* Density of a gas that weighs nothing, in that of the grains. */
#define WEIGHTLESS 1e-12

/* The velocity that carries c is solved for to this part of the tolerance of
 * pressure: its errors move grains at rest. */
#define CARRIED 0.01
#define LEAST_TOLERANCE 1e-12

/* Begin a projection, whose scratch end_projection gives back. */
static struct projection begin_projection(struct two_phase *sim) {
  double *rhs = scratch_take_one(&sim->scratch, FIELD_CELL, "projection");
  double *flux = scratch_take_one(&sim->scratch, FIELD_FACE, "projection");
  return (struct projection){.mesh = sim->grid.mesh,
                             .hierarchy = sim->grid.hierarchy,
                             .rho = sim->rho->v,
                             .alpha_f = sim->alpha_f->v,
                             .gravity_f = sim->gravity_f->v,
                             .bc = sim->p->bc,
                             .tolerance = sim->params->tolerance_pressure,
                             .max_iterations = sim->params->max_iterations,
                             .rhs = rhs,
                             .flux = flux};
}

static void end_projection(struct two_phase *sim) {
  scratch_give(&sim->scratch, "projection");
}

void pressures_fill(struct two_phase *sim) {
  const struct bc *bc = sim->p->bc;
  mesh_fill_potential(sim->grid.mesh, sim->rho->v, 1, &sim->p->v, &bc, false);
}

/* Set g [nleaves] from the flux of a projection. */
static void set_acceleration(struct two_phase *sim,
                             const struct projection *projection,
                             double *const g[DIM]) {
  double *face = scratch_take_one(&sim->scratch, FIELD_FACE, __func__);
  projection_acceleration(projection, face, g);
  scratch_give(&sim->scratch, __func__);
}

void pressures_acceleration(struct two_phase *sim, double *const g[DIM]) {
  const struct projection projection = begin_projection(sim);
  pressures_fill(sim);
  poisson_flux(sim->grid.mesh, projection.alpha_f, sim->p->v, projection.flux);
  set_acceleration(sim, &projection, g);
  end_projection(sim);
}

void pressures_renew(struct two_phase *sim) {
  double *g[DIM];
  if (sim->params->single_phase) return;
  scratch_take(&sim->scratch, FIELD_CELL, __func__, DIM, g);
  pressures_acceleration(sim, g);
  for (int e = 0; e < DIM; e++) {
    for (int32_t i = 0; i < sim->grid.mesh->nleaves; i++) {
      if (sim->c->v[i] > HOLDS_GRAINS) sim->g[e]->v[i] = g[e][i];
    }
    mesh_touch(sim->grid.mesh, sim->g[e]->v);
  }
  scratch_give(&sim->scratch, __func__);
}

/* Make u_f solenoidal to the tolerance by a projection over dt with a pressure
 * that starts from 0. */
static struct solve_stats make_solenoidal_by(struct two_phase *sim,
                                             const struct projection *by,
                                             double dt, double *u_f) {
  struct projection projection = *by;
  double *phi = scratch_take_one(&sim->scratch, FIELD_CELL, __func__);
  struct bc bc[MESH_MAX_PATCHES];
  memcpy(bc, sim->p->bc, sizeof bc);
  for (int k = 0; k < MESH_MAX_PATCHES; k++) bc[k].value = 0;
  projection.bc = bc;
  memset(phi, 0, (size_t)sim->grid.mesh->ncells * sizeof(double));
  struct solve_stats stats = projection_project(&projection, dt, u_f, phi);
  scratch_give(&sim->scratch, __func__);
  return stats;
}

struct solve_stats pressures_solenoidal(struct two_phase *sim, double dt,
                                        double *u_f) {
  const struct projection projection = begin_projection(sim);
  const struct solve_stats stats =
      make_solenoidal_by(sim, &projection, dt, u_f);
  end_projection(sim);
  clean_face_velocity(sim->grid.clean, sim->grid.mesh, sim->grid.open, u_f);
  return stats;
}

double pressures_carrying_tolerance(const struct params *params) {
  const double tolerance = params->tolerance_pressure;
  return min2(tolerance, max2(CARRIED * tolerance, LEAST_TOLERANCE));
}

/* Make of a projection one with a gas that weighs nothing, so that its currents
 * are felt by itself alone, in scratch that end_light gives back. Traces of
 * grains weigh nothing either: round-off of c must not outweigh the gas. */
static struct projection begin_light(struct two_phase *sim,
                                     const struct projection *projection) {
  static const struct bc neumann[MESH_MAX_PATCHES];
  const struct mesh *mesh = sim->grid.mesh;
  const double density[2] = {1, WEIGHTLESS};
  const struct bc *bc[] = {neumann};
  struct projection light = *projection;
  double *rho = scratch_take_one(&sim->scratch, FIELD_CELL, "light");
  double *alpha_f = scratch_take_one(&sim->scratch, FIELD_FACE, "light");
  double *c = scratch_take_one(&sim->scratch, FIELD_CELL, __func__);
  field_fill(mesh, sim->c);
  for (int32_t i = 0; i < mesh->ncells; i++) {
    c[i] = sim->c->v[i] < PARAMS_GAS ? 0 : sim->c->v[i];
  }
  properties_density(mesh, density, c, sim->grid.closed, rho, alpha_f);
  scratch_give(&sim->scratch, __func__);
  mesh_fill(mesh, 1, &rho, bc, false);
  light.rho = rho;
  light.alpha_f = alpha_f;
  light.tolerance = pressures_carrying_tolerance(sim->params);
  return light;
}

static void end_light(struct two_phase *sim) {
  scratch_give(&sim->scratch, "light");
}

/* Let the faces of slow grains move with u^{n+1}, and make u_f solenoidal again
 * (still.h). */
static void carry_with_grains(struct two_phase *sim,
                              const struct projection *light, double dt) {
  double *u[DIM];
  field_arrays(sim->u, u);
  field_fill_many(sim->grid.mesh, DIM, sim->u);
  double *mean = scratch_take_one(&sim->scratch, FIELD_FACE, __func__);
  projection_face_velocity(light, 0, u, mean);
  still_blend(sim, mean, sim->u_f->v);
  scratch_give(&sim->scratch, __func__);
  sim->carrying = make_solenoidal_by(sim, light, dt, sim->u_f->v);
}

static void add_acceleration(struct two_phase *sim, double dt) {
  const struct mesh *mesh = sim->grid.mesh;
  for (int e = 0; e < DIM; e++) {
    double *u = sim->u[e]->v;
    for (int32_t i = 0; i < mesh->nleaves; i++) u[i] += dt * sim->g[e]->v[i];
    mesh_touch(mesh, u);
  }
}

/* Find p, and from it u_f and g. */
static void find_pressure(struct two_phase *sim, struct projection *projection,
                          double dt) {
  double *g[DIM];
  field_arrays(sim->g, g);
  sim->pressure = projection_project(projection, dt, sim->u_f->v, sim->p->v);
  pressure_level_set(sim);
  set_acceleration(sim, projection, g);
}

/* With an exact yield, find p, u and u_f, which is the mean of u* - dt g, + dt
 * gravity. */
static void project_exactly(struct two_phase *sim,
                            struct projection *projection, double dt) {
  const struct projection light = begin_light(sim, projection);
  double *last_g[DIM];
  pressures_fill(sim);
  still_face_velocity(sim, projection, light.rho, dt, sim->u_f->v);
  still_remember(sim, last_g);
  find_pressure(sim, projection, dt);
  add_acceleration(sim, dt);
  still_keep(sim, dt, last_g);
  carry_with_grains(sim, &light, dt);
  end_light(sim);
}

/* Make room for the new u_f. The first solve writes into the array of u_half
 * and leaves u_f of the last step there, in case this step fails (u_f->old). A
 * repetition writes over the new u_f; returns a copy of u_f from before, else
 * NULL. */
static const double *turn_face_velocity(struct two_phase *sim, int k) {
  double *last = sim->u_f->v;
  if (k > 0) {
    double *copy = scratch_take_one(&sim->scratch, FIELD_FACE, "last");
    return memcpy(copy, last,
                  (size_t)sim->grid.mesh->nfaces_all * sizeof(double));
  }
  scratch_exchange(&sim->scratch, sim->u_half->v, last);
  sim->u_f->v = sim->u_half->v;
  sim->u_half->v = last;
  return NULL;
}

/* Measure how far repetition k has moved u_f from `last`, which
 * turn_face_velocity has kept. */
static void measure_repetition(struct two_phase *sim, int k,
                               const double *last) {
  const struct mesh *mesh = sim->grid.mesh;
  double change = 0;
  sim->repeat_change = 0;
  if (k == 0) return;
  for (int32_t f = 0; f < mesh->nfaces; f++) {
    change = max2(change, fabs(sim->u_f->v[f] - last[f]));
  }
  scratch_give(&sim->scratch, "last");
  sim->repeat_change = mesh_max(mesh, change);
  log_info("step %lld, repetition %d: velocity changes by %.3g of %.3g",
           (long long)sim->model.step, k, sim->repeat_change, sim->scale);
}

void pressures_project(struct two_phase *sim, double dt, int k) {
  const double *last = turn_face_velocity(sim, k);
  struct projection projection = begin_projection(sim);
  double *u[DIM];
  field_arrays(sim->u, u);
  field_fill_many(sim->grid.mesh, DIM, sim->u);
  projection_face_velocity(&projection, dt, u, sim->u_f->v);
  if (sim->exact) {
    project_exactly(sim, &projection, dt);
  } else {
    find_pressure(sim, &projection, dt);
    add_acceleration(sim, dt);
  }
  end_projection(sim);
  measure_repetition(sim, k, last);
}

struct solve_stats pressures_start(struct two_phase *sim) {
  struct projection projection = begin_projection(sim);
  double *rest[DIM], *g[DIM], size = 0;
  double *u_f = scratch_take_one(&sim->scratch, FIELD_FACE, __func__);
  scratch_take(&sim->scratch, FIELD_CELL, __func__, DIM, rest);
  field_arrays(sim->g, g);
  for (int d = 0; d < DIM; d++) {
    memset(rest[d], 0, (size_t)sim->grid.mesh->ncells * sizeof(double));
    size = max2(size, fabs(sim->params->gravity[d]));
  }
  /* 1e-13 of the divergence gravity makes at a density jump, but not below
   * the round-off of p / (rho h^2) */
  const double cells = exp2(sim->params->level_max);
  projection.tolerance =
      size * cells / sim->params->size * max2(1e-13, 1e-16 * cells);
  projection_face_velocity(&projection, 1, rest, u_f);
  struct solve_stats stats = projection_project(&projection, 1, u_f, sim->p->v);
  scratch_give(&sim->scratch, __func__);
  pressure_level_set(sim);
  set_acceleration(sim, &projection, g);
  end_projection(sim);
  return stats;
}
