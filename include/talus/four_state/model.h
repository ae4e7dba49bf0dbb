/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The four-state model as the program sees it (model.h). */
#ifndef TALUS_FOUR_STATE_MODEL_H
#define TALUS_FOUR_STATE_MODEL_H

#include "talus/model.h"

extern const struct model_kind four_state_model;

#endif
