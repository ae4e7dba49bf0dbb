/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/snapshot.h"

#include <dirent.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "talus/error.h"
#include "talus/field.h"
#include "talus/hdf5_file.h"
#include "talus/log.h"
#include "talus/memory.h"
#include "talus/output.h"
#include "vertices.h"
#include "xdmf.h"

enum { NAME_LENGTH = 128 };

struct snapshots {
  char *directory;
  int count;
  struct xdmf *index;
};

static void snapshot_name(int number, char name[NAME_LENGTH]) {
  snprintf(name, NAME_LENGTH, "snapshot-%06d.h5", number);
}

static char *snapshot_path(const struct snapshots *snapshots, int number) {
  char name[NAME_LENGTH];
  snapshot_name(number, name);
  return output_path(snapshots->directory, name);
}

/* Describe the arrays a snapshot holds, one entry per dataset with values on
 * cells. */
static void describe_fields(const struct fields *fields,
                            struct xdmf_grid *grid) {
  for (int k = 0; k < fields->n; k++) {
    const struct field *field = fields->field[k];
    if (!field->output || field->component > 0) continue;
    struct xdmf_array *array = &grid->array[grid->narrays++];
    CHECK(strlen(field->name) < sizeof array->name, "name '%s' is too long",
          field->name);
    strcpy(array->name, field->name);
    array->columns = 1;
    if (field->component == 0) { /* "u_x" begins the vector "u" */
      array->name[strlen(field->name) - 2] = '\0';
      array->columns = 3;
    }
  }
}

/* Return the part of a vector along axis d, NULL if there is none. */
static const struct field *find_component(const struct fields *fields,
                                          const char *vector, int d) {
  char name[NAME_LENGTH];
  snprintf(name, sizeof name, "%s_%c", vector, "xyz"[d]);
  return fields_find(fields, name);
}

struct vector {
  const struct field *part[3]; /* NULL: 0 */
};

static void fill_vector(void *context, int64_t first, int64_t n, void *data) {
  const struct vector *vector = context;
  double(*v)[3] = data;
  for (int d = 0; d < 3; d++) {
    const struct field *part = vector->part[d];
    for (int64_t i = 0; i < n; i++) v[i][d] = part ? part->v[first + i] : 0;
  }
}

/* Write means over the sides of the leaves. The run must not notice a snapshot,
 * so mesh_fill_faces works on a copy. */
static void write_sides(struct hdf5_file *file, const struct mesh *mesh,
                        const struct field *field) {
  const size_t nfaces = (size_t)mesh->nfaces_all;
  double *v = MEM_NEW(double, (size_t)mesh->nleaves);
  double *copy = MEM_NEW(double, nfaces);
  memcpy(copy, field->v, sizeof(double) * nfaces);
  mesh_fill_faces(mesh, 1, &copy);
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    v[i] = mesh_mean(mesh, copy, i);
  }
  hdf5_write(file, field->name, HDF5_REAL, mesh->nleaves, 1, v);
  mem_free(copy);
  mem_free(v);
}

static void write_array(struct hdf5_file *file, const struct mesh *mesh,
                        const struct fields *fields,
                        const struct xdmf_array *array) {
  struct vector vector = {{NULL}};
  const struct field *first = array->columns == 1
                                  ? fields_find(fields, array->name)
                                  : find_component(fields, array->name, 0);
  if (array->columns > 1) {
    for (int d = 0; d < DIM; d++)
      vector.part[d] = find_component(fields, array->name, d);
    hdf5_write_pieces(file, array->name, HDF5_REAL, mesh->nleaves, 3,
                      fill_vector, &vector);
  } else if (first->location == FIELD_FACE) {
    write_sides(file, mesh, first);
  } else {
    hdf5_write(file, array->name, HDF5_REAL, mesh->nleaves, 1, first->v);
  }
  hdf5_write_text(file, array->name, "unit", first->unit);
  hdf5_write_text(file, array->name, "title", first->title);
}

struct corners {
  const struct mesh *mesh;
  struct vertices vertices;
  int32_t leaf; /* where vertices_place is */
};

static void fill_vertices(void *context, int64_t first, int64_t n, void *data) {
  struct corners *corners = context;
  vertices_place(corners->mesh, &corners->vertices, first, n, &corners->leaf,
                 data);
}

static void fill_cells(void *context, int64_t first, int64_t n, void *data) {
  const struct vertices *vertices = &((struct corners *)context)->vertices;
  int64_t(*cell)[NCHILD] = data;
  for (int64_t i = 0; i < n; i++) {
    for (int k = 0; k < NCHILD; k++) {
      /* VTK goes round the lower face, then round the upper one */
      const int corner = (k & 2) != 0 ? k ^ 1 : k;
      cell[i][k] = vertices->first + vertices->cell[first + i][corner];
    }
  }
}

static void write_mesh(struct hdf5_file *file, const struct mesh *mesh) {
  struct corners corners = {.mesh = mesh};
  vertices_find(mesh, &corners.vertices);
  hdf5_write_pieces(file, "vertices", HDF5_REAL, corners.vertices.n, DIM,
                    fill_vertices, &corners);
  hdf5_write_pieces(file, "cells", HDF5_INT64, mesh->nleaves, NCHILD,
                    fill_cells, &corners);
  vertices_free(&corners.vertices);
  hdf5_write_text(file, "vertices", "unit", "m");
  hdf5_write_text(file, "vertices", "title", "corners of the leaves");
  hdf5_write_text(file, "cells", "unit", "1");
  hdf5_write_text(file, "cells", "title", "vertices of each leaf");
  hdf5_write(file, "level", HDF5_INT8, mesh->nleaves, 1, mesh->level);
  hdf5_write_text(file, "level", "unit", "1");
  hdf5_write_text(file, "level", "title", "level of refinement");
}

