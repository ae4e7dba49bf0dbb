/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/checkpoint.h"

#include <errno.h>
#include <float.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "disk.h"
#include "talus/error.h"
#include "talus/field.h"
#include "talus/forest.h"
#include "talus/hdf5_file.h"
#include "talus/memory.h"
#include "talus/mesh.h"
#include "talus/output.h"
#include "talus/seal.h"

enum { PATH_LENGTH = 4096, NAME_LENGTH = 128 };

/* Number of the layout in checkpoint.h; raise it whenever a file of before can
 * no longer be read. The files of format 1 had no seal. */
enum { FORMAT = 2 };

/* How far round-off may take a value out of its range. */
static const double RANGE_SLACK = 1e-6;

struct checkpoint {
  struct hdf5_file *file;
  char *path;
};

static void field_path(const struct field *field, char path[NAME_LENGTH]) {
  int n = snprintf(path, NAME_LENGTH, "/fields/%s", field->name);
  CHECK(n < NAME_LENGTH, "field name '%s' is too long", field->name);
}

/* Write */

static void write_layout(struct hdf5_file *file,
                         const struct forest_layout *layout) {
  int64_t format = FORMAT, dimension = DIM, trees[DIM], periodic[DIM];
  const int64_t axisymmetric = layout->axisymmetric;
  for (int d = 0; d < DIM; d++) {
    trees[d] = layout->trees[d];
    periodic[d] = layout->periodic[d];
  }
  hdf5_write_integer(file, "/", "format", 1, &format);
  hdf5_write_integer(file, "/", "dimension", 1, &dimension);
  hdf5_write_integer(file, "/", "trees", DIM, trees);
  hdf5_write_integer(file, "/", "periodic", DIM, periodic);
  hdf5_write_integer(file, "/", "axisymmetric", 1, &axisymmetric);
  hdf5_write_real(file, "/", "size", 1, &layout->size);
  hdf5_write_real(file, "/", "origin", DIM, layout->origin);
}

static void write_forest(struct hdf5_file *file, const struct forest *forest) {
  int64_t n = forest_nleaves(forest);
  int8_t *levels = MEM_NEW(int8_t, (size_t)n);
  forest_levels(forest, levels);
  hdf5_write(file, "levels", HDF5_INT8, n, 1, levels);
  hdf5_write(file, "partition", HDF5_INT64, 1, 1, &n);
  mem_free(levels);
}

struct sides {
  const struct mesh *mesh;
  const double *v; /* [nfaces_all] */
};

static void fill_sides(void *context, int64_t first, int64_t n, void *data) {
  const struct sides *sides = context;
  double(*side)[NFACE] = data;
  for (int64_t i = 0; i < n; i++) {
    const int32_t *face = sides->mesh->cell_face[first + i];
    for (int f = 0; f < NFACE; f++) side[i][f] = sides->v[face[f]];
  }
}

/* Write the values of a face field on all sides of the leaves. The run must not
 * notice a checkpoint, so what filling changes is set back. */
static void write_sides(struct hdf5_file *file, const char *path,
                        const struct mesh *mesh, const struct field *field) {
  struct sides sides = {mesh, field->v};
  const size_t filled = (size_t)(mesh->nfaces_all - mesh->nfaces);
  double *before = MEM_NEW(double, filled);
  memcpy(before, field->v + mesh->nfaces, filled * sizeof(double));
  mesh_fill_faces(mesh, 1, &field->v);
  hdf5_write_pieces(file, path, HDF5_REAL, mesh->nleaves, NFACE, fill_sides,
                    &sides);
  memcpy(field->v + mesh->nfaces, before, filled * sizeof(double));
  mem_free(before);
}

static void write_field(struct hdf5_file *file, const struct mesh *mesh,
                        const struct field *field) {
  char path[NAME_LENGTH];
  field_path(field, path);
  if (field->location == FIELD_CELL) {
    hdf5_write(file, path, HDF5_REAL, mesh->nleaves, 1, field->v);
  } else {
    write_sides(file, path, mesh, field);
  }
  hdf5_write_text(file, path, "unit", field->unit);
  hdf5_write_text(file, path, "title", field->title);
}

/* Give the number as the file holds it. */
static double value_of(const struct scalar *scalar, const void *of) {
  const void *at = (const char *)of + scalar->offset;
  if (scalar->type == SCALAR_INTEGER) return (double)*(const int64_t *)at;
  if (scalar->type == SCALAR_INT) return *(const int *)at;
  const double value = *(const double *)at;
  return isnan(value) && isinf(scalar->high) ? INFINITY : value;
}

