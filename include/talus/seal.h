/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Seal of a file: proves that every byte is as it was written.
 *
 * The first SEAL_LENGTH bytes are text, then zeros:
 *
 *   talus checkpoint
 *   format 2             how the contents are laid out
 *   version 0.1          of the talus that wrote them
 *   length 48640         of the whole file, bytes
 *   crc32 0a1b2c3d       of all bytes after the seal
 *   seal 4e5f6071        crc32 of the lines above
 *
 * A file is sound if its first SEAL_LENGTH bytes are those that this text asks
 * for and the rest has that length and checksum. Any run of up to 32 wrong
 * bits is then found with certainty, other damage but for one in 2^32. HDF5
 * passes over the seal: it is the user block of the file (hdf5_create), so data
 * sets, attributes, layout, B-trees and unused bytes are covered alike.
 *
 * Writing and checking, each rank reads an even share of the file; the
 * checksums of the shares are combined.
 */
#ifndef TALUS_SEAL_H
#define TALUS_SEAL_H

#include <mpi.h>
#include <stddef.h>

enum { SEAL_LENGTH = 512, SEAL_VERSION_LENGTH = 32 };

enum seal_verdict {
  SEAL_SOUND,
  SEAL_DAMAGED,  /* it has a seal, but is not what was sealed */
  SEAL_UNSEALED, /* a bare HDF5 file, as talus wrote before format 2 */
  SEAL_NONE      /* missing, unreadable or something else */
};

struct seal_report {
  enum seal_verdict verdict;
  int format;                        /* of a sound file */
  char version[SEAL_VERSION_LENGTH]; /* of the talus that sealed it */
  char reason[128]; /* what is wrong, for a message; "" if SOUND or UNSEALED */
};

/* Seal a file whose first SEAL_LENGTH bytes are free, and bring it to the disk.
 * Collective; no rank may hold it open for writing. A failure of the disk ends
 * the program. */
void seal_write(MPI_Comm comm, const char *path, int format);

/* Check a file against its seal. Collective; the report is the same on all
 * ranks. */
void seal_check(MPI_Comm comm, const char *path, struct seal_report *report);

#endif
