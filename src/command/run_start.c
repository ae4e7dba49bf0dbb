/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/run_start.h"
#include "talus/two_phase/start.h"

#include <stddef.h>

#include "talus/error.h"
#include "talus/forest.h"
#include "talus/grid_size.h"
#include "talus/params.h"
#include "talus/progress.h"
#include "talus/run_size.h"
#include "talus/run_state.h"
#include "talus/two_phase/state.h"

static void tell(void *context, const char *what, double part, int64_t leaves) {
  progress_start(context, what, part, leaves);
}

static struct two_phase *start_new(const struct params *params,
                                   struct progress *progress,
                                   struct run_size *size) {
  run_size_estimate(params, size);
  run_size_check(size);
  const struct model_start start = {
      .most_leaves = run_size_most_leaves(params, size),
      .tell = tell,
      .context = progress};
  struct two_phase *sim = two_phase_new_told(params, &start);
  if (sim->grid.outgrown > 0) { /* the estimate was too low */
    size->leaves = sim->grid.outgrown;
    size->bytes = size->leaves * grid_size_bytes(params);
    run_size_check(size);
  }
  return sim;
}

static struct two_phase *start_again(const struct params *params,
                                     const char *checkpoint,
                                     struct run_state *before,
                                     struct run_size *size) {
  struct two_phase *sim = run_state_read(checkpoint, params, before);
  size->leaves = (double)forest_nleaves_global(sim->grid.forest);
  size->bytes = size->leaves * grid_size_bytes(params);
  sim->grid.most_leaves = run_size_most_leaves(params, size);
  /* a run that ended at rest and goes on is to be slow for as long again */
  if (sim->slow_time >= params->rest_time) sim->slow_time = 0;
  return sim;
}

struct two_phase *run_start(const struct params *params, const char *checkpoint,
                            struct progress *progress, struct run_state *before,
                            struct run_size *size) {
  size->room = run_size_room();
  return checkpoint ? start_again(params, checkpoint, before, size)
                    : start_new(params, progress, size);
}
