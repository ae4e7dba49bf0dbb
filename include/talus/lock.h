/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Lock on a directory: one run at a time writes there.
 *
 * Rank 0 holds a lock of the system (flock) on the file run.lock, which says
 * who holds it. The lock is gone with its process, however that ends; the file
 * is removed by a process that ends in good order, and one that was left means
 * nothing. Where the file system knows no such locks a warning is all there is.
 * A process holds one lock at most.
 */
#ifndef TALUS_LOCK_H
#define TALUS_LOCK_H

/*
 * End the program (SYSTEM_ERROR, which says which process on which host) if
 * another process holds the lock of the directory. Leaves no trace. Collective.
 */
void lock_check(const char *directory);

/*
 * Take the lock of the directory until lock_release or the end of the process;
 * as lock_check if another process holds it, USER_ERROR if the file cannot be
 * made. Does nothing if this process holds it already, or if there is no such
 * directory. Collective.
 */
void lock_take(const char *directory);

/* End the program (FATAL) if the directory given to lock_take was removed,
 * renamed or replaced since: what is written by its name would be lost, or
 * spoil another run. Not collective; rank 0 looks. */
void lock_verify(void);

/* Give the lock back, if there is one. Not collective. */
void lock_release(void);

#endif
