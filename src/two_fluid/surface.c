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
/* A bed that fills this part of a leaf carries what lies in the one above. */
static const double FULL = 0.5;
/* A leaf of this part of the loosest solid fraction at rest is full. */
static const double PACKED = 0.9;
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

/* Return P of a bed of packing phi in leaf i, but for its granular temperature.
 */
static double pressure_of(const struct two_fluid *sim, int32_t i, double phi) {
  const struct two_fluid_frozen with = {.phi_p = sim->phi_p->v[i],
                                        .X = sim->X->v[i]};
  return two_fluid_pressure(&sim->closure, phi, &with, NULL);
}

/* Return the load of the middle of the bed in leaf i, Pa. */
static double load_of(const struct two_fluid *sim, int32_t i) {
  return sim->rest->v[i] * max2(sim->alpha->v[i], 0) + sim->burden->v[i];
}

/* Return the least packing of a bed in leaf i. */
static double loosest_bed(const struct two_fluid *sim, int32_t i) {
  return PACKED * two_fluid_loosest(&sim->closure, sim->phi_p->v[i]);
}

/* Set `load` of leaves to the load they carry over s alpha; 1 in a bed. */
static void find_carried(const struct two_fluid *sim, int axis, double *load) {
  const struct mesh *mesh = sim->grid.mesh;
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    const double alpha = sim->alpha->v[i];
    load[i] = 1;
    if (alpha >= loosest_bed(sim, i)) continue;
    load[i] = two_fluid_has_grains(sim, i)
                  ? min2(pressure_at_rest(sim, i, alpha) /
                             (weight_of(sim, axis, i) * alpha),
                         1)
                  : 0;
  }
  mesh_touch(mesh, load);
}

/* Has leaf i grains, and more than that on the side away from `below`? */
static bool is_highest(const struct two_fluid *sim, int32_t i, int below) {
  const struct mesh *mesh = sim->grid.mesh;
  const int32_t above = mesh->stencil[i][stencil_face(below ^ 1)];
  return two_fluid_has_grains(sim, i) &&
         (sim->alpha->v[above] < sim->alpha->v[i] ||
          two_fluid_is_side(sim, mesh->cell_face[i][below ^ 1]));
}

/* Does leaf i rest on a full one across side `below`, with less above? */
static bool rests(const struct two_fluid *sim, int32_t i, int below,
                  const double *load) {
  const struct mesh *mesh = sim->grid.mesh;
  const int32_t there = mesh->stencil[i][stencil_face(below)];
  const bool wall = two_fluid_is_side(sim, mesh->cell_face[i][below]);
  const double thickness = sim->alpha->v[i] * mesh->h[i] /
                           two_fluid_loosest(&sim->closure, sim->phi_p->v[i]);
  if (thickness < THINNEST * sim->closure.param[TWO_FLUID_GRAINS_D])
    return false;
  return is_highest(sim, i, below) && (wall || load[there] >= 0.5);
}

/* Set c and phi of a leaf with s and W. */
static void set_leaf(struct two_fluid *sim, int32_t i) {
  const double alpha = max2(sim->alpha->v[i], 0), s = sim->rest->v[i];
  double phi = alpha;
  sim->c->v[i] = min2(alpha / loosest_bed(sim, i), 1);
  sim->borne->v[i] = 0;
  if (s > 0) {
    phi = max2(sim->bed->v[i], alpha);
    sim->c->v[i] = alpha / phi;
    sim->borne->v[i] = min2(pressure_of(sim, i, phi) / load_of(sim, i), 1);
  }
  sim->phi->v[i] = phi;
}

/* Fill what tells neighbours of a leaf whether it rests, and how full it is. */
static void fill_resting(struct two_fluid *sim) {
  const struct mesh *mesh = sim->grid.mesh;
  mesh_touch(mesh, sim->c->v);
  mesh_touch(mesh, sim->rest->v);
  field_fill(mesh, sim->c);
  field_fill(mesh, sim->rest);
}

/* Let leaves rest on those below that rest and are not full: the surface cuts
 * both. */
