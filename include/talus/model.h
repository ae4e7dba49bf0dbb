/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Model: what the program asks of a model of granular flow.
 *
 * A model is a folder of src/ with a struct that begins with a `struct model`,
 * a table of keys and a `struct model_kind`; src/models.c lists all models. The
 * program starts a model, or fills the fields and scalars of one from a
 * checkpoint, advances it, and writes what it measures.
 */
#ifndef TALUS_MODEL_H
#define TALUS_MODEL_H

#include <stdbool.h>
#include <stdint.h>

#include "talus/columns.h"
#include "talus/grid.h"
#include "talus/key.h"
#include "talus/outline.h"
#include "talus/scalars.h"
#include "talus/stopwatch.h"

struct model {
  const struct model_kind *kind;
  struct grid *grid; /* owned by the model */
  double time, dt;   /* s, dt of the last step; 0 before the first */
  int64_t step;
  double wall_seconds;        /* since the first step, set by who measures */
  struct stopwatch stopwatch; /* by stage of the model */
};

/* How a model starts, which takes long on a fine grid. */
struct model_start {
  int64_t most_leaves; /* for which there is memory; 0: no bound */
  /* Called now and then on each rank with what is being done, the part of that
   * which is done, and the leaves so far. NULL: nobody is told. */
  void (*tell)(void *context, const char *what, double part, int64_t leaves);
  void *context;
};

/* The outline of the heap for profile.csv, and of each tracer its part of the
 * height, [n[1]][n[0]] m. Owned arrays. */
struct model_outline {
  struct outline outline;
  double *layer[PARAMS_MAX_TRACERS];
};

/* A step as the run saw it. */
struct step_taken {
  double time;    /* when it began */
  double last_dt; /* of the step before it; 0: none */
  double dt_max;  /* the most it might take */
};

/* All functions are collective; those marked so may be NULL. */
struct model_kind {
  const struct model_keys *keys; /* its name, and what a case may say */

  /* Write in a line what numbers of a case mean, for `talus check` and run.log;
   * "": nothing. NULL: the model has nothing to say. */
  void (*describe)(const struct params *params, size_t size, char *text);
  /* Refuse what the initial state cannot be (a USER_ERROR), for `talus check`;
   * start does so, too. NULL: nothing. */
  void (*check)(const struct params *params);
  /* Make the initial state. Where the grid would outgrow the memory,
   * grid->outgrown is set and the grid stays coarser. */
  struct model *(*start)(const struct params *params,
                         const struct model_start *start);
  /* Make a state of zeros on a forest, which it takes over; a checkpoint then
   * fills fields and scalars. */
  struct model *(*resume)(const struct params *params, struct forest *forest);
  /* Complete the state that a checkpoint has filled. NULL: it is. */
  void (*complete)(struct model *model);
  /* Compare the conditions of the case with those of the checkpoint, and do
   * what a change asks for; run.log is open. NULL: nothing. */
  void (*renew)(struct model *model);
  void (*destroy)(struct model *model);

  /* Take a step of at most dt_max; returns EXIT_DONE, or EXIT_NUMERICAL with
   * the state that was before it. */
  int (*advance)(struct model *model, double dt_max);
  /* Find the shortest dt that makes sense, s, and return whether a step was too
   * short (then say why). NULL: as short_step.h has it. */
  double (*least_dt)(const struct model *model);
  bool (*is_too_short)(const struct model *model, double least_dt,
                       const struct step_taken *taken);
  /* Note after a step whether the grains are slow, and return whether they have
   * come to rest (output.stop_at_rest). NULL: they never do. */
  bool (*is_at_rest)(struct model *model);
  /* Give the time when the grains came to rest; returns false while they move.
   * NULL: the model does not know. */
  bool (*arrest)(const struct model *model, double *time);

  /* Set value [ncolumns] of a row of series.csv, and unless NULL the outline
   * (free it with model_outline_free). The state stays as it is. */
  void (*measure)(struct model *model, double value[],
                  struct model_outline *outline);
  /* Make the fields that snapshots hold and the state does not, or free them
   * again. NULL: there are none. */
  void (*outputs)(struct model *model, bool make);
  /* Measure what a restart compares. NULL: nothing. */
  void (*remember)(struct model *model);
  /* Write to run.log what is to be said at the end. NULL: nothing. */
  void (*say_end)(const struct model *model);

  const struct column *columns; /* of series.csv */
  int ncolumns;
  const struct scalar *scalars; /* in the model's struct, for checkpoints,
                                   besides model_scalars */
  int nscalars;
  const char *const *stages; /* of a step, for --timing */
  int nstages;
};

/* Return model k of the program, in the order of key `model`; NULL past the
 * last. */
const struct model_kind *models_get(int k);

/* The scalars of a struct model: time, dt, step. */
enum { MODEL_NSCALARS = 3 };
extern const struct scalar model_scalars[MODEL_NSCALARS];

void model_outline_free(struct model_outline *outline);

#endif
