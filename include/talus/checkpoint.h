/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Checkpoint: all that a run needs to go on, in one HDF5 file.
 *
 * The forest is stored as the levels of all leaves in Morton order, and the
 * number of leaves of each rank. Cell fields are stored in the same order. Of a
 * face field each leaf stores the values on its 2 DIM sides [lower x, upper x,
 * ...]. A face is read from the side of the leaf that owns the face, where side
 * and face are the same, so nothing is lost on the average sides of coarse
 * leaves. Doubles are stored without rounding: on the same number of ranks a
 * restarted run repeats the first one bit by bit; on another number it goes on
 * from the same values with leaves spread evenly.
 *
 * The file is written beside the old one, sealed (seal.h), brought to the disk,
 * and then takes the place of the old one, so that a crash or a full disk
 * leaves the old one whole. A file whose seal is broken is refused before
 * anything of it is used, and so are values that no run can have written:
 * fractions out of [0, 1], numbers that are not finite or out of their range.
 *
 *   (512 bytes)          the seal
 *   /                    attributes version, format, model, dimension, trees,
 *                        size, origin, periodic
 *   /parameters          a group with one text attribute per parameter
 *   /state               a group with the scalars of the model as attributes
 *   /levels /partition   int8 [leaves], int64 [ranks]
 *   /fields/<name>       double [leaves] or [leaves][2 DIM], attributes unit
 *                        and title
 */
#ifndef TALUS_CHECKPOINT_H
#define TALUS_CHECKPOINT_H

#include <mpi.h>

#include <stdbool.h>
#include <stdint.h>
#include "talus/scalars.h"

struct field;
struct fields;
struct forest;
struct forest_layout;
struct mesh;

/* Write every field with `restart` set and n lists of scalars of a run of this
 * model. `parameters` is csv text (output.h). Collective. A failure of the disk
 * ends the program with the old file in place. */
void checkpoint_write(const char *path, const char *model,
                      const struct mesh *mesh, const struct fields *fields,
                      int n, const struct scalars scalars[],
                      const char *parameters);

struct checkpoint;

/* Open a checkpoint of a run of this model in a brick of this layout.
 * Collective; whatever does not fit is a USER_ERROR. */
struct checkpoint *checkpoint_open(MPI_Comm comm, const char *path,
                                   const char *model,
                                   const struct forest_layout *layout);
/* Make the stored forest, owned by the caller. Collective. */
struct forest *checkpoint_forest(struct checkpoint *checkpoint,
                                 const struct forest_layout *layout);
/* Read leaf and face values of every field with `restart` set, on a mesh of
 * that forest; ghosts and helpers are left to the caller, face copies are
 * filled. Collective; a field that is not in the file is a USER_ERROR. */
void checkpoint_read_fields(struct checkpoint *checkpoint,
                            const struct mesh *mesh, struct fields *fields);
/* Read n lists of scalars. Collective; one that is missing or out of its range
 * is a USER_ERROR. */
void checkpoint_read_scalars(struct checkpoint *checkpoint, int n,
                             const struct scalars scalars[]);
void checkpoint_close(struct checkpoint *checkpoint);

#endif
