/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/memory.h"

#include <malloc.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>

#include "talus/error.h"

static int64_t live_blocks;

void mem_begin(void) {
#ifdef M_MMAP_THRESHOLD /* glibc, which raises it as it goes unless told */
  mallopt(M_MMAP_THRESHOLD, 1 << 20);
#endif
}

/* Return the bytes of an array, at least one so that every block has an
 * address. */
static size_t array_bytes(size_t count, size_t size) {
  /* Half the address space is more than any allocator gives, and leaves room
   * for rounding up. */
  const size_t most = SIZE_MAX / 2;
  if (size != 0 && count > most / size)
    FATAL("array of %zu elements of %zu bytes does not fit in memory", count,
          size);
  return count * size > 0 ? count * size : 1;
}

static void *fail_unless_allocated(void *p, size_t bytes) {
  if (p == NULL)
    FATAL(
        "out of memory while asking for %zu bytes; use fewer cells or more "
        "nodes",
        bytes);
  return p;
}

/* Allocate a block on a cache line, contents undefined. */
static void *alloc_aligned(size_t bytes) {
  /* C11 wants a multiple of the alignment. */
  size_t rounded = (bytes + MEM_ALIGNMENT - 1) / MEM_ALIGNMENT * MEM_ALIGNMENT;
  return fail_unless_allocated(aligned_alloc(MEM_ALIGNMENT, rounded), bytes);
}

void *mem_alloc(size_t count, size_t size) {
  size_t bytes = array_bytes(count, size);
  void *p;
  if (bytes < MEM_LARGE) {
    p = fail_unless_allocated(calloc(bytes, 1), bytes);
  } else {
    p = alloc_aligned(bytes);
    memset(p, 0, bytes);
  }
  live_blocks++;
  return p;
}

void *mem_resize(void *p, size_t count, size_t size) {
  if (p == NULL) return mem_alloc(count, size);
  size_t bytes = array_bytes(count, size);
  void *q = fail_unless_allocated(realloc(p, bytes), bytes);
  if (bytes < MEM_LARGE || (uintptr_t)q % MEM_ALIGNMENT == 0) return q;
  /* realloc forgets the alignment of large blocks. */
  void *aligned = alloc_aligned(bytes);
  memcpy(aligned, q, bytes);
  free(q);
  return aligned;
}

void mem_free(void *p) {
  if (p == NULL) return;
  live_blocks--;
  free(p);
}

int64_t mem_live_blocks(void) { return live_blocks; }

int64_t mem_peak_resident(void) {
  struct rusage usage;
  getrusage(RUSAGE_SELF, &usage);
  return (int64_t)usage.ru_maxrss * 1024; /* kilobytes on Linux */
}
