/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Conditions of the boundaries of a case on the patches of a mesh: what all
 * models do alike. */
#ifndef TALUS_SIDES_H
#define TALUS_SIDES_H

#include "talus/mesh.h"
#include "talus/params.h"

/* Call `set` for each boundary of the case on each of its patches, which lie
 * across an axis. */
void sides_set(const struct params *params, void *context,
               void (*set)(void *context, int patch, int axis,
                           const struct boundary *boundary));
/* Return the condition for component e of a velocity on a boundary across
 * `axis`: walls move along themselves only, and by an outflow du/dn = 0. */
struct bc sides_velocity(const struct boundary *boundary, int axis, int e);

#endif
