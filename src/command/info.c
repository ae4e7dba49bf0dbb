/* SPDX-License-Identifier: GPL-3.0-or-later */
/* talus info: what a run left in its directory, or what is in one file. */
#include <dirent.h>
#include <errno.h>
#include <inttypes.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

#include "talus/command_line.h"
#include "talus/csv_row.h"
#include "talus/error.h"
#include "talus/hdf5_file.h"
#include "talus/run_end.h"
#include "talus/seal.h"

enum { LENGTH = 4096 };

static bool ends_in(const char *text, const char *end) {
  size_t n = strlen(text), m = strlen(end);
  return n >= m && strcmp(text + n - m, end) == 0;
}

/* Parts of a csv file that are told. */
struct table {
  struct csv_row header, last; /* the last complete row */
  long nrows;
};

/* Read a csv file, but for a last row that is being written; false if there is
 * none, or without a header. */
static bool read_table(const char *path, struct table *table) {
  FILE *f = fopen(path, "r");
  struct csv_row row = {0};
  *table = (struct table){0};
  if (f == NULL) return false;
  const bool good = csv_row_read(f, &table->header) && table->header.ends;
  while (csv_row_read(f, &row) && row.ends) {
    const struct csv_row before = table->last;
    table->last = row;
    row = before;
    table->nrows++;
  }
  csv_row_free(&row);
  fclose(f);
  return good;
}

static void free_table(struct table *table) {
  csv_row_free(&table->header);
  csv_row_free(&table->last);
}

/* Print `column = value` for each cell of the last row. */
static void print_last(const struct table *table) {
  for (int k = 0; k < table->header.n && k < table->last.n; k++)
    printf("  %-20s = %s\n", csv_row_cell(&table->header, k),
           csv_row_cell(&table->last, k));
}

static int info_csv(const char *path) {
  struct table table;
  if (!read_table(path, &table))
    USER_ERROR("%s is no csv file of talus: it has no header line", path);
  printf("%s: %ld rows of ", path, table.nrows);
  struct csv_row names = {0};
  for (int k = 0; k < table.header.n; k++)
    csv_row_add(&names, csv_row_cell(&table.header, k));
  csv_row_write(&names, stdout);
  csv_row_free(&names);
  printf("%s", table.nrows > 0 ? "last row\n" : "");
  print_last(&table);
  free_table(&table);
  return EXIT_DONE;
}

/* Print title and unit of each field that the root names. */
static void print_fields(struct hdf5_file *file) {
  char list[LENGTH], *rest = list;
  if (!hdf5_read_text(file, "/", "fields", sizeof list, list)) return;
  printf("fields\n");
  for (char *name; (name = strtok_r(rest, " ", &rest)) != NULL;) {
    char title[256] = "", unit[64] = "";
    hdf5_read_text(file, name, "title", sizeof title, title);
    hdf5_read_text(file, name, "unit", sizeof unit, unit);
    printf("  %-20s %-8s %s\n", name, unit, title);
  }
}

/* Refuse a checkpoint that is not what was written: HDF5 trusts its files. */
static void check_seal(const char *path) {
  struct seal_report report;
  seal_check(MPI_COMM_SELF, path, &report);
  if (report.verdict == SEAL_DAMAGED)
    USER_ERROR("%s is a damaged checkpoint: %s", path, report.reason);
}

