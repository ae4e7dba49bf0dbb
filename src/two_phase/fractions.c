/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/two_phase/fractions.h"

#include <math.h>
#include <string.h>

#include "talus/memory.h"
#include "talus/minmax.h"
#include "talus/momentum.h"
#include "talus/two_phase/state.h"
#include "talus/two_phase/time_step.h"
#include "talus/vof.h"

/* Arrays that the sweeps of a fraction work with: planes of its cut leaves, cc
 * (vof.h), and room for its flux. */
struct sweep {
  double *normal[DIM], *plane, *cc, *flux;
};

void fractions_update_planes(struct two_phase *sim) {
  double *normal[DIM];
  if (sim->planes_hold) return;
  field_arrays(sim->normal, normal);
  vof_reconstruct(sim->grid.mesh, sim->c->v, normal, sim->plane->v);
  sim->planes_hold = true;
}

/* Take cc dt div(u_f) out of a fraction c again, to which the terms with cc
 * (vof.h) add up over the axes where u_f has a source, 1/s; NULL: none. */
static void remove_dilation(const struct two_phase *sim, double dt,
                            const double *source, const double *cc, double *c) {
  if (!source) return;
  for (int32_t i = 0; i < sim->grid.mesh->nleaves; i++) {
    c[i] -= cc[i] * dt * source[i];
  }
  mesh_touch(sim->grid.mesh, c);
}

/* Sweep a tracer (or c), which is filled, along d. */
static void sweep_tracer(struct two_phase *sim, int d, double dt,
                         const double *u_f, const struct sweep *sweep,
                         double *tracer) {
  const struct mesh *mesh = sim->grid.mesh;
  vof_flux(mesh, d, dt, u_f, sim->grid.open, tracer, sweep->normal,
           sweep->plane, sweep->flux);
  vof_update(mesh, d, dt, u_f, sweep->flux, sweep->cc, tracer);
}

/* Begin the sweeps of a tracer with scratch, which end_tracer gives back. */
static struct sweep begin_tracer(struct two_phase *sim) {
  struct sweep sweep;
  double *cell[DIM + 2];
  scratch_take(&sim->scratch, FIELD_CELL, "tracer", DIM + 2, cell);
  for (int e = 0; e < DIM; e++) sweep.normal[e] = cell[e];
  sweep.plane = cell[DIM], sweep.cc = cell[DIM + 1];
  sweep.flux = scratch_take_one(&sim->scratch, FIELD_FACE, "tracer");
  return sweep;
}

static void end_tracer(struct two_phase *sim) {
  scratch_give(&sim->scratch, "tracer");
}

/* Advance a tracer, or c, over dt. The planes of c stay as they are, as c may
 * be set back. */
static void advance_tracer(struct two_phase *sim, double dt, const double *u_f,
                           const double *source, struct field *tracer) {
  const struct mesh *mesh = sim->grid.mesh;
  bool held = tracer == sim->c && sim->planes_hold;
  struct sweep sweep = begin_tracer(sim), known = sweep;
  field_arrays(sim->normal, known.normal), known.plane = sim->plane->v;
  vof_freeze(mesh, tracer->v, sweep.cc);
  for (int s = 0; s < DIM; s++, held = false) {
    const int d = (int)((sim->model.step + s) % DIM);
    field_fill(mesh, tracer);
    if (!held) vof_reconstruct(mesh, tracer->v, sweep.normal, sweep.plane);
    sweep_tracer(sim, d, dt, u_f, held ? &known : &sweep, tracer->v);
  }
  remove_dilation(sim, dt, source, sweep.cc, tracer->v);
  end_tracer(sim);
}

