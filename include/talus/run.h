/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Run: a case from the first to the last step, with all files that are left.
 *
 * The output directory holds series.csv, profile.csv, snapshots.xdmf with
 * snapshot-*.h5, checkpoint.h5, parameters.csv and run.log; the headers
 * series.h, profile.h, snapshot.h, checkpoint.h say what is in each.
 */
#ifndef TALUS_RUN_H
#define TALUS_RUN_H

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

struct params;

struct run_options {
  const char *directory; /* of output; made if missing */
  bool restart;          /* go on from directory/checkpoint.h5 */
  int64_t max_steps;     /* of this invocation; < 0: no bound */
  double max_walltime;   /* s of this invocation; <= 0: no bound */
  bool quiet;            /* nothing on the terminal but errors */
  bool timing;           /* say at the end where the time went */
  /* Writes every parameter in use as csv: a header line, then a row
   * `name,value,...` each; called on rank 0 only. May be NULL. */
  void (*write_parameters)(void *context, FILE *f);
  void *context; /* of write_parameters, borrowed */
};

/* Run a checked case, signals caught (signals.h). Collective. Returns an exit
 * status (error.h): EXIT_STOPPED when a signal (signals.h) or a bound of the
 * options ended it early, after a checkpoint. params   borrowed, unchanged
 *   options  borrowed */
int run_case(const struct params *params, const struct run_options *options);

#endif
