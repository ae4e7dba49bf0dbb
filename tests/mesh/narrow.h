/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Boxes of 3D cases that are the same all over the width across the flow. */
#ifndef TALUS_TESTS_NARROW_H
#define TALUS_TESTS_NARROW_H

#include <math.h>

#include "talus/params.h"

/* Make a box of one tree 2^-cut wide between its sides across the flow, with
 * leaves as long as before. */
static inline void params_make_narrow(struct params *p, int cut) {
  p->size = ldexp(p->size, -cut);
  p->trees[0] = p->trees[DIM - 1] = 1 << cut;
  p->level_min -= cut, p->level_max -= cut;
}

#endif
