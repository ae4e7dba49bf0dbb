/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Droplets: grains that lie or fly apart from the heap.
 *
 * Leaves with c > DROPLETS_THRESHOLD that share faces make a set. The set of
 * the largest volume is the heap (of equal ones the first in Morton order), the
 * others are droplets. Sets may stretch over ranks. */
#ifndef TALUS_DROPLETS_H
#define TALUS_DROPLETS_H

#include <stdbool.h>
#include <stdint.h>

struct mesh;

static const double DROPLETS_THRESHOLD = 1e-6;

struct droplets {
  int64_t n;     /* sets other than the heap */
  double volume; /* in them, m^DIM */
};

/* Find the sets of a volume fraction c [nleaves]; heap [nleaves] says which
 * leaves belong to the heap. Collective. The same on all ranks. */
void droplets_find(const struct mesh *mesh, const double *c, bool *heap,
                   struct droplets *droplets);

/* Number the sets of leaves with v > threshold that share faces: set [nleaves]
 * becomes a number in [0, n), the same on all ranks, or -1. Returns n; not
 * every number need be in use. Collective. */
int droplets_number(const struct mesh *mesh, const double *v, double threshold,
                    int32_t *set);

#endif
