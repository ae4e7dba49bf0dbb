/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/two_fluid/state.h"
#include "talus/two_fluid_grains.h"

#include "talus/error.h"
#include "talus/forest.h"
#include "talus/memory.h"
#include "talus/minmax.h"
#include "talus/remap.h"
#include "talus/sides.h"
#include "talus/skin.h"

/* Set the conditions of one boundary, on a patch across `axis`. Where fluid
 * passes, grains find a smooth wall. */
static void set_patch(void *context, int patch, int axis,
                      const struct boundary *boundary) {
  static const struct boundary smooth = {.type = BOUNDARY_SLIP};
  struct two_fluid *sim = context;
  const bool outflow = boundary->type == BOUNDARY_OUTFLOW;
  const bool open = outflow || boundary->type == BOUNDARY_INFLOW;
  for (int e = 0; e < DIM; e++) {
    sim->u[TWO_FLUID_F][e]->bc[patch] = sides_velocity(boundary, axis, e);
    sim->u[TWO_FLUID_S][e]->bc[patch] =
        sides_velocity(open ? &smooth : boundary, axis, e);
  }
  if (outflow)
    sim->p->bc[patch] = (struct bc){BC_DIRICHLET, boundary->pressure, 0};
}

static double solid_of(const void *context, int32_t i) {
  const struct two_fluid *sim = context;
  return two_fluid_part(TWO_FLUID_S, sim->alpha->v[i]);
}

static double fluid_of(const void *context, int32_t i) {
  const struct two_fluid *sim = context;
  return two_fluid_part(TWO_FLUID_F, sim->alpha->v[i]);
}

static double merge_solid(const struct remap *remap, const struct field *field,
                          int32_t leaf) {
  return remap_shared(remap, field, leaf, solid_of, field->context);
}

static double merge_fluid(const struct remap *remap, const struct field *field,
                          int32_t leaf) {
  return remap_shared(remap, field, leaf, fluid_of, field->context);
}

static const struct field_rule solid_rule = {remap_value, merge_solid};
static const struct field_rule fluid_rule = {remap_value, merge_fluid};

static struct field *add(struct two_fluid *sim, const char *name,
                         const char *unit, const char *title,
                         const struct field_rule *rule, bool output) {
  struct field *field = fields_add(&sim->grid.fields, sim->grid.mesh, name,
                                   unit, title, FIELD_CELL, rule);
  field->output = output;
  field->restart = rule != NULL;
  field->context = sim;
  return field;
}

static struct field *add_face(struct two_fluid *sim, const char *name) {
  return fields_add(&sim->grid.fields, sim->grid.mesh, name, "", "", FIELD_FACE,
                    NULL);
}

static struct field *add_kept_face(struct two_fluid *sim, const char *name,
                                   const char *title,
                                   const struct field_rule *rule) {
  struct field *field = fields_add(&sim->grid.fields, sim->grid.mesh, name,
                                   "m/s", title, FIELD_FACE, rule);
  field->restart = true;
  return field;
}

static void add_tracers(struct two_fluid *sim) {
  for (int k = 0; k < sim->params->ntracers; k++)
    sim->tracer[k] =
        add(sim, sim->params->tracer[k].name, "1",
            "part of the grains in the passive tracer", &solid_rule, true);
}

static void add_state(struct two_fluid *sim) {
  static const char *const name[TWO_FLUID_NPHASES][3] = {
      {"solid_velocity_x", "solid_velocity_y", "solid_velocity_z"},
      {"fluid_velocity_x", "fluid_velocity_y", "fluid_velocity_z"}};
  static const char *const title[] = {"momentum of the grains over mass",
                                      "velocity of the fluid"};
  static const struct field_rule *const rule[] = {&solid_rule, &fluid_rule};
  sim->alpha = add(sim, "solid_fraction", "1", "solid fraction of grains",
                   &remap_limited, true);
  sim->alpha->low = 0, sim->alpha->high = 1;
  for (int k = 0; k < TWO_FLUID_NPHASES; k++) {
    for (int d = 0; d < DIM; d++) {
      sim->u[k][d] = add(sim, name[k][d], "m/s", title[k], rule[k], true);
      sim->u[k][d]->component = d;
    }
  }
  sim->p = add(sim, "excess_pressure", "Pa",
               "pressure of the fluid less that at rest", &remap_linear, true);
  const bool plastic = sim->closure.set == TWO_FLUID_CRITICAL_STATE;
  sim->phi_p = add(sim, "plastic_packing", "1", "packing that carries no load",
                   &solid_rule, plastic);
  sim->X = add(sim, "shear_stress", "Pa", "shear that makes pressure",
               &solid_rule, false);
  sim->bed = add(sim, "bed_packing", "1", "solid fraction of the bed in a leaf",
                 &solid_rule, false);
  add_tracers(sim);
  sim->flux = add_kept_face(sim, "solid_flux", "volume flux of the grains",
                            &remap_faces);
  sim->j = add_kept_face(sim, "total_flux", "volume flux of grains and fluid",
                         &remap_flux);
}