/* Read from a file what the index must know of it; returns false if it is
 * unreadable. */
static bool read_grid(struct hdf5_file *file, struct xdmf_grid *grid) {
  char list[4096];
  int columns;
  if (!hdf5_read_real(file, "/", "time", 1, &grid->time) ||
      !hdf5_read_size(file, "vertices", &grid->nvertices, &columns) ||
      !hdf5_read_size(file, "cells", &grid->ncells, &columns) ||
      !hdf5_read_text(file, "/", "fields", sizeof list, list))
    return false;
  grid->narrays = 0;
  char *rest = list;
  for (char *name; (name = strtok_r(rest, " ", &rest)) != NULL;) {
    struct xdmf_array *array = &grid->array[grid->narrays];
    int64_t rows;
    if (grid->narrays == XDMF_MAX_ARRAYS ||
        strlen(name) >= sizeof array->name ||
        !hdf5_read_size(file, name, &rows, &array->columns))
      return false;
    strcpy(array->name, name);
    grid->narrays++;
  }
  return true;
}

static void add_to_index(struct snapshots *snapshots, int number) {
  struct xdmf_grid grid = {.narrays = 0};
  char *path = snapshot_path(snapshots, number);
  struct hdf5_file *file = hdf5_open(MPI_COMM_WORLD, path);
  if (file != NULL && read_grid(file, &grid)) {
    snapshot_name(number, grid.file);
    xdmf_add(snapshots->index, &grid);
  } else if (base_rank() == 0) {
    fprintf(stderr,
            "talus: warning: '%s' cannot be read, it is left out of "
            "snapshots.xdmf\n",
            path);
    log_info("warning: '%s' cannot be read", path);
  }
  if (file != NULL) hdf5_close(file, false);
  mem_free(path);
}

static int compare_numbers(const void *a, const void *b) {
  const int m = *(const int *)a, n = *(const int *)b;
  return (m > n) - (m < n);
}

/* List the numbers below `count` of the snapshots that are there, in order, on
 * all ranks; the caller frees them. The directory is listed, as `count` may be
 * large and the files few. */
static int *list_numbers(const char *directory, int count, int *n) {
  DIR *list = base_rank() == 0 && count > 0 ? opendir(directory) : NULL;
  int *number = NULL, room = 0;
  *n = 0;
  for (struct dirent *entry; list != NULL && (entry = readdir(list));) {
    char name[NAME_LENGTH];
    int k;
    if (sscanf(entry->d_name, "snapshot-%d.h5", &k) != 1 || k < 0) continue;
    snapshot_name(k, name);
    if (k >= count || strcmp(name, entry->d_name) != 0) continue;
    if (*n == room) {
      room = 2 * room + 64;
      number = mem_resize(number, (size_t)room, sizeof *number);
    }
    number[(*n)++] = k;
  }
  if (list != NULL) closedir(list);
  MPI_CHECK(MPI_Bcast(n, 1, MPI_INT, 0, MPI_COMM_WORLD));
  number = mem_resize(number, (size_t)*n + 1, sizeof *number);
  qsort(number, (size_t)*n, sizeof *number, compare_numbers);
  MPI_CHECK(MPI_Bcast(number, *n, MPI_INT, 0, MPI_COMM_WORLD));
  return number;
}

struct snapshots *snapshots_new(const char *directory, int count) {
  struct snapshots *snapshots = MEM_NEW(struct snapshots, 1);
  snapshots->directory = MEM_NEW(char, strlen(directory) + 1);
  strcpy(snapshots->directory, directory);
  snapshots->count = count;
  snapshots->index = xdmf_new();
  int n, *number = list_numbers(directory, count, &n);
  for (int k = 0; k < n; k++) add_to_index(snapshots, number[k]);
  mem_free(number);
  return snapshots;
}

void snapshots_destroy(struct snapshots *snapshots) {
  xdmf_destroy(snapshots->index);
  mem_free(snapshots->directory);
  mem_free(snapshots);
}

int snapshots_count(const struct snapshots *snapshots) {
  return snapshots->count;
}

/* Write the names of the arrays on cells, for read_grid and for other readers.
 */
static void write_list(struct hdf5_file *file, const struct xdmf_grid *grid) {
  char list[4096] = "";
  for (int k = 0; k < grid->narrays; k++) {
    if (k > 0) strcat(list, " ");
    strcat(list, grid->array[k].name);
  }
  hdf5_write_text(file, "/", "fields", list);
}

void snapshots_write(struct snapshots *snapshots, const struct mesh *mesh,
                     const struct fields *fields,
                     const struct snapshot_heading *heading) {
  char *path = snapshot_path(snapshots, snapshots->count);
  struct hdf5_file *file = hdf5_create(mesh->comm, path, 0);
  struct xdmf_grid grid = {.narrays = 0};
  describe_fields(fields, &grid);
  output_write_heading(file, heading->parameters);
  hdf5_write_real(file, "/", "time", 1, &heading->time);
  hdf5_write_integer(file, "/", "step", 1, &heading->step);
  hdf5_write_real(file, "/", "length_scale", 1, &heading->length_scale);
  write_list(file, &grid);
  write_mesh(file, mesh);
  for (int k = 0; k < grid.narrays; k++)
    write_array(file, mesh, fields, &grid.array[k]);
  read_grid(file, &grid);
  hdf5_close(file, true); /* checkpoints count it */
  mem_free(path);

  snapshot_name(snapshots->count++, grid.file);
  xdmf_add(snapshots->index, &grid);
  path = output_path(snapshots->directory, "snapshots.xdmf");
  xdmf_write(snapshots->index, path);
  mem_free(path);
}
