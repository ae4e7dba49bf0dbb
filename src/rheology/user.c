/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A function of the user: struct rheology holds it, rheology_eval calls it. */
#include "models.h"

const struct rheology_model rheology_user = {
    .name = "user",
    .title = "viscosity = function(shear_rate, pressure, time), Pa s",
    .source = "the case file",
};
