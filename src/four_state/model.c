/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/four_state/model.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "talus/changed_energy.h"
#include "talus/error.h"
#include "talus/forest.h"
#include "talus/four_state/measure.h"
#include "talus/four_state/start.h"
#include "talus/four_state/state.h"
#include "talus/four_state/step.h"
#include "talus/memory.h"
#include "talus/minmax.h"
#include "talus/no_grains.h"

static struct four_state *of(struct model *model) {
  return (struct four_state *)model;
}

static struct model *model_of(struct four_state *sim) {
  sim->model.kind = &four_state_model;
  return &sim->model;
}

/* Refuse closures that cannot be, and say how fast a slope creeps that should
 * rest, at 99 % of eta_S: its grains count as solid up to that shear rate. */
static void describe(const struct params *params, size_t size, char *text) {
  const struct four_state_keys *keys = params->own;
  const double gamma = 2 * log(100) / keys->param[LEE_HUANG_N];
  struct four_state_closure closure;
  four_state_closures(keys, &closure);
  four_state_closure_release(&closure);
  text[0] = '\0';
  if (keys->regularisation == FOUR_STATE_EXACT) return;
  snprintf(
      text, size,
      "friction is reached at a shear rate of 2 ln(100)/n = %.3g/s: slopes "
      "that rest creep by up to that times their height",
      gamma);
}

static struct model *start(const struct params *params,
                           const struct model_start *start) {
  return model_of(four_state_new(params, start));
}

static struct model *resume(const struct params *params,
                            struct forest *forest) {
  return model_of(four_state_new_on(params, forest));
}

static void remember(struct model *model) {
  struct four_state *sim = of(model);
  sim->energy = four_state_energy(sim);
}

/* Book what a restart with another gravity or other grains adds. */
static void renew(struct model *model) {
  struct four_state *sim = of(model);
  sim->changed += changed_energy(sim->energy, four_state_energy(sim));
}

static void destroy(struct model *model) {
  if (model != NULL) four_state_destroy(of(model));
}

static int advance(struct model *model, double dt_max) {
  return four_state_step(of(model), dt_max);
}

static bool is_at_rest(struct model *model) {
  struct four_state *sim = of(model);
  const struct params *params = sim->params;
  double fastest = 0;
  if (!(params->rest_time > 0)) return false;
  for (int32_t i = 0; i < sim->grid.mesh->nleaves; i++) {
    double u2 = 0;
    if (sim->nu->v[i] < sim->keys->nu_surface) continue;
    for (int d = 0; d < DIM; d++) u2 += sim->u[d]->v[i] * sim->u[d]->v[i];
    fastest = max2(fastest, u2);
  }
  const bool slow =
      sqrt(mesh_max(sim->grid.mesh, fastest)) < params->rest_speed;
  sim->slow_time = slow ? sim->slow_time + model->dt : 0;
  return sim->slow_time >= params->rest_time;
}

static void outputs(struct model *model, bool make) {
  struct four_state *sim = of(model);
  struct field *yields = sim->yield.state; /* NULL unless exact */
  struct field *made[] = {sim->contact, sim->name, yields};
  for (int k = 0; k < (yields ? 3 : 2); k++) {
    mem_free(made[k]->v);
    made[k]->v = make ? MEM_NEW(double, sim->grid.mesh->nleaves) : NULL;
  }
  if (!make) return;
  four_state_find_states(sim, sim->contact->v, sim->name->v);
  for (int32_t i = 0; i < sim->grid.mesh->nleaves; i++)
    sim->c->v[i] = min2(sim->nu->v[i] / sim->keys->nu_start, 1);
  mesh_touch(sim->grid.mesh, sim->c->v);
  if (yields) yield_find_state(&sim->yield, sim->c->v, yields->v);
}

/* Columns of series.csv */

enum {
  STEP,
  TIME,
  DT,
  CELLS,
  FRONT,
  HEIGHT,
  GRAIN_FRONT,
  GRAIN_HEIGHT,
  VOLUME,
  KINETIC,
  POTENTIAL,
  FLUCTUATING,
  ELASTIC,
  DISSIPATED,
  NUMERICAL,
  MAX_SPEED,
  GRAIN_SPEED,
  SLOW,
  MAX_NU,
  MAX_PRESSURE,
  SOLID,
  QUASI_STATIC,
  DENSE,
  INERTIAL,
  NEWTON,
  PRESSURE_ITERATIONS,
  VISCOUS_ITERATIONS,
  CONDUCTION_ITERATIONS,
  WALL_SECONDS,
  WORK_OF_CHANGES,
  IMPACT,
  NCOLUMNS
};

