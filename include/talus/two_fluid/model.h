/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The two-fluid model as the program sees it (model.h). */
#ifndef TALUS_TWO_FLUID_MODEL_H
#define TALUS_TWO_FLUID_MODEL_H

#include "talus/model.h"

extern const struct model_kind two_fluid_model;

#endif
