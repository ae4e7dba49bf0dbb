/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/two_phase/state.h"

#include <math.h>
#include <string.h>

#include "talus/adapt.h"
#include "talus/clean.h"
#include "talus/error.h"
#include "talus/forest.h"
#include "talus/hierarchy.h"
#include "talus/level_raster.h"
#include "talus/memory.h"
#include "talus/minmax.h"
#include "talus/openings.h"
#include "talus/shapes.h"
#include "talus/skin.h"
#include "talus/two_phase/step.h"
#include "talus/vof.h"

void two_phase_layout(const struct params *params,
                      struct forest_layout *layout) {
  memset(layout, 0, sizeof *layout);
  layout->size = params->size;
  for (int d = 0; d < DIM; d++) {
    layout->origin[d] = params->origin[d];
    layout->trees[d] = params->trees[d];
    layout->periodic[d] = params->boundary[2 * d].type == BOUNDARY_PERIODIC;
  }
  layout->patch = openings_patch;
  layout->patch_context = (void *)params;
}

/* Conditions of one boundary, on a patch across `axis`. */
static void set_patch(struct two_phase *sim, int patch, int axis,
                      const struct boundary *boundary) {
  CHECK(patch < MESH_MAX_PATCHES, "more than %d boundary patches",
        MESH_MAX_PATCHES);
  const bool open = boundary->type == BOUNDARY_OUTFLOW;
  sim->open[patch] = open;
  sim->closed[patch] = !open;
  for (int e = 0; e < DIM; e++) {
    struct bc *bc = &sim->u[e]->bc[patch];
    bc->value = boundary->velocity[e];
    if (open) {
      *bc = (struct bc){BC_NEUMANN, 0, 0};
    } else if (boundary->type == BOUNDARY_SLIP ||
               boundary->type == BOUNDARY_NAVIER) {
      if (e == axis) {
        *bc = (struct bc){BC_DIRICHLET, 0, 0};
      } else if (boundary->type == BOUNDARY_NAVIER) {
        bc->type = BC_ROBIN, bc->length = boundary->slip_length;
      } else {
        *bc = (struct bc){BC_NEUMANN, 0, 0};
      }
    } else {
      bc->type = BC_DIRICHLET; /* a wall moves along itself only */
      if (boundary->type == BOUNDARY_NO_SLIP && e == axis) bc->value = 0;
    }
    sim->u_old[e]->bc[patch] = *bc;
  }
  if (open) {
    sim->p->bc[patch] = (struct bc){BC_DIRICHLET, boundary->pressure, 0};
  }
  if (boundary->type == BOUNDARY_INFLOW) {
    sim->c->bc[patch] = (struct bc){BC_CARRIED, boundary->fraction, 0};
    for (int k = 0; k < sim->params->ntracers; k++) {
      sim->tracer[k]->bc[patch] = (struct bc){BC_CARRIED, 0, 0};
    }
  }
}

static void set_boundaries(struct two_phase *sim) {
  const struct params *params = sim->params;
  for (int side = 0; side < NFACE; side++) {
    set_patch(sim, side, side / 2, &params->boundary[side]);
  }
  for (int b = 6; b < params->nboundaries; b++) {
    for (int axis = 0; axis < DIM; axis++) {
      set_patch(sim, openings_patch_number(b, axis), axis,
                &params->boundary[b]);
    }
  }
}

/* Find out whether some face of the mesh sets the pressure. */
static void find_openings(struct two_phase *sim) {
  double open = 0;
  for (int32_t f = 0; f < sim->mesh->nfaces; f++) {
    const int patch = sim->mesh->face_patch[f];
    if (patch >= 0 && sim->open[patch]) open = 1;
  }
  sim->pressure_set = mesh_max(sim->mesh, open) > 0;
}

static struct field *add_cell(struct two_phase *sim, const char *name,
                              const char *unit, const char *title,
                              enum field_remap remap, bool output) {
  struct field *field =
      fields_add(&sim->fields, sim->mesh, name, unit, title, FIELD_CELL, remap);
  field->output = output;
  field->restart = remap != REMAP_NONE;
  return field;
}