static void rest_on_cut(struct two_fluid *sim, int axis, int below) {
  const struct mesh *mesh = sim->grid.mesh;
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    const int32_t there = mesh->stencil[i][stencil_face(below)];
    if (two_fluid_is_side(sim, mesh->cell_face[i][below])) continue;
    if (sim->rest->v[i] > 0 || !(sim->rest->v[there] > 0)) continue;
    if (sim->c->v[there] >= FULL && is_highest(sim, i, below))
      sim->rest->v[i] = weight_of(sim, axis, i);
  }
  fill_resting(sim);
}

/* Set W, and with it c and phi, of the leaves below these. */
static void add_burden(struct two_fluid *sim, int axis, int below) {
  const struct mesh *mesh = sim->grid.mesh;
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    const int32_t above = mesh->stencil[i][stencil_face(below ^ 1)];
    const bool side = two_fluid_is_side(sim, mesh->cell_face[i][below ^ 1]);
    if (sim->rest->v[i] > 0 && !side && sim->rest->v[above] > 0)
      sim->burden->v[i] =
          2 * weight_of(sim, axis, i) * max2(sim->alpha->v[above], 0);
    set_leaf(sim, i);
  }
}

/* No leaf has a surface. */
static void set_none(struct two_fluid *sim) {
  for (int32_t i = 0; i < sim->grid.mesh->nleaves; i++) {
    sim->phi->v[i] = max2(sim->alpha->v[i], 0);
    sim->rest->v[i] = sim->burden->v[i] = 0;
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
  const int below = 2 * axis + (g > 0 ? 1 : 0);
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    const bool resting = rests(sim, i, below, sim->carried->v);
    sim->rest->v[i] = resting ? weight_of(sim, axis, i) : 0;
    sim->burden->v[i] = 0;
    set_leaf(sim, i);
  }
  fill_resting(sim);
  rest_on_cut(sim, axis, below);
  add_burden(sim, axis, below);
  mesh_touch(mesh, sim->c->v);
  mesh_touch(mesh, sim->phi->v);
  field_fill(mesh, sim->c);
  field_fill(mesh, sim->phi);
  double *normal[DIM];
  field_arrays(sim->normal, normal);
  vof_reconstruct(mesh, sim->c->v, normal, sim->plane->v);
}

void two_fluid_lay_beds(struct two_fluid *sim) {
  const struct mesh *mesh = sim->grid.mesh;
  const struct two_fluid_keys *keys = sim->keys;
  two_fluid_find_surface(sim);
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    const double load = load_of(sim, i);
    if (!(load > 0)) continue;
    if (keys->start == TWO_FLUID_DENSE)
      sim->phi_p->v[i] =
          two_fluid_plastic_of(&sim->closure, sim->bed->v[i], load);
    else
      sim->bed->v[i] = two_fluid_settled(&sim->closure, load, sim->phi_p->v[i]);
  }
  mesh_touch(mesh, sim->bed->v);
  mesh_touch(mesh, sim->phi_p->v);
}

/* Return how far the grains of leaf i sink through the fluid over dt, m, on its
 * side `below`. */
static double sunk(const struct two_fluid *sim, int32_t i, int below,
                   double dt) {
  const int32_t f = sim->grid.mesh->cell_face[i][below];
  const double u = sim->w_f[TWO_FLUID_S]->v[f] + sim->v_f[TWO_FLUID_S]->v[f];
  const double up = below & 1 ? sim->j->v[f] - u : u - sim->j->v[f];
  return two_fluid_is_side(sim, f) ? 0 : -dt * up;
}

/* Return how fast the grains of leaf i sank through the fluid towards side
 * `below` when the step began, m/s. */
static double sank(const struct two_fluid *sim, int32_t i, int below) {
  const int axis = below / 2;
  const double slip =
      sim->u[TWO_FLUID_S][axis]->saved[i] - sim->u[TWO_FLUID_F][axis]->saved[i];
  return (1 - sim->bed->v[i]) * (below & 1 ? slip : -slip);
}

/* Return the packing of the bed in leaf i after dt: it gets denser as its top
 * sinks through the fluid, and looser as its bottom does, or at once where it
 * would press with more than its load. */
