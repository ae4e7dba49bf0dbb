/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/two_phase/model.h"

#include <float.h>
#include <limits.h>
#include <math.h>

#include "talus/error.h"
#include "talus/forest.h"
#include "talus/log.h"
#include "talus/memory.h"
#include "talus/no_grains.h"
#include "talus/two_phase/closure_fields.h"
#include "talus/two_phase/conditions.h"
#include "talus/two_phase/creep.h"
#include "talus/two_phase/fractions.h"
#include "talus/two_phase/keys.h"
#include "talus/two_phase/measure.h"
#include "talus/two_phase/percolation.h"
#include "talus/two_phase/rest.h"
#include "talus/two_phase/start.h"
#include "talus/two_phase/state.h"
#include "talus/two_phase/step.h"
#include "talus/two_phase/step_floor.h"

/* Return the state that begins with this model. */
static struct two_phase *of(struct model *model) {
  return (struct two_phase *)model;
}

static const struct two_phase *of_const(const struct model *model) {
  return (const struct two_phase *)model;
}

static struct model *model_of(struct two_phase *sim) {
  sim->model.kind = &two_phase_model;
  return &sim->model;
}

static struct model *start(const struct params *params,
                           const struct model_start *start) {
  return model_of(two_phase_new(params, start));
}

static struct model *resume(const struct params *params,
                            struct forest *forest) {
  return model_of(two_phase_new_on(params, forest));
}

/* Complete a state from a checkpoint. A run that ended at rest and goes on is
 * to be slow for as long again. */
static void complete(struct model *model) {
  struct two_phase *sim = of(model);
  two_phase_refine_openings(sim);
  if (sim->slow_time >= sim->params->rest_time) sim->slow_time = 0;
}

static void renew(struct model *model) { conditions_renew(of(model)); }

static void destroy(struct model *model) {
  if (model != NULL) two_phase_destroy(of(model));
}

static int advance(struct model *model, double dt_max) {
  return step_advance(of(model), dt_max);
}

static double least_dt(const struct model *model) {
  return step_floor(of_const(model));
}

static bool is_too_short(const struct model *model, double least_dt,
                         const struct step_taken *taken) {
  return step_is_too_short(of_const(model), least_dt, taken);
}

static bool is_at_rest(struct model *model) {
  rest_note(of(model));
  return rest_is_reached(of(model));
}

static bool arrest(const struct model *model, double *time) {
  const struct two_phase *sim = of_const(model);
  *time = sim->arrest.moved;
  return sim->arrest.rests;
}

static void outputs(struct model *model, bool make) {
  struct two_phase *sim = of(model);
  struct field *state = sim->yield.state; /* NULL unless exact */
  if (make) {
    closure_fields_update(sim);
    if (state) state->v = MEM_NEW(double, sim->grid.mesh->nleaves);
    if (state) yield_find_state(&sim->yield, sim->c->v, state->v);
  } else {
    closure_fields_release(sim);
    if (state) mem_free(state->v), state->v = NULL;
  }
}

static void remember(struct model *model) {
  struct two_phase *sim = of(model);
  conditions_measure(sim, &sim->conditions);
}

static void say_end(const struct model *model) {
  const struct two_phase *sim = of_const(model);
  if (!(sim->percolation.volume > 0)) return;
  log_info(
      "gas that grains enclosed has left through them: %.6g m^%d so far, "
      "at the pace of a permeability of %.3g m^2",
      sim->percolation.volume, DIM, percolation_permeability(sim));
}

/* Columns of series.csv */

