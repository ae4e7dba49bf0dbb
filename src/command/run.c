/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The order of things within a step: advance, row of series.csv, outline,
 * snapshot, checkpoint, stop. A checkpoint so comes after all rows up to its
 * time, and a restart keeps just those rows. Step and time alone decide what is
 * due, so a run in pieces writes the same files as a run in one piece. */
#include "talus/run.h"

#include <inttypes.h>
#include <math.h>
#include <string.h>
#include <time.h>

#include "talus/error.h"
#include "talus/forest.h"
#include "talus/lock.h"
#include "talus/log.h"
#include "talus/memory.h"
#include "talus/mesh.h"
#include "talus/model.h"
#include "talus/old_run.h"
#include "talus/output.h"
#include "talus/parameter_changes.h"
#include "talus/params.h"
#include "talus/profile.h"
#include "talus/progress.h"
#include "talus/run_size.h"
#include "talus/run_start.h"
#include "talus/run_state.h"
#include "talus/series.h"
#include "talus/short_step.h"
#include "talus/signals.h"
#include "talus/snapshot.h"

enum timed {
  TIME_START,
  TIME_STEP,
  TIME_TABLES,
  TIME_SNAPSHOT,
  TIME_CHECKPOINT,
  NTIMED
};

struct run {
  const struct params *params;
  const struct run_options *options;
  struct model *model;
  struct series *series;
  struct profile *profile;
  struct snapshots *snapshots;
  struct progress *progress;
  char *parameters; /* csv text */
  char *checkpoint_path;
  bool checkpoint_written; /* there is one of this run */
  bool at_rest;            /* the grains are (rest.h) */
  bool tables;            /* of before the restart are there, to be continued */
  double wall_checkpoint; /* when the last one was written */
  struct run_size size;   /* of it at the start */
  double least_dt;        /* s, shorter steps make no sense */
  struct run_state before; /* when this invocation began */
  double wall_begin;       /* then */
  int64_t first_step;      /* the step then */
  double seconds[NTIMED];  /* where the time went */
  double cell_steps;
  int64_t most_cells;
  double memory; /* bytes on this rank before the simulation was made */
};

/* Are two times equal? Nearly is enough, so that no sliver of a step is left.
 */
static bool same_time(const struct run *run, double a, double b) {
  return fabs(a - b) <= 1e-12 * fmax(fabs(run->params->stop), fabs(b));
}

static bool at_end(const struct run *run) {
  double time = run->model->time, stop = run->params->stop;
  return run->at_rest || time >= stop || same_time(run, time, stop);
}

/* Return the next time a step must land on. */
static double next_event(const struct run *run) {
  double time = run->model->time, next = run->params->stop;
  for (int k = 0; k < run->params->nprofile_times; k++) {
    double t = run->params->profile_times[k];
    if (t > time && t < next && !same_time(run, t, time)) next = t;
  }
  return next;
}

/* Return the largest next step: it ends on the event or leaves a whole step
 * before it. */
static double step_bound(const struct run *run, double event) {
  double left = event - run->model->time, dt = run->model->dt;
  return dt > 0 && left > dt * (1 + 1e-9) && left < 2 * dt ? 0.5 * left : left;
}

static bool outline_due(const struct run *run) {
  if (at_end(run)) return true;
  for (int k = 0; k < run->params->nprofile_times; k++)
    if (same_time(run, run->model->time, run->params->profile_times[k]))
      return true;
  return false;
}

/* Is a snapshot due? It is with the first step at or after its time; snapshots
 * do not bind steps. */
static bool snapshot_due(const struct run *run) {
  double every = run->params->snapshot_every, time = run->model->time;
  if (run->model->step == 0 || at_end(run)) return true;
  if (every <= 0) return false;
  return floor(time / every + 1e-9) >
         floor((time - run->model->dt) / every + 1e-9);
}

static double lap(struct run *run, enum timed what, double since) {
  double now = MPI_Wtime();
  run->seconds[what] += now - since;
  return now;
}

static double wall_seconds(const struct run *run) {
  return run->before.wall_seconds + MPI_Wtime() - run->wall_begin;
}

/* Write rows of both tables where they are due. */
static void write_tables(struct run *run) {
  struct model *model = run->model;
  int every = run->params->series_every;
  bool row = at_end(run) || every <= 1 || model->step % every == 0;
  bool outline = outline_due(run);
  if (!row && !outline) return;
  struct model_outline heap;
  double *value = MEM_NEW(double, (size_t)model->kind->ncolumns);
  model->wall_seconds = wall_seconds(run);
  model->kind->measure(model, value, outline ? &heap : NULL);
  if (row) series_write(run->series, value);
  if (outline) {
    profile_write(run->profile, model->time, heap.outline.n, heap.outline.first,
                  heap.outline.spacing, heap.outline.height, heap.layer);
    model_outline_free(&heap);
  }
  mem_free(value);
}

