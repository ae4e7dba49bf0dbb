/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Files of a run: HDF5, checkpoints, snapshots, csv. */
#include <check.h>
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "grid.h"
#include "talus/checkpoint.h"
#include "talus/csv.h"
#include "talus/field.h"
#include "talus/hdf5_file.h"
#include "talus/output.h"
#include "talus/progress.h"
#include "talus/remap.h"
#include "talus/snapshot.h"

static char directory[64]; /* of this test, the same on all ranks */

static void make_directory(void) {
  strcpy(directory, "/tmp/talus-io-XXXXXX");
  if (base_rank() == 0 && mkdtemp(directory) == NULL) FATAL("no directory");
  MPI_CHECK(
      MPI_Bcast(directory, sizeof directory, MPI_CHAR, 0, MPI_COMM_WORLD));
}

static void remove_directory(void) {
  char command[128];
  snprintf(command, sizeof command, "rm -rf '%s'", directory);
  MPI_CHECK(MPI_Barrier(MPI_COMM_WORLD));
  if (base_rank() == 0 && system(command) != 0) FATAL("cannot clean up");
}

/* Return the path of a file in the directory, valid until the next call. */
static const char *path_of(const char *name) {
  static char path[256];
  snprintf(path, sizeof path, "%s/%s", directory, name);
  return path;
}

/* HDF5 */

START_TEST(rows_of_all_ranks_follow_each_other) {
  const char *path = path_of("rows.h5");
  const int rank = base_rank(), rows = rank == 1 ? 0 : 2 + rank;
  double data[16][3];
  for (int i = 0; i < rows; i++)
    for (int k = 0; k < 3; k++) data[i][k] = 100 * rank + 10 * i + k + 1.0 / 3;
  struct hdf5_file *file = hdf5_create(MPI_COMM_WORLD, path, 0);
  hdf5_write(file, "data", HDF5_REAL, rows, 3, data);
  hdf5_close(file, true);

  file = hdf5_open(MPI_COMM_WORLD, path);
  bool good = file != NULL;
  int64_t all = 0;
  int columns = 0;
  good = good && hdf5_read_size(file, "data", &all, &columns) && columns == 3;
  double back[64][3];
  hdf5_read(file, "data", HDF5_REAL, 0, all, 3, back); /* all rows, all ranks */
  good = good && !hdf5_read_size(file, "other", &all, &columns);
  hdf5_close(file, false);
  int place = 0;
  for (int r = 0; r < base_size(); r++)
    for (int i = 0; i < (r == 1 ? 0 : 2 + r); i++, place++)
      for (int k = 0; k < 3; k++)
        good = good && back[place][k] == 100 * r + 10 * i + k + 1.0 / 3;
  ck_assert(all_ranks(good));
}
END_TEST

/* Fill rows of the number and place of each rank, made where *context says. */
static void fill_rows(void *context, int64_t first, int64_t n, void *data) {
  int64_t *next = context;
  int64_t(*row)[3] = data;
  for (int64_t i = 0; i < n; i++)
    for (int k = 0; k < 3; k++)
      row[i][k] =
          first == *next ? 1000000 * base_rank() + 10 * (first + i) + k : -1;
  *next = first + n;
}

/* More rows than are written at once, fewer on later ranks, none on the last
 * of three. */
START_TEST(rows_written_in_pieces_are_all_there) {
  enum { MOST = 50000 };
  const char *path = path_of("pieces.h5");
  const int64_t n = base_rank() == 2 ? 0 : MOST - 20000 * base_rank();
  int64_t next = 0, all = 0;
  int columns = 0;
  struct hdf5_file *file = hdf5_create(MPI_COMM_WORLD, path, 0);
  hdf5_write_pieces(file, "data", HDF5_INT64, n, 3, fill_rows, &next);
  hdf5_close(file, false);
  file = hdf5_open(MPI_COMM_WORLD, path);
  bool good = next == n && hdf5_read_size(file, "data", &all, &columns) &&
              all == MOST + (base_size() > 1 ? MOST - 20000 : 0);
  int64_t(*back)[3] = mem_alloc((size_t)n, sizeof *back);
  hdf5_read(file, "data", HDF5_INT64, base_rank() == 1 ? MOST : 0, n, 3, back);
  hdf5_close(file, false);
  for (int64_t i = 0; i < n; i++)
    for (int k = 0; k < 3; k++)
      good = good && back[i][k] == 1000000 * base_rank() + 10 * i + k;
  mem_free(back);
  ck_assert(all_ranks(good));
}
END_TEST

