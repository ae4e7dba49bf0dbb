/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/two_fluid/model.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "talus/changed_energy.h"
#include "talus/error.h"
#include "talus/forest.h"
#include "talus/memory.h"
#include "talus/minmax.h"
#include "talus/no_grains.h"
#include "talus/outline.h"
#include "talus/two_fluid/measure.h"
#include "talus/two_fluid/properties.h"
#include "talus/two_fluid/start.h"
#include "talus/two_fluid/state.h"
#include "talus/two_fluid/step.h"
#include "talus/two_fluid_drag.h"

/* A run may make this part of weight times height of its grains. */
static const double MOST_MADE = 0.02;

static struct two_fluid *of(struct model *model) {
  return (struct two_fluid *)model;
}

static struct model *model_of(struct two_fluid *sim) {
  sim->model.kind = &two_fluid_model;
  return &sim->model;
}

/* Name the regime by the bounds that figure 4 of [busch_johansen_2020] has. */
static const char *regime(double St, double r) {
  static const double ST = 10, R = 4;
  if (r > R && St > ST) return "free fall";
  return St > ST * fmin(r / R, 1) ? "inertial" : "viscous";
}

static void describe(const struct params *params, size_t size, char *text) {
  struct two_fluid_closure c;
  two_fluid_closures(params, &c);
  const double St = two_fluid_stokes_number(&c, params_gravity(params));
  const double r = two_fluid_density_ratio(&c);
  snprintf(text, size, "St = %.4g, r = %.4g: grains fall in the regime \"%s\"",
           St, r, regime(St, r));
}

static struct model *start(const struct params *params,
                           const struct model_start *start) {
  return model_of(two_fluid_new(params, start));
}

static struct model *resume(const struct params *params,
                            struct forest *forest) {
  return model_of(two_fluid_new_on(params, forest));
}

static void remember(struct model *model) {
  struct two_fluid *sim = of(model);
  sim->energy = two_fluid_energy(sim);
}

/* Book what a restart with another gravity or other grains adds. */
static void renew(struct model *model) {
  struct two_fluid *sim = of(model);
  sim->changed += changed_energy(sim->energy, two_fluid_energy(sim));
}

static void destroy(struct model *model) {
  if (model != NULL) two_fluid_destroy(of(model));
}

static int advance(struct model *model, double dt_max) {
  return two_fluid_step(of(model), dt_max);
}

static bool is_at_rest(struct model *model) {
  struct two_fluid *sim = of(model);
  const struct params *params = sim->params;
  if (!(params->rest_time > 0)) return false;
  const bool slow = two_fluid_carrying_speed(sim) < params->rest_speed;
  sim->slow_time = slow ? sim->slow_time + model->dt : 0;
  return sim->slow_time >= params->rest_time;
}

/* Make the array of a field on demand, or free it. */
static void provide(struct field *field, int32_t n, bool make) {
  mem_free(field->v);
  field->v = make ? MEM_NEW(double, n) : NULL;
}

static void outputs(struct model *model, bool make) {
  struct two_fluid *sim = of(model);
  const int32_t n = sim->grid.mesh->nleaves;
  struct field *state = sim->yield.state; /* NULL unless exact */
  if (state) provide(state, n, make);
  provide(sim->stress, n, make);
  for (int d = 0; d < DIM; d++) {
    provide(sim->mean[d], n, make);
    for (int32_t i = 0; make && i < n; i++)
      sim->mean[d]->v[i] = two_fluid_mean_velocity(sim, i, d);
  }
  if (!make) return;
  two_fluid_properties(sim);
  two_fluid_find_stress(sim, sim->stress->v);
  for (int32_t i = 0; i < n; i++)
    sim->c->v[i] = min2(sim->alpha->v[i] / sim->keys->alpha_start, 1);
  mesh_touch(sim->grid.mesh, sim->c->v);
  if (state) yield_find_state(&sim->yield, sim->c->v, state->v);
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
  FLUID_VOLUME,
  MOMENTUM_X,
  MOMENTUM_Y,
  MOMENTUM_Z,
  KINETIC,
  FLUID_KINETIC,
  POTENTIAL,
  LOST,
  MAX_FLUX,
  MAX_SPEED,
  GRAIN_SPEED,
  SUSPENDED,
  MEAN_ALPHA,
  MAX_ALPHA,
  MAX_SOLID_PRESSURE,
  LEAST_PRESSURE,
  MOST_PRESSURE,
  PASSES,
  NEWTON,
  SOLID_ITERATIONS,
  PRESSURE_ITERATIONS,
  VISCOUS_ITERATIONS,
  FLUID_VISCOUS_ITERATIONS,
  WALL_SECONDS,
  WORK_OF_CHANGES,
  NCOLUMNS
};

