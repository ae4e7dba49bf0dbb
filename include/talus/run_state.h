/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Keeps a run in a checkpoint: the model, and how far the
 * output has come. */
#ifndef TALUS_RUN_STATE_H
#define TALUS_RUN_STATE_H

#include <stdint.h>

#include "talus/csv.h"

struct params;
struct model;

struct run_state {
  double wall_seconds; /* since the first step, over all invocations */
  int64_t snapshots;   /* written so far */
  struct csv_mark series, profile; /* how far the tables have come */
  int64_t criteria, rounds;        /* of adaptation (adapt.h, grid.h) */
};

/* Write the checkpoint (checkpoint.h). Collective. */
void run_state_write(const char *path, struct model *model,
                     struct run_state *state, const char *parameters);
/* Make the model of the case with the state that the checkpoint holds, all
 * fields filled; *state is set. Collective; a file that does not fit the case
 * is a USER_ERROR. The caller owns the model. */
struct model *run_state_read(const char *path, const struct params *params,
                             struct run_state *state);

#endif