/* Sweep c with its cc, and u in the band. u and c are filled. */
static void sweep_grains(struct two_phase *sim, int d, double dt,
                         const double *u_f, double *cc) {
  const struct mesh *mesh = sim->grid.mesh;
  double density[2], *u[DIM], *start[DIM], *cell[DIM + 1], *face[DIM + 2];
  scratch_take(&sim->scratch, FIELD_CELL, __func__, DIM + 1, cell);
  scratch_take(&sim->scratch, FIELD_FACE, __func__, DIM + 2, face);
  struct sweep sweep = {.plane = sim->plane->v, .cc = cc, .flux = face[DIM]};
  double *c_old = cell[DIM];
  struct momentum_flux flux = {.mass = face[DIM + 1]};
  two_phase_densities(sim, density);
  field_arrays(sim->u, u), field_arrays(sim->u_old, start);
  field_arrays(sim->normal, sweep.normal);
  for (int e = 0; e < DIM; e++) {
    flux.carried[e] = face[e];
    flux.slope[e] = cell[e];
  }
  memcpy(c_old, sim->c->v, (size_t)mesh->nleaves * sizeof(double));
  fractions_update_planes(sim);
  sweep_tracer(sim, d, dt, u_f, &sweep, sim->c->v);
  sim->planes_hold = false;
  if (sim->params->advection == ADVECTION_ON) {
    momentum_flux(mesh, d, dt, density, u_f, c_old, sweep.flux, sim->band->v, u,
                  &flux);
    momentum_update(mesh, d, dt, density, u_f, c_old, cc, sim->band->v, start,
                    &flux, u);
  }
  scratch_give(&sim->scratch, __func__);
}

/* Add what div u_f has made of c, whose cc this is, over dt. */
static void add_divergence(struct two_phase *sim, double dt, const double *cc) {
  const struct mesh *mesh = sim->grid.mesh;
  double sum = 0;
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    double net = 0;
    for (int f = 0; f < NFACE; f++) {
      net += (f & 1 ? 1 : -1) * mesh_side(mesh, sim->u_f->v, i, f);
    }
    sum += cc[i] * net * dt * mesh_volume(mesh, i) / mesh_width(mesh, i);
  }
  sim->divergence_volume += mesh_sum(mesh, sum);
}

/* Carry as fractions_carry, and leave cc of c, [ncells], with the caller. */
static void carry(struct two_phase *sim, double dt, const double *u_f,
                  const double *source, double *cc) {
  const struct mesh *mesh = sim->grid.mesh;
  for (int k = 0; k < sim->params->ntracers; k++) {
    advance_tracer(sim, dt, u_f, source, sim->tracer[k]);
  }
  if (sim->params->single_phase) return;
  vof_freeze(mesh, sim->c->v, cc);
  for (int s = 0; s < DIM; s++) {
    if (s > 0) field_fill_many(mesh, DIM, sim->u), field_fill(mesh, sim->c);
    sweep_grains(sim, (int)((sim->model.step + s) % DIM), dt, u_f, cc);
  }
  remove_dilation(sim, dt, source, cc, sim->c->v);
}

void fractions_carry(struct two_phase *sim, double dt, const double *u_f,
                     const double *source) {
  double *cc = scratch_take_one(&sim->scratch, FIELD_CELL, __func__);
  carry(sim, dt, u_f, source, cc);
  scratch_give(&sim->scratch, __func__);
}

/* Sweep c and tracers with the velocity of the step. u, c and band are filled.
 */
static void sweep_fractions(struct two_phase *sim, double dt) {
  double *cc = scratch_take_one(&sim->scratch, FIELD_CELL, __func__);
  carry(sim, dt, sim->u_f->v, NULL, cc);
  if (!sim->params->single_phase) add_divergence(sim, dt, cc);
  scratch_give(&sim->scratch, __func__);
}

static void mark_band(struct two_phase *sim, int rings) {
  if (sim->params->single_phase) return;
  field_fill(sim->grid.mesh, sim->c);
  momentum_mark_band(sim->grid.mesh, sim->c->v, rings, sim->band->v);
}

static bool are_bounded(const struct two_phase *sim) {
  double excess = vof_excess(sim->grid.mesh, sim->c->v);
  for (int k = 0; k < sim->params->ntracers; k++) {
    excess = max2(excess, vof_excess(sim->grid.mesh, sim->tracer[k]->v));
  }
  return mesh_max(sim->grid.mesh, excess) <= VOF_EMPTY;
}

