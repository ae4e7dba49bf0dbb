/* SPDX-License-Identifier: GPL-3.0-or-later */
/* XDMF: an XML index of HDF5 files that ParaView and VTK read
 * [xdmf.org, XDMF Model and Format]. One temporal collection of unstructured
 * grids. */
#ifndef TALUS_IO_XDMF_H
#define TALUS_IO_XDMF_H

#include <stdint.h>

#include "talus/params.h"

enum { XDMF_MAX_ARRAYS = 64 };

/* How an index of ours begins. */
#define XDMF_HEAD                                     \
  "<?xml version=\"1.0\" encoding=\"utf-8\"?>\n"      \
  "<Xdmf Version=\"2.0\">\n  <Domain>\n"              \
  "    <Grid Name=\"talus\" GridType=\"Collection\" " \
  "CollectionType=\"Temporal\">\n"

struct xdmf_array {
  char name[PARAMS_NAME_LENGTH];
  int columns; /* 1, or 3 for a vector */
};

struct xdmf_grid {
  char file[128]; /* beside the index */
  double time;
  int64_t ncells, nvertices;
  int narrays;
  struct xdmf_array array[XDMF_MAX_ARRAYS];
};

struct xdmf;

struct xdmf *xdmf_new(void);
void xdmf_destroy(struct xdmf *xdmf);
/* Add one time. Does something on rank 0 only, like xdmf_write. */
void xdmf_add(struct xdmf *xdmf, const struct xdmf_grid *grid);
/* Write the file: first as a whole, then, as file systems are slow to replace
 * one, what is new over the tags at its end. */
void xdmf_write(struct xdmf *xdmf, const char *path);

#endif