/* In axisymmetric coordinates those of the whole turn around the axis. */
#define VOLUME_UNIT "m^2 (3D, axisymmetric: m^3)"
#define ENERGY_UNIT "J/m (3D, axisymmetric: J)"
#define MOMENTUM_UNIT "kg/s (3D, axisymmetric: kg m/s)"

/* clang-format off */
static const struct column COLUMNS[NCOLUMNS] = {
    [STEP] = {"step", COLUMN_INTEGER, "", "number of the step; 0 is the start"},
    [TIME] = {"time", COLUMN_REAL, "s", "at its end"},
    [DT] = {"dt", COLUMN_REAL, "s", "its length"},
    [CELLS] = {"cells", COLUMN_INTEGER, "", "leaves of the tree"},
    [FRONT] = {"front", COLUMN_SHORT, "m",
               "where the contour alpha = alpha_surface ends, its x (3D and "
               "axisymmetric: distance from the lower edge of the box)"},
    [HEIGHT] = {"height", COLUMN_SHORT, "m", "of that contour"},
    [GRAIN_FRONT] = {"grain_front", COLUMN_SHORT, "m",
                     "where the solid volume per area over alpha_start falls "
                     "below half a grain"},
    [GRAIN_HEIGHT] = {"grain_height", COLUMN_SHORT, "m",
                      "largest solid volume per area over alpha_start"},
    [VOLUME] = {"volume", COLUMN_REAL, VOLUME_UNIT, "of the grains alone"},
    [FLUID_VOLUME] = {"fluid_volume", COLUMN_REAL, VOLUME_UNIT, "of the fluid"},
    [MOMENTUM_X] = {"momentum_x", COLUMN_SHORT, MOMENTUM_UNIT,
                    "of both; radial where axisymmetric, and not kept"},
    [MOMENTUM_Y] = {"momentum_y", COLUMN_SHORT, MOMENTUM_UNIT, "likewise"},
    [MOMENTUM_Z] = {"momentum_z", COLUMN_SHORT, "kg m/s", "likewise; 0 in 2D"},
    [KINETIC] = {"kinetic", COLUMN_SHORT, ENERGY_UNIT, "energy of the grains"},
    [FLUID_KINETIC] = {"fluid_kinetic", COLUMN_SHORT, ENERGY_UNIT, "energy of the fluid"},
    [POTENTIAL] = {"potential", COLUMN_SHORT, ENERGY_UNIT,
                   "energy of the grains, less buoyancy"},
    [LOST] = {"lost", COLUMN_SHORT, ENERGY_UNIT,
              "what these three miss of the start and of work_of_changes: "
              "friction, drag, viscosity and the scheme"},
    [MAX_FLUX] = {"max_flux", COLUMN_SHORT, "m/s",
                  "largest volume flux of grains through a face"},
    [MAX_SPEED] = {"max_speed", COLUMN_SHORT, "m/s",
                   "largest mean flux of a leaf over its solid fraction, "
                   "within the contour"},
    [GRAIN_SPEED] = {"grain_speed", COLUMN_SHORT, "m/s",
                     "likewise, root of the mean square over all grains"},
    [SUSPENDED] = {"suspended", COLUMN_SHORT, "", "part of the grains outside the contour"},
    [MEAN_ALPHA] = {"mean_alpha", COLUMN_SHORT, "", "solid fraction within the contour"},
    [MAX_ALPHA] = {"max_alpha", COLUMN_REAL, "", "largest solid fraction"},
    [MAX_SOLID_PRESSURE] = {"max_solid_pressure", COLUMN_SHORT, "Pa", "of the grains"},
    [LEAST_PRESSURE] = {"least_pressure", COLUMN_SHORT, "Pa", "least excess pressure of the fluid"},
    [MOST_PRESSURE] = {"most_pressure", COLUMN_SHORT, "Pa", "largest excess pressure of the fluid"},
    [PASSES] = {"passes", COLUMN_INTEGER, "", "of the two pressures in the step"},
    [NEWTON] = {"newton", COLUMN_INTEGER, "",
                "iterations for pressure and mass of the grains, in all passes"},
    [SOLID_ITERATIONS] = {"solid_iterations", COLUMN_INTEGER, "",
                          "of the linear solver in all of them"},
    [PRESSURE_ITERATIONS] = {"pressure_iterations", COLUMN_INTEGER, "",
                             "of the projection"},
    [VISCOUS_ITERATIONS] = {"viscous_iterations", COLUMN_INTEGER, "",
                            "of the viscous solver for the grains, two passes"},
    [FLUID_VISCOUS_ITERATIONS] = {"fluid_viscous_iterations", COLUMN_INTEGER, "",
                                  "of that for the fluid"},
    [WALL_SECONDS] = {"wall_seconds", COLUMN_SHORT, "s",
                       "on the clock since the first step"},
    [WORK_OF_CHANGES] = {"work_of_changes", COLUMN_SHORT, ENERGY_UNIT,
                         "energy that restarts with another gravity or other "
                         "grains have added"},
};
/* clang-format on */

