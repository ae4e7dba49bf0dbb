/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/two_phase/creep.h"

#include <math.h>

#include "talus/error.h"
#include "talus/log.h"
#include "talus/params.h"

/* A slow shear: this times sqrt(g/H). */
static const double SLOW = 1e-6;

static double gravity_of(const struct params *params) {
  return hypot(hypot(params->gravity[0], params->gravity[1]),
               params->dimension == 3 ? params->gravity[2] : 0);
}

double creep_friction(const struct params *params, double height) {
  const double g = gravity_of(params);
  struct rheology open = params->grains.rheology;
  if (!(g > 0 && height > 0)) return 0;
  open.eta_max = 1e30;
  open.eta_min = 0;
  open.regularisation = RHEOLOGY_CLIP;
  const double rate = SLOW * sqrt(g / height);
  const double pressure = params->grains.density * g * height;
  double eta;
  rheology_eval(&open, 0, 1, &rate, &pressure, &eta);
  return eta * rate / pressure;
}

double creep_speed(const struct params *params, double height) {
  const double mu = creep_friction(params, height);
  const double sine = mu / sqrt(1 + mu * mu);
  return params->grains.density * gravity_of(params) * sine * height * height /
         (2 * params->grains.rheology.eta_max);
}

void creep_say(const struct params *params, double height) {
  /* below this what is left of a liquid's stress is no friction */
  enum { NONE = 1000 };
  const double speed = creep_speed(params, height);
  if (creep_friction(params, height) * NONE < 1 || speed < 1e-20) return;
  log_info(
      "the cap eta_max = %.4g lets slopes of height H = %.4g creep at up to "
      "%.3g, %.2g sqrt(g H)",
      params->grains.rheology.eta_max, height, speed,
      speed / sqrt(gravity_of(params) * height));
  if (!(params->rest_time > 0) || params->rest_speed >= speed) return;
  WARN(
      "output.stop_at_rest.speed = %g is below the creep that eta_max = %.4g "
      "allows, %.3g: grains that creep are not at rest; take a larger eta_max "
      "or a larger speed",
      params->rest_speed, params->grains.rheology.eta_max, speed);
}
