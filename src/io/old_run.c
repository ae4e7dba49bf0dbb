/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/old_run.h"

#include <dirent.h>
#include <mpi.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "talus/csv_row.h"
#include "talus/error.h"
#include "talus/memory.h"
#include "talus/output.h"
#include "xdmf.h"

enum { HEAD = 4096, NAME_LENGTH = 64 };

/* Files that a run writes, and how those of ours begin. */
static const struct {
  const char *name, *begin;
} FILES[] = {
    {"series.csv", "step,time,dt,cells,"},
    {"profile.csv", "time,x,"},
    {"parameters.csv", "key,value,unit,origin\n"},
    {"run.log", "talus "},
    {"snapshots.xdmf", XDMF_HEAD},
    {"checkpoint.h5", "talus checkpoint\n"},
    {"checkpoint.h5.tmp", "talus checkpoint\n"},
};

enum { NFILES = sizeof FILES / sizeof *FILES };

/* Pictures of tools/plot.py, and the words it signs them with. */
static const char *const PICTURES[] = {
    "outlines.png", "fields-final.png", "history.png", "film.gif",
    "film.mp4",     "plan.png",         "heap.png"};
static const char SIGNATURE[] = "talus plot";

enum { NPICTURES = sizeof PICTURES / sizeof *PICTURES };

/* Read the first bytes of a file, or with `end` the last; returns how many, or
 * -1 if it is no regular file that can be read. */
static int read_part(const char *path, bool end, char part[HEAD]) {
  struct stat status;
  if (stat(path, &status) != 0 || !S_ISREG(status.st_mode)) return -1;
  FILE *f = fopen(path, "rb");
  if (f == NULL) return -1;
  if (end && status.st_size > HEAD) fseek(f, -(long)HEAD, SEEK_END);
  const size_t n = fread(part, 1, HEAD, f);
  fclose(f);
  return (int)n;
}

/* Do the n bytes begin as those of ours do, as far as a crash let them come? */
static bool begins_with(const char *part, int n, const char *begin) {
  const size_t m = strlen(begin), least = (size_t)n < m ? (size_t)n : m;
  return memcmp(part, begin, least) == 0;
}

static bool holds(const char *part, int n, const char *words) {
  const int m = (int)strlen(words);
  for (int k = 0; k + m <= n; k++)
    if (memcmp(part + k, words, (size_t)m) == 0) return true;
  return false;
}

static bool exists(const char *path) {
  struct stat status;
  return lstat(path, &status) == 0;
}

/* Does the directory hold a run of ours? An empty series.csv is no proof. */
static bool holds_run(const char *directory) {
  char part[HEAD], *path = output_path(directory, FILES[0].name);
  const int n = read_part(path, false, part);
  mem_free(path);
  return n >= (int)strlen(FILES[0].begin) &&
         begins_with(part, n, FILES[0].begin);
}

/* Is the file absent, empty or of a run of ours? Of what is no table it is
 * enough that the directory holds a run. */
static bool is_ours(const char *directory, const char *name, bool run) {
  char part[HEAD], *path = output_path(directory, name);
  const int n = exists(path) ? read_part(path, false, part) : 0;
  bool ours = n == 0 || (n > 0 && run && strstr(name, ".csv") == NULL);
  mem_free(path);
  for (int k = 0; k < NFILES && n > 0; k++)
    if (strcmp(FILES[k].name, name) == 0 &&
        begins_with(part, n, FILES[k].begin))
      ours = true;
  return ours;
}

/* Is it the name of the snapshot `first` or a later one? */
static bool is_snapshot(const char *name, int first) {
  int number, end = 0;
  return sscanf(name, "snapshot-%d.h5%n", &number, &end) == 1 && end > 0 &&
         name[end] == '\0' && number >= first && strlen(name) < NAME_LENGTH;
}

/* Find a file of a run's names that is not ours, on rank 0; its name, or "".
 */
static void find_foreign(const char *directory, char name[NAME_LENGTH]) {
  const bool run = holds_run(directory);
  name[0] = '\0';
  for (int k = 0; k < NFILES && name[0] == '\0'; k++)
    if (!is_ours(directory, FILES[k].name, run)) strcpy(name, FILES[k].name);
  DIR *list = name[0] == '\0' ? opendir(directory) : NULL;
  if (list == NULL) return;
  for (struct dirent *entry; (entry = readdir(list)) != NULL;)
    if (is_snapshot(entry->d_name, 0) &&
        !is_ours(directory, entry->d_name, run))
      strcpy(name, entry->d_name);
  closedir(list);
}

void old_run_check(const char *directory) {
  char name[NAME_LENGTH] = "";
  if (base_rank() == 0) find_foreign(directory, name);
  if (base_size() > 1)
    MPI_CHECK(MPI_Bcast(name, NAME_LENGTH, MPI_CHAR, 0, MPI_COMM_WORLD));
  if (name[0] != '\0')
    USER_ERROR(
        "'%s/%s' would be written over, and no run of talus left it there; "
        "choose another directory with -o DIR, or move it away",
        directory, name);
}

bool old_run_time(const char *directory, double *time) {
  bool found = false;
  if (base_rank() != 0) return false;
  char *path = output_path(directory, "series.csv");
  FILE *f = fopen(path, "r");
  mem_free(path);
  if (f == NULL) return false;
  struct csv_row row = {0};
  double step;
  while (csv_row_read(f, &row))
    if (csv_row_number(&row, 0, &step) && csv_row_number(&row, 1, time))
      found = true;
  csv_row_free(&row);
  fclose(f);
  return found;
}

/* Remove a file; a directory that loses files while we write is no reason to
 * stop. */
static void remove_file(const char *directory, const char *name) {
  char *path = output_path(directory, name);
  unlink(path);
  mem_free(path);
}

/* Remove a picture that talus plot has signed. */
static void remove_picture(const char *directory, const char *name) {
  char part[2][HEAD], *path = output_path(directory, name);
  const int n = read_part(path, false, part[0]);
  const int m = read_part(path, true, part[1]);
  if (holds(part[0], n, SIGNATURE) || holds(part[1], m, SIGNATURE))
    unlink(path);
  else if (exists(path))
    fprintf(stderr,
            "talus: '%s' stays: this version of talus plot has not drawn it\n",
            path);
  mem_free(path);
}

/* Wait for all ranks, so that nobody writes before the old files are gone. */
static void wait_for_others(void) {
  if (base_size() > 1) MPI_CHECK(MPI_Barrier(MPI_COMM_WORLD));
}

void old_run_remove_snapshots(const char *directory, int first) {
  DIR *list = base_rank() == 0 ? opendir(directory) : NULL;
  for (struct dirent *entry; list != NULL && (entry = readdir(list)) != NULL;)
    if (is_snapshot(entry->d_name, first))
      remove_file(directory, entry->d_name);
  if (list != NULL) closedir(list);
  wait_for_others();
}

void old_run_remove(const char *directory) {
  static const char *const name[] = {"checkpoint.h5", "checkpoint.h5.tmp",
                                     "run.log", "snapshots.xdmf"};
  for (int k = 0; k < 4 && base_rank() == 0; k++)
    remove_file(directory, name[k]);
  for (int k = 0; k < NPICTURES && base_rank() == 0; k++)
    remove_picture(directory, PICTURES[k]);
  old_run_remove_snapshots(directory, 0);
}