/* In axisymmetric coordinates those of the whole turn around the axis. */
#define VOLUME_UNIT "m^2 (3D, axisymmetric: m^3)"
#define ENERGY_UNIT "J/m (3D, axisymmetric: J)"

/* clang-format off */
static const struct column COLUMNS[NCOLUMNS] = {
    [STEP] = {"step", COLUMN_INTEGER, "", "number of the step; 0 is the start"},
    [TIME] = {"time", COLUMN_REAL, "s", "at its end"},
    [DT] = {"dt", COLUMN_REAL, "s", "its length"},
    [CELLS] = {"cells", COLUMN_INTEGER, "", "leaves of the tree"},
    [FRONT] = {"front", COLUMN_SHORT, "m",
               "where the contour nu = nu_surface ends, its x (3D and "
               "axisymmetric: distance from the lower edge of the box)"},
    [HEIGHT] = {"height", COLUMN_SHORT, "m", "of that contour"},
    [GRAIN_FRONT] = {"grain_front", COLUMN_SHORT, "m",
                     "where the solid volume per area over nu_start falls "
                     "below half a grain"},
    [GRAIN_HEIGHT] = {"grain_height", COLUMN_SHORT, "m",
                      "largest solid volume per area over nu_start"},
    [VOLUME] = {"volume", COLUMN_REAL, VOLUME_UNIT, "of the grains alone"},
    [KINETIC] = {"kinetic", COLUMN_SHORT, ENERGY_UNIT, "energy of mean motion"},
    [POTENTIAL] = {"potential", COLUMN_SHORT, ENERGY_UNIT, "energy"},
    [FLUCTUATING] = {"fluctuating", COLUMN_SHORT, ENERGY_UNIT,
                     "3/2 rho_d nu T, energy of fluctuations"},
    [ELASTIC] = {"elastic", COLUMN_SHORT, ENERGY_UNIT,
                 "work that the packing has stored"},
    [DISSIPATED] = {"dissipated", COLUMN_SHORT, ENERGY_UNIT,
                    "by friction and collisions since the start"},
    [NUMERICAL] = {"numerical", COLUMN_SHORT, ENERGY_UNIT,
                   "what all these and impact miss of the start and of "
                   "work_of_changes, but for what gravity brings along a "
                   "periodic side: lost by the scheme"},
    [MAX_SPEED] = {"max_speed", COLUMN_SHORT, "m/s", "within the contour"},
    [GRAIN_SPEED] = {"grain_speed", COLUMN_SHORT, "m/s",
                     "root of the mean square over all grains"},
    [SLOW] = {"slow", COLUMN_SHORT, "", "part of the mass below sqrt(g d)/10"},
    [MAX_NU] = {"max_nu", COLUMN_REAL, "", "largest solid fraction"},
    [MAX_PRESSURE] = {"max_pressure", COLUMN_SHORT, "Pa", "largest pressure"},
    [SOLID] = {"solid", COLUMN_SHORT, "", "part of the area within the contour"},
    [QUASI_STATIC] = {"quasi_static", COLUMN_SHORT, "", "likewise"},
    [DENSE] = {"dense", COLUMN_SHORT, "", "likewise"},
    [INERTIAL] = {"inertial", COLUMN_SHORT, "", "likewise"},
    [NEWTON] = {"newton", COLUMN_INTEGER, "", "iterations for pressure and mass"},
    [PRESSURE_ITERATIONS] = {"pressure_iterations", COLUMN_INTEGER, "",
                             "of the linear solver in all of them"},
    [VISCOUS_ITERATIONS] = {"viscous_iterations", COLUMN_INTEGER, "",
                            "of the viscous solver"},
    [CONDUCTION_ITERATIONS] = {"conduction_iterations", COLUMN_INTEGER, "",
                               "of the solver for T"},
    [WALL_SECONDS] = {"wall_seconds", COLUMN_SHORT, "s",
                      "on the clock since the first step"},
    [WORK_OF_CHANGES] = {"work_of_changes", COLUMN_SHORT, ENERGY_UNIT,
                         "energy that restarts with another gravity or other "
                         "grains have added"},
    [IMPACT] = {"impact", COLUMN_SHORT, ENERGY_UNIT,
                "work against the pressure of grains that their packing has "
                "not stored: lost by grains that land on others; less where p_K "
                "and p_D drive grains apart, which eq. 3 leaves out"},
};
/* clang-format on */

