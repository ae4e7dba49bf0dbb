/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/shape_memory.h"

#include <math.h>
#include <stdint.h>
#include <string.h>

#include "talus/memory.h"

/* More than the corners of 32^3 leaves, which follow each other in the order of
 * the tree, in 1 MiB. */
enum { BITS = 15, NENTRIES = 1 << BITS };

struct entry {
  double x[3], value;
};

struct shape_memory {
  shape_level_set f;
  void *context;
  struct entry *entry; /* [NENTRIES], owned */
};

struct shape_memory *shape_memory_new(shape_level_set f, void *context) {
  struct shape_memory *memory = MEM_NEW(struct shape_memory, 1);
  *memory = (struct shape_memory){f, context, MEM_NEW(struct entry, NENTRIES)};
  for (int k = 0; k < NENTRIES; k++) {
    memory->entry[k].x[0] = NAN; /* as no point has */
  }
  return memory;
}

void shape_memory_destroy(struct shape_memory *memory) {
  mem_free(memory->entry);
  mem_free(memory);
}

/* Return the place of a point: multiplicative hashing of its bits. */
static uint32_t place_of(const double x[3]) {
  uint64_t sum = 0;
  for (int d = 0; d < 3; d++) {
    uint64_t bits;
    memcpy(&bits, &x[d], sizeof bits);
    sum = (sum ^ bits ^ bits >> 29) * UINT64_C(0x9e3779b97f4a7c15);
  }
  return (uint32_t)(sum >> (64 - BITS));
}

double shape_memory_value(void *context, const double x[3]) {
  const struct shape_memory *memory = (const struct shape_memory *)context;
  struct entry *entry = &memory->entry[place_of(x)];
  if (memcmp(entry->x, x, sizeof entry->x) == 0) return entry->value;
  *entry = (struct entry){{x[0], x[1], x[2]}, memory->f(memory->context, x)};
  return entry->value;
}
