/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/no_grains.h"

#include "talus/error.h"
#include "talus/params.h"

void no_grains_warn(const struct params *params, double volume) {
  if (volume > 0 || params_bring_grains(params)) return;
  WARN("grains.shape is positive nowhere: there are no grains");
}
