/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Stopwatch: wall-clock seconds on this rank, by stage. */
#ifndef TALUS_STOPWATCH_H
#define TALUS_STOPWATCH_H

#include <mpi.h>

enum { STOPWATCH_MOST = 16 };

struct stopwatch {
  double seconds[STOPWATCH_MOST]; /* of each stage so far */
  double mark;                    /* when the stage under way began */
};

static inline void stopwatch_start(struct stopwatch *watch) {
  watch->mark = MPI_Wtime();
}

/* Count the time since the last call for this stage. */
static inline void stopwatch_lap(struct stopwatch *watch, int stage) {
  const double now = MPI_Wtime();
  watch->seconds[stage] += now - watch->mark;
  watch->mark = now;
}

#endif
