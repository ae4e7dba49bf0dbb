/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/run_state.h"

#include <float.h>
#include <inttypes.h>
#include <limits.h>
#include <math.h>
#include <mpi.h>
#include <string.h>

#include "talus/adapt.h"
#include "talus/checkpoint.h"
#include "talus/error.h"
#include "talus/forest.h"
#include "talus/model.h"
#include "talus/params.h"

#define AT(member) offsetof(struct run_state, member)

static const struct scalar SCALARS[] = {
    {"wall_seconds", SCALAR_REAL, AT(wall_seconds), 0, DBL_MAX},
    {"snapshots", SCALAR_INTEGER, AT(snapshots), 0, INT_MAX},
    {"series_rows", SCALAR_INTEGER, AT(series.rows), 0, SCALAR_MOST},
    {"series_checksum", SCALAR_INTEGER, AT(series.checksum), 0, UINT32_MAX},
    {"profile_rows", SCALAR_INTEGER, AT(profile.rows), 0, SCALAR_MOST},
    {"profile_checksum", SCALAR_INTEGER, AT(profile.checksum), 0, UINT32_MAX},
    {"criteria", SCALAR_INTEGER, AT(criteria), 0, UINT32_MAX},
    {"rounds", SCALAR_INTEGER, AT(rounds), 0, 1000}};

enum { NLISTS = 3 };

/* List all that is remembered between steps besides the fields. */
static void list_scalars(struct model *model, struct run_state *state,
                         struct scalars list[NLISTS]) {
  const struct model_kind *kind = model->kind;
  list[0] = (struct scalars){MODEL_NSCALARS, model_scalars, model};
  list[1] = (struct scalars){kind->nscalars, kind->scalars, model};
  list[2] = (struct scalars){sizeof SCALARS / sizeof *SCALARS, SCALARS, state};
}

void run_state_write(const char *path, struct model *model,
                     struct run_state *state, const char *parameters) {
  const struct model_kind *kind = model->kind;
  struct scalars list[NLISTS];
  if (kind->remember != NULL) kind->remember(model);
  state->criteria = adapt_criteria(model->grid);
  state->rounds = model->grid->rounds;
  list_scalars(model, state, list);
  checkpoint_write(path, kind->keys->name, model->grid->mesh,
                   &model->grid->fields, NLISTS, list, parameters);
}

/* Check the number of snapshots: each step, and the start, writes one at most.
 */
static void check_snapshots(const char *path, int64_t snapshots, int64_t step) {
  if (snapshots <= step + 1) return;
  USER_ERROR("'%s' is damaged or was edited: snapshots = %" PRId64
             ", after step %" PRId64 " a number from 0 to %" PRId64
             " is needed; take another copy of it, or start afresh without "
             "--restart",
             path, snapshots, step, step + 1);
}

struct model *run_state_read(const char *path, const struct params *params,
                             struct run_state *state) {
  const struct model_kind *kind = models_get(params->model);
  struct forest_layout layout;
  grid_layout(params, &layout);
  struct checkpoint *checkpoint =
      checkpoint_open(MPI_COMM_WORLD, path, kind->keys->name, &layout);
  struct forest *forest = checkpoint_forest(checkpoint, &layout);
  struct model *model = kind->resume(params, forest);
  const struct grid *grid = model->grid;
  checkpoint_read_fields(checkpoint, grid->mesh, &model->grid->fields);
  struct scalars list[NLISTS];
  list_scalars(model, state, list);
  checkpoint_read_scalars(checkpoint, NLISTS, list);
  check_snapshots(path, state->snapshots, model->step);
  checkpoint_close(checkpoint);
  for (int k = 0; k < grid->fields.n; k++) {
    struct field *field = grid->fields.field[k];
    if (field->restart && field->location == FIELD_CELL)
      field_fill(grid->mesh, field);
  }
  if (kind->complete != NULL) kind->complete(model);
  model->grid->rounds = (int)state->rounds;
  if (state->criteria != adapt_criteria(model->grid)) adapt_anew(model->grid);
  return model;
}
