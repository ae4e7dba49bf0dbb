/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A volume fraction carried by a prescribed velocity, by the sweeps of vof.h on
 * the fields of a simulation, whose grid may follow the surface. */
#ifndef TALUS_TESTS_CARRIED_H
#define TALUS_TESTS_CARRIED_H

#include "../mesh/transport.h"
#include "report.h"
#include "runs.h"

/* A flow that brings a shape back to its place: velocity(d, x, h), times a
 * factor of time. */
struct carried_flow {
  /* Component d averaged over the face of edge h around x: solenoidal to
   * round-off, as what a stream function or vector potential gives. */
  double (*velocity)(int d, const double x[3], double h);
  double (*path)(double t); /* integral of the factor from 0 on; NULL: t */
  double turn, end;         /* where it changes sign, and the last time */
  shape_level_set shape;
  void *context;
  double origin; /* of the unit box, along all axes */
};

struct carried {
  const struct carried_flow *flow;
  struct two_phase *sim;
  double *steady; /* [nfaces_all] velocity without the factor */
  double volume;  /* at the start */
  double drift;   /* largest |volume / start - 1| */
  double excess;  /* how far fractions leave [0, 1] */
};

/* Fill the fractions of the shape, corners found to 1/32 of a leaf. */
static inline void carried_shape(const struct carried *c, double *v) {
  const struct mesh *mesh = c->sim->grid.mesh;
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    v[i] = shape_fraction(c->flow->shape, c->flow->context, mesh->x[i],
                          mesh->h[i], 5);
  }
}

static inline void carried_set_faces(struct carried *c) {
  const struct mesh *mesh = c->sim->grid.mesh;
  c->steady = mem_resize(c->steady, (size_t)mesh->nfaces_all, sizeof(double));
  for (int d = 0; d < DIM; d++) {
    for (int32_t f = mesh->face_begin[d]; f < mesh->face_begin[d + 1]; f++) {
      double x[3];
      face_centre(mesh, d, f, x);
      c->steady[f] = c->flow->velocity(d, x, mesh->face_h[f]);
    }
  }
  mesh_fill_faces(mesh, 1, &c->steady);
}

/* Return the path from `time` to `time` + dt. */
static inline double carried_path(const struct carried *c, double dt) {
  const double time = c->sim->model.time;
  if (!c->flow->path) return dt;
  return c->flow->path(time + dt) - c->flow->path(time);
}

/* Return the dt in which the steady flow would have gone as far as the bound
 * allows, not beyond the turn or the end. */
static inline double carried_dt(const struct carried *c) {
  const double time = c->sim->model.time, turn = c->flow->turn;
  const double most = courant_dt(c->sim->grid.mesh, c->steady, 0.5);
  double low = 0, high = (time < turn ? turn : c->flow->end) - time;
  if (fabs(carried_path(c, high)) <= most) return high;
  for (int k = 0; k < 60; k++) {
    const double middle = 0.5 * (low + high);
    if (fabs(carried_path(c, middle)) <= most)
      low = middle;
    else
      high = middle;
  }
  return low;
}

static inline void carried_adapt(struct carried *c, double dt) {
  struct two_phase *sim = c->sim;
  double travel = 0;
  for (int32_t i = 0; i < sim->grid.mesh->nleaves; i++) {
    for (int f = 0; f < NFACE && vof_is_cut(sim->c->v[i]); f++) {
      const double u = fabs(sim->u_f->v[sim->grid.mesh->cell_face[i][f]]);
      travel = larger(travel, u * dt / sim->grid.mesh->h[i]);
    }
  }
  sim->travel += travel;
  if (adapt_is_due(&sim->grid, sim->model.step, sim->travel) &&
      two_phase_adapt(sim))
    carried_set_faces(c);
}

static inline void carried_step(struct carried *c) {
  struct two_phase *sim = c->sim;
  const struct bench bench = {.mesh = sim->grid.mesh};
  struct field cc = {.v =
                         scratch_take_one(&sim->scratch, FIELD_CELL, __func__)};
  struct field flux = {
      .v = scratch_take_one(&sim->scratch, FIELD_FACE, __func__)};
  struct transport t = {.c = sim->c,
                        .u_f = sim->u_f,
                        .plane = sim->plane,
                        .frozen = &cc,
                        .flux = &flux};
  const double dt = carried_dt(c), factor = carried_path(c, dt) / dt;
  field_arrays(sim->normal, t.normal);
  for (int32_t f = 0; f < sim->grid.mesh->nfaces_all; f++) {
    sim->u_f->v[f] = factor * c->steady[f];
  }
  transport_step(&bench, &t, (int)(sim->model.step % DIM), dt);
  scratch_give(&sim->scratch, __func__);
  const double volume = integral(sim->grid.mesh, sim->c->v);
  c->excess = larger(c->excess, transport_excess(&bench, &t));
  c->drift = larger(c->drift, fabs(volume / c->volume - 1));
  sim->model.time += dt, sim->model.step++;
  carried_adapt(c, dt);
}

/* Return the integral of |c - exact| over the box. */
static inline double carried_error(struct carried *c) {
  struct two_phase *sim = c->sim;
  double *error = MEM_NEW(double, sim->grid.mesh->nleaves);
  carried_shape(c, error);
  for (int32_t i = 0; i < sim->grid.mesh->nleaves; i++) {
    error[i] = fabs(error[i] - sim->c->v[i]);
  }
  const double sum = integral(sim->grid.mesh, error);
  mem_free(error);
  return sum;
}

/* Make one run; adapted: the grid is fine (`level`) in a band of three cells
 * along the surface and coarse (3) elsewhere. Returns the error integral, NAN
 * if a fraction leaves [0, 1]; *drift: of the volume. */
static inline double carried_run(const struct carried_flow *flow, int level,
                                 bool adapted, double *drift) {
  struct params params = periodic_params(level);
  params.single_phase = false;
  params.pressure_level_given = true;
  params.shape = (struct function){flow->shape, flow->context};
  for (int d = 0; d < DIM; d++) params.origin[d] = flow->origin;
  if (adapted) params_follow_surface(&params, 3, 3);
  struct carried c = {.flow = flow, .sim = sim_start(&params)};
  carried_set_faces(&c);
  carried_shape(&c, c.sim->c->v);
  c.volume = integral(c.sim->grid.mesh, c.sim->c->v);
  while (c.sim->model.time < flow->end * (1 - 1e-12)) carried_step(&c);
  const double error = carried_error(&c);
  *drift = c.drift;
  two_phase_destroy(c.sim);
  mem_free(c.steady);
  return c.excess <= 1e-12 ? error : NAN;
}

/* Report rows of a flow on n levels from `first` on: the error integral divided
 * by `unit`, with bars or NULL, and the worst drift against 1e-12. error [n]:
 * out. */
static inline void carried_report(struct report *report, const char *grid,
                                  const struct carried_flow *flow, int first,
                                  int n, double unit, const double bars[],
                                  double error[]) {
  const bool adapted = strstr(grid, "adapted") != NULL;
  double worst = 0, drift;
  for (int k = 0; k < n; k++) {
    error[k] = carried_run(flow, first + k, adapted, &drift) / unit;
    worst = larger(worst, drift);
  }
  report_errors(report, grid, "mean |c - c0|", first, n, error, bars, 0);
  report_at_most(report, grid, "drift of volume", first + n - 1, worst, 1e-12);
}

#endif
