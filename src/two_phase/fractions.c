/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/two_phase/fractions.h"

#include <math.h>
#include <string.h>

#include "talus/memory.h"
#include "talus/minmax.h"
#include "talus/momentum.h"
#include "talus/outline.h"
#include "talus/two_phase/state.h"
#include "talus/two_phase/time_step.h"
#include "talus/vof.h"

/* Planes of the cut leaves of a fraction. */
struct planes {
  double *normal[DIM], *alpha;
};

/* A fraction that is carried over dt with u_f, and with c the velocity u. */
struct carriage {
  struct two_phase *sim;
  double dt;
  const double *u_f;
  struct field *fraction;
  bool with_u;
  double *cc, *flux;          /* vof.h; flux is scratch */
  struct planes own;          /* to be made anew; those of sim with u */
  const struct planes *valid; /* of the fraction as it is, NULL: none */
  const struct planes *last;  /* of the last sweep */
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

/* Sweep the fraction, which is filled, along d. */
static void sweep_fraction(struct carriage *k, int d) {
  const struct mesh *mesh = k->sim->grid.mesh;
  double *c = k->fraction->v;
  if (!k->valid) {
    vof_reconstruct(mesh, c, k->own.normal, k->own.alpha);
    k->valid = &k->own;
  }
  vof_flux(mesh, d, k->dt, k->u_f, k->sim->grid.open, c, k->valid->normal,
           k->valid->alpha, k->flux);
  vof_update(mesh, d, k->dt, k->u_f, k->flux, k->cc, c);
  k->last = k->valid, k->valid = NULL;
}

/* Sweep c, and u in the band. Both are filled. */
static void sweep_with_u(struct carriage *k, int d) {
  struct two_phase *sim = k->sim;
  const struct mesh *mesh = sim->grid.mesh;
  double density[2], *u[DIM], *start[DIM], *cell[DIM + 1], *face[DIM + 1];
  scratch_take(&sim->scratch, FIELD_CELL, __func__, DIM + 1, cell);
  scratch_take(&sim->scratch, FIELD_FACE, __func__, DIM + 1, face);
  double *c_old = cell[DIM];
  struct momentum_flux flux = {.mass = face[DIM]};
  two_phase_densities(sim, density);
  field_arrays(sim->u, u), field_arrays(sim->u_old, start);
  for (int e = 0; e < DIM; e++) {
    flux.carried[e] = face[e];
    flux.slope[e] = cell[e];
  }
  memcpy(c_old, sim->c->v, (size_t)mesh->nleaves * sizeof(double));
  sweep_fraction(k, d);
  if (sim->params->advection == ADVECTION_ON) {
    momentum_flux(mesh, d, k->dt, density, k->u_f, c_old, k->flux, sim->band->v,
                  u, &flux);
    momentum_update(mesh, d, k->dt, density, k->u_f, c_old, k->cc, sim->band->v,
                    start, &flux, u);
  }
  scratch_give(&sim->scratch, __func__);
}

static void sweep_along(struct carriage *k, int d) {
  if (k->with_u) {
    sweep_with_u(k, d);
  } else {
    sweep_fraction(k, d);
  }
}

static void fill(const struct carriage *k) {
  const struct mesh *mesh = k->sim->grid.mesh;
  if (k->with_u) field_fill_many(mesh, DIM, k->sim->u);
  field_fill(mesh, k->fraction);
}

/* List the arrays that sweeps change, the fraction first; returns how many. */
static int list_carried(const struct carriage *k, double *v[DIM + 1]) {
  v[0] = k->fraction->v;
  field_arrays(k->sim->u, v + 1);
  return k->with_u ? DIM + 1 : 1;
}

/* Exchange what is carried with `other`. */
static void exchange(const struct carriage *k, double *const other[DIM + 1]) {
  double *v[DIM + 1];
  const int n = list_carried(k, v);
  for (int e = 0; e < n; e++) {
    for (int32_t i = 0; i < k->sim->grid.mesh->ncells; i++) {
      const double kept = v[e][i];
      v[e][i] = other[e][i], other[e][i] = kept;
    }
  }
}

/* Take the mean of what is carried and `other`, of u by mass. */
static void take_mean(const struct carriage *k, double *const other[DIM + 1]) {
  const struct mesh *mesh = k->sim->grid.mesh;
  double density[2], *v[DIM + 1];
  const int n = list_carried(k, v);
  two_phase_densities(k->sim, density);
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    const double rho = density[1] + v[0][i] * (density[0] - density[1]);
    const double rho_other =
        density[1] + other[0][i] * (density[0] - density[1]);
    for (int e = 1; e < n; e++) {
      v[e][i] = (rho * v[e][i] + rho_other * other[e][i]) / (rho + rho_other);
    }
    v[0][i] = 0.5 * (v[0][i] + other[0][i]);
  }
  for (int e = 0; e < n; e++) mesh_touch(mesh, v[e]);
}