static void write_scalars(struct hdf5_file *file,
                          const struct scalars *scalars) {
  for (int k = 0; k < scalars->n; k++) {
    const struct scalar *s = &scalars->list[k];
    const double real = value_of(s, scalars->of);
    const int64_t integer = s->type == SCALAR_REAL ? 0 : (int64_t)real;
    if (s->type == SCALAR_REAL)
      hdf5_write_real(file, "state", s->name, 1, &real);
    else
      hdf5_write_integer(file, "state", s->name, 1, &integer);
  }
}

void checkpoint_write(const char *path, const char *model,
                      const struct mesh *mesh, const struct fields *fields,
                      int n, const struct scalars scalars[],
                      const char *parameters) {
  char draft[PATH_LENGTH];
  int length = snprintf(draft, sizeof draft, "%s.tmp", path);
  CHECK(length < PATH_LENGTH, "path '%s' is too long", path);
  struct hdf5_file *file = hdf5_create(mesh->comm, draft, SEAL_LENGTH);
  output_write_heading(file, parameters);
  write_layout(file, forest_layout(mesh->forest));
  write_forest(file, mesh->forest);
  hdf5_write_text(file, "/", "model", model);
  hdf5_write_group(file, "state");
  for (int k = 0; k < n; k++) write_scalars(file, &scalars[k]);
  hdf5_write_group(file, "fields");
  for (int k = 0; k < fields->n; k++)
    if (fields->field[k]->restart) write_field(file, mesh, fields->field[k]);
  hdf5_close(file, false);
  seal_write(mesh->comm, draft, FORMAT);
  if (mesh->rank == 0) {
    if (rename(draft, path) != 0) disk_fail(path, errno);
    disk_sync_directory(path);
  }
  MPI_CHECK(MPI_Barrier(mesh->comm));
}

/* Read */

/* Refuse a file that is not to the bit what was written, before HDF5, which
 * trusts what it reads, sees it. */
static void check_seal(MPI_Comm comm, const char *path) {
  struct seal_report report;
  seal_check(comm, path, &report);
  if (report.verdict == SEAL_UNSEALED)
    USER_ERROR(
        "'%s' was written by an older version of talus, whose checkpoints have "
        "no seal; go on with the version that wrote it (run.log names it), or "
        "start afresh without --restart",
        path);
  if (report.verdict != SEAL_SOUND)
    USER_ERROR(
        "'%s' is missing or damaged (%s), there is nothing to go on from; take "
        "another copy of it, or start afresh without --restart",
        path, report.reason);
  if (report.format != FORMAT)
    USER_ERROR(
        "'%s' was written by talus %s, %s version, in format %d, and this "
        "version reads format %d; go on with the version that wrote it, or "
        "start afresh without --restart",
        path, report.version, report.format < FORMAT ? "an older" : "a newer",
        report.format, FORMAT);
}

static void refuse_other_box(const char *path, const char *what) {
  USER_ERROR(
      "'%s' belongs to a run with another %s; --restart needs the box of that "
      "run: give the same dimension, coordinates, size, origin, trees and "
      "periodic axes, or start afresh without --restart",
      path, what);
}

static void compare_layout(struct hdf5_file *file, const char *path,
                           const struct forest_layout *layout) {
  int64_t dimension = 0, trees[DIM], periodic[DIM], axisymmetric = 0;
  double size = 0, origin[DIM];
  if (!hdf5_read_integer(file, "/", "dimension", 1, &dimension))
    USER_ERROR("'%s' is no checkpoint of talus", path);
  if (dimension != DIM) refuse_other_box(path, "dimension");
  if (!hdf5_read_integer(file, "/", "trees", DIM, trees) ||
      !hdf5_read_integer(file, "/", "periodic", DIM, periodic) ||
      !hdf5_read_real(file, "/", "size", 1, &size) ||
      !hdf5_read_real(file, "/", "origin", DIM, origin))
    USER_ERROR("'%s' does not say which box it is for", path);
  hdf5_read_integer(file, "/", "axisymmetric", 1, &axisymmetric);
  if ((axisymmetric != 0) != layout->axisymmetric)
    refuse_other_box(path, "kind of coordinates");
  if (size != layout->size) refuse_other_box(path, "size of the box");
  for (int d = 0; d < DIM; d++) {
    if (trees[d] != layout->trees[d]) refuse_other_box(path, "brick of trees");
    if ((periodic[d] != 0) != layout->periodic[d])
      refuse_other_box(path, "set of periodic axes");
    if (origin[d] != layout->origin[d]) refuse_other_box(path, "origin");
  }
}

static void compare_model(struct hdf5_file *file, const char *path,
                          const char *model) {
  char found[NAME_LENGTH];
  if (!hdf5_read_text(file, "/", "model", sizeof found, found)) return;
  if (strcmp(found, model) != 0)
    USER_ERROR(
        "'%s' belongs to a run of model = \"%s\", and the case is of model = "
        "\"%s\"; take the case of that run, or start afresh without --restart",
        path, found, model);
}

