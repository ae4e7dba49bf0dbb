/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A volume fraction on a bench and the sweeps that move it. */
#ifndef TALUS_TESTS_TRANSPORT_H
#define TALUS_TESTS_TRANSPORT_H

#include "../unit/level_sets.h"
#include "bench.h"
#include "talus/vof.h"

struct transport {
  struct field *c, *u_f, *plane, *frozen, *flux;
  double *normal[DIM];
};

static inline struct transport transport_new(struct bench *b) {
  static const char *const names[] = {"normal_x", "normal_y", "normal_z"};
  struct transport t = {.c = bench_cell(b, "c"),
                        .u_f = bench_face(b, "u_f"),
                        .plane = bench_cell(b, "plane"),
                        .frozen = bench_cell(b, "frozen"),
                        .flux = bench_face(b, "flux")};
  struct field *normal[DIM];
  bench_vector(b, names, normal);
  field_arrays(normal, t.normal);
  return t;
}

static inline void transport_sweep(const struct bench *b, struct transport *t,
                                   int d, double dt) {
  field_fill(b->mesh, t->c);
  vof_reconstruct(b->mesh, t->c->v, t->normal, t->plane->v);
  vof_flux(b->mesh, d, dt, t->u_f->v, NULL, t->c->v, t->normal, t->plane->v,
           t->flux->v);
  vof_update(b->mesh, d, dt, t->u_f->v, t->flux->v, t->frozen->v, t->c->v);
}

/* Take one step: a sweep per axis, from axis step % DIM on. */
static inline void transport_step(const struct bench *b, struct transport *t,
                                  int step, double dt) {
  vof_freeze(b->mesh, t->c->v, t->frozen->v);
  for (int s = 0; s < DIM; s++) transport_sweep(b, t, (step + s) % DIM, dt);
}

/* Return how far the fractions leave [0, 1]. */
static inline double transport_excess(const struct bench *b,
                                      const struct transport *t) {
  double most = 0;
  for (int32_t i = 0; i < b->mesh->nleaves; i++) {
    most = larger(most, larger(-t->c->v[i], t->c->v[i] - 1));
  }
  return mesh_max(b->mesh, most);
}

/* A ball, or a box, as level sets of the shape x - centre - shift. */
struct body {
  double centre[3], size;
};

static inline double ball(void *context, const double x[3]) {
  const struct body *body = (const struct body *)context;
  return level_set_ball(body->centre, body->size, x);
}

static inline double cube(void *context, const double x[3]) {
  const struct body *body = (const struct body *)context;
  double lo[3], hi[3];
  for (int d = 0; d < 3; d++) {
    lo[d] = body->centre[d] - body->size;
    hi[d] = body->centre[d] + body->size;
  }
  return level_set_box(lo, hi, x);
}

#endif
