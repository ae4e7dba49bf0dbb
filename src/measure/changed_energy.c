/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/changed_energy.h"

#include <math.h>

#include "talus/log.h"

/* Sums that differ by less than this part are the same. */
#define SAME 1e-10

double changed_energy(double checkpoint, double now) {
  if (fabs(now - checkpoint) <= SAME * (fabs(now) + fabs(checkpoint))) return 0;
  log_info("restart with other conditions: energy changes from %.10g to %.10g",
           checkpoint, now);
  return now - checkpoint;
}