enum {
  STEP,
  TIME,
  DT,
  CELLS,
  FRONT,
  HEIGHT,
  VOLUME,
  KINETIC,
  POTENTIAL,
  DISSIPATED,
  MAX_SPEED,
  PRESSURE_ITERATIONS,
  VISCOUS_ITERATIONS,
  WALL_SECONDS,
  DROPLETS,
  DROPLET_VOLUME,
  NUMERICAL,
  DIVERGENCE_VOLUME,
  PRESSURE_RESIDUAL,
  VISCOUS_RESIDUAL,
  MEAN_SHEAR_RATE,
  REPEAT_CHANGE,
  WORK_OF_CHANGES,
  GIVEN_TO_GAS,
  FLOWING,
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
               "where the heap ends, its x (3D and axisymmetric: radius from "
               "its axis)"},
    [HEIGHT] = {"height", COLUMN_SHORT, "m", "of the heap"},
    [VOLUME] = {"volume", COLUMN_REAL, VOLUME_UNIT, "of all grains"},
    [KINETIC] = {"kinetic", COLUMN_SHORT, ENERGY_UNIT,
                 "energy of the grains"},
    [POTENTIAL] = {"potential", COLUMN_SHORT, ENERGY_UNIT,
                   "energy of the grains"},
    [DISSIPATED] = {"dissipated", COLUMN_SHORT, ENERGY_UNIT,
                    "by viscosity since the start"},
    [MAX_SPEED] = {"max_speed", COLUMN_SHORT, "m/s", "of the grains"},
    [PRESSURE_ITERATIONS] = {"pressure_iterations", COLUMN_INTEGER, "",
                             "of the pressure solver in this step"},
    [VISCOUS_ITERATIONS] = {"viscous_iterations", COLUMN_INTEGER, "",
                            "of the viscous solver in this step"},
    [WALL_SECONDS] = {"wall_seconds", COLUMN_SHORT, "s",
                      "on the clock since the first step"},
    [DROPLETS] = {"droplets", COLUMN_INTEGER, "",
                  "sets of grains apart from the heap"},
    [DROPLET_VOLUME] = {"droplet_volume", COLUMN_SHORT, VOLUME_UNIT,
                        "their volume"},
    [NUMERICAL] = {"numerical", COLUMN_SHORT, ENERGY_UNIT,
                   "initial + work_of_changes - kinetic - potential - "
                   "dissipated - given_to_gas: what the scheme loses, less "
                   "what gravity brings along a periodic side, and what left "
                   "with grains"},
    [DIVERGENCE_VOLUME] = {"divergence_volume", COLUMN_REAL, VOLUME_UNIT,
                           "sum over steps of c div u dt V"},
    [PRESSURE_RESIDUAL] = {"pressure_residual", COLUMN_SHORT, "",
                           "left by the pressure solver, max |div u| dt"},
    [VISCOUS_RESIDUAL] = {"viscous_residual", COLUMN_SHORT, "m/s",
                          "left by the viscous solver, max |dt r/rho|"},
    [MEAN_SHEAR_RATE] = {"mean_shear_rate", COLUMN_SHORT, "1/s",
                         "of the grains: tells when they rest"},
    [REPEAT_CHANGE] = {"repeat_change", COLUMN_SHORT, "m/s",
                       "of the velocity in the last Picard repetition; 0 "
                       "without"},
    [WORK_OF_CHANGES] = {"work_of_changes", COLUMN_SHORT, ENERGY_UNIT,
                         "energy that restarts with another gravity or "
                         "density have added"},
    [GIVEN_TO_GAS] = {"given_to_gas", COLUMN_SHORT, ENERGY_UNIT,
                      "by the grains, in a box that as much gas enters as "
                      "leaves: it rises where they fall"},
    [FLOWING] = {"flowing", COLUMN_SHORT, "",
                 "part of the volume of the grains that is at its yield stress "
                 "if that is exact; else 1"},
};
/* clang-format on */

static void set_row(const struct two_phase *sim, const struct diagnostics *d,
                    double flowing, double value[NCOLUMNS]) {
  const struct model *model = &sim->model;
  const struct energy *energy = &sim->energy;
  const double given = d->gas - energy->gas + energy->gas_dissipated;
  value[STEP] = (double)model->step;
  value[TIME] = model->time;
  value[DT] = model->dt;
  value[CELLS] = (double)forest_nleaves_global(sim->grid.forest);
  value[FRONT] = d->front;
  value[HEIGHT] = d->height;
  value[VOLUME] = d->volume;
  value[KINETIC] = d->kinetic;
  value[POTENTIAL] = d->potential;
  value[DISSIPATED] = energy->dissipated;
  value[MAX_SPEED] = d->max_speed;
  value[PRESSURE_ITERATIONS] = sim->pressure.iterations;
  value[VISCOUS_ITERATIONS] = sim->viscous.iterations;
  value[WALL_SECONDS] = model->wall_seconds;
  value[DROPLETS] = (double)d->droplets.n;
  value[DROPLET_VOLUME] = d->droplets.volume;
  value[NUMERICAL] = energy->initial + energy->changed - d->kinetic -
                     d->potential - energy->dissipated - given;
  value[DIVERGENCE_VOLUME] = sim->divergence_volume;
  value[PRESSURE_RESIDUAL] = sim->pressure.residual_after;
  value[VISCOUS_RESIDUAL] = sim->viscous.residual_after;
  value[MEAN_SHEAR_RATE] = d->shear_rate;
  value[REPEAT_CHANGE] = sim->repeat_change;
  value[WORK_OF_CHANGES] = energy->changed;
  value[GIVEN_TO_GAS] = given;
  value[FLOWING] = flowing;
}

