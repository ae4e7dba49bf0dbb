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

#include "talus/lock.h"
#include "talus/log.h"
#include "talus/memory.h"
#include "talus/signals.h"

enum { MESSAGE_LENGTH = 4096 };

static int rank = 0;
static int size = 1;

/* Where launchers tell a process its rank. */
static const char *const LAUNCHER_RANK[] = {"OMPI_COMM_WORLD_RANK", "PMIX_RANK",
                                            "PMI_RANK", "SLURM_PROCID"};

/* Give the rank as the launcher names it, NULL without one. */
static const char *launcher_rank(void) {
  const char *text = NULL;
  for (size_t k = 0; k < sizeof LAUNCHER_RANK / sizeof *LAUNCHER_RANK; k++)
    if (text == NULL) text = getenv(LAUNCHER_RANK[k]);
  return text;
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

/* Forgotten memory is a bug, but not one to spoil a result that is there. */
static void report_leaks(void) {
#ifndef NDEBUG
  if (mem_live_blocks() != 0)
    fprintf(stderr, "talus: rank %d: %" PRId64 " blocks of memory not freed\n",
            rank, mem_live_blocks());
#endif
}

/* Started without a launcher, Open MPI forks a daemon to spawn further
 * processes from, and waits for networks to answer, unless told that nobody
 * will ask for either. All such processes of a user make and remove the same
 * directory for themselves, and one in some hundred of those that start at the
 * same time fails as another removes it: none is needed. What the user has set
 * stands. */
static void expect_no_others(void) {
  if (launcher_rank() != NULL) return;
  setenv("OMPI_MCA_ess_singleton_isolated", "1", 0);
  setenv("OMPI_MCA_orte_create_session_dirs", "0", 0);
  setenv("OMPI_MCA_pml", "ob1", 0);
  /* one process may remove the scratch directory that another makes */
  setenv("OMPI_MCA_orte_create_session_dirs", "0", 0);
}

int base_take_rank(void) {
  const char *text = launcher_rank();
  if (text != NULL && !mpi_runs()) rank = atoi(text);
  return rank;
}

void base_begin(int *argc, char ***argv) {
  expect_no_others();
  mem_begin();
  if (MPI_Init(argc, argv) != MPI_SUCCESS) FATAL("MPI does not start");
  MPI_CHECK(MPI_Comm_set_errhandler(MPI_COMM_WORLD, MPI_ERRORS_RETURN));
  MPI_CHECK(MPI_Comm_rank(MPI_COMM_WORLD, &rank));
  MPI_CHECK(MPI_Comm_size(MPI_COMM_WORLD, &size));
  base_trap_floating_point(true);
}

void base_end(void) {
  if (!mpi_runs()) return;
  report_leaks();
  log_close();
  MPI_Finalize();
  rank = 0;
  size = 1;
}

int base_rank(void) { return rank; }

int base_size(void) { return size; }

/* Last words of one rank, and the end of all of them. */
static _Noreturn void die(const char *file, int line, const char *function,
                          const char *message) {
  /* One call, so that the words of several ranks do not mix. */
  fprintf(stderr, "talus: fatal: %s\n  rank %d, %s:%d, %s\n", message, rank,
          file, line, function);
  log_info("fatal: %s (rank %d, %s:%d, %s)", message, rank, file, line,
           function);
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
  log_info("error: %s", message);
}

/* Last words in good order, of rank 0, and the end. */
static _Noreturn void end_in_order(int status, const char *format,
                                   va_list arguments) {
  signals_remember(); /* mpirun ends the others as soon as one has gone */
  if (rank == 0) say_error(format, arguments);
  log_close();
  lock_release(); /* before others end, and mpirun ends all */
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

/* Until lower ranks, which may have found the same, have had their say. */
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
  log_close();
  if (mpi_runs() && size > 1) MPI_Abort(MPI_COMM_WORLD, EXIT_USER);
  if (mpi_runs()) MPI_Finalize();
  exit(EXIT_USER);
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
  log_info("warning: %s (rank %d, %s:%d, %s)", message, rank, file, line,
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
