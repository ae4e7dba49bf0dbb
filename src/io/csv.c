/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/csv.h"

#include <errno.h>
#include <inttypes.h>
#include <mpi.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "csv_rows.h"
#include "disk.h"
#include "talus/error.h"
#include "talus/memory.h"
#include "talus/output.h"

struct csv {
  FILE *f;              /* rank 0 */
  char *path;           /* owned */
  struct csv_mark mark; /* of the rows written, on rank 0 */
  struct csv_row row;   /* under way */
};

/* Judge a file that is to be continued, on rank 0; returns 0, an errno, -1 for
 * a foreign header, or -2 with what differs in `text`. */
static int judge(const char *path, const struct csv_expected *expected,
                 size_t size, char *text) {
  FILE *f = fopen(path, "r");
  int verdict = 0;
  if (f == NULL) return errno;
  if (!csv_rows_read_header(f, expected->header)) {
    verdict = -1;
  } else if (!csv_rows_copy(f, NULL, &expected->mark)) {
    verdict = -2;
    rewind(f);
    csv_rows_read_header(f, expected->header);
    csv_rows_describe(f, expected, size, text);
  }
  fclose(f);
  return verdict;
}

static _Noreturn void refuse_header(const char *path) {
  USER_ERROR(
      "'%s' has other columns than this run writes, for other tracers or "
      "another version of talus, so its rows cannot be continued; take the "
      "tracers and the version of the first run, or copy checkpoint.h5 alone "
      "into a new directory and --restart there",
      path);
}

void csv_check(const char *directory, const struct csv_expected *expected) {
  char *path = output_path(directory, expected->name), text[512] = "";
  int verdict = base_rank() == 0 ? judge(path, expected, sizeof text, text) : 0;
  MPI_CHECK(MPI_Bcast(&verdict, 1, MPI_INT, 0, MPI_COMM_WORLD));
  if (verdict == -1) refuse_header(path);
  if (verdict > 0) snprintf(text, sizeof text, "%s", strerror(verdict));
  if (verdict != 0)
    USER_ERROR(
        "'%s' cannot be continued: %s; put a whole copy in its place, or copy "
        "checkpoint.h5 alone into a new directory and --restart there with -o "
        "DIR, where the tables begin with the next step",
        path, text);
  mem_free(path);
}

/* Write the start of the file beside the old one and put it in its place.
 * Returns 0, an errno, or -1 for rows that are no longer those of the mark. */
static int prepare(const char *path, const char *header,
                   const struct csv_mark *kept) {
  size_t size = strlen(path) + 5;
  char *draft = MEM_NEW(char, size);
  snprintf(draft, size, "%s.tmp", path);
  int error = 0;
  FILE *new = fopen(draft, "w"), *old = kept != NULL ? fopen(path, "r") : NULL;
  if (new == NULL || (kept != NULL && old == NULL)) {
    error = errno;
  } else {
    fprintf(new, "%s\n", header);
    if (kept != NULL &&
        !(csv_rows_read_header(old, header) && csv_rows_copy(old, new, kept)))
      error = -1;
    if (fflush(new) != 0 && error == 0) error = errno;
    if (fsync(fileno(new)) != 0 && error == 0) error = disk_sync_error(errno);
    if (error == 0 && rename(draft, path) != 0) error = errno;
    if (error != 0) remove(draft);
  }
  if (new != NULL) fclose(new);
  if (old != NULL) fclose(old);
  mem_free(draft);
  return error;
}

struct csv *csv_open(const char *directory, const char *name,
                     const char *header, const struct csv_mark *kept) {
  struct csv *csv = MEM_NEW(struct csv, 1);
  csv->path = output_path(directory, name);
  if (kept != NULL) csv->mark = *kept;
  int error = 0;
  if (base_rank() == 0) {
    error = prepare(csv->path, header, kept);
    if (error == 0 && (csv->f = fopen(csv->path, "a")) == NULL) error = errno;
  }
  if (base_size() > 1)
    MPI_CHECK(MPI_Bcast(&error, 1, MPI_INT, 0, MPI_COMM_WORLD));
  if (error == -1)
    USER_ERROR("'%s' has changed while it was being opened", csv->path);
  if (error == EACCES || error == EPERM || error == EROFS || error == EISDIR)
    USER_ERROR("cannot write '%s': %s", csv->path, strerror(error));
  if (error != 0 && base_rank() == 0) disk_fail(csv->path, error);
  if (error != 0 && base_size() > 1) MPI_CHECK(MPI_Barrier(MPI_COMM_WORLD));
  return csv;
}

struct csv_mark csv_sync(struct csv *csv) {
  struct csv_mark mark = csv->mark;
  if (csv->f != NULL) {
    output_flush(csv->f, csv->path);
    const int error = fsync(fileno(csv->f)) != 0 ? disk_sync_error(errno) : 0;
    if (error != 0) disk_fail(csv->path, error);
  }
  if (base_size() > 1) {
    MPI_CHECK(MPI_Bcast(&mark.rows, 1, MPI_INT64_T, 0, MPI_COMM_WORLD));
    MPI_CHECK(MPI_Bcast(&mark.checksum, 1, MPI_INT64_T, 0, MPI_COMM_WORLD));
  }
  return mark;
}

void csv_close(struct csv *csv) {
  if (csv->f != NULL) {
    output_flush(csv->f, csv->path);
    fclose(csv->f);
  }
  csv_row_free(&csv->row);
  mem_free(csv->path);
  mem_free(csv);
}

static void write_cell(struct csv *csv, const char *text) {
  if (csv->f != NULL) csv_row_add(&csv->row, text);
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

/* Warn when what is written can no longer be found by its name. */
static void warn_if_gone(const struct csv *csv) {
  struct stat status;
  if (fstat(fileno(csv->f), &status) != 0 || status.st_nlink > 0) return;
  WARN_ONCE(
      "'%s' was removed or replaced while the run goes on: its further "
      "rows are lost, and --restart will find it lacking",
      csv->path);
}

void csv_end_row(struct csv *csv) {
  if (csv->f == NULL) return;
  csv_row_write(&csv->row, csv->f);
  csv_rows_add(&csv->mark, &csv->row);
  output_flush(csv->f, csv->path);
  warn_if_gone(csv);
}
