/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How a run ended, as its run.log tells: each start of a run in the directory
 * leaves a line "talus VERSION, ...", each end one of "end: ...", "error: ..."
 * or "fatal: ...". */
#ifndef TALUS_RUN_END_H
#define TALUS_RUN_END_H

enum run_end {
  RUN_END_UNKNOWN,  /* no run, or one of an older version */
  RUN_END_OPEN,     /* it has begun: it runs, or was killed */
  RUN_END_FINISHED, /* at output.stop, or at rest */
  RUN_END_STOPPED,  /* before, by a signal or a bound on steps or seconds */
  RUN_END_FAILED    /* by an error */
};

enum { RUN_END_LENGTH = 1024 };

/* How the last run ended, and in `text` the line that says so, "" if there is
 * none. Not collective. */
enum run_end run_end_read(const char *directory, char text[RUN_END_LENGTH]);

/* Prints it for people as one line. Not collective. */
void run_end_print(const char *directory);

#endif