/* Give back the array of a field that is made for output alone. */
static void make_on_demand(struct field *field) {
  field->on_demand = true;
  mem_free(field->v);
  field->v = NULL;
}

static void add_leaves(struct two_fluid *sim) {
  static const char *const mean[] = {"velocity_x", "velocity_y", "velocity_z"};
  static const char *const upper[] = {"upper_x", "upper_y", "upper_z"};
  static const char *const gain[] = {"gain_x", "gain_y", "gain_z"};
  static const char *const normal[] = {"normal_x", "normal_y", "normal_z"};
  const bool kinetic = sim->closure.set == TWO_FLUID_KTGF;
  sim->alpha_new = add(sim, "next_solid_fraction", "1", "", NULL, false);
  sim->load = add(sim, "load", "Pa", "", NULL, false);
  sim->hardening = add(sim, "hardening", "Pa", "", NULL, false);
  sim->p_s =
      add(sim, "solid_pressure", "Pa", "pressure of the grains", NULL, true);
  sim->weight = add(sim, "weight", "1", "", NULL, false);
  sim->inertia = add(sim, "inertia", "kg/m^3", "", NULL, false);
  sim->Theta =
      add(sim, "temperature", "m^2/s^2", "granular temperature", NULL, kinetic);
  sim->shear =
      add(sim, "shear_rate", "1/s", "shear rate of the grains", NULL, true);
  sim->eta = add(sim, "fluid_viscosity", "Pa s", "", NULL, false);
  sim->drag = add(sim, "drag", "kg/m^3/s", "", NULL, false);
  sim->c = add(sim, "fraction", "1",
               "solid fraction over that of the start, at most 1", NULL, true);
  sim->phi = add(sim, "bed_fraction", "1", "", NULL, false);
  sim->rest = add(sim, "resting", "Pa", "", NULL, false);
  sim->burden = add(sim, "burden", "Pa", "", NULL, false);
  sim->borne = add(sim, "borne", "1", "", NULL, false);
  sim->lack = add(sim, "lack", "Pa", "", NULL, false);
  sim->carried = add(sim, "carried", "1", "", NULL, false);
  sim->plane = add(sim, "plane", "1", "", NULL, false);
  for (int d = 0; d < DIM; d++) {
    sim->normal[d] = add(sim, normal[d], "1", "", NULL, false);
    sim->gain[d] = add(sim, gain[d], "m/s", "", NULL, false);
    sim->upper[d] = add(sim, upper[d], "1", "", NULL, false);
    sim->mean[d] = add(sim, mean[d], "m/s",
                       "flux of the grains over their fraction", NULL, true);
    sim->mean[d]->component = d;
    make_on_demand(sim->mean[d]);
  }
  sim->stress =
      add(sim, "stress", "Pa", "stress of the grains, sqrt(T:T/2)", NULL, true);
  make_on_demand(sim->stress);
}

/* Add the fields of an exact yield. */
static void add_yield(struct two_fluid *sim) {
  struct yield *yield = &sim->yield;
  yield_add(yield, &sim->grid.fields, &sim->grid.mesh, true);
  yield->scratch = &sim->scratch;
  yield->eta = sim->eta_f[TWO_FLUID_S];
  yield->shear = sim->shear_f[TWO_FLUID_S];
  sim->pushed = add(sim, "pushed", "m/s^2", "", NULL, false);
  sim->touches = add(sim, "touches", "1", "", NULL, false);
  sim->skin = skin_new();
  yield->skin = &sim->skin;
  yield->still = add(sim, "still", "1", "", NULL, false);
  yield->state = add(sim, "yield_state", "1", "0: held, 1: at the yield stress",
                     NULL, true);
  make_on_demand(yield->state);
}

