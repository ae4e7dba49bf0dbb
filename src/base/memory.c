/* SPDX-License-Identifier: GPL-3.0-or-later */
#define _DEFAULT_SOURCE /* madvise */
#include "talus/memory.h"

#include <malloc.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/resource.h>

#include "talus/error.h"

enum {
  MEM_SMALL_HEAD = 16,     /* keeps the alignment of calloc */
  MEM_PAGE = 4096,         /* bytes after which lines of a cache repeat */
  MEM_STAGGERED = 1 << 16, /* bytes of arrays that start in turn */
  MEM_TURN = 11,           /* lines from one to the next */
  MEM_HUGE = 1 << 22       /* bytes that hold a large page for certain */
};

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

/* Return how far an array lies behind the start of its block. A block of whole
 * pages starts at one place of a page, so that arrays that are read side by
 * side would want the same few lines of a cache: theirs start on lines of a
 * page in turn. */
static size_t head_bytes(size_t bytes) {
  static unsigned turn;
  const size_t lines = MEM_PAGE / MEM_ALIGNMENT;
  if (bytes < MEM_LARGE) return MEM_SMALL_HEAD;
  if (bytes < MEM_STAGGERED) return MEM_ALIGNMENT;
  return MEM_ALIGNMENT * (1 + MEM_TURN * turn++ % lines);
}

/* Write the length of its head before an array and return the array. */
static void *array_of(void *block, size_t head) {
  char *p = (char *)block + head;
  memcpy(p - sizeof head, &head, sizeof head);
  return p;
}

static size_t head_of(const void *p) {
  size_t head;
  memcpy(&head, (const char *)p - sizeof head, sizeof head);
  return head;
}

static void *block_of(void *p) { return (char *)p - head_of(p); }

/* Ask for large pages for a block that has some: fewer of them to clear and to
 * look up. */
static void use_large_pages(void *block, size_t bytes) {
#ifdef MADV_HUGEPAGE
  char *begin = (char *)block - (uintptr_t)block % MEM_PAGE;
  if (bytes >= MEM_HUGE) madvise(begin, bytes, MADV_HUGEPAGE);
#endif
}

/* Allocate a zeroed array on a cache line. The system gives large blocks pages
 * of zeros that take room when they are written to, not before. */
static void *alloc_aligned(size_t bytes) {
  const size_t head = head_bytes(bytes), room = head + bytes + MEM_ALIGNMENT;
  void *block = fail_unless_allocated(calloc(room, 1), bytes);
  use_large_pages(block, room);
  return array_of(block, head + -(uintptr_t)block % MEM_ALIGNMENT);
}

void *mem_alloc(size_t count, size_t size) {
  size_t bytes = array_bytes(count, size);
  void *p;
  if (bytes < MEM_LARGE) {
    const size_t head = head_bytes(bytes);
    p = array_of(fail_unless_allocated(calloc(head + bytes, 1), bytes), head);
  } else {
    p = alloc_aligned(bytes);
  }
  live_blocks++;
  return p;
}

void *mem_resize(void *p, size_t count, size_t size) {
  if (p == NULL) return mem_alloc(count, size);
  const size_t bytes = array_bytes(count, size), head = head_of(p);
  void *block =
      fail_unless_allocated(realloc(block_of(p), head + bytes), bytes);
  void *q = (char *)block + head;
  if (bytes < MEM_LARGE || (uintptr_t)q % MEM_ALIGNMENT == 0) return q;
  /* realloc forgets the alignment of large blocks. */
  void *aligned = alloc_aligned(bytes);
  memcpy(aligned, q, bytes);
  free(block);
  return aligned;
}

void mem_free(void *p) {
  if (p == NULL) return;
  live_blocks--;
  free(block_of(p));
}

int64_t mem_live_blocks(void) { return live_blocks; }

int64_t mem_peak_resident(void) {
  struct rusage usage;
  getrusage(RUSAGE_SELF, &usage);
  return (int64_t)usage.ru_maxrss * 1024; /* kilobytes on Linux */
}
