/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Grains that follow a given flow, dc/dt + div(c u) = 0, u_x = rate y: a small
 * model that `make MODELS=tests/model/given_flow.c` adds to the program. */
#include <math.h>
#include <string.h>

#include "talus/adapt.h"
#include "talus/error.h"
#include "talus/forest.h"
#include "talus/memory.h"
#include "talus/model.h"
#include "talus/remap.h"
#include "talus/shapes.h"
#include "talus/vof.h"

/* clang-format off */
struct flow { double rate; }; /* values of the keys */
static const struct key KEYS[] = {
    {"shear_rate", KEY_NUMBER, KEY_NOT_NEGATIVE, KEY_DEFAULT "1", .unit = "1/s",
     .offset = offsetof(struct flow, rate), .help = "shear rate"}};
static const char *const REFUSED[] = {"tracers", "velocity", "output.stop_at_rest", NULL};
static const struct model_keys keys = {.name = "given_flow",
    .title = "grains in a shear flow", .keys = KEYS, .nkeys = 1,
    .own_size = sizeof(struct flow), .refused = REFUSED};
/* clang-format on */

struct given_flow {
  struct model model;
  struct grid grid;
  struct field *c, *u[DIM], *u_f;
  struct field *normal[DIM], *plane, *flux, *frozen; /* scratch */
  double travel; /* cells the surface may have moved since adaptation */
};
extern const struct model_kind given_flow_model;
static void set_velocity(struct model *model) {
  struct given_flow *sim = (struct given_flow *)model;
  const struct mesh *mesh = sim->grid.mesh;
  const struct flow *flow = sim->grid.params->own;
  for (int32_t i = 0; i < mesh->nleaves; i++)
    sim->u[0]->v[i] = flow->rate * mesh->x[i][1];
  for (int32_t f = 0; f < mesh->face_begin[1]; f++)
    sim->u_f->v[f] = flow->rate * mesh->x[mesh->face_owner[f]][1];
  field_fill_faces(mesh, sim->u_f);
}
static struct field *add(struct given_flow *sim, const char *name,
                         enum field_location at,
                         const struct field_rule *rule) {
  struct field *field =
      fields_add(&sim->grid.fields, sim->grid.mesh, name, "", name, at, rule);
  field->output = field->restart = rule != NULL;
  return field;
}

static struct model *resume(const struct params *params, struct forest *f) {
  static const char *const u[] = {"velocity_x", "velocity_y", "velocity_z"};
  static const char *const n[] = {"normal_x", "normal_y", "normal_z"};
  struct given_flow *sim = MEM_NEW(struct given_flow, 1);
  sim->model = (struct model){.kind = &given_flow_model, .grid = &sim->grid};
  grid_init(&sim->grid, params, f);
  sim->c = add(sim, "fraction", FIELD_CELL, &vof_rule);
  for (int d = 0; d < DIM; d++) {
    sim->u[d] = add(sim, u[d], FIELD_CELL, &remap_average);
    sim->u[d]->component = d;
    sim->normal[d] = add(sim, n[d], FIELD_CELL, NULL);
  }
  sim->plane = add(sim, "plane", FIELD_CELL, NULL);
  sim->frozen = add(sim, "frozen", FIELD_CELL, NULL);
  sim->u_f = add(sim, "face_velocity", FIELD_FACE, NULL);
  sim->flux = add(sim, "flux", FIELD_FACE, NULL);
  return &sim->model;
}
static bool adapt(struct given_flow *sim) {
  const bool changed =
      adapt_grid(&sim->grid, &(struct followed){.c = sim->c, .u = sim->u});
  sim->travel = 0;
  set_velocity(&sim->model);
  return changed;
}

static struct model *start(const struct params *params,
                           const struct model_start *start) {
  const struct function *shape = &params->shape;
  struct forest_layout layout;
  if (!shape->eval) USER_ERROR("grains.shape is missing");
  grid_layout(params, &layout);
  struct forest *f = forest_new(MPI_COMM_WORLD, &layout, params->level_max);
  struct given_flow *sim = (struct given_flow *)resume(params, f);
  sim->grid.most_leaves = start->most_leaves;
  do {
    const struct mesh *mesh = sim->grid.mesh;
    for (int32_t i = 0; i < mesh->nleaves; i++)
      sim->c->v[i] = shape_fraction(shape->eval, shape->context, mesh->x[i],
                                    mesh->h[i], 3);
  } while (adapt(sim));
  return &sim->model;
}
static void destroy(struct model *model) {
  grid_release(model->grid);
  mem_free(model);
}

static int advance(struct model *model, double dt_max) {
  struct given_flow *sim = (struct given_flow *)model;
  const struct mesh *mesh = sim->grid.mesh;
  const double shear = ((struct flow *)sim->grid.params->own)->rate;
  const double rate = shear * ldexp(1, mesh->level_finest); /* u/h */
  double *c = sim->c->v, *normal[DIM];
  model->dt = fmin(dt_max, VOF_CFL / fmax(rate, 1e-300));
  stopwatch_start(&model->stopwatch);
  field_arrays(sim->normal, normal);
  field_fill(mesh, sim->c);
  vof_freeze(mesh, c, sim->frozen->v);
  vof_reconstruct(mesh, c, normal, sim->plane->v);
  vof_flux(mesh, 0, model->dt, sim->u_f->v, sim->grid.open, c, normal,
           sim->plane->v, sim->flux->v);
  vof_update(mesh, 0, model->dt, sim->u_f->v, sim->flux->v, sim->frozen->v, c);
  model->time += model->dt, model->step++, sim->travel += rate * model->dt;
  stopwatch_lap(&model->stopwatch, 0);
  if (adapt_is_due(&sim->grid, model->step, sim->travel)) adapt(sim);
  stopwatch_lap(&model->stopwatch, 1);
  return EXIT_DONE;
}

static void measure(struct model *model, double value[],
                    struct model_outline *outline) {
  struct given_flow *sim = (struct given_flow *)model;
  const struct mesh *mesh = sim->grid.mesh;
  value[0] = (double)model->step, value[1] = model->time, value[2] = 0;
  for (int32_t i = 0; i < mesh->nleaves; i++)
    value[2] += sim->c->v[i] * mesh_volume(mesh, i);
  value[2] = mesh_sum(mesh, value[2]);
  if (!outline) return;
  bool *heap = memset(MEM_NEW(bool, mesh->nleaves), true, mesh->nleaves);
  memset(outline, 0, sizeof *outline);
  outline_measure(mesh, sim->c->v, heap, DIM - 1, &outline->outline);
  mem_free(heap);
}
/* clang-format off */
static const char *const STAGES[] = {"volume fraction", "adaptation"};
static const struct column COLUMNS[] = {
    {"step", COLUMN_INTEGER, "", "number of the step"},
    {"time", COLUMN_REAL, "s", "at its end"},
    {"volume", COLUMN_REAL, "m^2 (3D: m^3)", "of the grains"}};
static const struct scalar SCALARS[] = {
    {"travel", SCALAR_REAL, offsetof(struct given_flow, travel), 0, INFINITY}};
const struct model_kind given_flow_model = {
    .keys = &keys, .start = start, .resume = resume, .complete = set_velocity,
    .destroy = destroy, .advance = advance, .measure = measure,
    .columns = COLUMNS, .ncolumns = 3, .scalars = SCALARS, .nscalars = 1,
    .stages = STAGES, .nstages = 2};
/* clang-format on */