START_TEST(attributes_come_back) {
  const char *path = path_of("attributes.h5");
  const double real[2] = {0.1, -1e300}, one = 1.0 / 3;
  const int64_t integer = ((int64_t)1 << 60) + 1;
  struct hdf5_file *file = hdf5_create(MPI_COMM_WORLD, path, 0);
  output_write_heading(file,
                       "name,value,unit\na,1,\"m\"\na,2\nb,\"x, \"\"y\"\"\"\n");
  hdf5_write_real(file, "/", "two", 2, real);
  hdf5_write_real(file, "/", "one", 1, &one);
  hdf5_write_integer(file, "/", "integer", 1, &integer);
  hdf5_write_text(file, "/", "empty", "");
  hdf5_close(file, false);

  double two[2] = {0, 0}, back = 0;
  int64_t whole = 0;
  char a[8], b[16], empty[8] = "x";
  file = hdf5_open(MPI_COMM_WORLD, path);
  bool good = hdf5_read_real(file, "/", "two", 2, two) &&
              hdf5_read_real(file, "/", "one", 1, &back) &&
              hdf5_read_integer(file, "/", "integer", 1, &whole) &&
              hdf5_read_text(file, "/parameters", "a", sizeof a, a) &&
              hdf5_read_text(file, "/parameters", "b", sizeof b, b) &&
              hdf5_read_text(file, "/", "empty", sizeof empty, empty);
  good = good && !hdf5_read_real(file, "/", "two", 1, &back) &&
         !hdf5_read_real(file, "/", "three", 1, &back) &&
         !hdf5_read_text(file, "/parameters", "name", sizeof a, a);
  hdf5_close(file, false);
  good = good && two[0] == real[0] && two[1] == real[1] && back == one &&
         whole == integer && strcmp(a, "1") == 0 &&
         strcmp(b, "x, \"y\"") == 0 && empty[0] == '\0';
  ck_assert(all_ranks(good));
}
END_TEST

START_TEST(damaged_files_are_not_opened) {
  const char *path = path_of("damaged.h5");
  double zero[64] = {0};
  struct hdf5_file *file = hdf5_create(MPI_COMM_WORLD, path, 0);
  hdf5_write(file, "data", HDF5_REAL, 64, 1, zero);
  hdf5_close(file, true);
  bool cut = base_rank() != 0 || truncate(path, 700) == 0;
  MPI_CHECK(MPI_Barrier(MPI_COMM_WORLD));
  bool good = cut && hdf5_open(MPI_COMM_WORLD, path) == NULL &&
              hdf5_open(MPI_COMM_WORLD, path_of("missing.h5")) == NULL;
  ck_assert(all_ranks(good));
}
END_TEST

/* Checkpoints */

/* Return a number that is different everywhere, with all digits in use. */
static double value_at(const double x[DIM], int which) {
  double v = which;
  for (int d = 0; d < DIM; d++) v += sin((37 + 3 * d + which) * x[d]);
  return v;
}

static void add_fields(struct fields *fields, const struct mesh *mesh) {
  fields_add(fields, mesh, "a", "m/s", "a cell field", FIELD_CELL,
             &remap_linear)
      ->restart = true;
  fields_add(fields, mesh, "u_f", "m/s", "a face field", FIELD_FACE,
             &remap_faces)
      ->restart = true;
  fields_add(fields, mesh, "scratch", "1", "not kept", FIELD_CELL, NULL);
}

/* Give the centre of a face, from its owner, so that all ranks agree on every
 * bit. */
