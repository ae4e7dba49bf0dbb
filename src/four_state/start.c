/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/four_state/start.h"

#include <math.h>
#include <string.h>

#include "talus/depths.h"
#include "talus/error.h"
#include "talus/forest.h"
#include "talus/four_state/properties.h"
#include "talus/four_state/state.h"
#include "talus/four_state/step.h"
#include "talus/minmax.h"
#include "talus/model.h"
#include "talus/openings.h"
#include "talus/outline.h"
#include "talus/shape_memory.h"

/* Rounds that put columns in balance, and what is left then, of nu. */
enum { ROUNDS = 20, NEWTON = 8 };
static const double BALANCED = 1e-12;
/* A round counts if mass is right to ROUGHLY and nu changes by no more than
 * MOST_CHANGE. */
static const double ROUGHLY = 1e-9, MOST_CHANGE = 0.01;

static double packed(const void *context, double p) {
  const struct four_state *sim = context;
  return four_state_packed(&sim->closure, p);
}

static void fill_state(struct four_state *sim, const struct depths *depths,
                       int axis, int fineness) {
  const struct params *params = sim->params;
  const struct mesh *mesh = sim->grid.mesh;
  double (*fraction)(shape_level_set f, void *context, const double centre[DIM],
                     double h, int depth) =
      mesh_is_axisymmetric(mesh) ? shape_ring_fraction : shape_fraction;
  struct shape_memory *memory =
      shape_memory_new(params->shape.eval, params->shape.context);
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    double x[3] = {0};
    for (int e = 0; e < DIM; e++) x[e] = mesh->x[i][e];
    const int depth = params->level_max - mesh->level[i] + fineness;
    const double c = params->shape.eval
                         ? fraction(shape_memory_value, memory, mesh->x[i],
                                    mesh->h[i], depth)
                         : 1;
    double nu = sim->keys->nu_start;
    if (depths && c > 0)
      nu = depths_at(depths, depths_below(params, axis, 0.25 * mesh->h[i], x));
    sim->nu->v[i] = c * nu;
    sim->T->v[i] = 0;
    for (int e = 0; e < DIM; e++) {
      const struct function *u = &params->velocity[e];
      sim->u[e]->v[i] = u->eval && c > 0 ? u->eval(u->context, x) : 0;
    }
  }
  shape_memory_destroy(memory);
}

static void adapt_to_state(struct four_state *sim, const struct depths *depths,
                           int axis, int fineness) {
  fill_state(sim, depths, axis, fineness);
  for (int k = 0; k <= 2 * sim->params->level_max; k++) {
    if (!four_state_adapt(sim)) break;
    fill_state(sim, depths, axis, fineness);
  }
}

/* Keep leaves with nothing above them, which carry nothing, at the loosest
 * packing. */
static void loosen_surface(struct four_state *sim, int axis) {
  const struct mesh *mesh = sim->grid.mesh;
  const double nu_min = sim->closure.param[LEE_HUANG_NU_MIN];
  const int above = 2 * axis + (sim->params->gravity[axis] > 0 ? 0 : 1);
  field_fill(mesh, sim->nu);
  double *nu = scratch_take_one(&sim->scratch, FIELD_CELL, __func__);
  memcpy(nu, sim->nu->v, (size_t)mesh->ncells * sizeof *nu);
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    if (nu[mesh->stencil[i][stencil_face(above)]] < 0.1 * nu_min)
      sim->nu->v[i] = min2(sim->nu->v[i], nu_min);
  }
  scratch_give(&sim->scratch, __func__);
}

/* Let grains move along the vertical axis only, not into the vacuum, and only
 * where those below touch each other: leaves that the side of a shape cuts are
 * loose all the way down, and would fall. */
static void hold_columns(struct four_state *sim, int axis) {
  const struct mesh *mesh = sim->grid.mesh;
  const double none = sim->keys->nu_vacuum;
  const double touching = sim->closure.param[LEE_HUANG_NU_MIN] * (1 - 1e-6);
  const int below = sim->params->gravity[axis] > 0 ? 1 : 0;
  for (int d = 0; d < DIM; d++) {
    for (int32_t f = mesh->face_begin[d]; f < mesh->face_begin[d + 1]; f++) {
      const int32_t *node = mesh->face_node[f];
      if (d != axis || sim->nu->v[node[below]] < touching ||
          sim->nu->v[node[1 - below]] < none)
        sim->mobility_f->v[f] = 0;
    }
  }
  field_fill_faces(mesh, sim->mobility_f);
}

/* Put columns in the balance that the scheme itself has: grains fall from rest
 * over dt. Returns the largest change of nu; the state stays as it is if that
 * is too large to be trusted. */
static double settle_once(struct four_state *sim, int axis, double dt) {
  const struct mesh *mesh = sim->grid.mesh;
  double most = 0;
  double *cell[2];
  scratch_take(&sim->scratch, FIELD_CELL, __func__, 2, cell);
  double *p = cell[0], *nu = cell[1];
  double *a_f = scratch_take_one(&sim->scratch, FIELD_FACE, __func__);
  four_state_properties(sim);
  hold_columns(sim, axis);
  four_state_face_acceleration(sim, sim->p->v, a_f);
  for (int32_t f = 0; f < mesh->nfaces; f++) {
    sim->u_f->v[f] = sim->mobility_f->v[f] > 0 ? dt * a_f[f] : 0;
  }
  struct granular_pressure by = four_state_material(sim, "settle");
  by.tolerance = BALANCED, by.max_newton = NEWTON;
  const struct granular_stats stats =
      granular_pressure_solve(&by, dt, sim->u_f->v, p, nu, sim->flux->v);
  scratch_give(&sim->scratch, "settle");
  granular_carry(mesh, dt, sim->nu->v, sim->flux->v, nu);
  if (!(stats.residual <= ROUGHLY)) most = INFINITY;
  for (int32_t i = 0; i < mesh->nleaves; i++)
    most = max2(most, fabs(nu[i] - sim->nu->v[i]));
  most = mesh_max(mesh, most);
  if (most <= MOST_CHANGE)
    memcpy(sim->nu->v, nu, (size_t)mesh->nleaves * sizeof *nu);
  mesh_touch(mesh, sim->nu->v);
  scratch_give(&sim->scratch, __func__);
  return most;
}