/* Make the fields of a snapshot that are not kept, or free them. */
static void make_outputs(struct model *model, bool make) {
  if (model->kind->outputs != NULL) model->kind->outputs(model, make);
}

static void write_snapshot(struct run *run) {
  if (!snapshot_due(run)) return;
  struct model *model = run->model;
  make_outputs(model, true);
  struct snapshot_heading heading = {.time = model->time,
                                     .step = model->step,
                                     .length_scale = run->params->length_scale,
                                     .parameters = run->parameters};
  snapshots_write(run->snapshots, model->grid->mesh, &model->grid->fields,
                  &heading);
  make_outputs(model, false);
}

/* Write everything but the checkpoint, after a step and before the first one.
 */
static void write_output(struct run *run) {
  double now = MPI_Wtime();
  lock_verify();
  write_tables(run);
  now = lap(run, TIME_TABLES, now);
  write_snapshot(run);
  lap(run, TIME_SNAPSHOT, now);
}

static void write_checkpoint(struct run *run) {
  double begin = MPI_Wtime();
  lock_verify();
  struct run_state state = {.wall_seconds = wall_seconds(run),
                            .snapshots = snapshots_count(run->snapshots),
                            .series = series_sync(run->series),
                            .profile = profile_sync(run->profile)};
  run_state_write(run->checkpoint_path, run->model, &state, run->parameters);
  run->checkpoint_written = true;
  run->wall_checkpoint = lap(run, TIME_CHECKPOINT, begin);
  log_info("step %" PRId64 ", time %.10g: checkpoint", run->model->step,
           run->model->time);
}

/* Begin and end */

/* Say which parameters a restart changes: it may change most, but the grains
 * are those of the first part. */
static void compare_parameters(const struct run *run) {
  if (base_rank() != 0 || !run->options->restart) return;
  char *path = output_path(run->options->directory, "parameters.csv");
  parameter_changes_say(path, run->parameters);
  mem_free(path);
}

static void replace_old_run(const struct run *run) {
  const char *directory = run->options->directory;
  double time = 0;
  if (old_run_time(directory, &time))
    progress_say(run->progress, "%s held a run to time %.6g; it is replaced",
                 directory, time);
  old_run_remove(directory);
}

/* Are all rows there that were written before the checkpoint? One that was
 * copied without them begins new tables. */
static void check_tables(struct run *run) {
  const char *directory = run->options->directory;
  if (!run->options->restart) return;
  run->tables = output_holds_tables(directory);
  if (!run->tables) return;
  const struct model_kind *kind = run->model->kind;
  series_check(directory, kind->ncolumns, kind->columns, &run->before.series,
               run->model->step, run->params->series_every);
  profile_check(directory, run->params, &run->before.profile, run->model->time);
}

static void open_files(struct run *run) {
  const char *directory = run->options->directory;
  const struct run_state *before = &run->before;
  output_make_directory(directory);
  lock_take(directory);
  if (run->options->restart)
    old_run_remove_snapshots(directory, (int)run->before.snapshots);
  else
    replace_old_run(run);
  char *path = output_path(directory, "run.log");
  if (!log_open(path)) USER_ERROR("cannot write '%s'", path);
  mem_free(path);
  compare_parameters(run);
  output_write_text(directory, "parameters.csv", run->parameters);
  const struct model_kind *kind = run->model->kind;
  run->series = series_open(directory, kind->ncolumns, kind->columns,
                            run->tables ? &before->series : NULL);
  run->profile = profile_open(directory, run->params,
                              run->tables ? &before->profile : NULL);
  run->snapshots = snapshots_new(directory, (int)run->before.snapshots);
}

static void say_begin(const struct run *run) {
  static const char *const alone =
      "the checkpoint stands alone: series.csv and profile.csv begin here";
  const struct model *model = run->model;
  char date[64] = "", size[RUN_SIZE_LENGTH];
  time_t now = time(NULL);
  strftime(date, sizeof date, "%Y-%m-%d %H:%M:%S", localtime(&now));
  log_info("talus %s, %d-dimensional, %d rank%s, %s", TALUS_VERSION, DIM,
           base_size(), base_size() == 1 ? "" : "s", date);
  log_info("%s: %s", run->params->name, run->params->title);
  for (int k = 0; k < run->params->ncovers; k++)
    log_info("%s", run->params->cover[k]);
  log_info("%s at step %" PRId64 ", time %.10g with %" PRId64 " cells",
           run->options->restart ? "restart" : "start", model->step,
           model->time, forest_nleaves_global(model->grid->forest));
  run_size_text(&run->size, size);
  log_info("size: %s", size);
  progress_say(run->progress, "%s: %" PRId64 " cells on %d rank%s, to time %g",
               run->params->name, forest_nleaves_global(model->grid->forest),
               base_size(), base_size() == 1 ? "" : "s", run->params->stop);
  if (!run->options->restart || run->tables) return;
  log_info("%s", alone);
  progress_say(run->progress, "%s", alone);
}

