/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Progress of a run on standard output: on a terminal one line that is written
 * over again, elsewhere, and under mpirun, a plain line every few seconds. Rank
 * 0 speaks. */
#ifndef TALUS_PROGRESS_H
#define TALUS_PROGRESS_H

#include <stdbool.h>
#include <stdint.h>

struct progress;

/* Begin the progress of a run to time `stop`. Not collective. */
struct progress *progress_new(double stop, bool quiet);
/* Tell what is being done before the first step, and what part of it is done;
 * shown as often. */
void progress_start(struct progress *progress, const char *what, double part,
                    int64_t cells);
/* Tell of a finished step; shown a few times a second at most. */
void progress_step(struct progress *progress, int64_t step, double time,
                   double dt, int64_t cells);
/* Print a line of its own, unless quiet; the line of progress stays above. */
void progress_say(struct progress *progress, const char *format, ...)
    __attribute__((format(printf, 2, 3)));
void progress_destroy(struct progress *progress);

/* Write a duration as people say it, "1 h 05 min", into `text` [32]; returns
 * `text`. */
char *progress_duration(double seconds, char text[32]);

#endif