static void set_measures(const struct two_fluid *sim,
                         const struct two_fluid_measures *m,
                         double value[NCOLUMNS]) {
  value[FRONT] = m->front;
  value[HEIGHT] = m->height;
  value[GRAIN_FRONT] = m->grain_front;
  value[GRAIN_HEIGHT] = m->grain_height;
  value[VOLUME] = m->volume;
  value[FLUID_VOLUME] = m->fluid_volume;
  for (int d = 0; d < 3; d++) value[MOMENTUM_X + d] = m->momentum[d];
  value[KINETIC] = m->kinetic;
  value[FLUID_KINETIC] = m->fluid_kinetic;
  value[POTENTIAL] = m->potential;
  value[LOST] = sim->initial + sim->changed - m->kinetic - m->fluid_kinetic -
                m->potential;
  value[MAX_FLUX] = m->max_flux;
  value[MAX_SPEED] = m->max_speed;
  value[GRAIN_SPEED] = m->grain_speed;
  value[SUSPENDED] = m->suspended;
  value[MEAN_ALPHA] = m->mean_alpha;
  value[MAX_ALPHA] = m->max_alpha;
  value[MAX_SOLID_PRESSURE] = m->max_solid_pressure;
  value[LEAST_PRESSURE] = m->least_pressure;
  value[MOST_PRESSURE] = m->most_pressure;
}

