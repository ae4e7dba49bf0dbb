/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/two_fluid/transport.h"

#include <math.h>
#include <string.h>

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

/* Set keep [>= nleaves + nghosts] to how much of the slope of a phase counts in
 * what a leaf gives away: less of grains, the more a leaf gives, so that what
 * stays behind does not outrun its neighbours. */
static void find_keep(const struct two_fluid *sim, int phase, double dt,
                      double *keep) {
  const struct mesh *mesh = sim->grid.mesh;
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    keep[i] = 1;
    if (phase == TWO_FLUID_F) continue;
    keep[i] = is_inside(sim, i)
                  ? max2(1 - 2 * two_fluid_part_given(sim, dt, i), 0)
                  : 0;
  }
  mesh_fill_ghosts(mesh, 1, &keep);
}

/* Set the differences of q along d over leaves: central for the fluid, limited
 * for grains. */
static void find_slopes(const struct two_fluid *sim, int phase, int d,
                        const double *q, double *slope) {
  const struct mesh *mesh = sim->grid.mesh;
  const int lower = stencil_face(2 * d), upper = stencil_face(2 * d + 1);
  if (phase == TWO_FLUID_S) {
    granular_slopes(mesh, d, q, slope);
    return;
  }
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    const int32_t *node = mesh->stencil[i];
    slope[i] = 0.5 * (q[node[upper]] - q[node[lower]]);
  }
  mesh_fill_ghosts(mesh, 1, &slope);
}

/* Return q of what passes face f. */
static double carried(const struct two_fluid *sim, int phase, int32_t f,
                      double dt, double flux, const double *q,
                      const double *slope, const double *keep) {
  const struct mesh *mesh = sim->grid.mesh;
  const double speed = sim->w_f[phase]->v[f] + sim->v_f[phase]->v[f];
  const double u_f = copysign(speed, flux);
  const int32_t *node = mesh->face_node[f];
  const int32_t leaf = mesh->face_leaf[f][flux > 0 ? 0 : 1];
  if (flux == 0) return 0;
  if (leaf < 0) return 0.5 * (q[node[0]] + q[node[1]]); /* at the side */
  const double value = granular_donor(mesh, f, dt, u_f, q, slope);
  return q[leaf] + keep[leaf] * (value - q[leaf]);
}

/* Holds what all quantities of a phase share. */
struct carrier {
  int phase;
  double dt;
  double *flux, *keep; /* flux: of the phase, all faces */
  double *slope, *carried;
};

/* Carry q with a phase; q is filled here. */
static void carry(struct two_fluid *sim, const struct carrier *by,
                  struct field *q) {
  const struct mesh *mesh = sim->grid.mesh;
  field_fill(mesh, q);
  for (int d = 0; d < DIM; d++) {
    find_slopes(sim, by->phase, d, q->v, by->slope);
    for (int32_t f = mesh->face_begin[d]; f < mesh->face_begin[d + 1]; f++)
      by->carried[f] =
          by->flux[f] * carried(sim, by->phase, f, by->dt, by->flux[f], q->v,
                                by->slope, by->keep);
  }
  mesh_fill_faces(mesh, 1, (double *const[]){by->carried});
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    const double part = two_fluid_part(by->phase, sim->alpha_new->v[i]);
    if (part < TWO_FLUID_NONE) continue;
    const double rest = mesh_divergence(mesh, by->carried, i) -
                        q->v[i] * mesh_divergence(mesh, by->flux, i);
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

void two_fluid_transport(struct two_fluid *sim, double dt) {
  const struct mesh *mesh = sim->grid.mesh;
  double *cell[2], *face[2];
  scratch_take(&sim->scratch, FIELD_CELL, __func__, 2, cell);
  scratch_take(&sim->scratch, FIELD_FACE, __func__, 2, face);
  struct carrier by = {.dt = dt,
                       .flux = face[0],
                       .keep = cell[0],
                       .slope = cell[1],
                       .carried = face[1]};
  for (by.phase = 0; by.phase < TWO_FLUID_NPHASES; by.phase++) {
    for (int32_t f = 0; f < mesh->nfaces_all; f++) {
      const double flux = sim->flux->v[f];
      by.flux[f] = by.phase == TWO_FLUID_S ? flux : sim->j->v[f] - flux;
    }
    find_keep(sim, by.phase, dt, by.keep);
    for (int e = 0; e < DIM; e++) carry(sim, &by, sim->u[by.phase][e]);
    if (by.phase == TWO_FLUID_F) continue;
    carry(sim, &by, sim->phi_p);
    carry(sim, &by, sim->X);
    carry_tracers(sim, &by);
  }
  scratch_give(&sim->scratch, __func__);
  memcpy(sim->alpha->v, sim->alpha_new->v,
         (size_t)mesh->nleaves * sizeof(double));
  mesh_touch(mesh, sim->alpha->v);
}
