/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Memory that is zeroed, counted and never NULL.
 *
 * Everything talus allocates comes from here, so that size overflow and lack of
 * memory are dealt with in one place and leaks show at the end of a debug run.
 * Blocks of MEM_LARGE bytes or more start on a cache line (MEM_ALIGNMENT), as
 * vector loads like it. Never hand a block to free() nor a foreign one to
 * mem_free(). Not collective; not for use inside kernels.
 */
#ifndef TALUS_MEMORY_H
#define TALUS_MEMORY_H

#include <stddef.h>
#include <stdint.h>

enum { MEM_ALIGNMENT = 64, MEM_LARGE = 1024 }; /* bytes */

/* Have the system take back what is freed of the arrays of large grids: else
 * the C library keeps it for later, up to a fifth of the peak. Called once,
 * before the first large array. */
void mem_begin(void);

/* A zeroed array of `count` objects of a type, the caller's to free. */
#define MEM_NEW(type, count) ((type *)mem_alloc((count), sizeof(type)))

/*
 * Allocate a zeroed array; ends the program (FATAL) if there is no room or
 * count * size overflows.
 *   count  number of elements, 0 allowed
 *   size   bytes of one element
 * returns  a block the caller owns, to be given to mem_free; never NULL
 */
void *mem_alloc(size_t count, size_t size)
    __attribute__((malloc, returns_nonnull));

/*
 * Change the size of a block and keep its contents up to the smaller of both
 * sizes. What is added has no defined value. Fails as mem_alloc does.
 *   p      block from mem_alloc or mem_resize, no longer valid afterwards;
 *          NULL gives a new zeroed block
 *   count  number of elements, 0 allowed
 *   size   bytes of one element
 * returns  the block, owned by the caller; never NULL
 */
void *mem_resize(void *p, size_t count, size_t size)
    __attribute__((returns_nonnull));

/* Free a block of mem_alloc or mem_resize; NULL is allowed. */
void mem_free(void *p);

/* Number of blocks of this rank that are not freed yet. */
int64_t mem_live_blocks(void);

/* Return the most memory this rank has held so far, libraries and all, in
 * bytes. */
int64_t mem_peak_resident(void);

#endif
