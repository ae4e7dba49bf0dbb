/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/progress.h"

#include <inttypes.h>
#include <math.h>
#include <mpi.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "talus/error.h"
#include "talus/memory.h"

static const double TERMINAL_INTERVAL = 0.1; /* s between lines */
static const double PLAIN_INTERVAL = 5;
static const double MEMORY = 10; /* s over which the speed is averaged */

struct progress {
  double stop;
  bool shown, terminal;
  double wall_line; /* of the line shown last */
  double wall_rate; /* of the latest look at the rates */
  double time_rate; /* time and step then */
  int64_t step_rate;
  double steps_per_second, time_per_second; /* 0: not known yet */
  int width;                                /* of the line on the terminal */
};

/* Is there a launcher? mpirun gives its children a terminal of its own making,
 * wherever their output goes in the end. */
static bool has_launcher(void) {
  return getenv("OMPI_COMM_WORLD_SIZE") != NULL || getenv("PMI_SIZE") != NULL;
}

struct progress *progress_new(double stop, bool quiet) {
  struct progress *p = MEM_NEW(struct progress, 1);
  p->stop = stop;
  p->shown = !quiet && base_rank() == 0;
  p->terminal = p->shown && !has_launcher() && isatty(STDOUT_FILENO);
  p->wall_line = p->wall_rate = MPI_Wtime();
  p->step_rate = -1;
  return p;
}

char *progress_duration(double seconds, char text[32]) {
  if (!(seconds >= 0 && seconds < 1e9)) {
    strcpy(text, "unknown");
  } else if (seconds < 99.5) {
    snprintf(text, 32, "%.0f s", seconds);
  } else if (seconds < 3570) {
    snprintf(text, 32, "%.0f min", seconds / 60);
  } else {
    int64_t minutes = llround(seconds / 60);
    snprintf(text, 32, "%" PRId64 " h %02d min", minutes / 60,
             (int)(minutes % 60));
  }
  return text;
}

/* Update rates: those since the last look are mixed into the running ones with
 * the weight of that interval. */
static void update_rates(struct progress *p, double now, int64_t step,
                         double time) {
  double dw = now - p->wall_rate;
  if (p->step_rate >= 0 && dw > 0) {
    double old = p->steps_per_second > 0 ? exp(-dw / MEMORY) : 0;
    p->steps_per_second = old * p->steps_per_second +
                          (1 - old) * (double)(step - p->step_rate) / dw;
    p->time_per_second =
        old * p->time_per_second + (1 - old) * (time - p->time_rate) / dw;
  }
  p->wall_rate = now;
  p->time_rate = time;
  p->step_rate = step;
}

/* Write the line proper into `line` [size]; under 80 columns, or a terminal
 * would wrap it. "/s" are steps per second. */
static void format_line(const struct progress *p, int64_t step, double time,
                        double dt, int64_t cells, size_t size, char *line) {
  char left[32];
  double done = p->stop > 0 ? 100 * time / p->stop : 100;
  progress_duration(
      p->time_per_second > 0 ? (p->stop - time) / p->time_per_second : -1,
      left);
  snprintf(line, size,
           "t %.4g of %g (%.0f %%) step %" PRId64 " dt %.1e, %" PRId64
           " cells, %.3g/s, left %s",
           time, p->stop, done, step, dt, cells, p->steps_per_second, left);
}

static bool is_due(const struct progress *p, double now) {
  return now - p->wall_line >=
         (p->terminal ? TERMINAL_INTERVAL : PLAIN_INTERVAL);
}

static void show(struct progress *p, const char *line) {
  if (p->terminal) {
    /* Blanks cover what is left of a longer line. */
    printf("\r%-*s", p->width, line);
    p->width = (int)strlen(line);
  } else {
    printf("%s\n", line);
  }
  fflush(stdout);
  p->wall_line = MPI_Wtime();
}

void progress_step(struct progress *p, int64_t step, double time, double dt,
                   int64_t cells) {
  if (!p->shown) return;
  double now = MPI_Wtime();
  bool first = p->step_rate < 0;
  if (first) update_rates(p, now, step, time);
  if (!is_due(p, now)) return;
  if (!first) update_rates(p, now, step, time);
  char line[256];
  format_line(p, step, time, dt, cells, sizeof line, line);
  show(p, line);
}

void progress_start(struct progress *p, const char *what, double part,
                    int64_t cells) {
  if (!p->shown || !is_due(p, MPI_Wtime())) return;
  char line[256];
  snprintf(line, sizeof line, "start: %" PRId64 " cells, %s %.0f %%", cells,
           what, 100 * part);
  show(p, line);
}

void progress_say(struct progress *p, const char *format, ...) {
  if (!p->shown) return;
  if (p->terminal && p->width > 0) printf("\n");
  p->width = 0;
  va_list arguments;
  va_start(arguments, format);
  vprintf(format, arguments);
  va_end(arguments);
  printf("\n");
  fflush(stdout);
}

void progress_destroy(struct progress *p) {
  if (p->terminal && p->width > 0) printf("\n");
  mem_free(p);
}
