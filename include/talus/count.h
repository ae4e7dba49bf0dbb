/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Counts that must fit the 32 bits of an index, or the int of MPI. */
#ifndef TALUS_COUNT_H
#define TALUS_COUNT_H

#include <stdint.h>

/* Return the count n of `what`, such as "leaves"; FATAL if n exceeds `most`.
 * May be called by one rank alone. */
int64_t count_check(int64_t n, int64_t most, const char *what);

/* Give a count as an index or a count of MPI, checked. */
static inline int32_t count_index(int64_t n, const char *what) {
  return (int32_t)(n <= INT32_MAX ? n : count_check(n, INT32_MAX, what));
}

#endif
