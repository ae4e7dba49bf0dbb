/* SPDX-License-Identifier: GPL-3.0-or-later */
/* talus info: what a run left in its directory, or what is in one file. */
#include <dirent.h>
#include <errno.h>
#include <inttypes.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

#include "talus/command_line.h"
#include "talus/error.h"
#include "talus/hdf5_file.h"

enum { LENGTH = 4096 };

static bool ends_in(const char *text, const char *end) {
  size_t n = strlen(text), m = strlen(end);
  return n >= m && strcmp(text + n - m, end) == 0;
}

/* Header, last complete line and number of rows of a csv file. */
static bool read_csv(const char *path, char header[LENGTH], char last[LENGTH],
                     long *nrows) {
  FILE *f = fopen(path, "r");
  if (f == NULL) return false;
  char line[LENGTH];
  *nrows = -1;
  header[0] = last[0] = '\0';
  while (fgets(line, sizeof line, f) != NULL) {
    char *newline = strchr(line, '\n');
    if (newline == NULL) continue; /* being written, or too long */
    *newline = '\0';
    memcpy((*nrows)++ < 0 ? header : last, line, sizeof line);
  }
  fclose(f);
  return *nrows >= 0;
}

/* `column = value` for each cell of a row; plain numbers, so no quotes. */
static void print_row(char *header, char *row) {
  while (*header != '\0' && *row != '\0') {
    size_t n = strcspn(header, ","), m = strcspn(row, ",");
    printf("  %-20.*s = %.*s\n", (int)n, header, (int)m, row);
    header += n + (header[n] == ',');
    row += m + (row[m] == ',');
  }
}

static int info_csv(const char *path) {
  char header[LENGTH], last[LENGTH];
  long nrows;
  if (!read_csv(path, header, last, &nrows))
    USER_ERROR("%s is no csv file of talus: it has no header line", path);
  printf("%s: %ld rows of %s\n", path, nrows, header);
  if (nrows > 0) printf("last row\n");
  print_row(header, last);
  return EXIT_DONE;
}

/* Title and unit of each field that the root names. Collective. */
static void print_fields(struct hdf5_file *file) {
  char list[LENGTH], *rest = list;
  if (!hdf5_read_text(file, "/", "fields", sizeof list, list)) return;
  if (base_rank() == 0) printf("fields\n");
  for (char *name; (name = strtok_r(rest, " ", &rest)) != NULL;) {
    char title[256] = "", unit[64] = "";
    hdf5_read_text(file, name, "title", sizeof title, title);
    hdf5_read_text(file, name, "unit", sizeof unit, unit);
    if (base_rank() == 0) printf("  %-20s %-8s %s\n", name, unit, title);
  }
}

static int info_hdf5(const char *path) {
  struct hdf5_file *file = hdf5_open(MPI_COMM_WORLD, path);
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
  if (base_rank() == 0) {
    printf("%s: a %s of talus %s\n", path, snapshot ? "snapshot" : "checkpoint",
           version);
    printf("  %-20s = %d\n  %-20s = %.10g\n  %-20s = %" PRId64
           "\n  %-20s = %" PRId64 "\n",
           "dimension", dimension, "time", time, "step", step, "cells", rows);
  }
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

/* `key = value  unit` for each row of parameters.csv. */
static void print_parameters(const char *path) {
  FILE *f = fopen(path, "r");
  if (f == NULL) return;
  char line[LENGTH];
  printf("parameters\n");
  for (long n = 0; fgets(line, sizeof line, f) != NULL; n++) {
    line[strcspn(line, "\n")] = '\0';
    char *comma = strchr(line, ',');
    if (n == 0 || comma == NULL) continue;
    *comma = '\0';
    char *value = comma + 1, *end = value + strcspn(value, ",");
    if (*value == '"') { /* quoted for the commas in it */
      end = strchr(++value, '"');
      if (end == NULL) continue;
    }
    *end = '\0';
    printf("  %-28s = %s\n", line, value);
  }
  fclose(f);
}

static int info_directory(const char *directory) {
  char path[LENGTH], header[LENGTH], last[LENGTH];
  long nrows;
  snprintf(path, sizeof path, "%s/series.csv", directory);
  if (!read_csv(path, header, last, &nrows))
    USER_ERROR("%s holds no series.csv: is it the directory of a run?",
               directory);
  if (base_rank() != 0) return EXIT_DONE;
  printf("%s: %ld rows in series.csv, the last\n", directory, nrows);
  print_row(header, last);
  snprintf(path, sizeof path, "%s/parameters.csv", directory);
  print_parameters(path);
  print_files(directory);
  return EXIT_DONE;
}

int command_info(int argc, char *argv[]) {
  if (argc != 1) USER_ERROR("say: talus info DIR, or talus info FILE");
  const char *path = argv[0];
  struct stat status;
  if (stat(path, &status) != 0) USER_ERROR("%s: %s", path, strerror(errno));
  if (S_ISDIR(status.st_mode)) return info_directory(path);
  if (ends_in(path, ".h5")) return info_hdf5(path);
  if (ends_in(path, ".csv"))
    return base_rank() == 0 ? info_csv(path) : EXIT_DONE;
  USER_ERROR(
      "%s: a directory, .csv or .h5 file is needed; for a case there is "
      "talus check",
      path);
}