struct checkpoint *checkpoint_open(MPI_Comm comm, const char *path,
                                   const char *model,
                                   const struct forest_layout *layout) {
  check_seal(comm, path);
  struct hdf5_file *file = hdf5_open(comm, path);
  if (file == NULL) USER_ERROR("'%s' is no checkpoint of talus", path);
  compare_model(file, path, model);
  compare_layout(file, path, layout);
  struct checkpoint *checkpoint = MEM_NEW(struct checkpoint, 1);
  checkpoint->file = file;
  checkpoint->path = MEM_NEW(char, strlen(path) + 1);
  strcpy(checkpoint->path, path);
  return checkpoint;
}

void checkpoint_close(struct checkpoint *checkpoint) {
  hdf5_close(checkpoint->file, false);
  mem_free(checkpoint->path);
  mem_free(checkpoint);
}

/* Find the share of the leaves of this rank: the old one on as many ranks as
 * before, else an even one. */
static void share_leaves(struct checkpoint *checkpoint, MPI_Comm comm,
                         int64_t all, int64_t *first, int64_t *n) {
  int rank, nranks, columns = 0;
  int64_t old = 0, least;
  MPI_CHECK(MPI_Comm_rank(comm, &rank));
  MPI_CHECK(MPI_Comm_size(comm, &nranks));
  if (hdf5_read_size(checkpoint->file, "partition", &old, &columns) &&
      old == nranks) {
    hdf5_read(checkpoint->file, "partition", HDF5_INT64, rank, 1, 1, n);
    MPI_CHECK(MPI_Allreduce(n, &least, 1, MPI_INT64_T, MPI_MIN, comm));
    if (least < 0)
      USER_ERROR("'%s' is damaged: partition = %" PRId64 " leaves on some rank",
                 checkpoint->path, least);
    MPI_CHECK(MPI_Scan(n, first, 1, MPI_INT64_T, MPI_SUM, comm));
    *first -= *n;
  } else {
    *first = all * rank / nranks;
    *n = all * (rank + 1) / nranks - *first;
  }
}

struct forest *checkpoint_forest(struct checkpoint *checkpoint,
                                 const struct forest_layout *layout) {
  MPI_Comm comm = hdf5_comm(checkpoint->file);
  int64_t all = 0, first = 0, n = 0, sum = 0;
  int columns = 0;
  if (!hdf5_read_size(checkpoint->file, "levels", &all, &columns) ||
      columns != 1)
    USER_ERROR("'%s' holds no leaves", checkpoint->path);
  share_leaves(checkpoint, comm, all, &first, &n);
  MPI_CHECK(MPI_Allreduce(&n, &sum, 1, MPI_INT64_T, MPI_SUM, comm));
  if (sum != all)
    USER_ERROR("'%s' is damaged: it shares out %" PRId64 " of %" PRId64
               " leaves",
               checkpoint->path, sum, all);
  int8_t *levels = MEM_NEW(int8_t, (size_t)n);
  hdf5_read(checkpoint->file, "levels", HDF5_INT8, first, n, 1, levels);
  struct forest *forest = forest_from_levels(comm, layout, n, levels);
  mem_free(levels);
  if (forest == NULL)
    USER_ERROR("'%s' is damaged: its leaves do not fill the box",
               checkpoint->path);
  return forest;
}

/* Set each face to the value of the side of its owner that is this face. */
static void faces_from_sides(const struct mesh *mesh, const double *side,
                             double *v) {
  for (int d = 0; d < DIM; d++) {
    for (int32_t f = mesh->face_begin[d]; f < mesh->face_begin[d + 1]; f++) {
      int32_t owner = mesh->face_owner[f];
      int upper = mesh->face_node[f][0] == owner;
      v[f] = side[(int64_t)owner * NFACE + 2 * d + upper];
    }
  }
  mesh_fill_faces(mesh, 1, &v);
}

/* The values that a field may have. */
struct range {
  double low, high;
};

static bool is_within(struct range range, double value) {
  return isfinite(value) && value >= range.low && value <= range.high;
}

/* Refuse the value of a field in a leaf that this rank owns if `first` says so.
 * Collective; does not return. */
static _Noreturn void refuse_value(struct checkpoint *checkpoint,
                                   const struct mesh *mesh,
                                   const struct field *field, int first,
                                   int32_t leaf, double value) {
  double found[4] = {value}; /* and its place */
  char place[64];
  if (first == mesh->rank)
    for (int d = 0; d < DIM; d++) found[1 + d] = mesh->x[leaf][d];
  MPI_CHECK(MPI_Bcast(found, 4, MPI_DOUBLE, first, mesh->comm));
  int n = snprintf(place, sizeof place, "%g, %g", found[1], found[2]);
  if (DIM == 3) snprintf(place + n, sizeof place - (size_t)n, ", %g", found[3]);
  char range[64] = "";
  if (field->low < field->high)
    snprintf(range, sizeof range, " from %g to %g", field->low, field->high);
  USER_ERROR(
      "'%s' is damaged or was edited: %s (%s) = %g in the leaf at (%s), a "
      "finite number%s is needed; take another copy of it, or start afresh "
      "without --restart",
      checkpoint->path, field->name, field->title, found[0], place, range);
}

