/* SPDX-License-Identifier: GPL-3.0-or-later */
/* profile.csv: outlines of the heap, `time,x,height` (3D: `time,x,y,height`),
 * height = int c dz of the heap per finest column.
 *
 * To keep the file small only columns with some height are listed, and those
 * next to them; all others have the height 0. */
#ifndef TALUS_PROFILE_H
#define TALUS_PROFILE_H

#include <stdbool.h>

struct profile;

/* Open directory/profile.csv; with `keep` outlines up to `last_time` stay.
 * Collective. */
struct profile *profile_open(const char *directory, bool keep,
                             double last_time);
/* Add the outline at a time: n[0] n[1] columns (n[1] == 1 in 2D) with centres
 * first[d] + i spacing and height [n[1]][n[0]], m. Rank 0 writes. */
void profile_write(struct profile *profile, double time, const int n[2],
                   const double first[2], double spacing, const double *height);
void profile_close(struct profile *profile);

#endif
