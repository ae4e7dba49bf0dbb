/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Words on the size of a case before it is too late: leaves and memory at the
 * start (grid_size.h), and memory that the job may use (capacity.h). */
#ifndef TALUS_RUN_SIZE_H
#define TALUS_RUN_SIZE_H

#include <stdint.h>

struct params;

struct run_size {
  double leaves; /* over all ranks */
  double bytes;  /* that they take, over all ranks */
  double room;   /* that the job may use */
};

enum { RUN_SIZE_LENGTH = 256 };

/* Return the memory that the job may use: that of the poorest rank, times
 * ranks. Collective. */
double run_size_room(void);
/* Estimate the size of a run. Collective. */
void run_size_estimate(const struct params *params, struct run_size *size);
/* Say it: "about 1.12e+05 cells at the start, 101 MB of the 24.6 GB that this
 * job may use". */
void run_size_text(const struct run_size *size, char text[RUN_SIZE_LENGTH]);
/* End the program (USER_ERROR) if the run takes more than there is. Collective.
 */
void run_size_check(const struct run_size *size);
/* Return the number of leaves for which there is room, 0 for no bound. */
int64_t run_size_most_leaves(const struct params *params,
                             const struct run_size *size);
/* Warn on stderr if there is no room. Not collective. */
void run_size_warn(const struct run_size *size);
/* Say on stderr and in the log that the grid wants so many leaves during the
 * run, more than there is memory for. Not collective. */
void run_size_say_outgrown(const struct run_size *size, double leaves);

#endif
