/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/two_fluid/transport.h"

#include <math.h>
#include <string.h>

#include "talus/advection.h"
#include "talus/minmax.h"
#include "talus/two_fluid/state.h"
#include "talus/two_fluid_grains.h"

double two_fluid_part_given(const struct two_fluid *sim, double dt, int32_t i) {
  const struct mesh *mesh = sim->grid.mesh;
  const double alpha = sim->alpha->v[i];
  double out = 0;
  if (!(alpha > 0)) return 1;
  for (int s = 0; s < NFACE; s++) {
    const double v = mesh_side(mesh, sim->flux->v, i, s);
    out += max2(s & 1 ? v : -v, 0);
  }
  return dt * out / (mesh_width(mesh, i) * alpha);
}

double two_fluid_given(const struct two_fluid *sim, double dt) {
  double most = 0;
  for (int32_t i = 0; i < sim->grid.mesh->nleaves; i++) {
    if (!two_fluid_has_grains(sim, i)) continue;
    most = max2(most, two_fluid_part_given(sim, dt, i));
  }
  return mesh_max(sim->grid.mesh, most);
}

/* Return whether leaf i and those across its faces are packed. */
static bool is_inside(const struct two_fluid *sim, int32_t i) {
  const int32_t *node = sim->grid.mesh->stencil[i];
  const double *alpha = sim->alpha->v;
  double least = alpha[i];
  for (int s = 0; s < NFACE; s++)
    least = min2(least, alpha[node[stencil_face(s)]]);
  return least >= two_fluid_loosest(&sim->closure, sim->phi_p->v[i]);
}

/* Set keep [>= nleaves + nghosts] to how much of the slope of the grains counts
 * in what a leaf gives away: less, the more a leaf gives, so that what stays
 * behind does not outrun its neighbours. */
static void find_keep(const struct two_fluid *sim, double dt, double *keep) {
  const struct mesh *mesh = sim->grid.mesh;
  for (int32_t i = 0; i < mesh->nleaves; i++)
    keep[i] = is_inside(sim, i)
                  ? max2(1 - 2 * two_fluid_part_given(sim, dt, i), 0)
                  : 0;
  mesh_fill_ghosts(mesh, 1, &keep);
}

/* Return q of what passes face f. */
static double carried(const struct two_fluid *sim, int32_t f, double dt,
                      const double *q, const double *slope,
                      const double *keep) {
  const struct mesh *mesh = sim->grid.mesh;
  const double flux = sim->flux->v[f];
  const double speed =
      sim->w_f[TWO_FLUID_S]->v[f] + sim->v_f[TWO_FLUID_S]->v[f];
  const double u_f = copysign(speed, flux);
  const int32_t *node = mesh->face_node[f];
  const int32_t leaf = mesh->face_leaf[f][flux > 0 ? 0 : 1];
  if (flux == 0) return 0;
  if (leaf < 0) return 0.5 * (q[node[0]] + q[node[1]]); /* at the side */
  const double value = granular_donor(mesh, f, dt, u_f, q, slope);
  return q[leaf] + keep[leaf] * (value - q[leaf]);
}

/* Holds what all quantities of the grains share. */
struct carrier {
  double dt;
  double *keep, *slope, *carried;
};

/* Carry q with the grains; q is filled here. */
static void carry(struct two_fluid *sim, const struct carrier *by,
                  struct field *q) {
  const struct mesh *mesh = sim->grid.mesh;
  const double *flux = sim->flux->v;
  field_fill(mesh, q);
  for (int d = 0; d < DIM; d++) {
    granular_slopes(mesh, d, q->v, by->slope);
    for (int32_t f = mesh->face_begin[d]; f < mesh->face_begin[d + 1]; f++)
      by->carried[f] =
          flux[f] * carried(sim, f, by->dt, q->v, by->slope, by->keep);
  }
  mesh_fill_faces(mesh, 1, (double *const[]){by->carried});
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    const double part = sim->alpha_new->v[i];
    if (part < TWO_FLUID_NONE) continue;
    const double rest = mesh_divergence(mesh, by->carried, i) -
                        q->v[i] * mesh_divergence(mesh, flux, i);
    q->v[i] -= by->dt * rest / part;
  }
  mesh_touch(mesh, q->v);
}

/* Carry tracers with the grains; leaves without grains are in none. */
static void carry_tracers(struct two_fluid *sim, const struct carrier *by) {
  const struct mesh *mesh = sim->grid.mesh;
  for (int k = 0; k < sim->params->ntracers; k++) {
    double *part = sim->tracer[k]->v;
    carry(sim, by, sim->tracer[k]);
    for (int32_t i = 0; i < mesh->nleaves; i++)
      if (sim->alpha_new->v[i] < TWO_FLUID_NONE) part[i] = 0;
    mesh_touch(mesh, part);
  }
}