static double next_packing(const struct two_fluid *sim, int32_t i, int below,
                           double dt) {
  static const double ENOUGH = 1e-12;
  const double h = sim->grid.mesh->h[i], bed = sim->bed->v[i];
  const double load = load_of(sim, i), a = 1 - bed;
  const double part = min2(sim->alpha->v[i] / bed, 1);
  const double buoyant = 2 * sim->rest->v[i] / h;
  const double heavy = two_fluid_density(sim, TWO_FLUID_S) +
                       two_fluid_density(sim, TWO_FLUID_F) * bed / a;
  const double M = heavy + dt * sim->drag->v[i] / (a * a);
  const double kept = dt * heavy * sank(sim, i, below) / M;
  const double most = dt * dt * buoyant / M;
  const double bottom = sunk(sim, i, below, dt);
  double low = loosest_bed(sim, i), high = two_fluid_densest(&sim->closure);
  while (high - low > ENOUGH) {
    const double phi = 0.5 * (low + high);
    const double p = pressure_of(sim, i, phi);
    const double top = kept + most * (1 - p / load);
    if (p > load || phi - bed > bed / (part * h) * (top - bottom))
      high = phi;
    else
      low = phi;
  }
  return low;
}

void two_fluid_settle_beds(struct two_fluid *sim, double dt) {
  const struct mesh *mesh = sim->grid.mesh;
  const int axis = outline_axis(sim->params->gravity);
  const int below = 2 * axis + (sim->params->gravity[axis] > 0 ? 1 : 0);
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    const double alpha = max2(sim->alpha->v[i], 0);
    const double loosest = loosest_bed(sim, i);
    double *bed = &sim->bed->v[i];
    if (sim->rest->v[i] > 0 && two_fluid_has_grains(sim, i))
      *bed = next_packing(sim, i, below, dt);
    else if (alpha >= loosest)
      *bed = alpha;
    *bed = max2(max2(*bed, alpha), loosest);
  }
  mesh_touch(mesh, sim->bed->v);
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

/* Return how well leaf i leans on the node across side s: 1 where one of them
 * carries at least half the weight of its grains in a leaf. */
static double contact(const struct two_fluid *sim, int32_t i, int s,
                      double weight) {
  const struct mesh *mesh = sim->grid.mesh;
  const int32_t there = mesh->stencil[i][stencil_face(s)];
  const double alpha = max2(sim->alpha->v[i], sim->alpha->v[there]);
  const double p = max2(sim->p_s->v[i], sim->p_s->v[there]);
  const double half = 0.5 * weight * mesh->h[i] * alpha;
  return p < half ? max2(p, 0) / half : 1;
}

/* Return the part of the grains of leaf i that counts for its upper face along
 * axis d: a side that the bed hardly reaches counts less than the other one. Up
 * and down p_s of a leaf that rests is that of its middle, whatever the plane.
 */
static double upper_part(const struct two_fluid *sim, int32_t i, int d,
                         double weight) {
  double wet[2], chi[2];
  if (sim->rest->v[i] > 0 && d == outline_axis(sim->params->gravity))
    return 0.5;
  for (int k = 0; k < 2; k++) {
    wet[k] = two_fluid_wetted(sim, i, 2 * d + k);
    chi[k] = contact(sim, i, 2 * d + k, weight);
  }
  const double most = max2(wet[0], wet[1]);
  if (!(most > 0)) return 0.5;
  return 0.5 + 0.5 * (wet[1] * chi[1] - wet[0] * chi[0]) / most;
}

void two_fluid_find_contact(struct two_fluid *sim) {
  const struct mesh *mesh = sim->grid.mesh;
  const int axis = outline_axis(sim->params->gravity);
  const double weight =
      fabs(sim->params->gravity[axis]) * (two_fluid_density(sim, TWO_FLUID_S) -
                                          two_fluid_density(sim, TWO_FLUID_F));
  for (int d = 0; d < DIM; d++) {
    double *upper = sim->upper[d]->v;
    for (int32_t i = 0; i < mesh->nleaves; i++)
      upper[i] =
          two_fluid_has_grains(sim, i) ? upper_part(sim, i, d, weight) : 0.5;
    mesh_touch(mesh, upper);
    field_fill(mesh, sim->upper[d]);
    for (int32_t i = mesh->begin_boundary; i < mesh->ncells; i++)
      upper[i] = 1 - upper[i];
  }
}
