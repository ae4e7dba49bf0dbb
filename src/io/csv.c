/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/csv.h"

#include <errno.h>
#include <inttypes.h>
#include <mpi.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "disk.h"
#include "talus/error.h"
#include "talus/memory.h"
#include "talus/output.h"

struct csv {
  FILE *f;    /* rank 0 */
  char *path; /* owned */
  bool row_begun;
};

/* Next line of f without its end, in *line, which grows; false at the end of
 * the file, and for a last line that was cut short. */
static bool read_line(FILE *f, char **line, size_t *room) {
  size_t n = 0;
  for (int c; (c = fgetc(f)) != EOF;) {
    if (n + 1 >= *room) {
      *room = 2 * *room + 128;
      *line = mem_resize(*line, *room, 1);
    }
    (*line)[n] = '\0';
    if (c == '\n') return true;
    (*line)[n++] = (char)c;
  }
  return false;
}

/* Copies the header and the rows up to `last` of `old` to `new`; false if the
 * header is another one. */
static bool copy_rows(FILE *old, FILE *new, const char *header, double last) {
  char *line = NULL;
  size_t room = 0;
  bool same = read_line(old, &line, &room) && strcmp(line, header) == 0;
  while (same && read_line(old, &line, &room))
    if (strtod(line, NULL) <= last) fprintf(new, "%s\n", line);
  mem_free(line);
  return same;
}

/* Writes the start of the file beside the old one and puts it in its place.
 * Returns 0, an errno, or -1 for a foreign header. */
static int prepare(const char *path, const char *header, bool keep,
                   double last) {
  size_t size = strlen(path) + 5;
  char *draft = MEM_NEW(char, size);
  snprintf(draft, size, "%s.tmp", path);
  int error = 0;
  FILE *new = fopen(draft, "w"), *old = keep ? fopen(path, "r") : NULL;
  if (new == NULL) {
    error = errno;
  } else {
    fprintf(new, "%s\n", header);
    if (old != NULL && !copy_rows(old, new, header, last)) error = -1;
    if (fflush(new) != 0 && error == 0) error = errno;
    fclose(new);
    if (error == 0 && rename(draft, path) != 0) error = errno;
    if (error != 0) remove(draft);
  }
  if (old != NULL) fclose(old);
  mem_free(draft);
  return error;
}

struct csv *csv_open(const char *directory, const char *name,
                     const char *header, bool keep, double last) {
  struct csv *csv = MEM_NEW(struct csv, 1);
  csv->path = output_path(directory, name);
  int error = 0;
  if (base_rank() == 0) {
    error = prepare(csv->path, header, keep, last);
    if (error == 0 && (csv->f = fopen(csv->path, "a")) == NULL) error = errno;
  }
  if (base_size() > 1)
    MPI_CHECK(MPI_Bcast(&error, 1, MPI_INT, 0, MPI_COMM_WORLD));
  if (error == -1)
    USER_ERROR(
        "'%s' has other columns than this version of talus writes, so its "
        "rows cannot be continued; move it away to --restart",
        csv->path);
  if (error == EACCES || error == EPERM || error == EROFS || error == EISDIR)
    USER_ERROR("cannot write '%s': %s", csv->path, strerror(error));
  if (error != 0 && base_rank() == 0) disk_fail(csv->path, error);
  if (error != 0 && base_size() > 1) MPI_CHECK(MPI_Barrier(MPI_COMM_WORLD));
  return csv;
}

void csv_close(struct csv *csv) {
  if (csv->f != NULL) {
    output_flush(csv->f, csv->path);
    fclose(csv->f);
  }
  mem_free(csv->path);
  mem_free(csv);
}

static void write_cell(struct csv *csv, const char *text) {
  if (csv->f == NULL) return;
  if (csv->row_begun) putc(',', csv->f);
  fputs(text, csv->f);
  csv->row_begun = true;
}

void csv_real(struct csv *csv, double value) {
  char text[32];
  write_cell(csv, output_number(value, text));
}

void csv_short(struct csv *csv, double value) {
  char text[32];
  snprintf(text, sizeof text, "%.12g", value);
  write_cell(csv, text);
}

void csv_integer(struct csv *csv, int64_t value) {
  char text[32];
  snprintf(text, sizeof text, "%" PRId64, value);
  write_cell(csv, text);
}

void csv_end_row(struct csv *csv) {
  if (csv->f == NULL) return;
  putc('\n', csv->f);
  csv->row_begun = false;
  output_flush(csv->f, csv->path);
}
