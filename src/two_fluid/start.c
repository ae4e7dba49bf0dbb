/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/two_fluid/start.h"

#include <math.h>
#include <string.h>

#include "talus/depths.h"
#include "talus/error.h"
#include "talus/forest.h"
#include "talus/log.h"
#include "talus/minmax.h"
#include "talus/model.h"
#include "talus/openings.h"
#include "talus/outline.h"
#include "talus/shape_memory.h"
#include "talus/two_fluid/state.h"
#include "talus/two_fluid/surface.h"
#include "talus/two_fluid_grains.h"

/* Viscosity of the grains is capped where a slope creeps at this times sqrt(g
 * H). */
static const double CREEP = 1e-4;

/* How leaves are filled. */
struct filling {
  int axis;                    /* vertical */
  int fineness;                /* of parts of leaves */
  const struct depths *depths; /* NULL: one solid fraction */
};

/* Return the weight of grains that fill their volume, less buoyancy, N/m^3. */
static double weight_of(const struct params *params,
                        const struct two_fluid_closure *c, int axis) {
  return fabs(params->gravity[axis]) * (c->param[TWO_FLUID_GRAINS_DENSITY] -
                                        c->param[TWO_FLUID_FLUID_DENSITY]);
}

/* Grains at rest of one plastic packing. */
struct resting {
  const struct two_fluid_closure *closure;
  double phi_p;
};

static double packed(const void *context, double p) {
  const struct resting *by = context;
  return two_fluid_settled(by->closure, p, by->phi_p);
}

/* Return the solid fraction of settled grains over depth. */
static struct depths settle(const struct params *params,
                            const struct two_fluid_closure *c, int axis) {
  const struct two_fluid_keys *keys = params->own;
  const struct resting by = {c, keys->phi_p};
  return depths_new(weight_of(params, c, axis),
                    params->size * params->trees[axis], packed, &by);
}

/* Set alpha and phi_p of a leaf that the grains fill by the part c. */
static void fill_leaf(struct two_fluid *sim, const struct filling *by,
                      int32_t i, const double x[3], double c) {
  const struct params *params = sim->params;
  const struct two_fluid_keys *keys = sim->keys;
  const bool deep = params->gravity[by->axis] != 0;
  const double depth =
      deep && c > 0
          ? depths_below(params, by->axis, 0.25 * sim->grid.mesh->h[i], x)
          : 0;
  double alpha = keys->alpha_start;
  sim->phi_p->v[i] = keys->phi_p;
  if (by->depths && c > 0) alpha = depths_at(by->depths, depth);
  if (keys->start == TWO_FLUID_DENSE)
    sim->phi_p->v[i] = two_fluid_plastic_of(
        &sim->closure, alpha,
        depth * alpha * weight_of(params, &sim->closure, by->axis));
  sim->bed->v[i] = alpha;
  sim->alpha->v[i] = c * alpha;
}

/* Set `part` of leaves to that which is inside a shape, 1 without one. */
static void fill_part(const struct two_fluid *sim, int fineness,
                      const struct function *shape, double *part) {
  const struct mesh *mesh = sim->grid.mesh;
  double (*fraction)(shape_level_set f, void *context, const double centre[DIM],
                     double h, int depth) =
      mesh_is_axisymmetric(mesh) ? shape_ring_fraction : shape_fraction;
  struct shape_memory *memory = shape_memory_new(shape->eval, shape->context);
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    int depth = sim->params->level_max - mesh->level[i] + fineness;
    if (depth > 6) depth = 6;
    part[i] = shape->eval ? fraction(shape_memory_value, memory, mesh->x[i],
                                     mesh->h[i], depth)
                          : 1;
  }
  shape_memory_destroy(memory);
}

/* Set the part of the grains that is in each tracer, of grains that fill c. */
static void fill_tracers(struct two_fluid *sim, int fineness, const double *c) {
  const struct mesh *mesh = sim->grid.mesh;
  for (int k = 0; k < sim->params->ntracers; k++) {
    double *part = sim->tracer[k]->v;
    fill_part(sim, fineness, &sim->params->tracer[k].shape, part);
    for (int32_t i = 0; i < mesh->nleaves; i++)
      part[i] = c[i] > 0 ? min2(part[i] / c[i], 1) : 0;
    mesh_touch(mesh, part);
  }
}

