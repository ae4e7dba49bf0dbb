/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How a run ended, as its run.log tells: each start of a run in the directory
 * leaves a line "talus VERSION, ...", each end one of "end: ...", "error: ..."
 * or "fatal: ...". */
#ifndef TALUS_RUN_END_H
#define TALUS_RUN_END_H

/* Print for people, as one line, how the last run in a directory ended. Not
 * collective. */
void run_end_print(const char *directory);

#endif
