/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The creep of slopes that should rest.
 *
 * Where friction would need more than eta_max the viscosity is cut, and grains
 * below their yield stress flow as a liquid of that viscosity. A layer of
 * thickness H on a slope at the angle of repose alpha, tan alpha = mu_s, flows
 * down at most at
 *   u = rho g sin(alpha) H^2 / (2 eta_max)
 * on its surface: no heap of height H creeps faster. As long as grains move at
 * such a speed a run is slow, not at rest.
 */
#ifndef TALUS_TWO_PHASE_CREEP_H
#define TALUS_TWO_PHASE_CREEP_H

struct params;

/* Return the friction coefficient of the grains at rest, tau/p of a slow shear
 * under the pressure of `height` m of them; 0 of a liquid. Pure. */
double creep_friction(const struct params *params, double height);
/* Return the speed above, m/s, of grains `height` m high; 0 without friction,
 * cap, gravity or height. Pure. */
double creep_speed(const struct params *params, double height);
/* Log the speed of creep, and warn where params->rest_speed is lower. Not
 * collective. */
void creep_say(const struct params *params, double height);

#endif
