/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/two_phase/state.h"

#include <string.h>

#include "talus/adapt.h"
#include "talus/error.h"
#include "talus/forest.h"
#include "talus/memory.h"
#include "talus/remap.h"
#include "talus/sides.h"
#include "talus/skin.h"
#include "talus/slip_strip.h"
#include "talus/vof.h"

/* Set the conditions of one boundary, on a patch across `axis`. */
static void set_patch(void *context, int patch, int axis,
                      const struct boundary *boundary) {
  struct two_phase *sim = context;
  for (int e = 0; e < DIM; e++) {
    sim->u[e]->bc[patch] = sides_velocity(boundary, axis, e);
  }
  if (boundary->type == BOUNDARY_OUTFLOW) {
    sim->p->bc[patch] = (struct bc){BC_DIRICHLET, boundary->pressure, 0};
  }
  if (boundary->type == BOUNDARY_INFLOW) {
    sim->c->bc[patch] = (struct bc){BC_CARRIED, boundary->fraction, 0};
    for (int k = 0; k < sim->params->ntracers; k++) {
      sim->tracer[k]->bc[patch] = (struct bc){BC_CARRIED, 0, 0};
    }
  }
}

static struct field *add_cell(struct two_phase *sim, const char *name,
                              const char *unit, const char *title,
                              const struct field_rule *rule, bool output) {
  struct field *field = fields_add(&sim->grid.fields, sim->grid.mesh, name,
                                   unit, title, FIELD_CELL, rule);
  field->output = output;
  field->restart = rule != NULL;
  return field;
}

static struct field *add_fraction(struct two_phase *sim, const char *name,
                                  const char *title) {
  struct field *field = add_cell(sim, name, "1", title, &vof_rule, true);
  field->low = 0, field->high = 1;
  return field;
}

/* Does the sum of a velocity mean a momentum that is kept? That of a radial one
 * does not; it is linear at the axis, and is to stay so. */
static bool is_kept(const struct field *field) {
  const struct two_phase *sim = field->context;
  return field->component > 0 || !params_axisymmetric(sim->params);
}

/* Leave a mixed leaf its one velocity in all parts; elsewhere take slopes. */
static double divide_momentum(const struct remap *remap,
                              const struct field *field, int32_t leaf) {
  const struct two_phase *sim = field->context;
  if (vof_is_cut(sim->c->v[remap->map->first[leaf]])) {
    return remap_value(remap, field, leaf);
  }
  return is_kept(field) ? remap_on_ring_slopes(remap, field, leaf)
                        : remap_on_slopes(remap, field, leaf);
}

/* Take the mean velocity weighted by mass, which conserves momentum; a radial
 * one by density. */
static double merge_momentum(const struct remap *remap,
                             const struct field *field, int32_t leaf) {
  const struct two_phase *sim = field->context;
  const double grains = sim->params->grains.density;
  const double gas = sim->params->gas.density;
  const int32_t first = remap->map->first[leaf];
  double sum = 0, weights = 0;
  for (int32_t i = first; i < first + remap->map->count[leaf]; i++) {
    const double volume = is_kept(field) ? remap_weight(remap, leaf, i) : 1;
    const double weight = volume * (gas + sim->c->v[i] * (grains - gas));
    sum += weight * field->v[i];
    weights += weight;
  }
  return sum / weights;
}

static const struct field_rule momentum_rule = {divide_momentum,
                                                merge_momentum};

static struct field *add_kept_face(struct two_phase *sim, const char *name,
                                   const char *unit, const char *title,
                                   const struct field_rule *rule) {
  struct field *field = fields_add(&sim->grid.fields, sim->grid.mesh, name,
                                   unit, title, FIELD_FACE, rule);
  field->restart = true;
  return field;
}

static void add_state(struct two_phase *sim) {
  static const char *const velocity[] = {"velocity_x", "velocity_y",
                                         "velocity_z"};
  static const char *const force[] = {"acceleration_x", "acceleration_y",
                                      "acceleration_z"};
  static const char *const viscous[] = {"viscous_x", "viscous_y", "viscous_z"};
  sim->c = add_fraction(sim, "fraction", "volume fraction of grains");
  for (int k = 0; k < sim->params->ntracers; k++) {
    sim->tracer[k] =
        add_fraction(sim, sim->params->tracer[k].name, "passive tracer");
  }
  for (int d = 0; d < DIM; d++) {
    sim->u[d] =
        add_cell(sim, velocity[d], "m/s", "velocity", &momentum_rule, true);
    sim->u[d]->component = d;
    sim->u[d]->context = sim;
    sim->g[d] = add_cell(sim, force[d], "m/s^2",
                         "gravity less pressure gradient over density",
                         &remap_average, false);
    sim->viscous_g[d] =
        add_cell(sim, viscous[d], "m/s^2", "viscous force over density",
                 &remap_average, false);
  }
  sim->p = add_cell(sim, "pressure", "Pa", "pressure", &remap_linear, true);
  sim->u_f = add_kept_face(sim, "face_velocity", "m/s",
                           "normal velocity at faces", &remap_flux);
  const struct rheology *grains = &sim->params->grains.rheology;
  sim->exact =
      grains->regularisation == RHEOLOGY_EXACT && rheology_yields(grains);
  if (sim->exact)
    yield_add(&sim->yield, &sim->grid.fields, &sim->grid.mesh, false);
}

static struct field *add_face(struct two_phase *sim, const char *name) {
  return fields_add(&sim->grid.fields, sim->grid.mesh, name, "", "", FIELD_FACE,
                    NULL);
}

