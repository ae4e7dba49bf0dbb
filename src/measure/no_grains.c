/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/no_grains.h"

#include <stdio.h>

#include "talus/error.h"
#include "talus/log.h"
#include "talus/params.h"

void no_grains_warn(const struct params *params, double volume) {
  static const char *const text =
      "grains.shape is positive nowhere: there are no grains";
  if (volume > 0 || base_rank() != 0 || params_bring_grains(params)) return;
  fprintf(stderr, "talus: warning: %s\n", text);
  log_info("warning: %s", text);
}
