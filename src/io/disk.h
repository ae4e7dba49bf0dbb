/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Last words on a file that cannot be written, with what may be the cause. */
#ifndef TALUS_DISK_H
#define TALUS_DISK_H

/* Say what to try after `error`, an errno, on `path`: a directory that is gone
 * is named, a lack of space asked about; "" where the words of the system are
 * enough. The text is static. */
const char *disk_advice(const char *path, int error);

/* Ends the program (FATAL): `path` cannot be written, for this errno. */
_Noreturn void disk_fail(const char *path, int error);

/* Judge an errno of fsync: 0 for a file system that cannot sync. */
int disk_sync_error(int error);

/* Bring the directory of a file to the disk, so that the names in it last. File
 * systems that cannot do it are passed over. */
void disk_sync_directory(const char *file);

#endif
