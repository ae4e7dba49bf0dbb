/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/two_fluid/pressures.h"

#include <math.h>
#include <string.h>

#include "talus/minmax.h"
#include "talus/outline.h"
#include "talus/projection.h"
#include "talus/roots.h"
#include "talus/two_fluid/jumps.h"
#include "talus/two_fluid/properties.h"
#include "talus/two_fluid/state.h"
#include "talus/two_fluid/surface.h"
#include "talus/two_fluid_pair.h"

enum { MOST_NEWTON = 40 };
/* R of granular_pressure.h is bounded by this times solver.tolerance_pressure
 * in the last pass, in the first one by that. */
#define PRESSURE_FACTOR 1e-3
/* Slope of P where there is no pressure, Pa. */
#define LEAST_SLOPE 1e-3
/* Both pressures are found again while j changes by more than this times
 * solver.tolerance_pressure, in edges over dt; at most MOST_PASSES times. */
#define PASS_SLACK 10
enum { MOST_PASSES = 4 };
/* A face has at least this part of the mean mass of its leaves. */
#define LEAST_LENT 0.1
/* Give the solid fractions that both leaves lend to face f of axis d. */
static inline void lent(const struct two_fluid *sim, int d, int32_t f,
                        double part[2]) {
  const int32_t *node = sim->grid.mesh->face_node[f];
  const double *alpha = sim->alpha->v, *upper = sim->upper[d]->v;
  part[0] = alpha[node[0]] * upper[node[0]];
  part[1] = alpha[node[1]] * (1 - upper[node[1]]);
}

/* Give the pair of phases at face f of axis d: alpha is the mean of both
 * leaves, and the grains are as heavy as those that the leaves lend. */
static struct two_fluid_pair pair_of(const struct two_fluid *sim, double dt,
                                     int d, int32_t f) {
  const int32_t *node = sim->grid.mesh->face_node[f];
  const double *alpha = sim->alpha->v;
  const double phi = 0.5 * (alpha[node[0]] + alpha[node[1]]);
  double part[2];
  lent(sim, d, f, part);
  const double ratio = phi > TWO_FLUID_NONE ? (part[0] + part[1]) / phi : 1;
  return (struct two_fluid_pair){
      .phi = phi,
      .rho_s = two_fluid_density(sim, TWO_FLUID_S) * max2(ratio, LEAST_LENT),
      .rho_f = two_fluid_density(sim, TWO_FLUID_F),
      .drag = dt * sim->drag_f->v[f]};
}

/* Return the force on the grains over alpha at a face of axis d, but for p,
 * N/m^3. */
static double force_of(const struct two_fluid *sim, int d, int32_t f,
                       const struct two_fluid_pair *pair) {
  const double buoyant = 1 - two_fluid_density(sim, TWO_FLUID_F) /
                                 two_fluid_density(sim, TWO_FLUID_S);
  const double weight = buoyant * pair->rho_s * sim->params->gravity[d];
  if (!(pair->phi > TWO_FLUID_NONE)) return weight;
  const bool level = d != outline_axis(sim->params->gravity);
  const double slope = mesh_gradient(sim->grid.mesh, sim->p_s->v, f);
  const double lack =
      level ? mesh_gradient(sim->grid.mesh, sim->lack->v, f) : 0;
  return weight - (slope - lack) / pair->phi;
}

/* Does fluid, but no grains, pass face f of a side whose pressure is given? */
static bool is_open(const struct two_fluid *sim, int32_t f) {
  const int patch = sim->grid.mesh->face_patch[f];
  return patch >= 0 && sim->grid.open[patch];
}

void two_fluid_fill_pressure(struct two_fluid *sim, double dt) {
  const struct mesh *mesh = sim->grid.mesh;
  const struct bc *bc = sim->p->bc;
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    const struct two_fluid_pair pair = {
        .phi = max2(sim->alpha->v[i], 0),
        .rho_s = two_fluid_density(sim, TWO_FLUID_S),
        .rho_f = two_fluid_density(sim, TWO_FLUID_F),
        .drag = dt * sim->drag->v[i]};
    sim->inertia->v[i] = 1 / two_fluid_pair_mobility(&pair);
  }
  field_fill(mesh, sim->inertia);
  const double least = two_fluid_density(sim, TWO_FLUID_F) * TWO_FLUID_NONE;
  for (int32_t i = mesh->begin_virtual; i < mesh->ncells; i++)
    sim->inertia->v[i] = max2(sim->inertia->v[i], least);
  mesh_fill_potential(mesh, sim->inertia->v, 1, &sim->p->v, &bc, false);
}

