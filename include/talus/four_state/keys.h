/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Keys of the four-state model: every constant of table I of
 * [lee_huang_chiew_2015], and of the vacuum and the start. */
#ifndef TALUS_FOUR_STATE_KEYS_H
#define TALUS_FOUR_STATE_KEYS_H

#include "talus/key.h"
#include "talus/lee_huang.h"

enum four_state_start { FOUR_STATE_BALANCE, FOUR_STATE_UNIFORM };
enum four_state_regularisation {
  FOUR_STATE_EXPONENTIAL,
  FOUR_STATE_EXACT /* yield.h */
};

#define FOUR_STATE_N 1e5 /* grains.n, s, unless said: that of the paper */

struct four_state_keys {
  double param[LEE_HUANG_NKEYS]; /* in the order of lee_huang.h */
  double knudsen;                /* mean free paths count beyond this, in d */
  double T_max;                  /* bound on T, m^2/s^2 */
  double nu_vacuum;              /* below it there are no grains to speak of */
  double nu_surface;             /* the contour that is the surface */
  double nu_start;               /* at t = 0, if uniform */
  enum four_state_start start;
  enum four_state_regularisation regularisation;
};

extern const struct model_keys four_state_model_keys;

#endif