static void set_row(const struct four_state *sim,
                    const struct four_state_measures *m,
                    double value[NCOLUMNS]) {
  const struct model *model = &sim->model;
  value[STEP] = (double)model->step;
  value[TIME] = model->time;
  value[DT] = model->dt;
  value[CELLS] = (double)forest_nleaves_global(sim->grid.forest);
  value[FRONT] = m->front;
  value[HEIGHT] = m->height;
  value[GRAIN_FRONT] = m->grain_front;
  value[GRAIN_HEIGHT] = m->grain_height;
  value[VOLUME] = m->volume;
  value[KINETIC] = m->kinetic;
  value[POTENTIAL] = m->potential;
  value[FLUCTUATING] = m->fluctuating;
  value[ELASTIC] = m->elastic;
  value[DISSIPATED] = sim->dissipated;
  value[NUMERICAL] = sim->initial + sim->changed - m->kinetic - m->potential -
                     m->fluctuating - m->elastic - sim->dissipated -
                     sim->impact;
  value[MAX_SPEED] = m->max_speed;
  value[GRAIN_SPEED] = m->grain_speed;
  value[SLOW] = m->slow;
  value[MAX_NU] = m->max_nu;
  value[MAX_PRESSURE] = m->max_pressure;
  for (int k = 0; k < 4; k++) value[SOLID + k] = m->part[k];
  value[NEWTON] = sim->pressure.newton;
  value[PRESSURE_ITERATIONS] = sim->pressure.iterations;
  value[VISCOUS_ITERATIONS] = sim->viscous.iterations;
  value[CONDUCTION_ITERATIONS] = sim->conduction.iterations;
  value[WALL_SECONDS] = model->wall_seconds;
  value[WORK_OF_CHANGES] = sim->changed;
  value[IMPACT] = sim->impact;
}

static void measure(struct model *model, double value[],
                    struct model_outline *outline) {
  struct four_state *sim = of(model);
  struct four_state_measures m;
  four_state_measure(sim, &m);
  if (model->step == 0) {
    sim->initial = m.kinetic + m.potential + m.fluctuating + m.elastic;
    no_grains_warn(sim->params, m.volume);
  }
  set_row(sim, &m, value);
  if (outline) {
    memset(outline, 0, sizeof *outline);
    outline->outline = m.outline;
  } else {
    outline_free(&m.outline);
  }
}

/* Scalars of checkpoints */

#define AT(member) offsetof(struct four_state, member)
static const struct scalar SCALARS[] = {
    {"travel", SCALAR_REAL, AT(travel), 0, DBL_MAX},
    {"slow_time", SCALAR_REAL, AT(slow_time), 0, DBL_MAX},
    {"initial_energy", SCALAR_REAL, AT(initial), -DBL_MAX, DBL_MAX},
    {"changed_energy", SCALAR_REAL, AT(changed), -DBL_MAX, DBL_MAX},
    {"energy", SCALAR_REAL, AT(energy), -DBL_MAX, DBL_MAX},
    {"dissipated", SCALAR_REAL, AT(dissipated), -DBL_MAX, DBL_MAX},
    {"impact", SCALAR_REAL, AT(impact), -DBL_MAX, DBL_MAX}};

static const char *const STAGES[FOUR_STATE_NSTAGES] = {
    [FOUR_STATE_CLOSURES] = "closures",
    [FOUR_STATE_VISCOUS] = "viscous solve",
    [FOUR_STATE_PRESSURE] = "pressure and mass",
    [FOUR_STATE_TRANSPORT] = "transport",
    [FOUR_STATE_TEMPERATURE] = "temperature",
    [FOUR_STATE_ADAPTATION] = "adaptation",
    [FOUR_STATE_OTHER] = "other"};

const struct model_kind four_state_model = {
    .keys = &four_state_model_keys,
    .describe = describe,
    .start = start,
    .resume = resume,
    .renew = renew,
    .destroy = destroy,
    .advance = advance,
    .is_at_rest = is_at_rest,
    .measure = measure,
    .outputs = outputs,
    .remember = remember,
    .columns = COLUMNS,
    .ncolumns = NCOLUMNS,
    .scalars = SCALARS,
    .nscalars = sizeof SCALARS / sizeof *SCALARS,
    .stages = STAGES,
    .nstages = FOUR_STATE_NSTAGES};