static void face_centre(const struct mesh *mesh, int32_t f, int d,
                        double x[DIM]) {
  int32_t owner = mesh->face_owner[f];
  double side = mesh->face_node[f][0] == owner ? 0.5 : -0.5;
  for (int k = 0; k < DIM; k++) x[k] = mesh->x[owner][k];
  x[d] += side * mesh->h[owner];
}

static void set_fields(struct fields *fields, const struct mesh *mesh) {
  for (int32_t i = 0; i < mesh->nleaves; i++)
    fields->field[0]->v[i] = value_at(mesh->x[i], 1);
  for (int d = 0; d < DIM; d++)
    for (int32_t f = mesh->face_begin[d]; f < mesh->face_begin[d + 1]; f++) {
      double x[DIM];
      face_centre(mesh, f, d, x);
      fields->field[1]->v[f] = value_at(x, 2 + d);
    }
}

static bool fields_are_set(const struct fields *fields,
                           const struct mesh *mesh) {
  struct fields other = {.n = 0};
  add_fields(&other, mesh);
  set_fields(&other, mesh);
  bool good = memcmp(other.field[0]->v, fields->field[0]->v,
                     sizeof(double) * (size_t)mesh->nleaves) == 0;
  field_fill_faces(mesh, other.field[1]);
  good = good && memcmp(other.field[1]->v, fields->field[1]->v,
                        sizeof(double) * (size_t)mesh->nfaces_all) == 0;
  fields_destroy(&other);
  return good;
}

struct clock {
  double time;
  int64_t step;
};

static struct scalars clock_scalars(struct clock *clock) {
  static const struct scalar list[] = {
      {"time", SCALAR_REAL, offsetof(struct clock, time), -DBL_MAX, DBL_MAX},
      {"step", SCALAR_INTEGER, offsetof(struct clock, step), 0, SCALAR_MOST}};
  return (struct scalars){2, list, clock};
}

static void write_one(const char *path, struct forest *forest, double time) {
  struct mesh *mesh = mesh_new(forest);
  struct fields fields = {.n = 0};
  struct clock clock = {time, 12};
  const struct scalars scalars = clock_scalars(&clock);
  add_fields(&fields, mesh);
  set_fields(&fields, mesh);
  checkpoint_write(path, "model", mesh, &fields, 1, &scalars,
                   "name,value\na,1\n");
  fields_destroy(&fields);
  mesh_destroy(mesh);
}

/* Read on `comm` what write_one wrote; *leaves: of this rank. */
static bool read_one(MPI_Comm comm, const char *path,
                     const struct forest_layout *layout, double time,
                     int32_t *leaves) {
  struct checkpoint *checkpoint = checkpoint_open(comm, path, "model", layout);
  struct forest *forest = checkpoint_forest(checkpoint, layout);
  struct mesh *mesh = mesh_new(forest);
  struct fields fields = {.n = 0};
  struct clock clock = {0, 0};
  const struct scalars scalars = clock_scalars(&clock);
  add_fields(&fields, mesh);
  checkpoint_read_fields(checkpoint, mesh, &fields);
  checkpoint_read_scalars(checkpoint, 1, &scalars);
  checkpoint_close(checkpoint);
  bool good =
      clock.time == time && clock.step == 12 && fields_are_set(&fields, mesh);
  *leaves = mesh->nleaves;
  fields_destroy(&fields);
  mesh_destroy(mesh);
  forest_destroy(forest);
  return good;
}

static struct forest *uneven_forest(MPI_Comm comm) {
  return grid_new(comm, 2, false, 2, DIM == 2 ? 5 : 4);
}

START_TEST(checkpoint_restores_every_bit_and_the_partition) {
  struct forest *forest = uneven_forest(MPI_COMM_WORLD);
  int32_t before = forest_nleaves(forest), after = 0;
  write_one(path_of("checkpoint.h5"), forest, 1.0 / 3);
  bool good = read_one(MPI_COMM_WORLD, path_of("checkpoint.h5"),
                       forest_layout(forest), 1.0 / 3, &after);
  ck_assert(all_ranks(good && before == after));
  forest_destroy(forest);
}
END_TEST

