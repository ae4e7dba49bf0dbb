/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/log.h"

#include <errno.h>
#include <mpi.h>
#include <stdarg.h>
#include <stdio.h>

#include "talus/error.h"

static FILE *log_file; /* owned; NULL but on rank 0 */

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

void log_info(const char *format, ...) {
  va_list arguments;
  if (log_file == NULL) return;
  va_start(arguments, format);
  vfprintf(log_file, format, arguments);
  va_end(arguments);
  putc('\n', log_file);
  fflush(log_file); /* a run that dies should leave its last words */
}
