/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/short_step.h"

#include <float.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>

#include "talus/error.h"
#include "talus/log.h"
#include "talus/minmax.h"
#include "talus/model.h"
#include "talus/params.h"

static const double SHORT = 1e-9; /* of the times of the case */
/* A step that is longer by this factor than the last one recovers. */
static const double GROWS = 1.1;

double short_step_floor(const struct params *params) {
  const double g = params_gravity(params);
  double time = params->stop;
  if (g > 0) time = min2(time, sqrt(params->size / g));
  return max2(SHORT * time, 0.5 * DBL_EPSILON * params->stop);
}

bool short_step_is(const struct model *model, const struct params *params,
                   double floor, const struct step_taken *taken) {
  const double most = min2(taken->dt_max, params->dt_max);
  const bool stands = model->time == taken->time;
  const bool bound_by_flow = model->dt < most * (1 - 1e-9);
  const bool grows = taken->last_dt > 0 && model->dt >= GROWS * taken->last_dt;
  char line[512];
  if (!stands && !(model->dt < floor && bound_by_flow && !grows)) return false;
  snprintf(line, sizeof line,
           "the run gave up after step %" PRId64
           ", time %.6g: its dt = %.3g is below %.3g, with which it would "
           "never end. Are the speeds and forces of the case what they should "
           "be?",
           model->step, model->time, model->dt,
           stands ? max2(floor, DBL_EPSILON * model->time) : floor);
  if (base_rank() == 0) fprintf(stderr, "talus: error: %s\n", line);
  log_info("error: %s", line);
  return true;
}
