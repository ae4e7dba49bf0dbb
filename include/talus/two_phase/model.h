/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The two-phase model as the program sees it. */
#ifndef TALUS_TWO_PHASE_MODEL_H
#define TALUS_TWO_PHASE_MODEL_H

#include "talus/model.h"

extern const struct model_kind two_phase_model;

#endif