static void add_state(struct two_phase *sim) {
  static const char *const velocity[] = {"velocity_x", "velocity_y",
                                         "velocity_z"};
  static const char *const force[] = {"acceleration_x", "acceleration_y",
                                      "acceleration_z"};
  static const char *const viscous[] = {"viscous_x", "viscous_y", "viscous_z"};
  sim->c = add_cell(sim, "fraction", "1", "volume fraction of grains",
                    REMAP_VOF, true);
  for (int k = 0; k < sim->params->ntracers; k++) {
    sim->tracer[k] = add_cell(sim, sim->params->tracer[k].name, "1",
                              "passive tracer", REMAP_VOF, true);
  }
  for (int d = 0; d < DIM; d++) {
    sim->u[d] =
        add_cell(sim, velocity[d], "m/s", "velocity", REMAP_MOMENTUM, true);
    sim->u[d]->component = d;
    sim->g[d] = add_cell(sim, force[d], "m/s^2",
                         "gravity less pressure gradient over density",
                         REMAP_AVERAGE, false);
    sim->viscous_g[d] =
        add_cell(sim, viscous[d], "m/s^2", "viscous force over density",
                 REMAP_AVERAGE, false);
  }
  sim->p = add_cell(sim, "pressure", "Pa", "pressure", REMAP_LINEAR, true);
  sim->u_f = fields_add(&sim->fields, sim->mesh, "face_velocity", "m/s",
                        "normal velocity at faces", FIELD_FACE, REMAP_FACE);
  sim->u_f->restart = true;
}

static struct field *add_face(struct two_phase *sim, const char *name) {
  return fields_add(&sim->fields, sim->mesh, name, "", "", FIELD_FACE,
                    REMAP_NONE);
}

/* A field that is made when it is written. */
static struct field *add_output(struct two_phase *sim, const char *name,
                                const char *unit, const char *title) {
  struct field *field = add_cell(sim, name, unit, title, REMAP_NONE, true);
  field->on_demand = true;
  mem_free(field->v);
  field->v = NULL;
  return field;
}

static void add_known(struct two_phase *sim) {
  const struct rheology_model *model = sim->params->grains.rheology.model;
  sim->shear_rate =
      add_output(sim, "shear_rate", "1/s", "shear rate sqrt(2 D:D)");
  CHECK(model->noutputs <= TWO_PHASE_MAX_KNOWN, "%s has %d outputs",
        model->name, model->noutputs);
  for (; sim->nknown < model->noutputs; sim->nknown++) {
    const struct rheology_quantity *quantity = &model->outputs[sim->nknown];
    sim->known[sim->nknown] =
        add_output(sim, quantity->name, quantity->unit, quantity->title);
  }
}

static void add_walls(struct two_phase *sim) {
  sim->drag = add_cell(sim, "drag", "kg/m^3/s", "drag of the side walls",
                       REMAP_AVERAGE, false);
}

/* Add the scratch of gas that leaves through the grains (percolation.h). */
static void add_percolation(struct two_phase *sim) {
  sim->source = add_cell(sim, "source", "1/s", "", REMAP_NONE, false);
  sim->carrier = add_face(sim, "carrier");
}

