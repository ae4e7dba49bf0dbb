/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/output.h"

#include <errno.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "disk.h"
#include "talus/count.h"
#include "talus/csv_row.h"
#include "talus/error.h"
#include "talus/hdf5_file.h"
#include "talus/memory.h"

/* Broadcast a status; runs of one rank may do without MPI (unit tests). */
static void broadcast(void *data, size_t bytes) {
  if (base_size() > 1)
    MPI_CHECK(MPI_Bcast(data, count_index((int64_t)bytes, "bytes"), MPI_BYTE, 0,
                        MPI_COMM_WORLD));
}

/* Return 0, or the errno that keeps `path` from being a directory we can write
 * in, now or once it is made: the nearest ancestor that is there decides. */
static int directory_errno(const char *path) {
  char *part = MEM_NEW(char, strlen(path) + 3);
  strcpy(part, path[0] == '\0' ? "." : path);
  struct stat status;
  int error;
  while ((error = stat(part, &status) == 0 ? 0 : errno) == ENOENT) {
    char *slash = strrchr(part, '/');
    if (slash == NULL) {
      strcpy(part, ".");
    } else if (slash == part && slash[1] != '\0') {
      slash[1] = '\0';
    } else {
      *slash = '\0';
    }
    if (part[0] == '\0') break;
  }
  if (error == 0 && !S_ISDIR(status.st_mode)) error = ENOTDIR;
  if (error == 0 && access(part, W_OK | X_OK) != 0) error = errno;
  mem_free(part);
  return error;
}

static void refuse_directory(const char *directory, int error) {
  if (error != 0)
    USER_ERROR(
        "cannot write to the output directory '%s': %s; choose another with -o "
        "DIR",
        directory, strerror(error));
}

void output_check_directory(const char *directory) {
  int error = base_rank() == 0 ? directory_errno(directory) : 0;
  broadcast(&error, sizeof error);
  refuse_directory(directory, error);
}

/* Make directories as mkdir -p; returns 0 or an errno. */
static int make_directories(const char *directory) {
  char *part = MEM_NEW(char, strlen(directory) + 1);
  int error = 0;
  strcpy(part, directory);
  for (char *end = part + 1; error == 0 && end[-1] != '\0'; end++) {
    if (*end != '/' && *end != '\0') continue;
    char c = *end;
    *end = '\0';
    if (mkdir(part, 0777) != 0 && errno != EEXIST) error = errno;
    *end = c;
  }
  mem_free(part);
  return error != 0 ? error : directory_errno(directory);
}

void output_make_directory(const char *directory) {
  int error = base_rank() == 0 ? make_directories(directory) : 0;
  broadcast(&error, sizeof error);
  refuse_directory(directory, error);
}

bool output_holds_tables(const char *directory) {
  static const char *const name[] = {"series.csv", "profile.csv",
                                     "parameters.csv", "run.log"};
  bool found = false;
  for (int k = 0; k < 4 && base_rank() == 0; k++) {
    char *path = output_path(directory, name[k]);
    found = found || access(path, F_OK) == 0;
    mem_free(path);
  }
  broadcast(&found, sizeof found);
  return found;
}

char *output_path(const char *directory, const char *name) {
  size_t size = strlen(directory) + strlen(name) + 2;
  char *path = MEM_NEW(char, size);
  snprintf(path, size, "%s/%s", directory, name);
  return path;
}

char *output_parameters(void (*write)(void *context, FILE *f), void *context) {
  char *text = NULL;
  size_t length = 0;
  if (base_rank() == 0 && write != NULL) {
    FILE *f = open_memstream(&text, &length);
    if (f == NULL) FATAL("no memory for the list of parameters");
    write(context, f);
    fclose(f);
  }
  broadcast(&length, sizeof length);
  char *copy = MEM_NEW(char, length + 1);
  if (text != NULL) memcpy(copy, text, length);
  free(text); /* made by open_memstream */
  broadcast(copy, length + 1);
  return copy;
}

void output_write_text(const char *directory, const char *name,
                       const char *text) {
  if (base_rank() != 0) return;
  char *path = output_path(directory, name);
  FILE *f = fopen(path, "w");
  if (f == NULL) disk_fail(path, errno);
  fputs(text, f);
  output_flush(f, path);
  fclose(f);
  mem_free(path);
}

void output_write_heading(struct hdf5_file *file, const char *parameters) {
  struct csv_row row = {0};
  hdf5_write_text(file, "/", "version", TALUS_VERSION);
  hdf5_write_group(file, "parameters");
  if (*parameters == '\0') return;
  FILE *f = fmemopen((char *)(uintptr_t)parameters, strlen(parameters), "r");
  if (f == NULL) FATAL("no memory for the list of parameters");
  csv_row_read(f, &row); /* the header */
  while (csv_row_read(f, &row)) {
    char known[2];
    const char *name = csv_row_cell(&row, 0);
    /* of two rows with one name the first */
    if (*name != '\0' &&
        !hdf5_read_text(file, "parameters", name, sizeof known, known))
      hdf5_write_text(file, "parameters", name, csv_row_cell(&row, 1));
  }
  csv_row_free(&row);
  fclose(f);
}

char *output_number(double value, char text[32]) {
  for (int digits = 15; digits <= 17; digits++) {
    snprintf(text, 32, "%.*g", digits, value);
    if (strtod(text, NULL) == value) break;
  }
  return text;
}

void output_flush(FILE *f, const char *path) {
  if (fflush(f) != 0 || ferror(f)) disk_fail(path, errno);
}
