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
