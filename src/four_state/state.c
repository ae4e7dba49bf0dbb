/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/four_state/state.h"

#include "talus/error.h"
#include "talus/forest.h"
#include "talus/memory.h"
#include "talus/minmax.h"
#include "talus/remap.h"
#include "talus/sides.h"

/* Set the conditions of one boundary for velocity, on a patch across `axis`. */
static void set_patch(void *context, int patch, int axis,
                      const struct boundary *boundary) {
  struct four_state *sim = context;
  for (int e = 0; e < DIM; e++) {
    sim->u[e]->bc[patch] = sides_velocity(boundary, axis, e);
  }
}

static double grains_of(const void *context, int32_t i) {
  const struct four_state *sim = context;
  return sim->nu->v[i];
}

/* Take the mean of what each grain has. */
static double merge_by_mass(const struct remap *remap,
                            const struct field *field, int32_t leaf) {
  return remap_shared(remap, field, leaf, grains_of, field->context);
}

static const struct field_rule grain_rule = {remap_value, merge_by_mass};

static struct field *add(struct four_state *sim, const char *name,
                         const char *unit, const char *title,
                         const struct field_rule *rule, bool output) {
  struct field *field = fields_add(&sim->grid.fields, sim->grid.mesh, name,
                                   unit, title, FIELD_CELL, rule);
  field->output = output;
  field->restart = rule != NULL;
  field->context = sim;
  return field;
}

static struct field *add_face(struct four_state *sim, const char *name) {
  return fields_add(&sim->grid.fields, sim->grid.mesh, name, "", "", FIELD_FACE,
                    NULL);
}

static void add_state(struct four_state *sim) {
  static const char *const velocity[] = {"velocity_x", "velocity_y",
                                         "velocity_z"};
  static const char *const trend[] = {"trend_x", "trend_y", "trend_z"};
  sim->nu = add(sim, "solid_fraction", "1", "solid fraction of grains",
                &remap_limited, true);
  sim->nu->low = 0, sim->nu->high = 1;
  for (int d = 0; d < DIM; d++) {
    sim->u[d] = add(sim, velocity[d], "m/s", "velocity", &grain_rule, true);
    sim->trend[d] = add(sim, trend[d], "m/s^2", "change of the velocity",
                        &grain_rule, false);
    sim->u[d]->component = sim->trend[d]->component = d;
  }
  sim->T = add(sim, "temperature", "m^2/s^2", "granular temperature",
               &grain_rule, true);
  sim->T->low = 0, sim->T->high = HUGE_VAL;
}

/* Add a field that is made when it is written. */
static struct field *add_output(struct four_state *sim, const char *name,
                                const char *title) {
  struct field *field = add(sim, name, "1", title, NULL, true);
  field->on_demand = true;
  mem_free(field->v);
  field->v = NULL;
  return field;
}

/* Add the fields of an exact yield. */
static void add_yield(struct four_state *sim) {
  struct yield *yield = &sim->yield;
  yield_add(yield, &sim->grid.fields, &sim->grid.mesh, true);
  yield->scratch = &sim->scratch;
  yield->skin = &sim->skin;
  yield->eta = sim->eta_f;
  yield->shear = sim->shear_f;
  yield->state =
      add_output(sim, "yield_state", "0: held, 1: at the yield stress");
}

