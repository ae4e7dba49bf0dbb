/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Remap: carry the fields of a grid to its next leaves, each by its rule
 * (field.h). A model may add rules to those below, made of the same parts.
 */
#ifndef TALUS_REMAP_H
#define TALUS_REMAP_H

#include <stdint.h>

#include "talus/field.h"

struct forest_map;
struct grid;

struct remap {
  const struct mesh *mesh; /* of the old leaves */
  const struct forest_map *map;
};

/* Divided leaves keep the value, merged ones take the mean. */
extern const struct field_rule remap_average;
/* Divided leaves lie on the unlimited slopes of the old one, so that the mean
 * is conserved; merged ones take the mean. */
extern const struct field_rule remap_linear;
/* Velocity on faces: the halves of a side take its value, inner faces lie
 * between the two sides, so that leaves stay solenoidal. */
extern const struct field_rule remap_faces;

/* Serve as parts of rules: return the value of the old leaf around a new one,
 * that on its slopes, and the mean of the old leaves in a new one. */
double remap_value(const struct remap *remap, const struct field *field,
                   int32_t leaf);
double remap_on_slopes(const struct remap *remap, const struct field *field,
                       int32_t leaf);
double remap_mean(const struct remap *remap, const struct field *field,
                  int32_t leaf);
/* Give the corners of a new leaf in the old leaf i around it, whose edge is 1
 * and centre 0; returns i. */
int32_t remap_box(const struct remap *remap, int32_t leaf, double lo[DIM],
                  double hi[DIM]);

/* Carry the fields of a grid. Fields and mesh still have the old leaves, the
 * forest has the new ones, as `map` says. Moves leaves and data between
 * ranks, makes the new mesh and leaves every field with a rule valid on leaves
 * (face fields on all faces). Collective. */
void remap_fields(struct grid *grid, const struct forest_map *map);

#endif
