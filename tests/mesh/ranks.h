/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Long runs on more than one rank. */
#ifndef TALUS_TESTS_RANKS_H
#define TALUS_TESTS_RANKS_H

#include "talus/error.h"

/* Return when a run ends, on one rank and on more: ranks wait for each other at
 * every fill, and the first steps say as much of them as the rest does. */
static inline double end_of_run(double one_rank, double more) {
  return base_size() > 1 ? more : one_rank;
}

#endif