/* Return what leaf i has of a quantity of a phase on its faces of axis d. */
static inline double share_of(const struct two_fluid *sim, int phase, int d,
                              int32_t i, const double *face) {
  const struct mesh *mesh = sim->grid.mesh;
  if (phase == TWO_FLUID_F) return mesh_mean_along(mesh, face, i, d);
  const int32_t *side = mesh->cell_face[i];
  const double upper = sim->upper[d]->v[i];
  return (1 - upper) * face[side[2 * d]] + upper * face[side[2 * d + 1]];
}

/* Set `face` [nfaces_all] to the acceleration of a phase at faces of axis d by
 * p, p_s and weight, without drag. */
static void face_force(const struct two_fluid *sim, int phase, int d,
                       double *face) {
  const struct mesh *mesh = sim->grid.mesh;
  memset(face, 0, (size_t)mesh->nfaces_all * sizeof *face);
  for (int32_t f = mesh->face_begin[d]; f < mesh->face_begin[d + 1]; f++) {
    if (two_fluid_is_side(sim, f) && !(phase == TWO_FLUID_F && is_open(sim, f)))
      continue;
    const struct two_fluid_pair pair = pair_of(sim, 0, d, f);
    double force = -mesh_gradient(mesh, sim->p->v, f);
    if (phase == TWO_FLUID_S) force += force_of(sim, d, f, &pair);
    face[f] = force / (phase == TWO_FLUID_S ? pair.rho_s : pair.rho_f);
  }
  mesh_fill_faces(mesh, 1, &face);
}

void two_fluid_leaf_forces(struct two_fluid *sim, int e, double *const b[]) {
  const struct mesh *mesh = sim->grid.mesh;
  double *face[TWO_FLUID_NPHASES],
      *more = scratch_take_one(&sim->scratch, FIELD_CELL, __func__);
  scratch_take(&sim->scratch, FIELD_FACE, __func__, TWO_FLUID_NPHASES, face);
  for (int k = 0; k < TWO_FLUID_NPHASES; k++) face_force(sim, k, e, face[k]);
  two_fluid_jumps(sim, 1, e, (const double *const *)face, more);
  for (int k = 0; k < TWO_FLUID_NPHASES; k++)
    for (int32_t i = 0; i < mesh->nleaves; i++)
      b[k][i] = share_of(sim, k, e, i, face[k]) + more[i];
  scratch_give(&sim->scratch, __func__);
}

/* Return F of a velocity u of a phase at face f of axis d. */
static inline double mean_at(const struct two_fluid *sim, int phase, int d,
                             int32_t f, const double *u) {
  const int32_t *node = sim->grid.mesh->face_node[f];
  const double *alpha = sim->alpha->v;
  double m[2] = {1 - alpha[node[0]], 1 - alpha[node[1]]};
  if (phase == TWO_FLUID_S) lent(sim, d, f, m);
  const double u0 = u[node[0]], u1 = u[node[1]], M = m[0] + m[1];
  return M > TWO_FLUID_NONE ? (m[0] * u0 + m[1] * u1) / M : 0.5 * (u0 + u1);
}

/* Set w of both phases on our own faces; the velocities are filled. */
static void set_means(struct two_fluid *sim) {
  const struct mesh *mesh = sim->grid.mesh;
  for (int k = 0; k < TWO_FLUID_NPHASES; k++) {
    double *w = sim->w_f[k]->v;
    for (int d = 0; d < DIM; d++) {
      const double *u = sim->u[k][d]->v;
      for (int32_t f = mesh->face_begin[d]; f < mesh->face_begin[d + 1]; f++) {
        w[f] = mean_at(sim, k, d, f, u);
        if (two_fluid_is_side(sim, f) && k == TWO_FLUID_S) w[f] = 0;
      }
    }
  }
}

/* Leaves without grains are still, for the faces that a bed has with them. */
static void find_still(struct two_fluid *sim) {
  const struct mesh *mesh = sim->grid.mesh;
  for (int32_t i = 0; i < mesh->nleaves; i++)
    sim->yield.still->v[i] =
        two_fluid_has_grains(sim, i) ? two_fluid_slowness(sim, i) : 1;
  mesh_fill_ghosts(mesh, 1, &sim->yield.still->v);
}

/* Set `own` [nfaces_all] to what p_s and weight give the grains at faces of
 * axis d, m/s^2, and the field `pushed` to what they give the leaves. */
