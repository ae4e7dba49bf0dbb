/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/shape_memory.h"

#include <math.h>
#include <stdbool.h>
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
  static const uint64_t factor[] = {UINT64_C(0x9e3779b97f4a7c15),
                                    UINT64_C(0xbf58476d1ce4e5b9),
                                    UINT64_C(0x94d049bb133111eb)};
  uint64_t sum = 0;
  for (int d = 0; d < 3; d++) {
    uint64_t bits;
    memcpy(&bits, &x[d], sizeof bits);
    sum += (bits ^ bits >> 29) * factor[d];
  }
  return (uint32_t)(sum >> (64 - BITS));
}

static inline bool is_same(const double a[3], const double b[3]) {
  return a[0] == b[0] && a[1] == b[1] && a[2] == b[2];
}

double shape_memory_value(void *context, const double x[3]) {
  const struct shape_memory *memory = (const struct shape_memory *)context;
  struct entry *entry = &memory->entry[place_of(x)];
  if (is_same(entry->x, x)) return entry->value;
  *entry = (struct entry){{x[0], x[1], x[2]}, memory->f(memory->context, x)};
  return entry->value;
}
