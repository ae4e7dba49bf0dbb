/* SPDX-License-Identifier: GPL-3.0-or-later */
#define _GNU_SOURCE /* feenableexcept */
#include "talus/error.h"

#include <fenv.h>
#include <inttypes.h>
#include <mpi.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

enum { MESSAGE_LENGTH = 4096 };

static int rank = 0;
static int size = 1;
static struct error_hooks hooks;

void base_set(int new_rank, int new_size, const struct error_hooks *new_hooks) {
  rank = new_rank;
  size = new_size;
  hooks = *new_hooks;
}

/* Write a line (printf) to the log, if there is one. */
__attribute__((format(printf, 1, 2))) static void record(const char *format,
                                                         ...) {
  char line[2 * MESSAGE_LENGTH];
  va_list arguments;
  if (hooks.record == NULL) return;
  va_start(arguments, format);
  vsnprintf(line, sizeof line, format, arguments);
  va_end(arguments);
  hooks.record(line);
}

static void call(void (*hook)(void)) {
  if (hook != NULL) hook();
}

static bool mpi_runs(void) {
  int begun = 0, ended = 0;
  MPI_Initialized(&begun);
  MPI_Finalized(&ended);
  return begun && !ended;
}

bool base_trap_floating_point(bool on) {
#ifdef NDEBUG
  (void)on;
  return false;
#else
  const int born_here = FE_DIVBYZERO | FE_INVALID | FE_OVERFLOW;
  int before = fegetexcept();
  feclearexcept(born_here); /* else what is past would trap now */
  if (on)
    feenableexcept(born_here);
  else
    fedisableexcept(born_here);
  return (before & born_here) != 0;
#endif
}

int base_rank(void) { return rank; }

int base_size(void) { return size; }

/* Print the last words of one rank and end all ranks. */
static _Noreturn void die(const char *file, int line, const char *function,
                          const char *message) {
  /* One call, so that the words of several ranks do not mix. */
  fprintf(stderr, "talus: fatal: %s\n  rank %d, %s:%d, %s\n", message, rank,
          file, line, function);
  record("fatal: %s (rank %d, %s:%d, %s)", message, rank, file, line, function);
  if (mpi_runs()) MPI_Abort(MPI_COMM_WORLD, EXIT_SYSTEM);
  exit(EXIT_SYSTEM);
}

void base_fatal(const char *file, int line, const char *function,
                const char *format, ...) {
  char message[MESSAGE_LENGTH];
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(message, sizeof message, format, arguments);
  va_end(arguments);
  die(file, line, function, message);
}

void base_check_failed(const char *file, int line, const char *function,
                       const char *condition, const char *format, ...) {
  char words[MESSAGE_LENGTH / 2], message[MESSAGE_LENGTH];
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(words, sizeof words, format, arguments);
  va_end(arguments);
  snprintf(message, sizeof message, "%s (%s is false)", words, condition);
  die(file, line, function, message);
}

static void say_error(const char *format, va_list arguments) {
  char message[MESSAGE_LENGTH];
  vsnprintf(message, sizeof message, format, arguments);
  fflush(stdout);
  fprintf(stderr, "talus: error: %s\n", message);
  record("error: %s", message);
}

/* Print the last words of rank 0 and end the program in good order. */
static _Noreturn void end_in_order(int status, const char *format,
                                   va_list arguments) {
  call(hooks.before); /* mpirun ends the others as soon as one has gone */
  if (rank == 0) say_error(format, arguments);
  call(hooks.after); /* before others end, and mpirun ends all */
  if (mpi_runs()) MPI_Finalize();
  exit(status);
}

void base_user_error(const char *format, ...) {
  va_list arguments;
  va_start(arguments, format);
  end_in_order(EXIT_USER, format, arguments);
}

void base_system_error(const char *format, ...) {
  va_list arguments;
  va_start(arguments, format);
  end_in_order(EXIT_SYSTEM, format, arguments);
}

/* Wait until lower ranks, which may have found the same, have had their say. */
static void wait_for_lower_ranks(void) {
  const int64_t wait = rank == 0 ? 0 : 1000 + 20 * (int64_t)rank; /* ms */
  nanosleep(&(struct timespec){.tv_sec = wait / 1000,
                               .tv_nsec = wait % 1000 * 1000000},
            NULL);
}

void base_user_error_alone(const char *format, ...) {
  va_list arguments;
  wait_for_lower_ranks();
  va_start(arguments, format);
  say_error(format, arguments);
  va_end(arguments);
  call(hooks.after);
  if (mpi_runs() && size > 1) MPI_Abort(MPI_COMM_WORLD, EXIT_USER);
  if (mpi_runs()) MPI_Finalize();
  exit(EXIT_USER);
}

void base_tell(const char *format, ...) {
  if (rank != 0) return;
  char message[MESSAGE_LENGTH];
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(message, sizeof message, format, arguments);
  va_end(arguments);
  fprintf(stderr, "talus: warning: %s\n", message);
  record("warning: %s", message);
}

void base_warn(const char *file, int line, const char *function,
               const char *format, ...) {
  if (rank != 0) return;
  char message[MESSAGE_LENGTH];
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(message, sizeof message, format, arguments);
  va_end(arguments);
  fprintf(stderr, "talus: warning: %s\n  rank %d, %s:%d, %s\n", message, rank,
          file, line, function);
  record("warning: %s (rank %d, %s:%d, %s)", message, rank, file, line,
         function);
}

void base_check_mpi(const char *file, int line, const char *function,
                    const char *call, int result) {
  if (result == MPI_SUCCESS) return;
  char words[MPI_MAX_ERROR_STRING];
  int length = 0;
  if (MPI_Error_string(result, words, &length) != MPI_SUCCESS)
    snprintf(words, sizeof words, "MPI error %d", result);
  base_fatal(file, line, function, "%s: %s", call, words);
}