/* Sweep along axes a and b in both orders and take the mean, so that neither
 * comes first. All is filled. */
static void sweep_both(struct carriage *k, int a, int b) {
  struct two_phase *sim = k->sim;
  double *v[DIM + 1], *other[DIM + 1];
  const int n = list_carried(k, v);
  scratch_take(&sim->scratch, FIELD_CELL, __func__, n, other);
  for (int e = 0; e < n; e++) {
    memcpy(other[e], v[e], (size_t)sim->grid.mesh->ncells * sizeof(double));
  }
  sweep_along(k, a);
  exchange(k, other), k->valid = k->last; /* back to the start */
  sweep_along(k, b);
  fill(k), sweep_along(k, a);
  exchange(k, other);
  fill(k), sweep_along(k, b);
  take_mean(k, other);
  scratch_give(&sim->scratch, __func__);
}

/* Sweep along all axes, in an order that turns from step to step. In 3D the
 * horizontal axes are alike. */
static void sweep(struct carriage *k) {
  const int turn = (int)(k->sim->model.step % 2);
  if (DIM == 2) {
    sweep_along(k, turn);
    fill(k), sweep_along(k, 1 - turn);
    return;
  }
  const int d = outline_axis(k->sim->params->gravity);
  if (turn == 0) sweep_along(k, d), fill(k);
  sweep_both(k, (d + 1) % DIM, (d + 2) % DIM);
  if (turn == 1) fill(k), sweep_along(k, d);
}

/* Advance a tracer, or c alone, over dt. The planes of c stay as they are, as c
 * may be set back. */
static void advance_tracer(struct two_phase *sim, double dt, const double *u_f,
                           const double *source, struct field *tracer) {
  const struct mesh *mesh = sim->grid.mesh;
  struct carriage k = {sim, dt, u_f, tracer, .with_u = false};
  struct planes known = {.alpha = sim->plane->v};
  double *cell[DIM + 2];
  scratch_take(&sim->scratch, FIELD_CELL, "tracer", DIM + 2, cell);
  for (int e = 0; e < DIM; e++) k.own.normal[e] = cell[e];
  k.own.alpha = cell[DIM], k.cc = cell[DIM + 1];
  k.flux = scratch_take_one(&sim->scratch, FIELD_FACE, "tracer");
  field_arrays(sim->normal, known.normal);
  if (tracer == sim->c && sim->planes_hold) k.valid = &known;
  vof_freeze(mesh, tracer->v, k.cc);
  field_fill(mesh, tracer);
  sweep(&k);
  remove_dilation(sim, dt, source, k.cc, tracer->v);
  scratch_give(&sim->scratch, "tracer");
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
  struct carriage k = {sim, dt, u_f, sim->c, .with_u = true, .cc = cc};
  field_arrays(sim->normal, k.own.normal), k.own.alpha = sim->plane->v;
  k.flux = scratch_take_one(&sim->scratch, FIELD_FACE, __func__);
  if (sim->planes_hold) k.valid = &k.own;
  sweep(&k);
  sim->planes_hold = false;
  scratch_give(&sim->scratch, __func__);
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
