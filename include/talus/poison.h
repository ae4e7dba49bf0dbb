/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Poison: values that nobody may read, for debug builds.
 *
 * A poisoned number is a signalling NaN: it may be copied, but the traps of
 * debug builds (base_begin) end the program at the first sum, product or
 * comparison with it, and without them all results are NaN. Release builds do
 * nothing.
 */
#ifndef TALUS_POISON_H
#define TALUS_POISON_H

#include <stdbool.h>
#include <stdint.h>
#include <string.h>

#ifdef NDEBUG
#define POISON_ON false
#else
#define POISON_ON true
#endif

/* Poison n values. */
static inline void poison(double *v, int64_t n) {
  const uint64_t bits = UINT64_C(0x7ff4dead00000000);
  for (int64_t i = 0; POISON_ON && i < n; i++) {
    memcpy(&v[i], &bits, sizeof bits);
  }
}

/* Tell whether a value is poison, which a copy still is. */
static inline bool is_poison(const double *v) {
  uint64_t bits;
  memcpy(&bits, v, sizeof bits);
  return bits == UINT64_C(0x7ff4dead00000000);
}

#endif
