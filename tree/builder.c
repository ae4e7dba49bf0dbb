/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "builder.h"

#include "talus/memory.h"

int32_t list_grow(void **list, int32_t *n, int32_t *capacity, size_t size) {
  count_check((int64_t)*n + 1, KIND_MOST, "nodes of a kind");
  if (*n == *capacity) {
    *capacity = *capacity ? 2 * *capacity : 256;
    *list = mem_resize(*list, (size_t)*capacity, size);
  }
  return (*n)++;
}

void request_add(struct builder *b, uint64_t key, int32_t tag, int rank,
                 int32_t index) {
  if (b->nrequests == b->request_capacity) {
    b->request_capacity = b->request_capacity ? 2 * b->request_capacity : 256;
    b->request =
        mem_resize(b->request, (size_t)b->request_capacity, sizeof *b->request);
  }
  b->request[b->nrequests++] = (struct plan_request){key, tag, rank, index};
}

int key_rank(const struct builder *b, uint64_t key) {
  int low = 0, high = b->mesh->nranks - 1;
  while (low < high) { /* last rank whose first key is <= key */
    int middle = (low + high + 1) / 2;
    if (b->first_keys[middle] <= key) {
      low = middle;
    } else {
      high = middle - 1;
    }
  }
  return low;
}

void index_begin(struct key_index *index, const uint64_t *key, int32_t n) {
  *index = (struct key_index){.key = key, .n = n};
  if (n == 0) return;
  while ((key[n - 1] - key[0]) >> index->shift >= 2 * (uint64_t)n) {
    index->shift++;
  }
  const uint64_t pieces = ((key[n - 1] - key[0]) >> index->shift) + 1;
  index->begin = MEM_NEW(int32_t, pieces + 1);
  int32_t i = 0;
  for (uint64_t k = 0; k <= pieces; k++) {
    while (i < n && (key[i] - key[0]) >> index->shift < k) i++;
    index->begin[k] = i;
  }
}

void index_end(struct key_index *index) { mem_free(index->begin); }

/* Return the number of the last key that is not above `key`, -1: none. */
static int32_t index_find(const struct key_index *index, uint64_t key) {
  if (index->n == 0 || key < index->key[0]) return -1;
  if (key >= index->key[index->n - 1]) return index->n - 1;
  const uint64_t piece = (key - index->key[0]) >> index->shift;
  int32_t low = index->begin[piece] - 1, high = index->begin[piece + 1];
  while (high - low > 1) { /* key[low] <= key < key[high] */
    const int32_t middle = low + (high - low) / 2;
    if (index->key[middle] <= key) {
      low = middle;
    } else {
      high = middle;
    }
  }
  return low;
}

int32_t leaf_at(const struct builder *b, uint64_t key) {
  const struct mesh *mesh = b->mesh;
  const uint64_t *first = b->first_keys + mesh->rank;
  if (key >= first[0] && key < first[1]) return index_find(&b->leaves, key);
  const int32_t ghost = index_find(&b->ghosts, key);
  if (ghost < 0) return -1;
  const int32_t i = mesh->nleaves + ghost;
  return key < mesh->key[i] + morton_span(mesh->level[i]) ? i : -1;
}
