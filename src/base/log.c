/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/log.h"

#include <errno.h>
#include <mpi.h>
#include <stdarg.h>
#include <stdio.h>

#include "talus/error.h"

static FILE *log_file; /* owned; NULL but on rank 0 */
static int log_level = LOG_LEVEL_INFO;

bool log_open(const char *path) {
  log_close();
  int opened = 1, error = 0;
  if (base_rank() == 0) {
    log_file = fopen(path, "a");
    opened = log_file != NULL;
    error = errno;
  }
  if (base_size() > 1)
    MPI_CHECK(MPI_Bcast(&opened, 1, MPI_INT, 0, MPI_COMM_WORLD));
  errno = error; /* the broadcast may have changed it */
  return opened;
}

void log_close(void) {
  if (log_file != NULL) fclose(log_file);
  log_file = NULL;
}

void log_level_set(int level) {
  CHECK(level >= LOG_LEVEL_NONE && level <= LOG_LEVEL_DEBUG,
        "log level is %d, allowed are 0 (none), 1 (info) and 2 (debug)", level);
  log_level = level;
}

static void log_line(int level, const char *format, va_list arguments) {
  if (log_file == NULL || level > log_level) return;
  vfprintf(log_file, format, arguments);
  putc('\n', log_file);
  fflush(log_file); /* a run that dies should leave its last words */
}

void log_info(const char *format, ...) {
  va_list arguments;
  va_start(arguments, format);
  log_line(LOG_LEVEL_INFO, format, arguments);
  va_end(arguments);
}

void log_debug(const char *format, ...) {
  va_list arguments;
  va_start(arguments, format);
  log_line(LOG_LEVEL_DEBUG, format, arguments);
  va_end(arguments);
}
