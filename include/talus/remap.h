/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Remapping: carry the fields of a simulation from one grid to the next. */
#ifndef TALUS_REMAP_H
#define TALUS_REMAP_H

struct forest_map;
struct two_phase;

/* sim->mesh and the fields are of the old grid, sim->forest already of the
 * new one as `map` says. Moves leaves and data between ranks, makes the new
 * mesh and leaves every field with remap != REMAP_NONE valid on leaves (face
 * fields on all faces). Collective. */
void remap_fields(struct two_phase *sim, const struct forest_map *map);

#endif
