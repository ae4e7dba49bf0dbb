/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/seal.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

#include "disk.h"
#include "talus/error.h"
#include "talus/memory.h"

enum { PIECE = 1 << 20 }; /* bytes read at once */

/* Contents of the text of a seal. */
struct seal {
  int format;
  char version[SEAL_VERSION_LENGTH];
  int64_t length;
  uint32_t checksum;
};

static uint32_t checksum(uint32_t start, const void *data, size_t n) {
  return (uint32_t)crc32(start, data, (uInt)n);
}

/* Write the first SEAL_LENGTH bytes of a file with this seal. */
static void print_seal(const struct seal *seal, char block[SEAL_LENGTH]) {
  memset(block, 0, SEAL_LENGTH);
  int n = snprintf(block, SEAL_LENGTH,
                   "talus checkpoint\nformat %d\nversion %s\nlength %" PRId64
                   "\ncrc32 %08" PRIx32 "\n",
                   seal->format, seal->version, seal->length, seal->checksum);
  const uint32_t own = checksum(0, block, (size_t)n);
  snprintf(block + n, SEAL_LENGTH - (size_t)n, "seal %08" PRIx32 "\n", own);
}

/* Read the text back; false unless it is to the bit what we would print. */
static bool read_seal(const char block[SEAL_LENGTH], struct seal *seal) {
  char text[SEAL_LENGTH + 1], again[SEAL_LENGTH];
  memcpy(text, block, SEAL_LENGTH);
  text[SEAL_LENGTH] = '\0';
  if (sscanf(text,
             "talus checkpoint\nformat %d\nversion %31s\nlength %" SCNd64
             "\ncrc32 %8" SCNx32,
             &seal->format, seal->version, &seal->length, &seal->checksum) != 4)
    return false;
  print_seal(seal, again);
  return memcmp(block, again, SEAL_LENGTH) == 0;
}

/* Read n bytes from `place` on; returns 0 or an errno, EIO at the end. */
static int read_bytes(int file, int64_t place, size_t n, char *data) {
  while (n > 0) {
    const ssize_t got = pread(file, data, n, (off_t)place);
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return got < 0 ? errno : EIO;
    place += got, data += got, n -= (size_t)got;
  }
  return 0;
}

/* Add up the bytes [begin, end) of a file; returns 0 or an errno. */
static int add_up(const char *path, int64_t begin, int64_t end, uint32_t *sum) {
  int file = open(path, O_RDONLY), error = file < 0 ? errno : 0;
  char *data = MEM_NEW(char, PIECE);
  *sum = checksum(0, NULL, 0);
  while (error == 0 && begin < end) {
    const size_t n = end - begin < PIECE ? (size_t)(end - begin) : PIECE;
    error = read_bytes(file, begin, n, data);
    if (error == 0) *sum = checksum(*sum, data, n);
    begin += (int64_t)n;
  }
  mem_free(data);
  if (file >= 0) close(file);
  return error;
}

/* Find the checksum of the bytes between the seal and `length`, on all ranks.
 * Returns 0 or the errno of some rank. */
static int add_up_shares(MPI_Comm comm, const char *path, int64_t length,
                         uint32_t *sum) {
  int rank, nranks;
  MPI_CHECK(MPI_Comm_rank(comm, &rank));
  MPI_CHECK(MPI_Comm_size(comm, &nranks));
  const int64_t all = length - SEAL_LENGTH;
  const int64_t begin = all / nranks * rank;
  const int64_t end = rank + 1 < nranks ? all / nranks * (rank + 1) : all;
  uint32_t own = 0;
  int error = add_up(path, SEAL_LENGTH + begin, SEAL_LENGTH + end, &own);
  MPI_CHECK(MPI_Allreduce(MPI_IN_PLACE, &error, 1, MPI_INT, MPI_MAX, comm));
  uint32_t *share = MEM_NEW(uint32_t, nranks);
  MPI_CHECK(MPI_Allgather(&own, 1, MPI_UINT32_T, share, 1, MPI_UINT32_T, comm));
  *sum = checksum(0, NULL, 0);
  for (int r = 0; r < nranks; r++) {
    const int64_t n =
        r + 1 < nranks ? all / nranks : all - all / nranks * (nranks - 1);
    *sum = (uint32_t)crc32_combine(*sum, share[r], (z_off_t)n);
  }
  mem_free(share);
  return error;
}

