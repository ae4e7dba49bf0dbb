/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The beginning of a run: its state, within the memory that there is. */
#ifndef TALUS_RUN_START_H
#define TALUS_RUN_START_H

struct params;
struct progress;
struct run_size;
struct run_state;
struct model;

/* Make the initial state, or read what `checkpoint` holds if that is not NULL,
 * and tell `progress` meanwhile. A state that exceeds the memory of the job is
 * a USER_ERROR, before it is made where the estimate says so. *before is set by
 * a checkpoint, *size by the estimate, or by what the checkpoint holds.
 * Collective; the caller owns the model. */
struct model *run_start(const struct params *params, const char *checkpoint,
                        struct progress *progress, struct run_state *before,
                        struct run_size *size);

#endif