/* Add a field that is made when it is written. */
static struct field *add_output(struct two_phase *sim, const char *name,
                                const char *unit, const char *title) {
  struct field *field = add_cell(sim, name, unit, title, NULL, true);
  field->on_demand = true;
  mem_free(field->v);
  field->v = NULL;
  return field;
}

static void add_known(struct two_phase *sim) {
  const struct rheology_model *model = sim->params->grains.rheology.model;
  sim->shear_rate =
      add_output(sim, "shear_rate", "1/s", "shear rate sqrt(2 D:D)");
  sim->stress =
      add_output(sim, "stress", "Pa", "stress of the grains, sqrt(T:T/2)");
  CHECK(model->noutputs <= TWO_PHASE_MAX_KNOWN, "%s has %d outputs",
        model->name, model->noutputs);
  for (; sim->nknown < model->noutputs; sim->nknown++) {
    const struct rheology_quantity *quantity = &model->outputs[sim->nknown];
    sim->known[sim->nknown] =
        add_output(sim, quantity->name, quantity->unit, quantity->title);
  }
}

static void add_walls(struct two_phase *sim) {
  static const char *const name[] = {"wall_x", "wall_y", "wall_z"};
  for (int d = 0; d < DIM; d++) {
    sim->wall[d] = add_cell(sim, name[d], "N/m^3", "force of the side walls",
                            &remap_average, false);
  }
}

/* Add the scratch of gas that leaves through the grains (percolation.h). */
static void add_percolation(struct two_phase *sim) {
  sim->source = add_cell(sim, "source", "1/s", "", NULL, false);
  sim->carrier = add_face(sim, "carrier");
}

static void add_scratch(struct two_phase *sim) {
  static const char *const normal[] = {"normal_x", "normal_y", "normal_z"};
  static const char *const old[] = {"old_x", "old_y", "old_z"};
  sim->rho = add_cell(sim, "density", "kg/m^3", "density", NULL, false);
  sim->eta = add_cell(sim, "viscosity", "Pa s",
                      sim->exact ? "plastic viscosity, mean of the faces"
                                 : "viscosity, mean of the faces",
                      &remap_average, true);
  sim->eta->old = sim->eta; /* a step that fails does not touch it */
  sim->plane = add_cell(sim, "plane", "1", "", NULL, false);
  sim->band = add_cell(sim, "band", "1", "", NULL, false);
  for (int d = 0; d < DIM; d++) {
    sim->normal[d] = add_cell(sim, normal[d], "1", "", NULL, false);
    sim->u_old[d] = add_cell(sim, old[d], "m/s", "", NULL, false);
    sim->u[d]->old = sim->u_old[d];
  }
  add_known(sim);
  if (sim->exact) {
    sim->yield.still = add_cell(sim, "still", "1", "", NULL, false);
    sim->yield.state =
        add_output(sim, "yield_state", "1", "0: held, 1: at the yield stress");
  }
  if (sim->params->side_walls.mu > 0) add_walls(sim);
  if (sim->params->permeable) add_percolation(sim);
  sim->eta_f = add_face(sim, "face_viscosity");
  if (sim->exact) {
    sim->yield.shear = add_face(sim, "face_shear");
    sim->yield.eta = sim->eta_f;
    sim->yield.scratch = &sim->scratch;
    sim->yield.skin = &sim->skin;
  }
  sim->alpha_f = add_face(sim, "face_specific_volume");
  sim->gravity_f = add_face(sim, "face_gravity");
  sim->u_half = add_face(sim, "face_half");
  sim->u_half->on_demand = true;
  mem_free(sim->u_half->v);
  sim->u_half->v = NULL;
  sim->u_f->old = sim->u_half; /* when a step has failed */
  /* for a predictor with viscosity, or sweeps in two orders */
  const bool more = sim->params->theta < 1 || sim->exact || DIM == 3;
  const int walls = sim->wall[0] != NULL; /* have their mass */
  const int ncells = (more ? 3 : 2) * DIM + 1 + walls;
  scratch_init(&sim->scratch, &sim->grid.fields, &sim->grid.mesh, ncells,
               sim->exact ? sim->yield.nrows + 4 : DIM + 2);
}

struct two_phase *two_phase_new_on(const struct params *params,
                                   struct forest *forest) {
  struct two_phase *sim = MEM_NEW(struct two_phase, 1);
  sim->model.grid = &sim->grid;
  sim->params = params;
  sim->skin = skin_new();
  grid_init(&sim->grid, params, forest);
  add_state(sim);
  add_scratch(sim);
  sides_set(params, sim, set_patch);
  return sim;
}

void two_phase_destroy(struct two_phase *sim) {
  if (!sim) return;
  grid_release(&sim->grid);
  skin_destroy(sim->skin);
  mem_free(sim);
}

void two_phase_densities(const struct two_phase *sim, double density[2]) {
  density[0] = sim->params->grains.density;
  density[1] =
      sim->params->single_phase ? density[0] : sim->params->gas.density;
}

struct followed two_phase_followed(const struct two_phase *sim) {
  return (struct followed){.c = sim->c, .u = sim->u};
}

bool two_phase_adapt(struct two_phase *sim) {
  const struct followed followed = two_phase_followed(sim);
  const bool changed = adapt_grid(&sim->grid, &followed);
  if (changed) sim->planes_hold = false;
  if (changed) slip_strip_renew(&sim->grid, sim->c->v);
  sim->travel = 0;
  return changed;
}