static int info_hdf5(const char *path) {
  check_seal(path);
  struct hdf5_file *file = hdf5_open(MPI_COMM_SELF, path);
  if (file == NULL) USER_ERROR("%s cannot be read as an HDF5 file", path);
  char version[64] = "?";
  double time = 0;
  int64_t step = 0, rows = 0;
  int columns = 0;
  hdf5_read_text(file, "/", "version", sizeof version, version);
  bool snapshot = hdf5_read_real(file, "/", "time", 1, &time);
  const char *object = snapshot ? "/" : "/state";
  hdf5_read_real(file, object, "time", 1, &time);
  hdf5_read_integer(file, object, "step", 1, &step);
  const char *leaves = snapshot ? "/cells" : "/levels";
  if (!hdf5_read_size(file, leaves, &rows, &columns))
    USER_ERROR("%s is neither a snapshot nor a checkpoint of talus", path);
  int dimension = snapshot ? (columns == 4 ? 2 : 3) : 0;
  int64_t stored;
  if (hdf5_read_integer(file, "/", "dimension", 1, &stored))
    dimension = (int)stored;
  printf("%s: a %s of talus %s\n", path, snapshot ? "snapshot" : "checkpoint",
         version);
  printf("  %-20s = %d\n  %-20s = %.10g\n  %-20s = %" PRId64
         "\n  %-20s = %" PRId64 "\n",
         "dimension", dimension, "time", time, "step", step, "cells", rows);
  if (snapshot) print_fields(file);
  hdf5_close(file, false);
  return EXIT_DONE;
}

static void print_files(const char *directory) {
  DIR *list = opendir(directory);
  if (list == NULL) return;
  double snapshots_size = 0;
  int snapshots = 0;
  printf("files\n");
  for (struct dirent *entry; (entry = readdir(list)) != NULL;) {
    char path[LENGTH];
    struct stat status;
    snprintf(path, sizeof path, "%s/%s", directory, entry->d_name);
    if (stat(path, &status) != 0 || !S_ISREG(status.st_mode)) continue;
    double kilobytes = (double)status.st_size / 1e3;
    if (strncmp(entry->d_name, "snapshot-", 9) == 0) {
      snapshots++;
      snapshots_size += kilobytes;
    } else {
      printf("  %-24s %10.0f kB\n", entry->d_name, kilobytes);
    }
  }
  closedir(list);
  if (snapshots > 0)
    printf("  snapshot-*.h5, %5d      %10.0f kB\n", snapshots, snapshots_size);
}

/* Print `key = value` for each row of parameters.csv. */
static void print_parameters(const char *path) {
  FILE *f = fopen(path, "r");
  struct csv_row row = {0};
  if (f == NULL) return;
  printf("parameters\n");
  csv_row_read(f, &row); /* the header */
  while (csv_row_read(f, &row))
    printf("  %-28s = %s\n", csv_row_cell(&row, 0), csv_row_cell(&row, 1));
  csv_row_free(&row);
  fclose(f);
}

static int info_directory(const char *directory) {
  char path[LENGTH];
  struct table table;
  snprintf(path, sizeof path, "%s/series.csv", directory);
  if (!read_table(path, &table))
    USER_ERROR("%s holds no series.csv: is it the directory of a run?",
               directory);
  printf("%s: %ld rows in series.csv%s\n", directory, table.nrows,
         table.nrows > 0 ? ", the last" : "");
  print_last(&table);
  free_table(&table);
  run_end_print(directory);
  snprintf(path, sizeof path, "%s/parameters.csv", directory);
  print_parameters(path);
  print_files(directory);
  return EXIT_DONE;
}

/* Rank 0 alone looks and speaks: others may see another directory, or none. */
int command_info(int argc, char *argv[]) {
  if (base_rank() != 0) return EXIT_DONE;
  if (argc != 1) USER_ERROR("say: talus info DIR, or talus info FILE");
  const char *path = argv[0];
  struct stat status;
  if (stat(path, &status) != 0) USER_ERROR("%s: %s", path, strerror(errno));
  if (S_ISDIR(status.st_mode)) return info_directory(path);
  if (!S_ISREG(status.st_mode))
    USER_ERROR("%s is neither a file nor a directory", path);
  if (ends_in(path, ".h5")) return info_hdf5(path);
  if (ends_in(path, ".csv")) return info_csv(path);
  USER_ERROR(
      "%s: a directory, .csv or .h5 file is needed; for a case there is "
      "talus check",
      path);
}