static void add_scratch(struct two_phase *sim) {
  static const char *const normal[] = {"normal_x", "normal_y", "normal_z"};
  static const char *const old[] = {"old_x", "old_y", "old_z"};
  static const char *const cell[] = {"cell_0", "cell_1", "cell_2",
                                     "cell_3", "cell_4", "cell_5",
                                     "cell_6", "cell_7", "cell_8"};
  static const char *const face[] = {"face_0", "face_1", "face_2", "face_3"};
  sim->rho = add_cell(sim, "density", "kg/m^3", "density", REMAP_NONE, false);
  sim->eta = add_cell(sim, "viscosity", "Pa s", "viscosity, mean of the faces",
                      REMAP_AVERAGE, true);
  sim->eta->old = sim->eta; /* a step that fails does not touch it */
  sim->frozen = add_cell(sim, "frozen", "1", "", REMAP_NONE, false);
  sim->plane = add_cell(sim, "plane", "1", "", REMAP_NONE, false);
  sim->band = add_cell(sim, "band", "1", "", REMAP_NONE, false);
  for (int d = 0; d < DIM; d++) {
    sim->normal[d] = add_cell(sim, normal[d], "1", "", REMAP_NONE, false);
    sim->u_old[d] = add_cell(sim, old[d], "m/s", "", REMAP_NONE, false);
    sim->u[d]->old = sim->u_old[d];
  }
  add_known(sim);
  if (sim->params->side_walls.mu > 0) add_walls(sim);
  if (sim->params->permeable) add_percolation(sim);
  const int ncells = (sim->params->theta < 1 ? 3 : 2) * DIM;
  for (int k = 0; k < ncells; k++) {
    sim->cell[k] = add_cell(sim, cell[k], "", "", REMAP_NONE, false);
  }
  sim->eta_f = add_face(sim, "face_viscosity");
  sim->alpha_f = add_face(sim, "face_specific_volume");
  sim->gravity_f = add_face(sim, "face_gravity");
  sim->u_half = add_face(sim, "face_half");
  sim->u_f->old = sim->u_half; /* when a step has failed */
  for (int k = 0; k < DIM + 1; k++) sim->face[k] = add_face(sim, face[k]);
}

void two_phase_remesh(struct two_phase *sim) {
  fields_release(&sim->fields, true);
  clean_destroy(sim->clean);
  hierarchy_destroy(sim->hierarchy);
  mesh_destroy(sim->mesh);
  sim->mesh = mesh_new(sim->forest);
  sim->hierarchy = hierarchy_new(sim->mesh);
  sim->clean = clean_new(sim->mesh);
  fields_reset(&sim->fields, sim->mesh);
  find_openings(sim);
  sim->planes_hold = false;
}

struct two_phase *two_phase_new_on(const struct params *params,
                                   struct forest *forest) {
  struct two_phase *sim = MEM_NEW(struct two_phase, 1);
  sim->params = params;
  sim->forest = forest;
  sim->skin = skin_new();
  two_phase_remesh(sim);
  add_state(sim);
  add_scratch(sim);
  set_boundaries(sim);
  find_openings(sim);
  return sim;
}

void two_phase_destroy(struct two_phase *sim) {
  if (!sim) return;
  fields_destroy(&sim->fields);
  for (int k = 0; k < PARAMS_MAX_CRITERIA; k++) {
    level_raster_destroy(sim->level_raster[k]);
  }
  clean_destroy(sim->clean);
  skin_destroy(sim->skin);
  hierarchy_destroy(sim->hierarchy);
  mesh_destroy(sim->mesh);
  forest_destroy(sim->forest);
  mem_free(sim);
}

/* How far shapes are divided to measure them, in levels below the finest of
 * the grid: not at all to see where they are, to adapt the grid to them. */
enum fineness { FINENESS_ROUGH = 0, FINENESS_FINAL = 3 };

/* Say, every so many leaves of a loop over them, how far it is. */
static void tell(const struct two_phase *sim, const char *what, int32_t i) {
  enum { EVERY = 256 };
  if (!sim->start || !sim->start->tell || i % EVERY != 0) return;
  sim->start->tell(sim->start->context, what,
                   (double)i / max2(sim->mesh->nleaves, 1),
                   forest_nleaves_global(sim->forest));
}

/* Fractions of a shape. Coarse leaves are divided more often, so that what
 * is DEEPEST levels finer is not missed. */
static void fill_shape(const struct two_phase *sim, enum fineness fineness,
                       const struct function *shape, struct field *field) {
  enum { DEEPEST = 6 };
  const struct mesh *mesh = sim->mesh;
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    tell(sim, "shapes", i);
    int depth = sim->params->level_max - mesh->level[i] + (int)fineness;
    if (depth > DEEPEST) depth = DEEPEST;
    field->v[i] = shape->eval ? shape_fraction(shape->eval, shape->context,
                                               mesh->x[i], mesh->h[i], depth)
                              : 1;
  }
}

