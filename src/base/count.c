/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/count.h"

#include <inttypes.h>

#include "talus/error.h"

int64_t count_check(int64_t n, int64_t most, const char *what) {
  if (n > most)
    FATAL("%" PRId64 " %s on one rank or in one message, at most %" PRId64
          " can be: use more ranks, or a coarser grid",
          n, what, most);
  return n;
}
