/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Axisymmetric coordinates: what they ask of a case. */
#include "case_file.h"

/* Refuse what has a direction across the axis. */
static void check_physics(struct case_file *file) {
  const struct params *params = &file->params;
  if (params->gravity[0] != 0)
    read_fail_at(file, "gravity",
                 "gravity = {%g, %g}: with coordinates = \"axisymmetric\" it "
                 "lies along the axis, so take {0, %g}",
                 params->gravity[0], params->gravity[1], params->gravity[1]);
  if (params->side_walls.mu > 0)
    read_fail_at(file, "grains.side_walls",
                 "grains.side_walls: they stand across the motion of a plane "
                 "channel, and there is none with coordinates = "
                 "\"axisymmetric\": take grains.side_walls away");
}

/* Check the lower side along r: the axis, or a wall around it. */
static void check_axis(struct case_file *file) {
  const struct params *params = &file->params;
  const double origin = params->origin[0];
  if (origin < 0)
    read_fail_at(file, "domain.origin",
                 "domain.origin[1] = %g: with coordinates = \"axisymmetric\" x "
                 "is the distance from the axis; it begins at 0, or at the "
                 "radius of an inner wall",
                 origin);
  for (int side = 0; side < 2; side++)
    if (params->boundary[side].type == BOUNDARY_PERIODIC)
      read_fail_at(file, side ? "boundary.right" : "boundary.left",
                   "boundary.%s = \"periodic\": with coordinates = "
                   "\"axisymmetric\" the two ends of a radius do not meet; "
                   "bottom and top may",
                   side ? "right" : "left");
  const bool mirror = params->boundary[0].type == BOUNDARY_SLIP;
  if (origin == 0 && (!mirror || file->side_function[0] != NULL))
    read_fail_at(file, "boundary.left",
                 "boundary.left is the axis, as domain.origin[1] is 0 with "
                 "coordinates = \"axisymmetric\": it must be \"symmetry\", or "
                 "let domain.origin begin at the radius of an inner wall");
}

void coordinates_check(struct case_file *file) {
  const struct params *params = &file->params;
  if (!params_axisymmetric(params)) return;
  if (params->dimension != 2)
    read_fail_at(file, "coordinates",
                 "coordinates = \"axisymmetric\" is for dimension = 2, the "
                 "plane of r and z: set dimension = 2, or take it away for a "
                 "body without symmetry");
  check_physics(file);
  check_axis(file);
}