/* Carry u_s, phi_p, X and tracers with the grains. */
static void carry_grains(struct two_fluid *sim, double dt) {
  double *cell[2], *face;
  scratch_take(&sim->scratch, FIELD_CELL, __func__, 2, cell);
  face = scratch_take_one(&sim->scratch, FIELD_FACE, __func__);
  const struct carrier by = {
      .dt = dt, .keep = cell[0], .slope = cell[1], .carried = face};
  find_keep(sim, dt, by.keep);
  for (int e = 0; e < DIM; e++) carry(sim, &by, sim->u[TWO_FLUID_S][e]);
  carry(sim, &by, sim->phi_p);
  carry(sim, &by, sim->X);
  carry(sim, &by, sim->bed);
  carry_tracers(sim, &by);
  scratch_give(&sim->scratch, __func__);
}

/* Add to `out` [DIM][nleaves] what u_f gains by what the fluid carries over dt,
 * times its part; u_f and g are filled. */
static void carry_fluid(struct two_fluid *sim, double dt, double *const g[DIM],
                        double *const out[DIM]) {
  const struct mesh *mesh = sim->grid.mesh;
  struct advection_work work = {.limiter = LIMITER_NONE};
  double *cell[2 * DIM], *face[DIM + 2], *u[DIM];
  scratch_take(&sim->scratch, FIELD_CELL, __func__, 2 * DIM, cell);
  scratch_take(&sim->scratch, FIELD_FACE, __func__, DIM + 2, face);
  for (int e = 0; e < DIM; e++) {
    work.slope[e] = cell[e], work.transverse[e] = cell[DIM + e];
    work.flux[e] = face[e];
  }
  work.volume = face[DIM];
  double *flux = face[DIM + 1];
  for (int32_t f = 0; f < mesh->nfaces_all; f++)
    flux[f] = sim->j->v[f] - sim->flux->v[f];
  field_arrays(sim->u[TWO_FLUID_F], u);
  advection_momentum(mesh, dt, u, g, flux, NULL, &work, out);
  scratch_give(&sim->scratch, __func__);
}

/* Add `sign` times what was foreseen to u_f, filled here. */
static void add_gain(struct two_fluid *sim, int sign) {
  const struct mesh *mesh = sim->grid.mesh;
  for (int e = 0; e < DIM; e++) {
    double *u = sim->u[TWO_FLUID_F][e]->v;
    for (int32_t i = 0; i < mesh->nleaves; i++)
      u[i] += sign * sim->gain[e]->v[i];
    mesh_touch(mesh, u);
  }
  field_fill_many(mesh, DIM, sim->u[TWO_FLUID_F]);
}

void two_fluid_foresee(struct two_fluid *sim, double dt) {
  const struct mesh *mesh = sim->grid.mesh;
  double *none[DIM], *gain[DIM];
  none[0] = scratch_take_one(&sim->scratch, FIELD_CELL, __func__);
  memset(none[0], 0, (size_t)mesh->ncells * sizeof *none[0]);
  field_arrays(sim->gain, gain);
  for (int e = 0; e < DIM; e++) {
    none[e] = none[0];
    memset(gain[e], 0, (size_t)mesh->nleaves * sizeof *gain[e]);
  }
  carry_fluid(sim, dt, none, gain);
  scratch_give(&sim->scratch, __func__);
  for (int e = 0; e < DIM; e++)
    for (int32_t i = 0; i < mesh->nleaves; i++)
      gain[e][i] /= 1 - sim->alpha->v[i];
  add_gain(sim, 1);
}

/* Carry u_f, with what it has half a step earlier. */
static void carry_momentum(struct two_fluid *sim, double dt) {
  const struct mesh *mesh = sim->grid.mesh;
  double *out[DIM], *g[DIM];
  scratch_take(&sim->scratch, FIELD_CELL, __func__, DIM, out);
  field_arrays(sim->gain, g);
  add_gain(sim, -1);
  for (int e = 0; e < DIM; e++) {
    const struct field *u = sim->u[TWO_FLUID_F][e];
    for (int32_t i = 0; i < mesh->nleaves; i++)
      g[e][i] = (u->saved[i] - u->v[i]) / dt, out[e][i] = 0;
    mesh_touch(mesh, g[e]);
  }
  field_fill_many(mesh, DIM, sim->gain);
  carry_fluid(sim, dt, g, out);
  for (int e = 0; e < DIM; e++) {
    double *u = sim->u[TWO_FLUID_F][e]->v;
    for (int32_t i = 0; i < mesh->nleaves; i++)
      u[i] += out[e][i] / (1 - sim->alpha_new->v[i]);
    mesh_touch(mesh, u);
  }
  scratch_give(&sim->scratch, __func__);
}

void two_fluid_transport(struct two_fluid *sim, double dt) {
  const struct mesh *mesh = sim->grid.mesh;
  carry_grains(sim, dt);
  carry_momentum(sim, dt);
  memcpy(sim->alpha->v, sim->alpha_new->v,
         (size_t)mesh->nleaves * sizeof(double));
  mesh_touch(mesh, sim->alpha->v);
}
