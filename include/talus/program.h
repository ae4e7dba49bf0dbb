/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Start and end of the program. */
#ifndef TALUS_PROGRAM_H
#define TALUS_PROGRAM_H

/*
 * Initialise MPI, with or without a launcher, make MPI errors return to
 * MPI_CHECK, and in debug builds trap invalid operations, overflow and
 * division by zero. Collective; call once, first thing in main.
 *   argc, argv  in/out: as main got them, MPI may take its own options out;
 *               may be NULL
 */
void base_begin(int *argc, char ***argv);

/*
 * Take the rank from the environment that a launcher (mpirun, srun) sets, for
 * what is said before MPI begins, or without it. Not collective. returns  the
 * rank, 0 without a launcher
 */
int base_take_rank(void);

/*
 * End MPI. Debug builds say on stderr how many blocks of memory.h each rank
 * still holds. Collective; does nothing if MPI is not running.
 */
void base_end(void);

#endif