static void keep_energies(struct two_phase *sim, const struct diagnostics *d) {
  sim->energy.kinetic = d->kinetic;
  sim->energy.potential = d->potential;
  if (sim->model.step > 0) return;
  sim->energy.initial = d->kinetic + d->potential;
  sim->energy.gas = d->gas;
  if (!sim->params->single_phase) no_grains_warn(sim->params, d->volume);
  creep_say(sim->params, d->height);
}

/* Hand the outline and the layers over to the caller. */
static void give_outline(struct diagnostics *d, struct model_outline *outline) {
  outline->outline = d->outline;
  d->outline.height = NULL;
  for (int k = 0; k < PARAMS_MAX_TRACERS; k++) {
    outline->layer[k] = d->layer[k];
    d->layer[k] = NULL;
  }
}

static void measure(struct model *model, double value[],
                    struct model_outline *outline) {
  struct two_phase *sim = of(model);
  struct diagnostics d;
  fractions_synchronise(sim);
  diagnostics_measure(sim, &d);
  const double flowing = diagnostics_flowing(sim);
  if (outline) diagnostics_measure_layers(sim, &d);
  fractions_desynchronise(sim);
  keep_energies(sim, &d);
  set_row(sim, &d, flowing, value);
  if (outline) give_outline(&d, outline);
  diagnostics_free(&d);
}

/* Scalars of checkpoints */

#define AT(member) offsetof(struct two_phase, member)
#define REAL(name, member) \
  { name, SCALAR_REAL, AT(member), -DBL_MAX, DBL_MAX }
#define NOT_NEGATIVE(name, member) \
  { name, SCALAR_REAL, AT(member), 0, DBL_MAX }
/* of a solve that may have failed */
#define RESIDUAL(name, member) \
  { name, SCALAR_REAL, AT(member), 0, INFINITY }
#define SOLVE(name, member)                                                   \
  {name "_iterations", SCALAR_INT, AT(member.iterations), 0, INT_MAX},        \
      {name "_status", SCALAR_INT, AT(member.status), 0, SOLVE_INCOMPATIBLE}, \
      RESIDUAL(name "_residual_before", member.residual_before),              \
      RESIDUAL(name "_residual_after", member.residual_after)

static const struct scalar SCALARS[] = {
    NOT_NEGATIVE("travel", travel),
    NOT_NEGATIVE("slow_time", slow_time),
    NOT_NEGATIVE("moved", arrest.moved),
    {"rests", SCALAR_INT, AT(arrest.rests), 0, 1},
    NOT_NEGATIVE("kinetic", energy.kinetic),
    REAL("potential", energy.potential),
    REAL("dissipated", energy.dissipated),
    REAL("initial_energy", energy.initial),
    REAL("changed_energy", energy.changed),
    REAL("gas_energy", energy.gas),
    REAL("gas_dissipated", energy.gas_dissipated),
    REAL("conditions_gas", conditions.gas),
    REAL("conditions_energy", conditions.energy),
    NOT_NEGATIVE("conditions_force", conditions.force),
    NOT_NEGATIVE("conditions_inflow", conditions.inflow),
    REAL("divergence_volume", divergence_volume),
    NOT_NEGATIVE("percolated_volume", percolation.volume),
    NOT_NEGATIVE("percolated_flow", percolation.flow),
    {"pockets", SCALAR_INTEGER, AT(percolation.pockets), 0, SCALAR_MOST},
    RESIDUAL("repeat_change", repeat_change),
    SOLVE("pressure", pressure),
    SOLVE("predictor", predictor),
    SOLVE("viscous", viscous)};

static const char *const STAGES[NSTAGES] = {
    [STAGE_FRACTION] = "volume fraction", [STAGE_DENSITY] = "density, gravity",
    [STAGE_RHEOLOGY] = "rheology",        [STAGE_ADVECTION] = "advection",
    [STAGE_VISCOUS] = "viscous solve",    [STAGE_PROJECTION] = "pressure",
    [STAGE_ADAPTATION] = "adaptation",    [STAGE_OTHER] = "other"};

const struct model_kind two_phase_model = {
    .keys = &two_phase_keys,
    .start = start,
    .resume = resume,
    .complete = complete,
    .renew = renew,
    .destroy = destroy,
    .advance = advance,
    .least_dt = least_dt,
    .is_too_short = is_too_short,
    .is_at_rest = is_at_rest,
    .arrest = arrest,
    .measure = measure,
    .outputs = outputs,
    .remember = remember,
    .say_end = say_end,
    .columns = COLUMNS,
    .ncolumns = NCOLUMNS,
    .scalars = SCALARS,
    .nscalars = sizeof SCALARS / sizeof *SCALARS,
    .stages = STAGES,
    .nstages = NSTAGES};
