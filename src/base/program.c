/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/program.h"

#include <inttypes.h>
#include <mpi.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>

#include "talus/error.h"
#include "talus/lock.h"
#include "talus/log.h"
#include "talus/memory.h"
#include "talus/signals.h"

static void record(const char *line) { log_info("%s", line); }

static void close_files(void) {
  log_close();
  lock_release();
}

static const struct error_hooks HOOKS = {record, signals_remember, close_files};

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

/* Report memory that was not freed: a bug, but not one to spoil a result that
 * is there. */
static void report_leaks(void) {
#ifndef NDEBUG
  if (mem_live_blocks() != 0)
    fprintf(stderr, "talus: rank %d: %" PRId64 " blocks of memory not freed\n",
            base_rank(), mem_live_blocks());
#endif
}

/* Tell Open MPI that nobody will ask for further processes or for networks.
 * Else, without a launcher, it forks a daemon to spawn processes, and waits for
 * networks to answer. All daemons of a user make and remove the same directory,
 * and one in some hundred that start at the same time fails as another removes
 * the directory. Settings of the user stand. */
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
  if (text != NULL && !mpi_runs()) base_set(atoi(text), 1, &HOOKS);
  return base_rank();
}

void base_begin(int *argc, char ***argv) {
  int rank, size;
  expect_no_others();
  mem_begin();
  if (MPI_Init(argc, argv) != MPI_SUCCESS) FATAL("MPI does not start");
  MPI_CHECK(MPI_Comm_set_errhandler(MPI_COMM_WORLD, MPI_ERRORS_RETURN));
  MPI_CHECK(MPI_Comm_rank(MPI_COMM_WORLD, &rank));
  MPI_CHECK(MPI_Comm_size(MPI_COMM_WORLD, &size));
  base_set(rank, size, &HOOKS);
  base_trap_floating_point(true);
}

void base_end(void) {
  if (!mpi_runs()) return;
  report_leaks();
  log_close();
  MPI_Finalize();
  base_set(0, 1, &HOOKS);
}
