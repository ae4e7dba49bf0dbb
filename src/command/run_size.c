/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/run_size.h"

#include <math.h>
#include <stdio.h>

#include "talus/capacity.h"
#include "talus/error.h"
#include "talus/grid_size.h"
#include "talus/log.h"

double run_size_room(void) { return capacity_per_rank() * base_size(); }

void run_size_estimate(const struct params *params, struct run_size *size) {
  size->leaves = grid_size_leaves(params);
  size->bytes = size->leaves * grid_size_bytes(params);
  size->room = run_size_room();
}

/* Write bytes as "1.2 GB". */
static void text_bytes(double bytes, char text[32]) {
  static const char *const unit[] = {"B", "kB", "MB", "GB", "TB", "PB"};
  int k = 0;
  while (bytes >= 999.5 && k < 5) {
    bytes /= 1000;
    k++;
  }
  snprintf(text, 32, "%.3g %s", bytes, unit[k]);
}

void run_size_text(const struct run_size *size, char text[RUN_SIZE_LENGTH]) {
  char bytes[32], room[32];
  text_bytes(size->bytes, bytes);
  text_bytes(size->room, room);
  if (isfinite(size->room))
    snprintf(text, RUN_SIZE_LENGTH,
             "about %.3g cells at the start, %s of the %s that this job may "
             "use",
             size->leaves, bytes, room);
  else
    snprintf(text, RUN_SIZE_LENGTH, "about %.3g cells at the start, %s",
             size->leaves, bytes);
}

static const char ADVICE[] =
    "lower domain.level, or the level of a criterion of `adapt`, or use more "
    "nodes";

void run_size_check(const struct run_size *size) {
  char text[RUN_SIZE_LENGTH];
  if (size->bytes <= size->room) return;
  run_size_text(size, text);
  USER_ERROR("the case is too large: %s; %s", text, ADVICE);
}

void run_size_warn(const struct run_size *size) {
  char text[RUN_SIZE_LENGTH];
  if (size->bytes <= size->room) return;
  run_size_text(size, text);
  fprintf(stderr, "talus: warning: a run here would be refused: %s; %s\n", text,
          ADVICE);
}

int64_t run_size_most_leaves(const struct params *params,
                             const struct run_size *size) {
  const double most = size->room / grid_size_bytes(params);
  return most < 0x1p62 ? (int64_t)most : 0;
}

void run_size_say_outgrown(const struct run_size *size, double leaves) {
  char line[2 * RUN_SIZE_LENGTH], room[32];
  text_bytes(size->room, room);
  snprintf(line, sizeof line,
           "the run gave up: its grid wants %.3g cells, more than fit into the "
           "%s that this job may use; the state is in the checkpoint, "
           "--restart goes on with more memory, or %s",
           leaves, room, ADVICE);
  if (base_rank() == 0) fprintf(stderr, "talus: error: %s\n", line);
  log_info("error: %s", line);
}
