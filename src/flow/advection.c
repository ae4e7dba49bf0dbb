/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/advection.h"

#include <math.h>

#include "talus/minmax.h"
#include "talus/momentum.h"

/* Generalised minmod takes at most this times the smaller difference
 * (docs/notes/limiter.md). */
#define LIMITER_FACTOR 1.3

/* Return the slope of a leaf from the differences to its lower and upper
 * neighbour. */
static inline double limited(enum limiter limiter, double a, double b) {
  const double mean = 0.5 * (a + b);
  if (limiter == LIMITER_NONE) return mean;
  if (a * b <= 0) return 0;
  const double factor = limiter == LIMITER_MINMOD ? 1 : LIMITER_FACTOR;
  const double most = factor * min2(fabs(a), fabs(b));
  return copysign(min2(most, fabs(mean)), mean);
}

/* Set slopes along d of the components u_e of a leaf, first <= e < end, and the
 * upwind changes per time of u_e along the other axes with velocities w. */
static inline void leaf_terms(const struct mesh *mesh, enum limiter limiter,
                              int d, int32_t i, const double w[DIM], int first,
                              int end, double *const u[DIM],
                              const struct advection_work *work) {
  const int32_t *node = mesh->stencil[i];
  for (int e = first; e < end; e++) {
    const double *u_e = u[e], here = u_e[i];
    double sum = 0;
    for (int t = 0; t < DIM; t++) {
      const double below = here - u_e[node[stencil_face(2 * t)]];
      const double above = u_e[node[stencil_face(2 * t + 1)]] - here;
      if (t == d) {
        work->slope[e][i] = limited(limiter, below, above);
      } else {
        sum += w[t] * (w[t] < 0 ? above : below);
      }
    }
    work->transverse[e][i] = mesh_leaf_slope(mesh, i, sum);
  }
}

/* Holds what all components share at a face, for the sign of u_n. */
struct upwind {
  const int32_t *node; /* on both sides */
  int32_t from, leaf;  /* upwind node and leaf; leaf -1: a boundary */
  double reach;        /* edges of the leaf from the node to where the value
                          comes from */
};

static inline struct upwind upwind_of(const struct mesh *mesh, int32_t f,
                                      double u_n, double dt) {
  const int side = u_n > 0 ? 0 : 1;
  const int32_t *node = mesh->face_node[f];
  struct upwind up = {node, node[side], mesh->face_leaf[f][side], 0};
  if (up.leaf < 0) return up;
  up.reach = (side ? -1 : 1) - mesh_face_edges(mesh, f, u_n * dt);
  up.reach *= up.from < mesh->begin_virtual ? 0.5 : 0.25; /* a coarse leaf */
  return up;
}

/* Evaluate the formula of the header at one face. */
static inline double face_value(const struct upwind *up, double dt,
                                const double *u_e, const double *g_e,
                                const double *slope, const double *transverse) {
  const int32_t *node = up->node;
  if (up->leaf < 0) return 0.5 * (u_e[node[0]] + u_e[node[1]]);
  return u_e[up->from] + up->reach * slope[up->leaf] -
         0.5 * dt * transverse[up->leaf] +
         0.25 * dt * (g_e[node[0]] + g_e[node[1]]);
}

void advection_predict(const struct mesh *mesh, double dt, double *const u[DIM],
                       double *const g[DIM], const bool *closed,
                       struct advection_work *work, double *u_f) {
  const enum limiter limiter = work->limiter;
#pragma GCC unroll 3 /* so that d is known in the loops */
  for (int d = 0; d < DIM; d++) {
    double *v[2] = {work->slope[d], work->transverse[d]};
    for (int32_t i = 0; i < mesh->nleaves; i++) {
      double w[DIM];
      for (int t = 0; t < DIM; t++) w[t] = u[t][i];
      leaf_terms(mesh, limiter, d, i, w, d, d + 1, u, work);
    }
    mesh_fill_ghosts(mesh, 2, v);
    for (int32_t f = mesh->face_begin[d]; f < mesh->face_begin[d + 1]; f++) {
      const int32_t *node = mesh->face_node[f];
      const int patch = mesh->face_patch[f];
      const double u_n = 0.5 * (u[d][node[0]] + u[d][node[1]]);
      if (patch >= 0 && closed[patch]) {
        u_f[f] = u_n; /* the wall's own normal velocity */
      } else {
        const struct upwind up = upwind_of(mesh, f, u_n, dt);
        u_f[f] = face_value(&up, dt, u[d], g[d], v[0], v[1]);
      }
    }
  }
  mesh_fill_faces(mesh, 1, &u_f);
}

static inline void axis_fluxes(const struct mesh *mesh, int d, double dt,
                               double *const u[DIM], double *const g[DIM],
                               const double *u_f, const double *band,
                               struct advection_work *work) {
  const enum limiter limiter = work->limiter;
  double *v[2 * DIM];
  for (int e = 0; e < DIM; e++) {
    v[2 * e] = work->slope[e], v[2 * e + 1] = work->transverse[e];
  }
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    double w[DIM];
    for (int t = 0; t < DIM; t++) w[t] = mesh_mean_along(mesh, u_f, i, t);
    leaf_terms(mesh, limiter, d, i, w, 0, DIM, u, work);
  }
  mesh_fill_ghosts(mesh, 2 * DIM, v);
  for (int32_t f = mesh->face_begin[d]; f < mesh->face_begin[d + 1]; f++) {
    const bool skip = band && momentum_face_in_band(mesh, band, f);
    const double u_n = skip ? 0 : u_f[f];
    work->volume[f] = u_n;
    const struct upwind up = upwind_of(mesh, f, u_n, dt);
    for (int e = 0; e < DIM; e++) {
      work->flux[e][f] = u_n == 0 ? 0
                                  : u_n * face_value(&up, dt, u[e], g[e],
                                                     v[2 * e], v[2 * e + 1]);
    }
  }
}

void advection_momentum(const struct mesh *mesh, double dt,
                        double *const u[DIM], double *const g[DIM],
                        const double *u_f, const double *band,
                        struct advection_work *work, double *const out[DIM]) {
#pragma GCC unroll 3
  for (int d = 0; d < DIM; d++) {
    axis_fluxes(mesh, d, dt, u, g, u_f, band, work);
  }
  double *v[DIM + 1] = {work->volume};
  for (int e = 0; e < DIM; e++) v[e + 1] = work->flux[e];
  mesh_fill_faces(mesh, DIM + 1, v);
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    const double net = mesh_net(mesh, work->volume, i);
    for (int e = 0; e < DIM; e++) {
      double sum = -net * u[e][i];
      for (int d = 0; d < DIM; d++) {
        sum += mesh_net_along(mesh, work->flux[e], i, d);
      }
      out[e][i] -= dt / mesh_width(mesh, i) * sum;
    }
  }
  for (int e = 0; e < DIM; e++) mesh_touch(mesh, out[e]);
}