static void find_pushes(struct two_fluid *sim, int d, double *own) {
  const struct mesh *mesh = sim->grid.mesh;
  double *leaf = sim->pushed->v;
  memset(own, 0, (size_t)mesh->nfaces_all * sizeof *own);
  for (int32_t f = mesh->face_begin[d]; f < mesh->face_begin[d + 1]; f++) {
    const struct two_fluid_pair pair = pair_of(sim, 0, d, f);
    if (!two_fluid_is_side(sim, f))
      own[f] = force_of(sim, d, f, &pair) / pair.rho_s;
  }
  mesh_fill_faces(mesh, 1, &own);
  for (int32_t i = 0; i < mesh->nleaves; i++)
    leaf[i] = share_of(sim, TWO_FLUID_S, d, i, own);
  mesh_touch(mesh, leaf);
  field_fill(mesh, sim->pushed);
}

/* Let what p_s and weight of before give the leaves cancel in w, between still
 * grains, with what they give the face. */
static void hold_still(struct two_fluid *sim, double dt) {
  const struct mesh *mesh = sim->grid.mesh;
  const double *still = sim->yield.still->v;
  double *own = sim->force_f->v;
  find_still(sim);
  for (int d = 0; d < DIM; d++) {
    find_pushes(sim, d, own);
    for (int32_t f = mesh->face_begin[d]; f < mesh->face_begin[d + 1]; f++) {
      const int32_t *leaf = mesh->face_leaf[f];
      if (two_fluid_is_side(sim, f) || leaf[0] < 0 || leaf[1] < 0) continue;
      const double part = min2(still[leaf[0]], still[leaf[1]]);
      const double mean = mean_at(sim, TWO_FLUID_S, d, f, sim->pushed->v);
      sim->w_f[TWO_FLUID_S]->v[f] += part * dt * (mean - own[f]);
    }
  }
}

static double find_pressure(const void *context, int32_t i, double alpha,
                            double *slope) {
  const struct two_fluid *sim = context;
  return two_fluid_law(sim, i, max2(alpha, 0), sim->dt, slope);
}

/* Holds what P of a leaf is inverted with. */
struct question {
  const struct two_fluid *sim;
  int32_t leaf;
};

static double pressure_of(double alpha, double *slope, const void *context) {
  const struct question *of = context;
  return find_pressure(of->sim, of->leaf, alpha, slope);
}

/* Invert P. */
static double find_fraction(const void *context, int32_t i, double p,
                            double from, double guess) {
  const struct question of = {context, i};
  return root_of_rising(pressure_of, &of, p, max2(from, 0), guess);
}

struct granular_pressure two_fluid_material(struct two_fluid *sim,
                                            const char *taker) {
  struct granular_pressure by = {
      .mesh = sim->grid.mesh,
      .hierarchy = sim->grid.hierarchy,
      .material = {sim, find_pressure, find_fraction},
      .mobility_f = sim->mobility_f->v,
      .nu_old = sim->alpha->v,
      .p_old = sim->p_s->v,
      .rho = sim->weight->v,
      .least_slope = LEAST_SLOPE,
      .tolerance = PRESSURE_FACTOR * sim->params->tolerance_pressure,
      .max_newton = MOST_NEWTON,
      .max_iterations = sim->params->max_iterations};
  granular_pressure_take(&by, &sim->scratch, taker);
  return by;
}

/* Find the velocity of the grains at faces with the p_s of before, in total
 * flux form, and their mobility. */
static void start_grains(struct two_fluid *sim, double dt, double *u_f) {
  const struct mesh *mesh = sim->grid.mesh;
  for (int d = 0; d < DIM; d++) {
    for (int32_t f = mesh->face_begin[d]; f < mesh->face_begin[d + 1]; f++) {
      const struct two_fluid_pair pair = pair_of(sim, dt, d, f);
      const double phi = pair.phi, w_s = sim->w_f[TWO_FLUID_S]->v[f];
      const double w_f = sim->w_f[TWO_FLUID_F]->v[f];
      u_f[f] = sim->mobility_f->v[f] = 0;
      if (two_fluid_is_side(sim, f)) continue;
      const double M = two_fluid_pair_inertia(&pair);
      const double N = M - pair.rho_s + pair.rho_f;
      u_f[f] = (pair.rho_s * w_s - pair.rho_f * w_f + N * sim->j->v[f] +
                dt * force_of(sim, d, f, &pair)) /
               M;
      if (phi > TWO_FLUID_NONE) sim->mobility_f->v[f] = 1 / (phi * M);
    }
  }
  field_fill_faces(mesh, sim->mobility_f);
}

/* Find p_s, alpha at the end of the step and the flux, for the present j; those
 * of the last pass are the guess. j of the first pass changes, so that p_s need
 * not be better. */