/* Velocity of a leaf with grains and gas in it, which may move apart: that of
 * its mass, sampled on a lattice. */
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
      x[e] = sim->mesh->x[i][e] +
             sim->mesh->h[i] * ((at[e] + 0.5) / SAMPLES - 0.5);
    }
    const bool grains = params->shape.eval(params->shape.context, x) > 0;
    const double rho = grains ? params->grains.density : params->gas.density;
    mass += rho;
    momentum += rho * velocity->eval(velocity->context, x);
  }
  return momentum / mass;
}

/* What the grid may follow. */
static void fill_state(struct two_phase *sim, enum fineness fineness) {
  const struct params *params = sim->params;
  const struct mesh *mesh = sim->mesh;
  fill_shape(sim, fineness, &params->shape, sim->c);
  for (int d = 0; d < DIM; d++) {
    const struct function *function = &params->velocity[d];
    if (!function->eval) continue;
    for (int32_t i = 0; i < mesh->nleaves; i++) {
      double x[3] = {0};
      tell(sim, "velocity", i);
      for (int e = 0; e < DIM; e++) x[e] = mesh->x[i][e];
      sim->u[d]->v[i] = vof_is_cut(sim->c->v[i])
                            ? mixed_velocity(sim, function, i)
                            : function->eval(function->context, x);
    }
  }
}

/* Normal velocity at the centres of the faces. */
static void fill_face_velocity(struct two_phase *sim) {
  const struct mesh *mesh = sim->mesh;
  field_fill_many(mesh, DIM, sim->u);
  for (int d = 0; d < DIM; d++) {
    const struct function *function = &sim->params->velocity[d];
    for (int32_t f = mesh->face_begin[d]; f < mesh->face_begin[d + 1]; f++) {
      const int32_t i = mesh->face_owner[f];
      const int patch = mesh->face_patch[f];
      const double *u = sim->u[d]->v;
      const int32_t *node = mesh->face_node[f];
      sim->u_f->v[f] = 0.5 * (u[node[0]] + u[node[1]]);
      if (!function->eval || (patch >= 0 && sim->closed[patch])) continue;
      double x[3] = {0};
      for (int e = 0; e < DIM; e++) x[e] = mesh->x[i][e];
      x[d] += 0.5 * mesh->h[i] * (node[0] == i ? 1 : -1);
      sim->u_f->v[f] = function->eval(function->context, x);
    }
  }
  field_fill_faces(mesh, sim->u_f);
}

static void adapt_to_state(struct two_phase *sim, enum fineness fineness) {
  fill_state(sim, fineness);
  for (int k = 0; k <= 2 * sim->params->level_max; k++) {
    if (!adapt_grid(sim)) break;
    fill_state(sim, fineness);
  }
}

struct two_phase *two_phase_new_told(const struct params *params,
                                     const struct two_phase_start *start) {
  struct forest_layout layout;
  two_phase_layout(params, &layout);
  const int level =
      params->ncriteria > 0 ? params->level_min : params->level_max;
  struct two_phase *sim =
      two_phase_new_on(params, forest_new(MPI_COMM_WORLD, &layout, level));
  sim->start = start;
  sim->most_leaves = start->most_leaves;
  if (params->ncriteria > 0) {
    adapt_to_state(sim, FINENESS_ROUGH);
    adapt_to_state(sim, FINENESS_FINAL);
  } else {
    fill_state(sim, FINENESS_FINAL);
  }
  openings_check(sim);
  for (int k = 0; k < params->ntracers; k++) {
    fill_shape(sim, FINENESS_FINAL, &params->tracer[k].shape, sim->tracer[k]);
  }
  fill_face_velocity(sim);
  tell(sim, "pressure at rest", 0);
  step_start(sim);
  sim->start = NULL;
  return sim;
}

struct two_phase *two_phase_new(const struct params *params) {
  const struct two_phase_start start = {.most_leaves = 0};
  return two_phase_new_told(params, &start);
}

void two_phase_densities(const struct two_phase *sim, double density[2]) {
  density[0] = sim->params->grains.density;
  density[1] =
      sim->params->single_phase ? density[0] : sim->params->gas.density;
}
