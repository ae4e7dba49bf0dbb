/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Keys of the two-phase model. */
#ifndef TALUS_TWO_PHASE_KEYS_H
#define TALUS_TWO_PHASE_KEYS_H

#include "talus/key.h"

extern const struct model_keys two_phase_keys;

#endif
