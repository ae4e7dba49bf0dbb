/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The messages behind a mesh. */
#ifndef TALUS_TREE_EXCHANGE_H
#define TALUS_TREE_EXCHANGE_H

#include "talus/plan.h"

struct mesh_exchange {
  struct plan ghost;        /* leaf values to the ranks that touch them */
  struct plan average;      /* parts of averages, added where needed */
  struct plan virtual_node; /* groups of NCHILD, relative to begin_virtual */
  struct plan face;         /* face values from the rank that computes them */
};

#endif