START_TEST(checkpoint_of_many_ranks_is_read_on_one) {
  struct forest *forest = uneven_forest(MPI_COMM_WORLD);
  int32_t leaves = 0;
  write_one(path_of("checkpoint.h5"), forest, 0.7);
  bool good = read_one(MPI_COMM_SELF, path_of("checkpoint.h5"),
                       forest_layout(forest), 0.7, &leaves);
  good = good && leaves == forest_nleaves_global(forest);
  ck_assert(all_ranks(good));
  forest_destroy(forest);
}
END_TEST

START_TEST(checkpoint_of_one_rank_is_read_on_many) {
  struct forest *forest = uneven_forest(MPI_COMM_SELF);
  int32_t leaves = 0;
  if (base_rank() == 0) write_one(path_of("checkpoint.h5"), forest, 0.7);
  MPI_CHECK(MPI_Barrier(MPI_COMM_WORLD));
  bool good = read_one(MPI_COMM_WORLD, path_of("checkpoint.h5"),
                       forest_layout(forest), 0.7, &leaves);
  ck_assert(all_ranks(good));
  forest_destroy(forest);
}
END_TEST

START_TEST(checkpoint_leaves_the_run_alone) {
  struct forest *forest = uneven_forest(MPI_COMM_WORLD);
  struct mesh *mesh = mesh_new(forest);
  struct fields fields = {.n = 0};
  add_fields(&fields, mesh);
  for (int32_t f = 0; f < mesh->nfaces_all; f++)
    fields.field[1]->v[f] = 1.0 / (1 + f); /* no valid copies */
  double *before = MEM_NEW(double, mesh->nfaces_all);
  memcpy(before, fields.field[1]->v, sizeof(double) * mesh->nfaces_all);
  checkpoint_write(path_of("checkpoint.h5"), "model", mesh, &fields, 0, NULL,
                   "");
  bool good = memcmp(before, fields.field[1]->v,
                     sizeof(double) * mesh->nfaces_all) == 0;
  /* no draft is left */
  good = good && access(path_of("checkpoint.h5.tmp"), F_OK) != 0;
  mem_free(before);
  fields_destroy(&fields);
  mesh_destroy(mesh);
  forest_destroy(forest);
  ck_assert(all_ranks(good));
}
END_TEST

/* Snapshots */

/* Return twice the area of the quads, or what the bottom faces of hexahedra
 * span: positive if the vertices go round as VTK wants them. */
static double quad_area(const double (*x)[DIM], const int64_t *cell) {
  double area = 0;
  for (int k = 0; k < 4; k++) {
    const double *p = x[cell[k]], *q = x[cell[(k + 1) % 4]];
    area += p[0] * q[1] - p[1] * q[0];
  }
  return area;
}

static int compare_places(const void *a, const void *b) {
  return memcmp(a, b, sizeof(double[DIM]));
}

/* Is no vertex listed twice? Those of several ranks are. */
static bool all_differ(int64_t n, double (*x)[DIM]) {
  bool good = true;
  qsort(x, (size_t)n, sizeof *x, compare_places);
  for (int64_t i = 1; i < n; i++) good = good && compare_places(x[i - 1], x[i]);
  return good;
}

static bool cells_are_sound(struct hdf5_file *file, int64_t leaves,
                            int64_t *nvertices) {
  int64_t n = 0;
  int columns = 0;
  bool good = hdf5_read_size(file, "cells", &n, &columns) && n == leaves &&
              columns == NCHILD &&
              hdf5_read_size(file, "vertices", nvertices, &columns) &&
              columns == DIM;
  double(*x)[DIM] = mem_alloc((size_t)*nvertices, sizeof *x);
  int64_t(*cell)[NCHILD] = mem_alloc((size_t)n, sizeof *cell);
  double *level = MEM_NEW(double, (size_t)n);
  hdf5_read(file, "vertices", HDF5_REAL, 0, *nvertices, DIM, x);
  hdf5_read(file, "cells", HDF5_INT64, 0, n, NCHILD, cell);
  hdf5_read(file, "level", HDF5_REAL, 0, n, 1, level);
  for (int64_t i = 0; i < n; i++) {
    double h = 0.5 * ldexp(1, (int)-level[i]); /* two trees in the unit box */
    good = good &&
           fabs(quad_area((const double(*)[DIM])x, cell[i]) / (2 * h * h) - 1) <
               1e-10;
    if (DIM == 3)
      good = good && fabs(x[cell[i][NCHILD - 4]][DIM - 1] -
                          x[cell[i][0]][DIM - 1] - h) < 1e-12;
  }
  int nranks;
  MPI_CHECK(MPI_Comm_size(hdf5_comm(file), &nranks));
  good = good && (nranks > 1 || all_differ(*nvertices, x));
  mem_free(x);
  mem_free(cell);
  mem_free(level);
  return good;
}

