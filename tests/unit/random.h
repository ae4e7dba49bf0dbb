/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Samples for unit tests: the same on every machine, and asserted once. */
#ifndef TALUS_TESTS_RANDOM_H
#define TALUS_TESTS_RANDOM_H

#include <stdint.h>

/* Draw a number uniform in [0, 1): Knuth's MMIX congruential generator. */
static inline double uniform(uint64_t *state) {
  *state = *state * 6364136223846793005u + 1442695040888963407u;
  return (double)(*state >> 11) / 9007199254740992.;
}

/* Raise `most` to the largest value seen; NaN stays. A ck_assert per sample
 * would be slow. */
static inline void raise_to(double *largest, double value) {
  if (*largest == *largest && !(value <= *largest)) *largest = value;
}

#endif