static void press(struct two_fluid *sim, double dt, double *p_s) {
  double *u_f = scratch_take_one(&sim->scratch, FIELD_FACE, __func__);
  start_grains(sim, dt, u_f);
  const struct granular_surface surface = {sim, two_fluid_passing};
  struct granular_pressure by = two_fluid_material(sim, "pressure");
  if (sim->keys->surface == TWO_FLUID_PLANES) by.surface = &surface;
  by.guessed = sim->passes > 0;
  if (!by.guessed) by.tolerance = sim->params->tolerance_pressure;
  const int newton = sim->pressure.newton;
  const int iterations = sim->pressure.iterations;
  sim->pressure = granular_pressure_solve(&by, dt, u_f, p_s, sim->alpha_new->v,
                                          sim->flux->v);
  sim->pressure.newton += newton;
  sim->pressure.iterations += iterations;
  scratch_give(&sim->scratch, "pressure");
  scratch_give(&sim->scratch, __func__);
}

/* Find the velocities u of both phases through face f of axis d, for a slope of
 * p. */
static inline void move(const struct two_fluid *sim, double dt, int d,
                        int32_t f, double slope, double u[2]) {
  const struct two_fluid_pair pair = pair_of(sim, dt, d, f);
  u[0] = sim->w_f[TWO_FLUID_S]->v[f];
  u[1] = sim->w_f[TWO_FLUID_F]->v[f] - dt * slope / pair.rho_f;
  if (two_fluid_is_side(sim, f)) return; /* grains stay, the fluid is clear */
  u[0] += dt * (force_of(sim, d, f, &pair) - slope) / pair.rho_s;
  two_fluid_pair_solve(&pair, u);
}

/* Set j for p = 0 and the mobility of the mixture. */
static void start_mixture(struct two_fluid *sim, double dt) {
  const struct mesh *mesh = sim->grid.mesh;
  for (int d = 0; d < DIM; d++) {
    for (int32_t f = mesh->face_begin[d]; f < mesh->face_begin[d + 1]; f++) {
      const struct two_fluid_pair pair = pair_of(sim, dt, d, f);
      const bool side = two_fluid_is_side(sim, f);
      double u[2];
      move(sim, dt, d, f, 0, u);
      sim->j->v[f] = side ? u[1] : pair.phi * u[0] + (1 - pair.phi) * u[1];
      sim->lambda_f->v[f] = two_fluid_pair_mobility(&pair);
      if (side) sim->lambda_f->v[f] = is_open(sim, f) ? 1 / pair.rho_f : 0;
    }
  }
  mesh_fill_faces(mesh, 2, (double *const[]){sim->j->v, sim->lambda_f->v});
}

/* Set v of both phases for the pressure found. */
static void set_responses(struct two_fluid *sim, double dt) {
  const struct mesh *mesh = sim->grid.mesh;
  for (int d = 0; d < DIM; d++) {
    for (int32_t f = mesh->face_begin[d]; f < mesh->face_begin[d + 1]; f++) {
      const double lambda = sim->lambda_f->v[f];
      double u[2];
      move(sim, dt, d, f, lambda > 0 ? sim->force_f->v[f] / lambda : 0, u);
      for (int k = 0; k < TWO_FLUID_NPHASES; k++)
        sim->v_f[k]->v[f] = u[k] - sim->w_f[k]->v[f];
    }
  }
  for (int k = 0; k < TWO_FLUID_NPHASES; k++)
    field_fill_faces(mesh, sim->v_f[k]);
}

/* Find p and j for the present p_s. */
static void project(struct two_fluid *sim, double dt) {
  double *rhs = scratch_take_one(&sim->scratch, FIELD_CELL, __func__);
  const struct projection projection = {
      .mesh = sim->grid.mesh,
      .hierarchy = sim->grid.hierarchy,
      .rho = sim->inertia->v,
      .alpha_f = sim->lambda_f->v,
      .bc = sim->p->bc,
      .tolerance = sim->params->tolerance_pressure,
      .max_iterations = sim->params->max_iterations,
      .rhs = rhs,
      .flux = sim->force_f->v};
  start_mixture(sim, dt);
  const int iterations = sim->projection.iterations;
  sim->projection = projection_project(&projection, dt, sim->j->v, sim->p->v);
  sim->projection.iterations += iterations;
  scratch_give(&sim->scratch, __func__);
  set_responses(sim, dt);
}

