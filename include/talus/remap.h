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
/* Divided leaves lie on limited slopes, so that the content is conserved and
 * nothing falls below 0; merged ones take the mean by volume. */
extern const struct field_rule remap_limited;
/* Values on faces: the halves of a side take its value, inner faces lie between
 * the two sides, merged sides take the mean over their areas. */
extern const struct field_rule remap_faces;
/* Velocity on faces, likewise: leaves stay solenoidal, for which the velocity
 * along r times r lies between the sides in r^2. */
extern const struct field_rule remap_flux;

/* Serve as parts of rules: return the value of the old leaf around a new one,
 * that on its slopes, and the mean of the old leaves in a new one. */
double remap_value(const struct remap *remap, const struct field *field,
                   int32_t leaf);
double remap_on_slopes(const struct remap *remap, const struct field *field,
                       int32_t leaf);
double remap_mean(const struct remap *remap, const struct field *field,
                  int32_t leaf);
/* Return the mean by volume, which keeps what the leaves contain; and the value
 * on the slopes through the centre of the volume, whose sum over the parts of a
 * leaf is what it contained. Both differ from the above in rings only. */
double remap_content(const struct remap *remap, const struct field *field,
                     int32_t leaf);
double remap_on_ring_slopes(const struct remap *remap,
                            const struct field *field, int32_t leaf);
/* Return the value on limited slopes through the centre of the volume. */
double remap_on_limited_slopes(const struct remap *remap,
                               const struct field *field, int32_t leaf);
/* Return the mean of what each grain has: by the part of old leaf i that
 * carries the field. Without any, the value of the first. */
double remap_shared(const struct remap *remap, const struct field *field,
                    int32_t leaf,
                    double (*part)(const void *context, int32_t i),
                    const void *context);
/* Return the volume of old leaf `child` over the mean of those in a new one. */
double remap_weight(const struct remap *remap, int32_t leaf, int32_t child);
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
