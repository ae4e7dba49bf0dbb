/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/lock.h"

#include <errno.h>
#include <fcntl.h>
#include <mpi.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "talus/error.h"
#include "talus/memory.h"

enum { WORDS_LENGTH = 256, TRIALS = 100, PLACE_LENGTH = 4096 };

/* Outcomes of an attempt, on rank 0. */
enum outcome { TAKEN, ABSENT, HELD, WITHOUT, REFUSED };

static int held = -1;   /* descriptor of run.lock; -1: no lock is held */
static char *held_path; /* owned */

/* The directory, as it was when lock_take was called; "" before. */
static char place[PLACE_LENGTH];
static struct stat place_status;

static char *lock_path(const char *directory) {
  size_t size = strlen(directory) + sizeof "/run.lock";
  char *path = MEM_NEW(char, size);
  snprintf(path, size, "%s/run.lock", directory);
  return path;
}

/* Is `file` still the one of this name? The one who held it may have removed
 * it in the meantime. */
static bool is_current(int file, const char *path) {
  struct stat mine, named;
  return fstat(file, &mine) == 0 && stat(path, &named) == 0 &&
         mine.st_ino == named.st_ino && mine.st_dev == named.st_dev;
}

/* Read who holds the lock, without the end of the line. */
static void read_holder(int file, char words[WORDS_LENGTH]) {
  const ssize_t n = pread(file, words, WORDS_LENGTH - 1, 0);
  words[n > 0 ? n : 0] = '\0';
  words[strcspn(words, "\n")] = '\0';
  if (words[0] == '\0') strcpy(words, "another process");
}

static void write_holder(int file) {
  char host[128] = "?", words[WORDS_LENGTH];
  gethostname(host, sizeof host - 1);
  int n = snprintf(words, sizeof words, "process %ld on %s\n", (long)getpid(),
                   host);
  const bool told =
      ftruncate(file, 0) == 0 && pwrite(file, words, (size_t)n, 0) == n;
  (void)told; /* a lock without a name holds as well */
}

/* Open and lock the file of this name, made if `flags` say so. */
static enum outcome try_lock(const char *path, int flags, int *file,
                             char words[WORDS_LENGTH]) {
  for (int k = 0; k < TRIALS; k++) {
    *file = open(path, O_RDWR | O_CLOEXEC | flags, 0666);
    if (*file < 0 && (errno == ENOENT || errno == ENOTDIR)) return ABSENT;
    if (*file < 0 && errno == ESTALE) continue;
    if (*file < 0) break;
    if (flock(*file, LOCK_EX | LOCK_NB) == 0) {
      if (is_current(*file, path)) return TAKEN;
    } else if (errno == EWOULDBLOCK) {
      read_holder(*file, words);
      close(*file);
      return HELD;
    } else if (errno != EINTR && errno != ESTALE) {
      snprintf(words, WORDS_LENGTH, "%s", strerror(errno));
      close(*file);
      return WITHOUT;
    }
    close(*file);
  }
  snprintf(words, WORDS_LENGTH, "%s", strerror(errno));
  return REFUSED;
}

/* Let all ranks end, or go on, with what rank 0 has found. */
static void conclude(const char *directory, enum outcome outcome,
                     const char *words) {
  int found = outcome;
  if (base_size() > 1)
    MPI_CHECK(MPI_Bcast(&found, 1, MPI_INT, 0, MPI_COMM_WORLD));
  if (found == HELD)
    SYSTEM_ERROR(
        "'%s' is in use by %s, a run that goes on there; wait for its end, "
        "stop it, or choose another directory with -o DIR",
        directory, words);
  if (found == REFUSED)
    USER_ERROR("cannot write '%s/run.lock': %s; choose another with -o DIR",
               directory, words);
}

void lock_check(const char *directory) {
  char words[WORDS_LENGTH] = "";
  enum outcome outcome = ABSENT;
  if (base_rank() == 0 && held < 0) {
    int file = -1;
    char *path = lock_path(directory);
    outcome = try_lock(path, 0, &file, words);
    if (outcome == TAKEN) close(file);
    mem_free(path);
  }
  conclude(directory, outcome == HELD ? HELD : ABSENT, words);
}

/* Take the lock on rank 0, and remember it. */
static enum outcome take(const char *directory, char words[WORDS_LENGTH]) {
  if (stat(directory, &place_status) == 0)
    snprintf(place, sizeof place, "%s", directory);
  char *path = lock_path(directory);
  int file = -1;
  const enum outcome outcome = try_lock(path, O_CREAT, &file, words);
  if (outcome == TAKEN) {
    write_holder(file);
    held = file;
    held_path = path;
    return outcome;
  }
  if (outcome == WITHOUT) {
    unlink(path);
    fprintf(stderr,
            "talus: warning: the file system of '%s' knows no locks (%s): see "
            "to it that no other run writes there\n",
            directory, words);
  }
  mem_free(path);
  return outcome;
}

void lock_take(const char *directory) {
  char words[WORDS_LENGTH] = "";
  enum outcome outcome = TAKEN;
  if (base_rank() == 0 && held < 0) outcome = take(directory, words);
  conclude(directory, outcome, words);
}

void lock_verify(void) {
  struct stat status;
  if (place[0] == '\0') return;
  if (stat(place, &status) == 0 && status.st_ino == place_status.st_ino &&
      status.st_dev == place_status.st_dev)
    return;
  FATAL(
      "the directory '%s' was removed, renamed or replaced while the run went "
      "on, so the run ends here; if it was renamed, --restart goes on from its "
      "last checkpoint under the new name",
      place);
}

void lock_release(void) {
  place[0] = '\0';
  if (held < 0) return;
  unlink(held_path); /* while it is ours: who opens it now looks again */
  close(held);
  mem_free(held_path);
  held = -1;
}