/* Refuse values v [nleaves][columns] that no run can have written. */
static void check_values(struct checkpoint *checkpoint, const struct mesh *mesh,
                         const struct field *field, int columns,
                         const double *v) {
  const bool bounded = field->low < field->high;
  const struct range range = {bounded ? field->low - RANGE_SLACK : -DBL_MAX,
                              bounded ? field->high + RANGE_SLACK : DBL_MAX};
  const int64_t n = (int64_t)mesh->nleaves * columns;
  int64_t k = 0;
  while (k < n && is_within(range, v[k])) k++;
  int first = k < n ? mesh->rank : mesh->nranks;
  MPI_CHECK(
      MPI_Allreduce(MPI_IN_PLACE, &first, 1, MPI_INT, MPI_MIN, mesh->comm));
  if (first < mesh->nranks)
    refuse_value(checkpoint, mesh, field, first, (int32_t)(k / columns),
                 k < n ? v[k] : 0);
}

static void read_field(struct checkpoint *checkpoint, const struct mesh *mesh,
                       struct field *field) {
  char path[NAME_LENGTH];
  field_path(field, path);
  int64_t all = 0, first = forest_first_leaf(mesh->forest);
  int columns = 0, wanted = field->location == FIELD_CELL ? 1 : NFACE;
  if (!hdf5_read_size(checkpoint->file, path, &all, &columns) ||
      columns != wanted || all != forest_nleaves_global(mesh->forest))
    USER_ERROR(
        "'%s' has no values of %s (%s) for this case; --restart needs the "
        "phases, tracers and regularisation of the first run",
        checkpoint->path, field->name, field->title);
  if (field->location == FIELD_CELL) {
    hdf5_read(checkpoint->file, path, HDF5_REAL, first, mesh->nleaves, 1,
              field->v);
    check_values(checkpoint, mesh, field, 1, field->v);
    return;
  }
  double *side = MEM_NEW(double, (size_t)mesh->nleaves *NFACE);
  hdf5_read(checkpoint->file, path, HDF5_REAL, first, mesh->nleaves, NFACE,
            side);
  check_values(checkpoint, mesh, field, NFACE, side);
  faces_from_sides(mesh, side, field->v);
  mem_free(side);
}

void checkpoint_read_fields(struct checkpoint *checkpoint,
                            const struct mesh *mesh, struct fields *fields) {
  for (int k = 0; k < fields->n; k++)
    if (fields->field[k]->restart)
      read_field(checkpoint, mesh, fields->field[k]);
}

/* Refuse a number out of its range. */
static void check_scalar(const struct checkpoint *checkpoint,
                         const struct scalar *s, double value) {
  if (value >= s->low && value <= s->high) return;
  char range[64];
  if (s->high < DBL_MAX)
    snprintf(range, sizeof range, "a number from %g to %g", s->low, s->high);
  else if (s->low > -DBL_MAX)
    snprintf(range, sizeof range, "a finite number of at least %g", s->low);
  else
    snprintf(range, sizeof range, "a finite number");
  USER_ERROR(
      "'%s' is damaged or was edited: %s = %.17g, %s is needed; take another "
      "copy of it, or start afresh without --restart",
      checkpoint->path, s->name, value, range);
}

static void read_scalar(const struct checkpoint *checkpoint,
                        const struct scalar *s, void *of) {
  void *at = (char *)of + s->offset;
  double real = 0;
  int64_t integer = 0;
  const bool found =
      s->type == SCALAR_REAL
          ? hdf5_read_real(checkpoint->file, "state", s->name, 1, &real)
          : hdf5_read_integer(checkpoint->file, "state", s->name, 1, &integer);
  if (!found)
    USER_ERROR("'%s' has no '%s'; it was written by another version of talus",
               checkpoint->path, s->name);
  check_scalar(checkpoint, s, s->type == SCALAR_REAL ? real : (double)integer);
  switch (s->type) {
    case SCALAR_REAL:
      *(double *)at = real;
      break;
    case SCALAR_INTEGER:
      *(int64_t *)at = integer;
      break;
    case SCALAR_INT:
      *(int *)at = (int)integer;
      break;
  }
}

void checkpoint_read_scalars(struct checkpoint *checkpoint, int n,
                             const struct scalars scalars[]) {
  for (int k = 0; k < n; k++)
    for (int i = 0; i < scalars[k].n; i++)
      read_scalar(checkpoint, &scalars[k].list[i], scalars[k].of);
}
