/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The state of t = 0. By default the pressure of the grains carries their
 * weight, dp/dz = -rho_d nu g: columns of leaves along the vertical axis are
 * put in balance, so that nothing moves before something gives way. */
#ifndef TALUS_FOUR_STATE_START_H
#define TALUS_FOUR_STATE_START_H

struct four_state;
struct model_start;
struct params;

struct four_state *four_state_new(const struct params *params,
                                  const struct model_start *start);

#endif
