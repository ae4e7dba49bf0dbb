/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Checksums of what a case says, to be compared between ranks. */
#include <string.h>

#include "case_file.h"

/* Compute FNV-1a, 64 bits [Fowler, Noll & Vo]. */
uint64_t checksum_add(uint64_t checksum, const void *data, size_t n) {
  const unsigned char *byte = (const unsigned char *)data;
  for (size_t i = 0; i < n; i++)
    checksum = (checksum ^ byte[i]) * UINT64_C(1099511628211);
  return checksum;
}

static uint64_t add_text(uint64_t checksum, const char *text) {
  return checksum_add(checksum, text, strlen(text) + 1);
}

const char *case_checksum(const struct case_file *file, int i,
                          uint64_t *checksum) {
  *checksum = UINT64_C(14695981039346656037);
  if (i < file->nrows) {
    const struct row *row = &file->rows[i];
    *checksum = add_text(add_text(*checksum, row->key), row->value);
    return row->key;
  }
  i -= file->nrows;
  if (i >= file->nfunctions) return NULL;
  const struct case_function *function = &file->functions[i];
  *checksum = add_text(*checksum, function->path) ^ function->checksum;
  return function->path;
}