static void add_vector(struct fields *fields, const struct mesh *mesh) {
  static const char *const name[] = {"u_x", "u_y", "u_z"};
  for (int d = 0; d < DIM; d++) {
    struct field *u = fields_add(fields, mesh, name[d], "m/s", "velocity",
                                 FIELD_CELL, &remap_linear);
    u->output = true;
    u->component = d;
    for (int32_t i = 0; i < mesh->nleaves; i++) u->v[i] = d + 1;
  }
  struct field *eta =
      fields_add(fields, mesh, "eta_f", "Pa s", "viscosity", FIELD_FACE, NULL);
  eta->output = true;
  for (int32_t f = 0; f < mesh->nfaces; f++) eta->v[f] = 2.5;
}

static bool snapshot_is_sound(struct forest *forest, int64_t *nvertices) {
  struct hdf5_file *file =
      hdf5_open(MPI_COMM_WORLD, path_of("snapshot-000000.h5"));
  if (file == NULL) return false;
  int64_t n = forest_nleaves_global(forest), rows = 0;
  int columns = 0;
  double time = 0;
  char unit[16] = "";
  bool good = cells_are_sound(file, n, nvertices) &&
              hdf5_read_real(file, "/", "time", 1, &time) && time == 0.25 &&
              hdf5_read_text(file, "u", "unit", sizeof unit, unit) &&
              strcmp(unit, "m/s") == 0 &&
              hdf5_read_size(file, "u", &rows, &columns) && rows == n &&
              columns == 3;
  double(*u)[3] = mem_alloc((size_t)n, sizeof *u);
  double *eta = MEM_NEW(double, (size_t)n);
  hdf5_read(file, "u", HDF5_REAL, 0, n, 3, u);
  hdf5_read(file, "eta_f", HDF5_REAL, 0, n, 1, eta);
  for (int64_t i = 0; i < n; i++)
    good = good && u[i][0] == 1 && u[i][1] == 2 &&
           u[i][2] == (DIM == 3 ? 3 : 0) && eta[i] == 2.5;
  mem_free(u);
  mem_free(eta);
  hdf5_close(file, false);
  return good;
}

START_TEST(snapshots_share_vertices_and_go_round_as_vtk_wants) {
  for (int kind = 0; kind < 4; kind++) {
    const bool adapted = kind & 1, periodic = kind & 2;
    struct forest *forest =
        grid_new(MPI_COMM_WORLD, 2, periodic, 2, adapted ? 4 : 2);
    struct mesh *mesh = mesh_new(forest);
    struct fields fields = {.n = 0};
    add_vector(&fields, mesh);
    struct snapshots *snapshots = snapshots_new(directory, 0);
    struct snapshot_heading heading = {0.25, 3, 1, "name,value\na,1\n"};
    snapshots_write(snapshots, mesh, &fields, &heading);
    bool good = snapshots_count(snapshots) == 1;
    snapshots_destroy(snapshots);
    int64_t nvertices = 0;
    good = good && snapshot_is_sound(forest, &nvertices) &&
           access(path_of("snapshots.xdmf"), R_OK) == 0;
    /* 2 trees of 4 leaves along each axis */
    if (!adapted && mesh->nranks == 1)
      good = good && nvertices == (DIM == 2 ? 81 : 729);
    fields_destroy(&fields);
    mesh_destroy(mesh);
    forest_destroy(forest);
    ck_assert(all_ranks(good));
  }
}
END_TEST

