/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Hash table from (64-bit key, tag) to a 32-bit value >= 0, open addressing. */
#ifndef TALUS_HASH_H
#define TALUS_HASH_H

#include <stdint.h>

#include "talus/memory.h"

struct hash_slot {
  uint64_t key;
  int32_t tag;
  int32_t next_value; /* value + 1; 0: empty, as memory comes */
};

struct hash {
  struct hash_slot *slot;
  uint64_t mask; /* slots - 1 */
  int64_t n;
};

static inline uint64_t hash_start(uint64_t key, int32_t tag) {
  uint64_t h = (key + (uint64_t)(uint32_t)tag * 0x9e3779b97f4a7c15u);
  h ^= h >> 29;
  h *= 0xbf58476d1ce4e5b9u;
  return h ^ h >> 32;
}

static inline void hash_begin(struct hash *t, int64_t expected) {
  uint64_t size = 64;
  while (size < 2 * (uint64_t)expected) size *= 2;
  t->slot = MEM_NEW(struct hash_slot, size);
  t->mask = size - 1;
  t->n = 0;
}

static inline void hash_end(struct hash *t) { mem_free(t->slot); }

/* Return the slot that holds (key, tag), or the empty one where it belongs. */
static inline struct hash_slot *hash_place(const struct hash *t, uint64_t key,
                                           int32_t tag) {
  uint64_t i = hash_start(key, tag) & t->mask;
  while (t->slot[i].next_value != 0 &&
         (t->slot[i].key != key || t->slot[i].tag != tag)) {
    i = (i + 1) & t->mask;
  }
  return &t->slot[i];
}

/* Return the value of (key, tag), or -1. */
static inline int32_t hash_find(const struct hash *t, uint64_t key,
                                int32_t tag) {
  return hash_place(t, key, tag)->next_value - 1;
}

static inline void hash_insert(struct hash *t, uint64_t key, int32_t tag,
                               int32_t value) {
  if (2 * (uint64_t)(t->n + 1) > t->mask) {
    struct hash old = *t;
    hash_begin(t, 2 * (old.n + 1));
    for (uint64_t i = 0; i <= old.mask; i++) {
      if (old.slot[i].next_value != 0) {
        *hash_place(t, old.slot[i].key, old.slot[i].tag) = old.slot[i];
        t->n++;
      }
    }
    hash_end(&old);
  }
  *hash_place(t, key, tag) =
      (struct hash_slot){.key = key, .tag = tag, .next_value = value + 1};
  t->n++;
}

#endif