/* Put the seal in its place and sync the file; returns 0 or an errno. */
static int put_seal(const char *path, const char block[SEAL_LENGTH]) {
  int file = open(path, O_WRONLY), error = 0;
  if (file < 0) return errno;
  for (size_t n = 0; error == 0 && n < SEAL_LENGTH;) {
    const ssize_t put = pwrite(file, block + n, SEAL_LENGTH - n, (off_t)n);
    if (put < 0 && errno != EINTR) error = errno;
    if (put > 0) n += (size_t)put;
  }
  if (error == 0 && fsync(file) != 0) error = errno;
  if (close(file) != 0 && error == 0) error = errno;
  return error;
}

void seal_write(MPI_Comm comm, const char *path, int format) {
  struct seal seal = {.format = format};
  struct stat status;
  int rank, error = 0;
  MPI_CHECK(MPI_Comm_rank(comm, &rank));
  if (rank == 0 && stat(path, &status) != 0) disk_fail(path, errno);
  if (rank == 0) seal.length = (int64_t)status.st_size;
  MPI_CHECK(MPI_Bcast(&seal.length, 1, MPI_INT64_T, 0, comm));
  snprintf(seal.version, sizeof seal.version, "%s", TALUS_VERSION);
  error = add_up_shares(comm, path, seal.length, &seal.checksum);
  if (error != 0) disk_fail(path, error);
  if (rank == 0) {
    char block[SEAL_LENGTH];
    print_seal(&seal, block);
    error = put_seal(path, block);
    if (error != 0) disk_fail(path, error);
  }
  MPI_CHECK(MPI_Barrier(comm));
}

/* Read what stands first in a file; false, with the reason, if that fails. */
static bool read_head(const char *path, char block[SEAL_LENGTH],
                      int64_t *length, struct seal_report *report) {
  struct stat status;
  int error = stat(path, &status) != 0 ? errno : 0;
  if (error == 0 && !S_ISREG(status.st_mode)) {
    snprintf(report->reason, sizeof report->reason, "it is no regular file");
    return false;
  }
  int file = error == 0 ? open(path, O_RDONLY) : -1;
  if (error == 0 && file < 0) error = errno;
  memset(block, 0, SEAL_LENGTH);
  if (error == 0) {
    *length = (int64_t)status.st_size;
    const int64_t n = *length < SEAL_LENGTH ? *length : SEAL_LENGTH;
    error = read_bytes(file, 0, (size_t)n, block);
  }
  if (file >= 0) close(file);
  if (error != 0)
    snprintf(report->reason, sizeof report->reason, "%s", strerror(error));
  return error == 0;
}

/* Judge the head of a file by itself; SEAL_SOUND if the rest must decide. */
static void judge_head(const char *path, struct seal *seal,
                       struct seal_report *report) {
  static const char first[] = "talus checkpoint\n";
  static const char hdf5[8] = {'\x89', 'H', 'D', 'F', '\r', '\n', '\x1a', '\n'};
  char block[SEAL_LENGTH];
  int64_t length = 0;
  report->verdict = SEAL_NONE;
  if (!read_head(path, block, &length, report)) return;
  if (strncmp(block, first, sizeof first - 1) == 0)
    report->verdict = SEAL_DAMAGED;
  if (memcmp(block, hdf5, sizeof hdf5) == 0) {
    report->verdict = SEAL_UNSEALED;
  } else if (!read_seal(block, seal)) {
    snprintf(report->reason, sizeof report->reason, "it has no sound seal");
  } else if (seal->length != length || length < SEAL_LENGTH) {
    snprintf(report->reason, sizeof report->reason,
             "it has %" PRId64 " bytes, %" PRId64 " were written", length,
             seal->length);
  } else {
    report->verdict = SEAL_SOUND;
    report->format = seal->format;
    strcpy(report->version, seal->version);
  }
}

void seal_check(MPI_Comm comm, const char *path, struct seal_report *report) {
  struct seal seal = {.length = SEAL_LENGTH};
  uint32_t sum = 0;
  int rank;
  MPI_CHECK(MPI_Comm_rank(comm, &rank));
  memset(report, 0, sizeof *report);
  if (rank == 0) judge_head(path, &seal, report);
  MPI_CHECK(MPI_Bcast(report, sizeof *report, MPI_BYTE, 0, comm));
  MPI_CHECK(MPI_Bcast(&seal, sizeof seal, MPI_BYTE, 0, comm));
  if (report->verdict != SEAL_SOUND) return;
  const int error = add_up_shares(comm, path, seal.length, &sum);
  if (error == 0 && sum == seal.checksum) return;
  report->verdict = SEAL_DAMAGED;
  if (error != 0)
    snprintf(report->reason, sizeof report->reason, "some rank reads: %s",
             strerror(error));
  else
    snprintf(report->reason, sizeof report->reason,
             "its checksum is %08" PRIx32 ", %08" PRIx32 " was written", sum,
             seal.checksum);
}