static void fill_state(struct two_fluid *sim, const struct filling *by) {
  const struct params *params = sim->params;
  const struct mesh *mesh = sim->grid.mesh;
  double *c = sim->c->v;
  fill_part(sim, by->fineness, &params->shape, c);
  fill_tracers(sim, by->fineness, c);
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    double x[3] = {0};
    for (int e = 0; e < DIM; e++) x[e] = mesh->x[i][e];
    fill_leaf(sim, by, i, x, c[i]);
    for (int e = 0; e < DIM; e++) {
      const struct function *u = &params->velocity[e];
      const double value = u->eval ? u->eval(u->context, x) : 0;
      for (int k = 0; k < TWO_FLUID_NPHASES; k++) sim->u[k][e]->v[i] = value;
    }
  }
}

static void adapt_to_state(struct two_fluid *sim, struct filling *by,
                           int fineness) {
  by->fineness = fineness;
  fill_state(sim, by);
  for (int k = 0; k <= 2 * sim->params->level_max; k++) {
    if (!two_fluid_adapt(sim)) break;
    fill_state(sim, by);
  }
}

/* Set the fluxes of the velocities, on all faces. */
static void set_fluxes(struct two_fluid *sim) {
  const struct mesh *mesh = sim->grid.mesh;
  field_fill(mesh, sim->alpha);
  for (int k = 0; k < TWO_FLUID_NPHASES; k++)
    field_fill_many(mesh, DIM, sim->u[k]);
  for (int d = 0; d < DIM; d++) {
    for (int32_t f = mesh->face_begin[d]; f < mesh->face_begin[d + 1]; f++) {
      const int32_t *node = mesh->face_node[f];
      const double *u = sim->u[TWO_FLUID_F][d]->v, *alpha = sim->alpha->v;
      const double mean = 0.5 * (u[node[0]] + u[node[1]]);
      sim->j->v[f] = mean;
      sim->flux->v[f] = two_fluid_is_side(sim, f)
                            ? 0
                            : 0.5 * (alpha[node[0]] + alpha[node[1]]) * mean;
    }
  }
  field_fill_faces(mesh, sim->j);
  field_fill_faces(mesh, sim->flux);
}

/* Return the height of the grains, m. */
static double height_of(const struct two_fluid *sim, int axis) {
  const struct mesh *mesh = sim->grid.mesh;
  double low = HUGE_VAL, high = -HUGE_VAL;
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    if (!two_fluid_has_grains(sim, i)) continue;
    low = min2(low, mesh->x[i][axis] - 0.5 * mesh->h[i]);
    high = max2(high, mesh->x[i][axis] + 0.5 * mesh->h[i]);
  }
  const double height = mesh_max(mesh, high) + mesh_max(mesh, -low);
  return isfinite(height) ? height : 0;
}

/* Choose the cap on the viscosity of the grains, and say what it lets them
 * creep at. */
static void set_cap(struct two_fluid *sim, int axis) {
  const double g = fabs(sim->params->gravity[axis]);
  const double H = height_of(sim, axis);
  const double load =
      weight_of(sim->params, &sim->closure, axis) * sim->keys->alpha_start * H;
  sim->eta_max = sim->keys->eta_max;
  if (sim->eta_max == 0 && H > 0 && !(load > 0))
    USER_ERROR(
        "grains.eta_max is missing: without weight (gravity %g along axis %d) "
        "nothing tells how stiff grains may be. Give it, in Pa s: many times "
        "density * size^2/(time of the flow)",
        g, axis);
  if (sim->eta_max == 0 && load > 0)
    sim->eta_max = 0.5 * load * H / (CREEP * sqrt(g * H));
  if (load > 0)
    log_info(
        "viscosity of the grains is at most %.3g Pa s: a slope of 20 degrees, "
        "%.3g m high, creeps at %.3g m/s",
        sim->eta_max, H, 0.5 * 0.342 * load * H / sim->eta_max);
}

/* Warn of what a patched start means. */
static void say_pressure(const struct two_fluid *sim, int axis) {
  const double phi = sim->keys->alpha_start;
  const struct two_fluid_frozen with = {.phi_p = sim->keys->phi_p};
  const double p = two_fluid_pressure(&sim->closure, phi, &with, NULL);
  const double weight =
      weight_of(sim->params, &sim->closure, axis) * phi * height_of(sim, axis);
  log_info(
      "grains begin at a solid fraction of %g, where they hold %.3g Pa: %.3g "
      "times the weight of the heap on its floor",
      phi, p, weight > 0 ? p / weight : 0);
}

