/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Snapshots: the fields at one time, for ParaView and for Python.
 *
 * Leaves are quads or hexahedra with shared vertices in an unstructured grid,
 * in Morton order. A vertex is shared within a rank; on the border of two ranks
 * each has its own. Where leaves of two sizes meet the finer ones have vertices
 * on the side of the coarser one (hanging nodes).
 *
 *   snapshot-000012.h5
 *     /             attributes version, time, step, length_scale
 *     /parameters   a group with one text attribute per parameter
 *     /vertices     double [vertices][DIM], m
 *     /cells        int64 [leaves][4 or 8], vertices in the order of VTK
 *     /level        int8 [leaves]
 *     /<name>       double [leaves], or [leaves][3] for a vector (third
 *                   component 0 in 2D); attributes unit and title. Of a face
 *                   field the mean over the sides of the leaf.
 *   snapshots.xdmf  all of them as one collection in time; replaced as a whole
 *                   after each snapshot, so that it can be read during a run
 */
#ifndef TALUS_SNAPSHOT_H
#define TALUS_SNAPSHOT_H

#include <stdint.h>

struct fields;
struct mesh;
struct snapshots;

/* Begin or go on with the snapshots of a run in `directory`; `count` of them
 * are there already (a restart; else 0). Collective. */
struct snapshots *snapshots_new(const char *directory, int count);
void snapshots_destroy(struct snapshots *snapshots);

/* Number of the next one. */
int snapshots_count(const struct snapshots *snapshots);

/* Heads a snapshot. */
struct snapshot_heading {
  double time;
  int64_t step;
  double length_scale;    /* params.h */
  const char *parameters; /* csv text, output.h */
};

/* Write every field with `output` set. Collective. */
void snapshots_write(struct snapshots *snapshots, const struct mesh *mesh,
                     const struct fields *fields,
                     const struct snapshot_heading *heading);

#endif