/* csv and words */

static bool file_holds(const char *path, const char *text) {
  char back[256] = "";
  FILE *f = fopen(path, "r");
  if (f == NULL) return false;
  size_t n = fread(back, 1, sizeof back - 1, f);
  fclose(f);
  back[n] = '\0';
  return strcmp(back, text) == 0;
}

/* Write rows 0, 1, 2, 3 and a row the crash cut short; the mark is that of two.
 */
static struct csv_mark write_table(void) {
  struct csv *csv = csv_open(directory, "a.csv", "t,v", NULL);
  struct csv_mark mark = {0, 0};
  for (int k = 0; k < 4; k++) {
    csv_real(csv, 0.1 * k);
    csv_integer(csv, k);
    csv_end_row(csv);
    if (k == 1) mark = csv_sync(csv);
  }
  csv_close(csv);
  if (base_rank() == 0) {
    FILE *f = fopen(path_of("a.csv"), "a");
    fputs("0.05,1", f);
    fclose(f);
  }
  return mark;
}

START_TEST(csv_rows_after_the_checkpoint_are_dropped) {
  const struct csv_mark mark = write_table();
  const struct csv_expected expected = {"a.csv", "t,v", mark, 0.1, 0};
  csv_check(directory, &expected);
  struct csv *csv = csv_open(directory, "a.csv", "t,v", &mark);
  csv_short(csv, 0.125);
  csv_integer(csv, 7);
  csv_end_row(csv);
  const struct csv_mark after = csv_sync(csv);
  csv_close(csv);
  bool good = mark.rows == 2 && after.rows == 3 &&
              (base_rank() != 0 ||
               file_holds(path_of("a.csv"), "t,v\n0,0\n0.1,1\n0.125,7\n"));
  ck_assert(all_ranks(good));
}
END_TEST

START_TEST(numbers_are_short_and_exact) {
  char text[32];
  ck_assert_str_eq(output_number(0.1, text), "0.1");
  ck_assert_str_eq(output_number(0.1 + 0.2, text), "0.30000000000000004");
  ck_assert_double_eq(strtod(output_number(1.0 / 3, text), NULL), 1.0 / 3);
}
END_TEST

START_TEST(durations_are_said_as_people_do) {
  char text[32];
  ck_assert_str_eq(progress_duration(3.4, text), "3 s");
  ck_assert_str_eq(progress_duration(150, text), "2 min");
  ck_assert_str_eq(progress_duration(3600 * 2.1, text), "2 h 06 min");
  ck_assert_str_eq(progress_duration(-1, text), "unknown");
}
END_TEST

Suite *io_suite(void);
Suite *io_suite(void) {
  Suite *suite = suite_create("io");
  TCase *tcase = tcase_create("files");
  tcase_add_checked_fixture(tcase, make_directory, remove_directory);
  tcase_add_test(tcase, rows_of_all_ranks_follow_each_other);
  tcase_add_test(tcase, rows_written_in_pieces_are_all_there);
  tcase_add_test(tcase, attributes_come_back);
  tcase_add_test(tcase, damaged_files_are_not_opened);
  tcase_add_test(tcase, checkpoint_restores_every_bit_and_the_partition);
  tcase_add_test(tcase, checkpoint_of_many_ranks_is_read_on_one);
  tcase_add_test(tcase, checkpoint_of_one_rank_is_read_on_many);
  tcase_add_test(tcase, checkpoint_leaves_the_run_alone);
  tcase_add_test(tcase, snapshots_share_vertices_and_go_round_as_vtk_wants);
  tcase_add_test(tcase, csv_rows_after_the_checkpoint_are_dropped);
  suite_add_tcase(suite, tcase);
  tcase = tcase_create("words");
  tcase_add_test(tcase, numbers_are_short_and_exact);
  tcase_add_test(tcase, durations_are_said_as_people_do);
  suite_add_tcase(suite, tcase);
  return suite;
}