static void check_boundaries(const struct params *params) {
  for (int b = 0; b < params->nboundaries; b++) {
    const struct boundary *boundary = &params->boundary[b];
    if (boundary->type == BOUNDARY_INFLOW && boundary->fraction > 0)
      USER_ERROR(
          "model = \"two_fluid\": an inflow brings a solid fraction of %g, but "
          "only fluid passes the sides of the box: take fraction = 0",
          boundary->fraction);
  }
}

/* Refuse a flow into a box that nothing leaves: no pressure lets it in. */
static void check_balance(const struct two_fluid *sim) {
  const struct mesh *mesh = sim->grid.mesh;
  double net = 0, all = 0;
  if (sim->grid.pressure_set) return;
  for (int32_t f = 0; f < mesh->nfaces; f++) {
    if (!two_fluid_is_side(sim, f)) continue;
    const double through = sim->j->v[f] * mesh_face_area(mesh, f);
    net += mesh->face_leaf[f][0] < 0 ? through : -through;
    all += fabs(through);
  }
  net = mesh_sum(mesh, net), all = mesh_sum(mesh, all);
  if (fabs(net) > 1e-6 * all)
    USER_ERROR(
        "the sides of the box let in %g m^2/s (3D, axisymmetric: m^3/s) of "
        "fluid more than they let out, which is to be 0 in a box without an "
        "outflow: take { \"outflow\", pressure = 0 } for one of them, or "
        "velocities that balance",
        net);
}

/* Refuse a solid fraction that the closures do not have. */
static void check_fraction(const struct two_fluid *sim) {
  const double densest = two_fluid_densest(&sim->closure);
  if (sim->keys->alpha_start >= densest)
    USER_ERROR(
        "grains.alpha_start = %g: the densest packing of these closures is %g; "
        "take less, 0.55 to 0.60 are common",
        sim->keys->alpha_start, densest);
}

/* Return the depth at which settled grains pass a solid fraction, m. */
static double depth_of(const struct depths *depths, double phi) {
  int k = 0;
  while (k < depths->n && depths->nu[k + 1] < phi) k++;
  return k * depths->spacing;
}

void two_fluid_check_packing(const struct params *params) {
  const int axis = outline_axis(params->gravity);
  struct two_fluid_closure c;
  two_fluid_closures(params, &c);
  if (params->gravity[axis] == 0) return;
  struct depths depths = settle(params, &c, axis);
  const double deepest = depths_deepest(params, axis);
  const double foot = depths_at(&depths, deepest);
  const double allowed = depth_of(&depths, c.by.phi_m);
  const struct two_fluid_keys *keys = params->own;
  const bool packs = foot < 1 || keys->start == TWO_FLUID_SETTLED;
  depths_free(&depths);
  if (packs && foot >= c.by.phi_m)
    USER_ERROR(
        "a heap of %.3g m packs its foot to a solid fraction of %.4f, and "
        "closure = \"%s\" has no shear beyond phi_m = %g: such grains burst "
        "when they give way. It allows %.3g m of them: take a lower heap, a "
        "larger %s.phi_m, or closure = \"critical_state\", whose phi_m is "
        "its densest packing",
        deepest, foot, two_fluid_set_names[c.set], c.by.phi_m, allowed,
        two_fluid_set_names[c.set]);
}

struct two_fluid *two_fluid_new(const struct params *params,
                                const struct model_start *start) {
  struct forest_layout layout;
  check_boundaries(params);
  two_fluid_check_packing(params);
  grid_layout(params, &layout);
  const int level =
      params->ncriteria > 0 ? params->level_min : params->level_max;
  struct two_fluid *sim =
      two_fluid_new_on(params, forest_new(MPI_COMM_WORLD, &layout, level));
  sim->grid.most_leaves = start->most_leaves;
  const int axis = outline_axis(params->gravity);
  const bool settled =
      sim->keys->start == TWO_FLUID_SETTLED && params->gravity[axis] != 0;
  struct depths depths = {0};
  if (!settled) check_fraction(sim);
  if (settled) depths = settle(params, &sim->closure, axis);
  struct filling by = {axis, 3, settled ? &depths : NULL};
  if (params->ncriteria > 0) {
    adapt_to_state(sim, &by, 0);
    adapt_to_state(sim, &by, 3);
  } else {
    fill_state(sim, &by);
  }
  openings_check(&sim->grid);
  set_fluxes(sim);
  if (sim->keys->start != TWO_FLUID_PATCHED) two_fluid_lay_beds(sim);
  check_balance(sim);
  if (!sim->exact) set_cap(sim, axis);
  if (!settled) say_pressure(sim, axis);
  depths_free(&depths);
  return sim;
}
