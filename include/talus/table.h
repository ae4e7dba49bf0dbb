/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Hash table from (64-bit key, tag) to a 32-bit value >= 0, open addressing. */
#ifndef TALUS_TABLE_H
#define TALUS_TABLE_H

#include <stdint.h>

#include "talus/memory.h"

struct table_slot {
  uint64_t key;
  int32_t tag;
  int32_t next_value; /* value + 1; 0: empty, as memory comes */
};

struct table {
  struct table_slot *slot;
  uint64_t mask; /* slots - 1 */
  int64_t n;
};

static inline uint64_t table_hash(uint64_t key, int32_t tag) {
  uint64_t h = (key + (uint64_t)(uint32_t)tag * 0x9e3779b97f4a7c15u);
  h ^= h >> 29;
  h *= 0xbf58476d1ce4e5b9u;
  return h ^ h >> 32;
}

static inline void table_begin(struct table *t, int64_t expected) {
  uint64_t size = 64;
  while (size < 2 * (uint64_t)expected) size *= 2;
  t->slot = MEM_NEW(struct table_slot, size);
  t->mask = size - 1;
  t->n = 0;
}

static inline void table_end(struct table *t) { mem_free(t->slot); }

/* Slot that holds (key, tag), or the empty one where it belongs. */
static inline struct table_slot *table_place(const struct table *t,
                                             uint64_t key, int32_t tag) {
  uint64_t i = table_hash(key, tag) & t->mask;
  while (t->slot[i].next_value != 0 &&
         (t->slot[i].key != key || t->slot[i].tag != tag)) {
    i = (i + 1) & t->mask;
  }
  return &t->slot[i];
}

/* Value of (key, tag), or -1. */
static inline int32_t table_find(const struct table *t, uint64_t key,
                                 int32_t tag) {
  return table_place(t, key, tag)->next_value - 1;
}

static inline void table_insert(struct table *t, uint64_t key, int32_t tag,
                                int32_t value) {
  if (2 * (uint64_t)(t->n + 1) > t->mask) {
    struct table old = *t;
    table_begin(t, 2 * (old.n + 1));
    for (uint64_t i = 0; i <= old.mask; i++) {
      if (old.slot[i].next_value != 0) {
        *table_place(t, old.slot[i].key, old.slot[i].tag) = old.slot[i];
        t->n++;
      }
    }
    table_end(&old);
  }
  *table_place(t, key, tag) =
      (struct table_slot){.key = key, .tag = tag, .next_value = value + 1};
  t->n++;
}

#endif