static void add_faces(struct two_fluid *sim) {
  for (int k = 0; k < TWO_FLUID_NPHASES; k++) {
    const bool solid = k == TWO_FLUID_S;
    sim->shear_f[k] = add_face(sim, solid ? "solid_shear" : "fluid_shear");
    sim->eta_f[k] = add_face(sim, solid ? "solid_eta" : "fluid_eta");
    sim->kappa_f[k] = add_face(sim, solid ? "solid_kappa" : "fluid_kappa");
    sim->w_f[k] = add_face(sim, solid ? "solid_w" : "fluid_w");
    sim->v_f[k] = add_face(sim, solid ? "solid_v" : "fluid_v");
  }
  sim->drag_f = add_face(sim, "face_drag");
  sim->mobility_f = add_face(sim, "mobility");
  sim->lambda_f = add_face(sim, "mixture_mobility");
  sim->force_f = add_face(sim, "face_force");
  sim->exact = sim->keys->regularisation == TWO_FLUID_EXACT;
  if (sim->exact) add_yield(sim);
  const int more = sim->exact ? STRAIN_ROWS : 0;
  scratch_init(&sim->scratch, &sim->grid.fields, &sim->grid.mesh,
               3 * DIM + 1 + sim->exact, DIM + 2 + more);
}

/* Refuse bounds of what an exact yield does not bound. */
static void check_yield(const struct two_fluid_keys *keys) {
  if (keys->regularisation != TWO_FLUID_EXACT) return;
  if (keys->eta_max > 0)
    USER_ERROR(
        "grains.eta_max = %g has no meaning with regularisation = \"exact\", "
        "which caps nothing: leave it out, or say regularisation = \"clip\"",
        keys->eta_max);
  if (keys->gamma_r > 0)
    USER_ERROR(
        "grains.gamma_r = %g has no meaning with regularisation = \"exact\": "
        "leave it out, or say regularisation = \"clip\"",
        keys->gamma_r);
}

void two_fluid_closures(const struct params *params,
                        struct two_fluid_closure *c) {
  const struct two_fluid_keys *keys = params->own;
  check_yield(keys);
  *c = keys->closure;
  if (keys->fluid != TWO_FLUID_OWN) two_fluid_take_fluid(c, keys->fluid);
  for (int k = TWO_FLUID_FLUID_DENSITY; k <= TWO_FLUID_FLUID_N; k++)
    if (keys->closure.param[k] != 0) c->param[k] = keys->closure.param[k];
  if (c->param[TWO_FLUID_FLUID_ETA_INF] == 0)
    c->param[TWO_FLUID_FLUID_ETA_INF] = c->param[TWO_FLUID_FLUID_ETA_0];
  c->param[TWO_FLUID_GRAINS_DENSITY] = params->grains.density;
  if (!(c->param[TWO_FLUID_FLUID_DENSITY] > 0))
    USER_ERROR(
        "fluid.density is missing: a fluid that has no name, as \"water\" is "
        "one, needs density and eta_0");
  const char *wrong = two_fluid_prepare(c);
  if (wrong != NULL)
    USER_ERROR("closures of grains of %g kg/m^3 in a fluid of %g kg/m^3: %s",
               c->param[TWO_FLUID_GRAINS_DENSITY],
               c->param[TWO_FLUID_FLUID_DENSITY], wrong);
}

struct two_fluid *two_fluid_new_on(const struct params *params,
                                   struct forest *forest) {
  struct two_fluid *sim = MEM_NEW(struct two_fluid, 1);
  sim->model.grid = &sim->grid;
  sim->params = params;
  sim->keys = params->own;
  two_fluid_closures(params, &sim->closure);
  grid_init(&sim->grid, params, forest);
  add_state(sim);
  add_leaves(sim);
  add_faces(sim);
  sides_set(params, sim, set_patch);
  return sim;
}

bool two_fluid_is_driven(const struct two_fluid *sim) {
  bool driven = false;
  for (int b = 0; b < MESH_MAX_PATCHES; b++)
    for (int d = 0; d < DIM; d++)
      driven |= sim->u[TWO_FLUID_F][d]->bc[b].value != 0 ||
                sim->u[TWO_FLUID_S][d]->bc[b].value != 0 ||
                sim->p->bc[b].value != 0;
  return driven;
}

void two_fluid_destroy(struct two_fluid *sim) {
  if (!sim) return;
  grid_release(&sim->grid);
  skin_destroy(sim->skin);
  mem_free(sim);
}

/* Set what the criteria follow: 1 where grains touch, less where they are
 * loose, 0 where there are hardly any. */
static void set_followed(struct two_fluid *sim) {
  const struct mesh *mesh = sim->grid.mesh;
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    const double alpha = sim->alpha->v[i];
    const double full =
        0.9 * two_fluid_loosest(&sim->closure, sim->phi_p->v[i]);
    sim->c->v[i] = alpha < 1e-3 * full ? 0 : min2(alpha / full, 1);
  }
  mesh_touch(mesh, sim->c->v);
}

bool two_fluid_adapt(struct two_fluid *sim) {
  const struct followed followed = {.c = sim->c, .u = sim->u[TWO_FLUID_S]};
  set_followed(sim);
  sim->travel = 0;
  return adapt_grid(&sim->grid, &followed);
}
