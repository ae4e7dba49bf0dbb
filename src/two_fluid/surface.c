/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/two_fluid/surface.h"

#include <math.h>

#include "talus/minmax.h"
#include "talus/outline.h"
#include "talus/two_fluid/state.h"
#include "talus/two_fluid_grains.h"
#include "talus/vof.h"

/* A bed is at least so many grains thick. */
static const double THINNEST = 0.5;
/* The part of a face that is wetted is that of a volume so many edges deep. */
static const double SHALLOW = 1e-6;

/* Return s of a leaf, Pa. */
static double weight_of(const struct two_fluid *sim, int axis, int32_t i) {
  return 0.5 * sim->grid.mesh->h[i] * fabs(sim->params->gravity[axis]) *
         (two_fluid_density(sim, TWO_FLUID_S) -
          two_fluid_density(sim, TWO_FLUID_F));
}

/* Return P(alpha) of leaf i at rest, with its own plastic packing. */
static double pressure_at_rest(const struct two_fluid *sim, int32_t i,
                               double alpha) {
  const struct two_fluid_frozen with = {.phi_p = sim->phi_p->v[i]};
  return two_fluid_pressure(&sim->closure, alpha, &with, NULL);
}

/* Set `load` of leaves to the load they carry over s alpha. */
static void find_carried(const struct two_fluid *sim, int axis, double *load) {
  const struct mesh *mesh = sim->grid.mesh;
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    const double alpha = sim->alpha->v[i];
    load[i] = two_fluid_has_grains(sim, i)
                  ? min2(pressure_at_rest(sim, i, alpha) /
                             (weight_of(sim, axis, i) * alpha),
                         1)
                  : 0;
  }
  mesh_touch(mesh, load);
}

/* Does leaf i rest on what is across side `below`, with less above? */
static bool rests(const struct two_fluid *sim, int32_t i, int below,
                  const double *load) {
  const struct mesh *mesh = sim->grid.mesh;
  const int32_t there = mesh->stencil[i][stencil_face(below)];
  const int32_t above = mesh->stencil[i][stencil_face(below ^ 1)];
  const bool wall = two_fluid_is_side(sim, mesh->cell_face[i][below]);
  const double thickness = sim->alpha->v[i] * mesh->h[i] /
                           two_fluid_loosest(&sim->closure, sim->phi_p->v[i]);
  if (thickness < THINNEST * sim->closure.param[TWO_FLUID_GRAINS_D])
    return false;
  if (sim->alpha->v[above] >= sim->alpha->v[i] &&
      !two_fluid_is_side(sim, mesh->cell_face[i][below ^ 1]))
    return false;
  return wall || load[there] >= 0.5;
}

/* Set c, phi and s of a leaf. */
static void set_leaf(struct two_fluid *sim, int32_t i, double s, bool resting) {
  const double alpha = max2(sim->alpha->v[i], 0);
  const double loose = two_fluid_loosest(&sim->closure, sim->phi_p->v[i]);
  double phi = alpha;
  sim->rest->v[i] = resting ? s : 0;
  sim->c->v[i] = min2(alpha / (0.9 * loose), 1);
  if (resting) {
    phi = two_fluid_settled(&sim->closure, s * alpha, sim->phi_p->v[i]);
    phi = max2(phi, alpha);
    sim->c->v[i] = alpha / phi;
  }
  sim->phi->v[i] = phi;
}

/* No leaf has a surface. */
static void set_none(struct two_fluid *sim) {
  for (int32_t i = 0; i < sim->grid.mesh->nleaves; i++) {
    sim->phi->v[i] = max2(sim->alpha->v[i], 0);
    sim->rest->v[i] = 0;
  }
  mesh_touch(sim->grid.mesh, sim->phi->v);
  field_fill(sim->grid.mesh, sim->phi);
}

void two_fluid_find_surface(struct two_fluid *sim) {
  const struct mesh *mesh = sim->grid.mesh;
  const int axis = outline_axis(sim->params->gravity);
  const double g = sim->params->gravity[axis];
  if (g == 0 || sim->keys->surface == TWO_FLUID_NO_SURFACE) {
    set_none(sim);
    return;
  }
  find_carried(sim, axis, sim->carried->v);
  field_fill(mesh, sim->carried);
  for (int32_t i = 0; i < mesh->nleaves; i++)
    set_leaf(sim, i, weight_of(sim, axis, i),
             rests(sim, i, 2 * axis + (g > 0 ? 1 : 0), sim->carried->v));
  mesh_touch(mesh, sim->c->v);
  mesh_touch(mesh, sim->phi->v);
  field_fill(mesh, sim->c);
  field_fill(mesh, sim->phi);
  double *normal[DIM];
  field_arrays(sim->normal, normal);
  vof_reconstruct(mesh, sim->c->v, normal, sim->plane->v);
}

/* Does the surface cut a leaf or ghost? */
static bool is_cut(const struct two_fluid *sim, int32_t i) {
  return sim->phi->v[i] > sim->alpha->v[i] * (1 + 1e-9) &&
         vof_is_cut(sim->c->v[i]);
}

/* Is side s of a leaf that on which gravity leaves it? */
static bool is_top(const struct two_fluid *sim, int s) {
  const int axis = outline_axis(sim->params->gravity);
  return s == 2 * axis + (sim->params->gravity[axis] > 0 ? 0 : 1);
}

double two_fluid_wetted(const struct two_fluid *sim, int32_t i, int s) {
  const struct mesh *mesh = sim->grid.mesh;
  double n[DIM], lo[DIM], hi[DIM];
  const int d = s / 2;
  if (!is_cut(sim, i)) return 1;
  if (is_top(sim, s)) return 1;
  for (int e = 0; e < DIM; e++) {
    n[e] = sim->normal[e]->v[i];
    lo[e] = -0.5, hi[e] = 0.5;
  }
  if (s & 1)
    lo[d] = 0.5 - SHALLOW;
  else
    hi[d] = -0.5 + SHALLOW;
  return vof_part(mesh, i, n, sim->plane->v[i], lo, hi);
}

double two_fluid_passing(const void *context, int d, int32_t f, double dt,
                         double u_f, double otherwise) {
  const struct two_fluid *sim = context;
  const struct mesh *mesh = sim->grid.mesh;
  const int upwind = u_f > 0 ? 0 : 1;
  const int32_t leaf = mesh->face_leaf[f][upwind];
  double *normal[DIM];
  if (leaf < 0 || !is_cut(sim, leaf)) return otherwise;
  if (is_top(sim, 2 * d + 1 - upwind)) return 0;
  for (int e = 0; e < DIM; e++) normal[e] = sim->normal[e]->v;
  const double deep =
      max2(mesh_swept(mesh, f, d, upwind, fabs(u_f) * dt), SHALLOW);
  return sim->phi->v[leaf] *
         vof_swept(mesh, d, f, upwind, min2(deep, 1), normal, sim->plane->v);
}