static void add_made(struct four_state *sim) {
  static const char *const upper[] = {"upper_x", "upper_y", "upper_z"};
  sim->p = add(sim, "pressure", "Pa", "pressure", NULL, true);
  sim->p_E = add(sim, "contact_pressure", "Pa", "", NULL, false);
  sim->weight = add(sim, "weight", "1", "", NULL, false);
  sim->mu_K = add(sim, "kinetic_viscosity", "Pa s", "", NULL, false);
  sim->lambda_K = add(sim, "bulk_viscosity", "Pa s", "", NULL, false);
  for (int d = 0; d < DIM; d++) {
    sim->upper[d] = add(sim, upper[d], "1", "", NULL, false);
  }
  sim->c = add(sim, "fraction", "1", "solid fraction over that at the start",
               NULL, true);
  sim->contact =
      add_output(sim, "pE_over_p", "part of the pressure by enduring contact");
  sim->name =
      add_output(sim, "state", "0 solid 1 quasi-static 2 dense 3 inertial");
  sim->skin = skin_new();
  sim->still = add(sim, "still", "1", "", NULL, false);
  sim->touches = add(sim, "touches", "1", "", NULL, false);
  sim->known[0] = add(sim, "known_fraction", "1", "", NULL, false);
  sim->known[1] = add(sim, "known_temperature", "m^2/s^2", "", NULL, false);
  sim->mobility_f = add_face(sim, "mobility");
  sim->thrust_f = add_face(sim, "thrust");
  sim->eta_f = add_face(sim, "face_viscosity");
  sim->kappa_f = add_face(sim, "face_bulk_viscosity");
  sim->shear_f = add_face(sim, "face_shear_rate");
  sim->u_f = add_face(sim, "face_velocity");
  sim->flux = add_face(sim, "face_flux");
  sim->exact = sim->keys->regularisation == FOUR_STATE_EXACT;
  if (sim->exact) add_yield(sim);
  scratch_init(&sim->scratch, &sim->grid.fields, &sim->grid.mesh,
               sim->exact ? 3 * DIM + 3 : 2 * DIM + 4,
               DIM + 4 + (sim->exact ? STRAIN_ROWS : 0));
}

static void refuse(const double *param, const char *wrong) {
  USER_ERROR(
      "grains: %s (nu_min = %g, nu_0 = %g, nu_max = %g, a = %g, delta = %g, "
      "e_eff = %g)",
      wrong, param[LEE_HUANG_NU_MIN], param[LEE_HUANG_NU_0],
      param[LEE_HUANG_NU_MAX], param[LEE_HUANG_A], param[LEE_HUANG_DELTA],
      param[LEE_HUANG_E_EFF]);
}

/* Refuse what an exact yield does not read. */
static void check_yield(const struct four_state_keys *keys) {
  const double n = keys->param[LEE_HUANG_N];
  if (keys->regularisation == FOUR_STATE_EXACT && n != FOUR_STATE_N)
    USER_ERROR(
        "grains.n = %g has no meaning with regularisation = \"exact\", "
        "whose friction does not fall at small shear rates: leave it "
        "out, or say regularisation = \"exponential\"",
        n);
}

void four_state_closures(const struct four_state_keys *keys,
                         struct four_state_closure *closure) {
  check_yield(keys);
  const char *wrong =
      four_state_closure_init(closure, keys->param, keys->knudsen);
  if (wrong != NULL) refuse(keys->param, wrong);
}

struct four_state *four_state_new_on(const struct params *params,
                                     struct forest *forest) {
  struct four_state *sim = MEM_NEW(struct four_state, 1);
  sim->model.grid = &sim->grid;
  sim->params = params;
  sim->keys = params->own;
  four_state_closures(sim->keys, &sim->closure);
  grid_init(&sim->grid, params, forest);
  add_state(sim);
  add_made(sim);
  sides_set(params, sim, set_patch);
  return sim;
}

void four_state_destroy(struct four_state *sim) {
  if (!sim) return;
  skin_destroy(sim->skin);
  grid_release(&sim->grid);
  four_state_closure_release(&sim->closure);
  mem_free(sim);
}

/* Set what the criteria follow: 1 where grains touch, less where they are
 * loose, 0 where there are hardly any. */
static void set_followed(struct four_state *sim) {
  const double full = 0.9 * sim->keys->param[LEE_HUANG_NU_MIN];
  const double none = 10 * sim->keys->nu_vacuum;
  const struct mesh *mesh = sim->grid.mesh;
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    const double nu = sim->nu->v[i];
    sim->c->v[i] = nu < none ? 0 : min2(nu / full, 1);
  }
  mesh_touch(mesh, sim->c->v);
}

bool four_state_adapt(struct four_state *sim) {
  const struct followed followed = {.c = sim->c, .u = sim->u};
  set_followed(sim);
  sim->travel = 0;
  return adapt_grid(&sim->grid, &followed);
}