/* Restore what the sweeps have changed. */
static void restore(struct two_phase *sim) {
  const struct mesh *mesh = sim->grid.mesh;
  field_restore(sim->c, mesh);
  for (int k = 0; k < sim->params->ntracers; k++) {
    field_restore(sim->tracer[k], mesh);
  }
  for (int e = 0; e < DIM; e++) {
    memcpy(sim->u[e]->v, sim->u_old[e]->v,
           (size_t)mesh->ncells * sizeof(double));
  }
  sim->planes_hold = false;
}

/* Count the parts of at most `most`, up to round-off, in a Courant number. */
static int parts_of(double courant, double most) {
  return (int)max2(1, ceil(courant / most - 1e-9));
}

/* Sweep n times over dt / n, from the state that has been saved. u is filled.
 */
static void sweep_in_parts(struct two_phase *sim, double dt, int n) {
  mark_band(sim, n);
  for (int k = 0; k < n; k++) {
    if (k > 0) {
      field_fill_many(sim->grid.mesh, DIM, sim->u);
      field_fill(sim->grid.mesh, sim->c);
    }
    sweep_fractions(sim, dt / n);
  }
}

void fractions_advance(struct two_phase *sim, double dt, double rate) {
  const struct mesh *mesh = sim->grid.mesh;
  const double divergence = sim->divergence_volume;
  field_fill_many(mesh, DIM, sim->u);
  for (int e = 0; e < DIM; e++) {
    memcpy(sim->u_old[e]->v, sim->u[e]->v,
           (size_t)mesh->ncells * sizeof(double));
  }
  sweep_in_parts(sim, dt, parts_of(rate * dt, 1));
  if (rate * dt <= VOF_CFL || are_bounded(sim)) return;
  restore(sim);
  sim->divergence_volume = divergence;
  sweep_in_parts(sim, dt, parts_of(rate * dt, VOF_CFL));
}

static void set_back(struct two_phase *sim) {
  memcpy(sim->c->v, sim->c_before,
         (size_t)sim->grid.mesh->nleaves * sizeof(double));
  mesh_touch(sim->grid.mesh, sim->c->v);
}

void fractions_synchronise(struct two_phase *sim) {
  const struct mesh *mesh = sim->grid.mesh;
  sim->c_before = scratch_take_one(&sim->scratch, FIELD_CELL, "c_before");
  field_fill(mesh, sim->c);
  memcpy(sim->c_before, sim->c->v, (size_t)mesh->ncells * sizeof(double));
  if (sim->params->single_phase || sim->model.dt == 0) return;
  advance_tracer(sim, 0.5 * sim->model.dt, sim->u_f->v, NULL, sim->c);
  if (mesh_max(mesh, vof_excess(mesh, sim->c->v)) <= VOF_EMPTY) return;
  const bool held = sim->planes_hold;
  const double half = 0.5 * sim->model.dt;
  const int parts = parts_of(half * time_step_rate(sim), VOF_CFL);
  set_back(sim);
  for (int k = 0; k < parts; k++, sim->planes_hold = false) {
    advance_tracer(sim, half / parts, sim->u_f->v, NULL, sim->c);
  }
  sim->planes_hold = held;
}

void fractions_desynchronise(struct two_phase *sim) {
  set_back(sim);
  scratch_give(&sim->scratch, "c_before");
  sim->c_before = NULL;
}

void fractions_read_tracer(struct two_phase *sim, int k, double *value) {
  struct field *tracer = sim->tracer[k];
  const int32_t n = sim->grid.mesh->nleaves;
  double *before = MEM_NEW(double, (size_t)n);
  memcpy(before, tracer->v, (size_t)n * sizeof(double));
  if (sim->model.dt > 0)
    advance_tracer(sim, 0.5 * sim->model.dt, sim->u_f->v, NULL, tracer);
  memcpy(value, tracer->v, (size_t)n * sizeof(double));
  memcpy(tracer->v, before, (size_t)n * sizeof(double));
  mesh_touch(sim->grid.mesh, tracer->v);
  mem_free(before);
}
