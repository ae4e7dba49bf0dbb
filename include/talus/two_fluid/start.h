/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The state of t = 0. By default (grains.start = "settled") the pressure of the
 * grains carries their weight less buoyancy, dp_s/dz = -(rho_s - rho_f) alpha
 * g, integrated down each column, so that nothing moves before something gives
 * way. */
#ifndef TALUS_TWO_FLUID_START_H
#define TALUS_TWO_FLUID_START_H

struct model_start;
struct params;
struct two_fluid;

/* Refuse grains whose own weight packs the foot of their heap beyond what can
 * shear, the key phi_m of their closures: it would burst as it gives way,
 * whatever it starts from. A USER_ERROR says so. Suspensions whose contacts
 * would not carry them at any packing pass, if they do not start settled. */
void two_fluid_check_packing(const struct params *params);
struct two_fluid *two_fluid_new(const struct params *params,
                                const struct model_start *start);

#endif