static void settle(struct four_state *sim, int axis) {
  const struct params *params = sim->params;
  const double g = fabs(params->gravity[axis]);
  double dt = 0.1 * sqrt(params->size / g), change = 1;
  loosen_surface(sim, axis);
  for (int k = 0; k < ROUNDS && change > BALANCED; k++) {
    change = settle_once(sim, axis, dt);
    if (change > MOST_CHANGE) dt *= 0.25;
  }
}

/* Warn if a uniform start has a pressure that nothing holds: the grains burst.
 * With K = 1e8 Pa and 0.575 it is 700 Pa, the weight of 5 cm. */
static void check_pressure(const struct four_state *sim, int axis) {
  static const double BURSTS = 5; /* pressure over weight */
  const struct mesh *mesh = sim->grid.mesh;
  const double nu = sim->keys->nu_start, g = sim->params->gravity[axis];
  double low = HUGE_VAL, high = -HUGE_VAL;
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    if (!four_state_has_grains(sim, i)) continue;
    low = min2(low, mesh->x[i][axis] - 0.5 * mesh->h[i]);
    high = max2(high, mesh->x[i][axis] + 0.5 * mesh->h[i]);
  }
  const double height = mesh_max(mesh, high) + mesh_max(mesh, -low);
  const double p = four_state_pressure(&sim->closure, nu, 0, NULL);
  const double weight =
      sim->closure.param[LEE_HUANG_RHO_D] * nu * fabs(g) * height;
  if (g == 0 || !isfinite(height) || p <= BURSTS * weight) return;
  WARN_ONCE(
      "grains begin at a solid fraction of %g with a pressure of %.3g Pa, %.3g "
      "times their weight, and burst: take grains.start = \"balance\", a "
      "smaller grains.nu_start or a smaller grains.K",
      nu, p, p / weight);
}

/* Refuse starts that are as dense as grains can be packed, or more, and columns
 * whose weight packs them beyond nu_0: p_D has its pole there, and the first
 * fluctuation would make them burst. */
static void check_packing(const struct four_state *sim) {
  const double *param = sim->closure.param;
  const bool uniform = sim->keys->start == FOUR_STATE_UNIFORM;
  double most = 0;
  for (int32_t i = 0; i < sim->grid.mesh->nleaves; i++)
    most = max2(most, sim->nu->v[i]);
  most = mesh_max(sim->grid.mesh, most);
  if (most < param[uniform ? LEE_HUANG_NU_MAX : LEE_HUANG_NU_0]) return;
  if (uniform)
    USER_ERROR(
        "grains would begin at a solid fraction of %g, and grains.nu_max = %g "
        "is the densest: take a smaller grains.nu_start",
        most, param[LEE_HUANG_NU_MAX]);
  USER_ERROR(
      "grains would begin at a solid fraction of %.4g at the foot of a column "
      "in balance; above grains.nu_0 = %g their pressure has no bound once "
      "they move: take a larger grains.K, a smaller grains.chi, a lower column "
      "or grains.start = \"uniform\"",
      most, param[LEE_HUANG_NU_0]);
}

static void check_boundaries(const struct params *params) {
  for (int b = 0; b < params->nboundaries; b++) {
    const enum boundary_type type = params->boundary[b].type;
    if (type == BOUNDARY_INFLOW || type == BOUNDARY_OUTFLOW)
      USER_ERROR(
          "model = \"four_state\" has no inflow and no outflow: its grains are "
          "in a vacuum, so take a wall (\"slip\", \"no_slip\") that they do "
          "not "
          "reach");
  }
}

struct four_state *four_state_new(const struct params *params,
                                  const struct model_start *start) {
  struct forest_layout layout;
  check_boundaries(params);
  grid_layout(params, &layout);
  const int level =
      params->ncriteria > 0 ? params->level_min : params->level_max;
  struct four_state *sim =
      four_state_new_on(params, forest_new(MPI_COMM_WORLD, &layout, level));
  sim->grid.most_leaves = start->most_leaves;
  const int axis = outline_axis(params->gravity);
  const bool balance = sim->keys->start == FOUR_STATE_BALANCE;
  struct depths depths = {0};
  if (balance)
    depths = depths_new(
        sim->closure.param[LEE_HUANG_RHO_D] * fabs(params->gravity[axis]),
        params->size * params->trees[axis], packed, sim);
  const struct depths *fill = balance ? &depths : NULL;
  if (params->ncriteria > 0) {
    adapt_to_state(sim, NULL, axis, 0); /* nearly as with depths */
    adapt_to_state(sim, fill, axis, 3);
  } else {
    fill_state(sim, fill, axis, 3);
  }
  openings_check(&sim->grid);
  check_packing(sim);
  if (balance && params->gravity[axis] != 0) settle(sim, axis);
  if (sim->keys->start == FOUR_STATE_UNIFORM) check_pressure(sim, axis);
  depths_free(&depths);
  return sim;
}