/* Refuse a directory that cannot be written to, or that holds what is not to be
 * written over: another run, or somebody's files. */
static void prepare_directory(const struct run_options *options) {
  output_check_directory(options->directory);
  if (options->restart) {
    lock_take(options->directory);
  } else {
    lock_check(options->directory);
    old_run_check(options->directory);
  }
}

static struct run *run_new(const struct params *params,
                           const struct run_options *options) {
  struct run *run = MEM_NEW(struct run, 1);
  double begin = MPI_Wtime();
  run->params = params;
  run->options = options;
  prepare_directory(options);
  run->checkpoint_path = output_path(options->directory, "checkpoint.h5");
  run->parameters =
      output_parameters(options->write_parameters, options->context);
  run->checkpoint_written = options->restart;
  run->memory = (double)mem_peak_resident();
  run->progress = progress_new(params->stop, options->quiet);
  run->model = run_start(params, options->restart ? run->checkpoint_path : NULL,
                         run->progress, &run->before, &run->size);
  const struct model_kind *kind = run->model->kind;
  run->least_dt = kind->least_dt != NULL ? kind->least_dt(run->model)
                                         : short_step_floor(params);
  check_tables(run);
  signals_remember();
  open_files(run);
  if (options->restart && kind->renew != NULL) kind->renew(run->model);
  if (run->model->grid->rounds > 0)
    log_info("restart with other criteria of adaptation: the grid follows");
  run->first_step = run->model->step;
  run->wall_begin = run->wall_checkpoint = lap(run, TIME_START, begin);
  say_begin(run);
  return run;
}

static void run_destroy(struct run *run) {
  progress_destroy(run->progress);
  snapshots_destroy(run->snapshots);
  profile_close(run->profile);
  series_close(run->series);
  run->model->kind->destroy(run->model);
  mem_free(run->parameters);
  mem_free(run->checkpoint_path);
  log_close();
  lock_release();
  mem_free(run);
}

static void say_time(const struct run *run, const char *indent,
                     const char *what, double seconds, double all) {
  progress_say(run->progress, "  %s%-*s%9.3f s %5.1f %%", indent,
               26 - (int)strlen(indent), what, seconds,
               100 * seconds / fmax(all, 1e-9));
}

/* Say where the time went on rank 0, and the memory of all ranks. Collective.
 */
static void say_timing(const struct run *run) {
  static const char *const title[] = {
      "start", "steps", "tables (series, profile)", "snapshots", "checkpoints"};
  const struct model_kind *kind = run->model->kind;
  double all = 0;
  for (int k = 0; k < NTIMED; k++) all += run->seconds[k];
  for (int k = 0; k < NTIMED; k++) {
    say_time(run, "", title[k], run->seconds[k], all);
    for (int s = 0; s < kind->nstages && k == TIME_STEP; s++)
      say_time(run, "  ", kind->stages[s], run->model->stopwatch.seconds[s],
               all);
  }
  progress_say(run->progress, "  per cell and step       %11.0f ns",
               1e9 * run->seconds[TIME_STEP] / fmax(run->cell_steps, 1));
  const double memory = mesh_sum(run->model->grid->mesh,
                                 (double)mem_peak_resident() - run->memory);
  progress_say(run->progress, "  memory per cell         %11.0f bytes",
               memory / fmax((double)run->most_cells, 1));
}

/* Write when the grains came to rest, if they did, into text. */
static void write_arrest(const struct model *model, size_t size, char *text) {
  double time;
  if (model->kind->arrest != NULL && model->kind->arrest(model, &time))
    snprintf(text, size, "; the grains came to rest at t = %.6g", time);
}

static void say_end(const struct run *run, const char *why) {
  const struct model *model = run->model;
  double wall = MPI_Wtime() - run->wall_begin;
  int64_t steps = model->step - run->first_step;
  char line[512], arrest[64] = "";
  write_arrest(model, sizeof arrest, arrest);
  snprintf(line, sizeof line,
           "%s%s at step %" PRId64 ", time %.6g: %" PRId64
           " steps in %.2f s (%.1f steps/s)%s",
           at_end(run) ? "" : "stopped by ", why, model->step, model->time,
           steps, wall, (double)steps / fmax(wall, 1e-9), arrest);
  if (model->kind->say_end != NULL) model->kind->say_end(model);
  log_info("end: %s", line);
  progress_say(run->progress, "%s", line);
  if (at_end(run)) {
    progress_say(run->progress, "results are in %s", run->options->directory);
  } else {
    snprintf(line, sizeof line,
             "the state is in %s; the same command with --restart goes on from "
             "there",
             run->checkpoint_path);
    log_info("%s", line);
    progress_say(run->progress, "%s", line);
  }
  if (run->options->timing) say_timing(run);
}

