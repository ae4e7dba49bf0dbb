/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/sides.h"

#include "talus/openings.h"

void sides_set(const struct params *params, void *context,
               void (*set)(void *context, int patch, int axis,
                           const struct boundary *boundary)) {
  for (int side = 0; side < NFACE; side++) {
    set(context, side, side / 2, &params->boundary[side]);
  }
  for (int b = 6; b < params->nboundaries; b++) {
    for (int axis = 0; axis < DIM; axis++) {
      set(context, openings_patch_number(b, axis), axis, &params->boundary[b]);
    }
  }
}

struct bc sides_velocity(const struct boundary *boundary, int axis, int e) {
  const double value = boundary->velocity[e];
  switch (boundary->type) {
    case BOUNDARY_OUTFLOW:
      return (struct bc){BC_NEUMANN, 0, 0};
    case BOUNDARY_INFLOW:
      return (struct bc){BC_DIRICHLET, value, 0};
    default:
      break;
  }
  if (e == axis) return (struct bc){BC_DIRICHLET, 0, 0};
  switch (boundary->type) {
    case BOUNDARY_SLIP:
      return (struct bc){BC_NEUMANN, 0, 0};
    case BOUNDARY_NAVIER:
      return (struct bc){BC_ROBIN, value, boundary->slip_length};
    default:
      return (struct bc){BC_DIRICHLET, value, 0};
  }
}
