/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/two_phase/start.h"

#include "talus/clean.h"
#include "talus/forest.h"
#include "talus/minmax.h"
#include "talus/model.h"
#include "talus/openings.h"
#include "talus/shape_memory.h"
#include "talus/two_phase/state.h"
#include "talus/two_phase/step.h"
#include "talus/vof.h"
#include "talus/yield.h"

/* Levels below the finest of the grid to which shapes are divided to be
 * measured: none to see where a shape is, while the grid is adapted. */
enum fineness { FINENESS_ROUGH = 0, FINENESS_FINAL = 3 };

/* A state that is being made. */
struct beginning {
  struct two_phase *sim;
  const struct model_start *start;
};

/* Say, every so many leaves of a loop, how far the loop is. */
static void tell(const struct beginning *beginning, const char *what,
                 int32_t i) {
  enum { EVERY = 256 };
  const struct model_start *start = beginning->start;
  const struct grid *grid = &beginning->sim->grid;
  if (!start->tell || i % EVERY != 0) return;
  start->tell(start->context, what, (double)i / max2(grid->mesh->nleaves, 1),
              forest_nleaves_global(grid->forest));
}

/* Fill a field with the fractions of a shape. Coarse leaves are divided more
 * often, so that what is of the size of the finest ones is not missed. */
static void fill_shape(const struct beginning *beginning,
                       enum fineness fineness, const struct function *shape,
                       struct field *field) {
  const struct two_phase *sim = beginning->sim;
  const struct mesh *mesh = sim->grid.mesh;
  double (*const fraction)(shape_level_set, void *, const double[DIM], double,
                           int) =
      mesh_is_axisymmetric(mesh) ? shape_ring_fraction : shape_fraction;
  struct shape_memory *memory = shape_memory_new(shape->eval, shape->context);
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    tell(beginning, "shapes", i);
    const int depth = sim->params->level_max - mesh->level[i] + (int)fineness;
    field->v[i] = shape->eval ? fraction(shape_memory_value, memory, mesh->x[i],
                                         mesh->h[i], depth)
                              : 1;
  }
  shape_memory_destroy(memory);
}

/* Return the velocity of the mass of a leaf in which grains and gas may move
 * apart, sampled on a lattice. */
static double mixed_velocity(const struct two_phase *sim,
                             const struct function *velocity, int32_t i) {
  enum { SAMPLES = 8, ALL = DIM == 2 ? 64 : 512 }; /* along an edge, in all */
  const struct params *params = sim->params;
  double mass = 0, momentum = 0;
  for (int k = 0; k < ALL; k++) {
    const int at[] = {k % SAMPLES, k / SAMPLES % SAMPLES,
                      k / (SAMPLES * SAMPLES)};
    double x[3] = {0};
    for (int e = 0; e < DIM; e++) {
      x[e] = sim->grid.mesh->x[i][e] +
             sim->grid.mesh->h[i] * ((at[e] + 0.5) / SAMPLES - 0.5);
    }
    const bool grains = params->shape.eval(params->shape.context, x) > 0;
    const double rho = grains ? params->grains.density : params->gas.density;
    const double part = params_axisymmetric(params) ? rho * x[0] : rho;
    mass += part;
    momentum += part * velocity->eval(velocity->context, x);
  }
  return momentum / mass;
}

/* Fill the fields that the grid may follow. */
static void fill_state(const struct beginning *beginning,
                       enum fineness fineness) {
  struct two_phase *sim = beginning->sim;
  const struct params *params = sim->params;
  const struct mesh *mesh = sim->grid.mesh;
  fill_shape(beginning, fineness, &params->shape, sim->c);
  for (int d = 0; d < DIM; d++) {
    const struct function *function = &params->velocity[d];
    if (!function->eval) continue;
    for (int32_t i = 0; i < mesh->nleaves; i++) {
      double x[3] = {0};
      tell(beginning, "velocity", i);
      for (int e = 0; e < DIM; e++) x[e] = mesh->x[i][e];
      sim->u[d]->v[i] = vof_is_cut(sim->c->v[i])
                            ? mixed_velocity(sim, function, i)
                            : function->eval(function->context, x);
    }
  }
}

/* Set u_f to the normal velocity at the centres of the faces. */
static void fill_face_velocity(struct two_phase *sim) {
  const struct mesh *mesh = sim->grid.mesh;
  field_fill_many(mesh, DIM, sim->u);
  for (int d = 0; d < DIM; d++) {
    const struct function *function = &sim->params->velocity[d];
    for (int32_t f = mesh->face_begin[d]; f < mesh->face_begin[d + 1]; f++) {
      const int32_t i = mesh->face_owner[f];
      const int patch = mesh->face_patch[f];
      const double *u = sim->u[d]->v;
      const int32_t *node = mesh->face_node[f];
      sim->u_f->v[f] = 0.5 * (u[node[0]] + u[node[1]]);
      if (!function->eval || (patch >= 0 && sim->grid.closed[patch])) continue;
      double x[3] = {0};
      for (int e = 0; e < DIM; e++) x[e] = mesh->x[i][e];
      x[d] += 0.5 * mesh->h[i] * (node[0] == i ? 1 : -1);
      sim->u_f->v[f] = function->eval(function->context, x);
    }
  }
  field_fill_faces(mesh, sim->u_f);
}

static void adapt_to_state(const struct beginning *beginning,
                           enum fineness fineness) {
  struct two_phase *sim = beginning->sim;
  fill_state(beginning, fineness);
  for (int k = 0; k <= 2 * sim->params->level_max; k++) {
    if (!two_phase_adapt(sim)) break;
    fill_state(beginning, fineness);
  }
}

void two_phase_refine_openings(struct two_phase *sim) {
  const struct grid *grid = &sim->grid;
  bool changed = false;
  for (int k = 0; k < 2 * sim->params->level_max; k++) {
    if (openings_are_fine(grid) || !two_phase_adapt(sim)) break;
    changed = true;
  }
  if (changed) {
    clean_face_velocity(grid->clean, grid->mesh, grid->open, sim->u_f->v);
  }
  openings_check(grid);
}

/* Grains with an exact yield that move at first have their stress at once. */
static void start_stress(struct two_phase *sim) {
  double *u[DIM];
  if (!sim->exact) return;
  field_arrays(sim->u, u);
  yield_start(&sim->yield, u);
}

struct two_phase *two_phase_new(const struct params *params,
                                const struct model_start *start) {
  struct forest_layout layout;
  grid_layout(params, &layout);
  const int level =
      params->ncriteria > 0 ? params->level_min : params->level_max;
  struct two_phase *sim =
      two_phase_new_on(params, forest_new(MPI_COMM_WORLD, &layout, level));
  const struct beginning beginning = {sim, start};
  sim->grid.most_leaves = start->most_leaves;
  if (params->ncriteria > 0) {
    adapt_to_state(&beginning, FINENESS_ROUGH);
    adapt_to_state(&beginning, FINENESS_FINAL);
  } else {
    fill_state(&beginning, FINENESS_FINAL);
  }
  openings_check(&sim->grid);
  for (int k = 0; k < params->ntracers; k++) {
    fill_shape(&beginning, FINENESS_FINAL, &params->tracer[k].shape,
               sim->tracer[k]);
  }
  fill_face_velocity(sim);
  tell(&beginning, "pressure at rest", 0);
  step_start(sim);
  start_stress(sim);
  return sim;
}
