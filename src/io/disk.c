/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "disk.h"

#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "talus/error.h"
#include "talus/memory.h"

/* Return the directory of a file; the caller frees it with mem_free. */
static char *directory_of(const char *path) {
  char *directory = MEM_NEW(char, strlen(path) + 2);
  strcpy(directory, path);
  char *slash = strrchr(directory, '/');
  if (slash == NULL)
    strcpy(directory, ".");
  else
    slash[slash == directory] = '\0';
  return directory;
}

static bool directory_is_gone(const char *path) {
  struct stat status;
  char *directory = directory_of(path);
  const bool gone = stat(directory, &status) != 0 &&
                    (errno == ENOENT || errno == ENOTDIR || errno == ESTALE);
  mem_free(directory);
  return gone;
}

const char *disk_advice(const char *path, int error) {
  if (directory_is_gone(path))
    return "; its directory was removed or renamed while the run went on";
  if (error == ENOENT || error == ESTALE)
    return "; it was removed or renamed while the run went on";
  if (error == ENOSPC || error == EDQUOT || error == EFBIG)
    return "; is there space left on the disk?";
  return "";
}

_Noreturn void disk_fail(const char *path, int error) {
  FATAL("cannot write '%s': %s%s", path, strerror(error),
        disk_advice(path, error));
}

int disk_sync_error(int error) {
  return error == EINVAL || error == EROFS || error == ENOSYS ? 0 : error;
}

void disk_sync_directory(const char *file) {
  char *path = directory_of(file);
  const int directory = open(path, O_RDONLY);
  if (directory >= 0) {
    fsync(directory);
    close(directory);
  }
  mem_free(path);
}
