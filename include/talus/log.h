/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * The log of a run: a text file written by rank 0, a line at a time.
 *
 * Nothing here reaches the terminal. Until log_open, and on ranks other than 0,
 * log_info does nothing, so that it may be called anywhere.
 */
#ifndef TALUS_LOG_H
#define TALUS_LOG_H

#include <stdbool.h>

/*
 * Open the log on rank 0 and close the one open before. An existing file is
 * continued, as a restarted run goes on in its directory. Collective.
 *   path  file to write; its directory must exist
 * returns  on all ranks whether it could be opened; errno of rank 0 says why
 */
bool log_open(const char *path);

/* Close the log; allowed when none is open. Not collective. */
void log_close(void);

/* Write one line (printf, without the newline) and flush it. */
void log_info(const char *format, ...) __attribute__((format(printf, 1, 2)));

#endif
