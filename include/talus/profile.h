/* SPDX-License-Identifier: GPL-3.0-or-later */
/* profile.csv: outlines of the heap, `time,x,height` (3D: `time,x,y,height`),
 * height = int c dz of the heap per finest column, then a column per tracer
 * with the part of that height that the tracer has (outline.h).
 *
 * To keep the file small only columns with some height are listed, and those
 * next to them; all others have the height 0. */
#ifndef TALUS_PROFILE_H
#define TALUS_PROFILE_H

#include "talus/csv.h"

struct params;
struct profile;

/* End the program (USER_ERROR) unless directory/profile.csv has the tracers of
 * `params` and the rows of the mark, none of them after `last_time`.
 * Collective. */
void profile_check(const char *directory, const struct params *params,
                   const struct csv_mark *mark, double last_time);
/* Open directory/profile.csv, with the tracers of `params`: afresh, or after
 * the rows of `kept`, if not NULL. Collective. */
struct profile *profile_open(const char *directory, const struct params *params,
                             const struct csv_mark *kept);
/* Bring all rows to the disk (csv_sync). */
struct csv_mark profile_sync(struct profile *profile);
/* Add the outline at a time: n[0] n[1] columns (n[1] == 1 in 2D) with centres
 * first[d] + i spacing, height [n[1]][n[0]] and layer [ntracers][n[1]][n[0]] of
 * the tracers, m. Rank 0 writes. */
void profile_write(struct profile *profile, double time, const int n[2],
                   const double first[2], double spacing, const double *height,
                   double *const *layer);
void profile_close(struct profile *profile);

#endif