/* Say that the solvers gave up; the state before the step is in the checkpoint.
 */
static void say_failure(const struct run *run) {
  if (base_rank() != 0) return;
  char line[1024];
  snprintf(
      line, sizeof line,
      "the run gave up after step %" PRId64
      ", time %.6g: a solve failed or the fields are no longer finite, "
      "with smaller steps too (run.log says which); the state before "
      "that is in %s, --restart goes on from it: try a larger tolerance, "
      "more solver.max_iterations or, where there is one, a smaller eta_max",
      run->model->step, run->model->time, run->checkpoint_path);
  fprintf(stderr, "talus: error: %s\n", line);
  log_info("error: %s", line);
}

/* The loop */

/* Says what all ranks agree to do after a step. */
struct verdict {
  int signal, out_of_time, checkpoint;
};

static struct verdict agree(const struct run *run) {
  double now = MPI_Wtime(), every = run->params->checkpoint_every;
  double most = run->options->max_walltime;
  int mine[3] = {signals_caught(), most > 0 && now - run->wall_begin >= most,
                 every > 0 && now - run->wall_checkpoint >= every};
  int all[3];
  MPI_CHECK(MPI_Allreduce(mine, all, 3, MPI_INT, MPI_MAX, MPI_COMM_WORLD));
  return (struct verdict){all[0], all[1], all[2]};
}

/* Give the reason to stop now; NULL: the run goes on. */
static const char *reason_to_stop(const struct run *run,
                                  const struct verdict *verdict) {
  int64_t steps = run->model->step - run->first_step;
  if (at_end(run)) return run->at_rest ? "at rest" : "done";
  if (verdict->signal != 0) return signals_name(verdict->signal);
  if (verdict->out_of_time) return "--max-walltime";
  if (run->options->max_steps >= 0 && steps >= run->options->max_steps)
    return "--max-steps";
  return NULL;
}

/* Take one step; if it reaches the next event, up to round-off, the time
 * becomes that of the event. *taken tells how the step began. */
static int advance(struct run *run, struct step_taken *taken) {
  struct model *model = run->model;
  double begin = MPI_Wtime(), event = next_event(run);
  *taken = (struct step_taken){model->time, model->dt, step_bound(run, event)};
  int status = model->kind->advance(model, taken->dt_max);
  if (same_time(run, model->time, event)) model->time = event;
  const int64_t cells = forest_nleaves_global(model->grid->forest);
  run->cell_steps += (double)cells;
  if (cells > run->most_cells) run->most_cells = cells;
  lap(run, TIME_STEP, begin);
  return status;
}

/* Take one step; returns EXIT_DONE if the run can go on, or the status it ends
 * with, the reason having been said. */
static int try_step(struct run *run) {
  struct step_taken taken;
  const int status = advance(run, &taken);
  if (status != EXIT_DONE) {
    say_failure(run);
    return status;
  }
  if (run->model->grid->outgrown > 0) {
    run_size_say_outgrown(&run->size, run->model->grid->outgrown);
    return EXIT_SYSTEM;
  }
  const struct model_kind *kind = run->model->kind;
  const bool short_step =
      kind->is_too_short != NULL
          ? kind->is_too_short(run->model, run->least_dt, &taken)
          : short_step_is(run->model, run->params, run->least_dt, &taken);
  return short_step ? EXIT_NUMERICAL : EXIT_DONE;
}

static int run_loop(struct run *run) {
  const struct model *model = run->model;
  for (;;) {
    struct verdict verdict = agree(run);
    const char *why = reason_to_stop(run, &verdict);
    bool fresh = model->step > run->first_step || !run->checkpoint_written;
    if (fresh && (why != NULL || verdict.checkpoint)) write_checkpoint(run);
    if (why != NULL) {
      say_end(run, why);
      return at_end(run) ? EXIT_DONE : EXIT_STOPPED;
    }
    int status = try_step(run);
    if (status != EXIT_DONE) {
      write_checkpoint(run);
      return status;
    }
    run->at_rest =
        model->kind->is_at_rest != NULL && model->kind->is_at_rest(run->model);
    write_output(run);
    progress_step(run->progress, model->step, model->time, model->dt,
                  forest_nleaves_global(model->grid->forest));
  }
}

int run_case(const struct params *params, const struct run_options *options) {
  struct run *run = run_new(params, options);
  if (!options->restart) write_output(run);
  int status = run_loop(run);
  run_destroy(run);
  return status;
}
