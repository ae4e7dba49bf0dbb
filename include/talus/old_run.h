/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Files that an earlier run left in the directory of a new one.
 *
 * The first words of a file prove that talus wrote it: the header of a table,
 * the seal of a checkpoint, the heading of a log. HDF5 files and logs that do
 * not are taken for ours where series.csv is; pictures where `talus plot` has
 * signed them. What is somebody else's is never removed or written over. */
#ifndef TALUS_OLD_RUN_H
#define TALUS_OLD_RUN_H

#include <stdbool.h>

/* End the program (USER_ERROR) if a file that a run writes is there and is not
 * of a run of ours. Changes nothing. Collective. */
void old_run_check(const char *directory);

/* Find the time that the run in the directory came to, on rank 0; returns false
 * if there is none, and on the other ranks. */
bool old_run_time(const char *directory, double *time);

/* Remove what a run of ours left and a new one would not write over at once:
 * snapshots, checkpoint, log, index of snapshots, pictures. Pictures that are
 * not ours stay, and a word on stderr names them. Collective. */
void old_run_remove(const char *directory);

/* Remove the snapshots from number `first` on, as a run that is gone on with
 * writes them again. Collective. */
void old_run_remove_snapshots(const char *directory, int first);

#endif