static void set_row(const struct two_fluid *sim,
                    const struct two_fluid_measures *m,
                    double value[NCOLUMNS]) {
  const struct model *model = &sim->model;
  value[STEP] = (double)model->step;
  value[TIME] = model->time;
  value[DT] = model->dt;
  value[CELLS] = (double)forest_nleaves_global(sim->grid.forest);
  set_measures(sim, m, value);
  value[PASSES] = sim->passes;
  value[NEWTON] = sim->pressure.newton;
  value[SOLID_ITERATIONS] = sim->pressure.iterations;
  value[PRESSURE_ITERATIONS] = sim->projection.iterations;
  value[VISCOUS_ITERATIONS] = sim->viscous[TWO_FLUID_S].iterations;
  value[FLUID_VISCOUS_ITERATIONS] = sim->viscous[TWO_FLUID_F].iterations;
  value[WALL_SECONDS] = model->wall_seconds;
  value[WORK_OF_CHANGES] = sim->changed;
}

/* Warn once of a run that makes energy: it is not to be believed. */
static void check_energy(const struct two_fluid *sim,
                         const struct two_fluid_measures *m, double lost) {
  const struct params *params = sim->params;
  const double *param = sim->closure.param;
  const double rho =
      fabs(param[TWO_FLUID_GRAINS_DENSITY] - param[TWO_FLUID_FLUID_DENSITY]);
  const double g = fabs(params->gravity[outline_axis(params->gravity)]);
  const double most = rho * g * m->volume * m->grain_height;
  for (int d = 0; d < DIM; d++) { /* gravity drives such a flow for ever */
    if (params->gravity[d] != 0 &&
        params->boundary[2 * d].type == BOUNDARY_PERIODIC)
      return;
  }
  if (two_fluid_is_driven(sim) || !(-lost > MOST_MADE * most)) return;
  WARN_ONCE(
      "at time %.4g, step %lld, there are %.3g J more than at the start, %.2g "
      "of weight times height of the grains: they have burst, and the run is "
      "not right from here on; it may be for a start that is denser than the "
      "closures hold (grains.start = \"settled\" is in balance)",
      sim->model.time, (long long)sim->model.step, -lost, -lost / most);
}

static void measure(struct model *model, double value[],
                    struct model_outline *outline) {
  struct two_fluid *sim = of(model);
  struct two_fluid_measures m;
  two_fluid_measure(sim, &m);
  if (model->step == 0) {
    sim->initial = two_fluid_energy(sim);
    no_grains_warn(sim->params, m.volume);
  }
  set_row(sim, &m, value);
  check_energy(sim, &m, value[LOST]);
  if (outline) {
    memset(outline, 0, sizeof *outline);
    outline->outline = m.outline;
    two_fluid_measure_layers(sim, outline->layer);
  } else {
    outline_free(&m.outline);
  }
}

/* Scalars of checkpoints */

#define AT(member) offsetof(struct two_fluid, member)
static const struct scalar SCALARS[] = {
    {"travel", SCALAR_REAL, AT(travel), 0, DBL_MAX},
    {"slow_time", SCALAR_REAL, AT(slow_time), 0, DBL_MAX},
    {"largest_viscosity", SCALAR_REAL, AT(eta_max), 0, DBL_MAX},
    {"initial_energy", SCALAR_REAL, AT(initial), -DBL_MAX, DBL_MAX},
    {"changed_energy", SCALAR_REAL, AT(changed), -DBL_MAX, DBL_MAX},
    {"energy", SCALAR_REAL, AT(energy), -DBL_MAX, DBL_MAX}};

static const char *const STAGES[TWO_FLUID_NSTAGES] = {
    [TWO_FLUID_CLOSURES] = "closures",
    [TWO_FLUID_VISCOUS] = "viscous solves",
    [TWO_FLUID_PRESSURE] = "pressure of grains",
    [TWO_FLUID_PROJECTION] = "projection",
    [TWO_FLUID_TRANSPORT] = "transport",
    [TWO_FLUID_ADAPTATION] = "adaptation",
    [TWO_FLUID_OTHER] = "other"};

const struct model_kind two_fluid_model = {
    .keys = &two_fluid_model_keys,
    .describe = describe,
    .check = two_fluid_check_packing,
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
    .nstages = TWO_FLUID_NSTAGES};
