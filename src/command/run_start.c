/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/run_start.h"

#include <stddef.h>

#include "talus/error.h"
#include "talus/forest.h"
#include "talus/grid_size.h"
#include "talus/model.h"
#include "talus/params.h"
#include "talus/progress.h"
#include "talus/run_size.h"
#include "talus/run_state.h"

static void tell(void *context, const char *what, double part, int64_t leaves) {
  progress_start(context, what, part, leaves);
}

static struct model *start_new(const struct params *params,
                               struct progress *progress,
                               struct run_size *size) {
  run_size_estimate(params, size);
  run_size_check(size);
  const struct model_start start = {
      .most_leaves = run_size_most_leaves(params, size),
      .tell = tell,
      .context = progress};
  const struct model_kind *kind = models_get(params->model);
  struct model *model = kind->start(params, &start);
  if (model->grid->outgrown > 0) { /* the estimate was too low */
    size->leaves = model->grid->outgrown;
    size->bytes = size->leaves * grid_size_bytes(params);
    run_size_check(size);
  }
  return model;
}

static struct model *start_again(const struct params *params,
                                 const char *checkpoint,
                                 struct run_state *before,
                                 struct run_size *size) {
  struct model *model = run_state_read(checkpoint, params, before);
  size->leaves = (double)forest_nleaves_global(model->grid->forest);
  size->bytes = size->leaves * grid_size_bytes(params);
  model->grid->most_leaves = run_size_most_leaves(params, size);
  return model;
}

struct model *run_start(const struct params *params, const char *checkpoint,
                        struct progress *progress, struct run_state *before,
                        struct run_size *size) {
  size->room = run_size_room();
  return checkpoint ? start_again(params, checkpoint, before, size)
                    : start_new(params, progress, size);
}