/* Return the largest change of j over dt, in edges. */
static double change_of(const struct two_fluid *sim, double dt,
                        const double *before) {
  const struct mesh *mesh = sim->grid.mesh;
  double most = 0;
  for (int32_t f = 0; f < mesh->nfaces; f++) {
    const double change = fabs(sim->j->v[f] - before[f]) * dt;
    most = max2(most, mesh_face_edges(mesh, f, change));
  }
  return mesh_max(mesh, most);
}

/* Let drag act on what leaf i has of slip and its faces have not, which their
 * means do not see. */
static void drag_rest(struct two_fluid *sim, double dt, int e, int32_t i,
                      const double u[2]) {
  const struct two_fluid_pair pair = {
      .phi = max2(sim->alpha->v[i], 0),
      .rho_s = two_fluid_density(sim, TWO_FLUID_S),
      .rho_f = two_fluid_density(sim, TWO_FLUID_F),
      .drag = dt * sim->drag->v[i]};
  double *u_s = &sim->u[TWO_FLUID_S][e]->v[i];
  double *u_f = &sim->u[TWO_FLUID_F][e]->v[i];
  double rest[2] = {*u_s - *u_f - (u[0] - u[1]), 0};
  const double before = rest[0];
  two_fluid_pair_solve(&pair, rest);
  *u_s += rest[0] - before;
  *u_f += rest[1];
}

/* Give the leaves what their faces have got along axis e. */
static void accelerate_along(struct two_fluid *sim, double dt, int e) {
  const struct mesh *mesh = sim->grid.mesh;
  const double *v[TWO_FLUID_NPHASES] = {sim->v_f[0]->v, sim->v_f[1]->v};
  double *more = scratch_take_one(&sim->scratch, FIELD_CELL, __func__);
  two_fluid_jumps(sim, dt, e, v, more);
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    double u[TWO_FLUID_NPHASES];
    for (int k = 0; k < TWO_FLUID_NPHASES; k++) {
      const double gain = share_of(sim, k, e, i, v[k]);
      u[k] = share_of(sim, k, e, i, sim->w_f[k]->v) + gain;
      sim->u[k][e]->v[i] += gain + more[i];
    }
    if (two_fluid_has_grains(sim, i)) drag_rest(sim, dt, e, i, u);
  }
  for (int k = 0; k < TWO_FLUID_NPHASES; k++) mesh_touch(mesh, sim->u[k][e]->v);
  scratch_give(&sim->scratch, __func__);
}

void two_fluid_pressures(struct two_fluid *sim, double dt) {
  const struct mesh *mesh = sim->grid.mesh;
  const double enough = PASS_SLACK * sim->params->tolerance_pressure;
  const double fits = PRESSURE_FACTOR * sim->params->tolerance_pressure;
  double *kept[2], *before;
  scratch_take(&sim->scratch, FIELD_CELL, __func__, 2, kept);
  before = scratch_take_one(&sim->scratch, FIELD_FACE, "flux of before");
  double *p_s = kept[0], *old = kept[1], change = INFINITY;
  memcpy(old, sim->p_s->v, (size_t)mesh->ncells * sizeof *old);
  memcpy(sim->load->v, sim->p_s->v, (size_t)mesh->nleaves * sizeof *old);
  sim->pressure = (struct granular_stats){.residual = INFINITY};
  sim->projection = (struct solve_stats){0};
  set_means(sim);
  if (sim->exact) hold_still(sim, dt);
  field_fill_faces(mesh, sim->j);
  for (sim->passes = 0; sim->passes < MOST_PASSES &&
                        (change > enough || sim->pressure.residual > fits);
       sim->passes++) {
    memcpy(before, sim->j->v, (size_t)mesh->nfaces_all * sizeof *before);
    if (sim->passes > 0)
      memcpy(sim->p_s->v, old, (size_t)mesh->ncells * sizeof *old);
    press(sim, dt, p_s), two_fluid_lap(sim, TWO_FLUID_PRESSURE);
    memcpy(sim->p_s->v, p_s, (size_t)mesh->ncells * sizeof *p_s);
    project(sim, dt), two_fluid_lap(sim, TWO_FLUID_PROJECTION);
    change = change_of(sim, dt, before);
  }
  granular_carry(mesh, dt, sim->alpha->v, sim->flux->v, sim->alpha_new->v);
  scratch_give(&sim->scratch, __func__);
  scratch_give(&sim->scratch, "flux of before");
  for (int k = 0; k < TWO_FLUID_NPHASES; k++)
    field_fill_faces(mesh, sim->w_f[k]);
  for (int e = 0; e < DIM; e++) accelerate_along(sim, dt, e);
}
