/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "xdmf.h"

#include <errno.h>
#include <inttypes.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "disk.h"
#include "talus/error.h"
#include "talus/memory.h"
#include "talus/output.h"

enum { CORNERS = 1 << DIM };

/* The grids as text, so that a long run does not print them again and again. */
struct xdmf {
  char *text; /* owned */
  size_t length, room;
  size_t written; /* of the text, in the file */
};

static const char head[] = XDMF_HEAD;
static const char tail[] = "    </Grid>\n  </Domain>\n</Xdmf>\n";

struct xdmf *xdmf_new(void) {
  return MEM_NEW(struct xdmf, 1);
}

void xdmf_destroy(struct xdmf *xdmf) {
  mem_free(xdmf->text);
  mem_free(xdmf);
}

static void add(struct xdmf *xdmf, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

static void add(struct xdmf *xdmf, const char *format, ...) {
  enum { MOST = 512 }; /* of one piece */
  if (xdmf->length + MOST > xdmf->room) {
    xdmf->room = 2 * xdmf->room + 4 * MOST;
    xdmf->text = mem_resize(xdmf->text, xdmf->room, 1);
  }
  va_list arguments;
  va_start(arguments, format);
  int n = vsnprintf(xdmf->text + xdmf->length, MOST, format, arguments);
  va_end(arguments);
  CHECK(n >= 0 && n < MOST, "a piece of XDMF has %d characters", n);
  xdmf->length += (size_t)n;
}

/* Write where a dataset is, and of what it is made. */
static void write_item(struct xdmf *xdmf, const char *kind, int bytes,
                       int64_t rows, int columns, const char *file,
                       const char *name) {
  add(xdmf, "<DataItem Format=\"HDF\" NumberType=\"%s\" Precision=\"%d\"", kind,
      bytes);
  add(xdmf, " Dimensions=\"%" PRId64, rows);
  if (columns > 1) add(xdmf, " %d", columns);
  add(xdmf, "\">%s:/%s</DataItem>", file, name);
}

static void write_attribute(struct xdmf *xdmf, const char *kind, int bytes,
                            const struct xdmf_grid *grid,
                            const struct xdmf_array *array) {
  add(xdmf, "        <Attribute Name=\"%s\" Center=\"Cell\" ", array->name);
  add(xdmf, "AttributeType=\"%s\">", array->columns == 1 ? "Scalar" : "Vector");
  write_item(xdmf, kind, bytes, grid->ncells, array->columns, grid->file,
             array->name);
  add(xdmf, "</Attribute>\n");
}

void xdmf_add(struct xdmf *xdmf, const struct xdmf_grid *grid) {
  static const struct xdmf_array level = {"level", 1};
  char time[32];
  if (base_rank() != 0) return;
  add(xdmf, "      <Grid Name=\"%.*s\" GridType=\"Uniform\">\n",
      (int)strcspn(grid->file, "."), grid->file);
  add(xdmf, "        <Time Value=\"%s\"/>\n", output_number(grid->time, time));
  add(xdmf, "        <Topology TopologyType=\"%s\" ",
      DIM == 2 ? "Quadrilateral" : "Hexahedron");
  add(xdmf, "NumberOfElements=\"%" PRId64 "\">", grid->ncells);
  write_item(xdmf, "Int", 8, grid->ncells, CORNERS, grid->file, "cells");
  add(xdmf, "</Topology>\n        <Geometry GeometryType=\"%s\">",
      DIM == 2 ? "XY" : "XYZ");
  write_item(xdmf, "Float", 8, grid->nvertices, DIM, grid->file, "vertices");
  add(xdmf, "</Geometry>\n");
  write_attribute(xdmf, "Char", 1, grid, &level);
  for (int k = 0; k < grid->narrays; k++)
    write_attribute(xdmf, "Float", 8, grid, &grid->array[k]);
  add(xdmf, "      </Grid>\n");
}

/* Replace the whole file, so that a reader never sees half of it. */
static void replace(const struct xdmf *xdmf, const char *path) {
  size_t size = strlen(path) + 5;
  char *draft = MEM_NEW(char, size);
  snprintf(draft, size, "%s.tmp", path);
  FILE *f = fopen(draft, "w");
  if (f == NULL) disk_fail(draft, errno);
  fprintf(f, "%s%s%s", head, xdmf->text != NULL ? xdmf->text : "", tail);
  output_flush(f, draft);
  fclose(f);
  if (rename(draft, path) != 0) disk_fail(path, errno);
  mem_free(draft);
}

void xdmf_write(struct xdmf *xdmf, const char *path) {
  if (base_rank() != 0) return;
  FILE *f = xdmf->written > 0 ? fopen(path, "r+") : NULL;
  if (f == NULL) {
    replace(xdmf, path);
  } else {
    fseek(f, (long)(strlen(head) + xdmf->written), SEEK_SET);
    fprintf(f, "%s%s", xdmf->text + xdmf->written, tail);
    output_flush(f, path);
    fclose(f);
  }
  xdmf->written = xdmf->length;
}
