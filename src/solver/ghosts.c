/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Nodes of a hierarchy on other ranks.
 *
 * A link that could not be followed from the parents is looked up by key. If
 * the node would be another rank's, that rank is asked whether it exists; if
 * not, the leaf one level coarser does. */
#include <string.h>

#include "linking.h"
#include "talus/count.h"
#include "talus/error.h"
#include "talus/memory.h"

int32_t ghosts_get(struct linking *k, uint64_t key, int level) {
  int32_t g = hash_find(&k->ghosts, key, level);
  if (g >= 0) return k->h->nowned + g;
  if (k->nghosts == k->ghost_capacity) {
    count_check((int64_t)k->h->nowned + k->nghosts + 1, INT32_MAX / 2,
                "nodes of the hierarchy");
    k->ghost_capacity = k->ghost_capacity ? 2 * k->ghost_capacity : 64;
    const size_t n = (size_t)k->ghost_capacity;
    k->ghost_key = mem_resize(k->ghost_key, n, sizeof *k->ghost_key);
    k->ghost_level = mem_resize(k->ghost_level, n, sizeof *k->ghost_level);
  }
  g = k->nghosts++;
  k->ghost_key[g] = key;
  k->ghost_level[g] = (int8_t)level;
  hash_insert(&k->ghosts, key, level, g);
  return k->h->nowned + g;
}

/* Questions to other ranks, and what they said. */
struct questions {
  struct hash hash; /* (key, level) -> number */
  struct plan_request *request;
  int32_t n, capacity;
  double *answer; /* [n] 1: the node exists */
};

static int32_t question_add(struct questions *q, uint64_t key, int level,
                            int rank) {
  if (q->n == q->capacity) {
    count_check(q->n, INT32_MAX / 4, "questions");
    q->capacity = q->capacity ? 2 * q->capacity : 64;
    q->request =
        mem_resize(q->request, (size_t)q->capacity, sizeof *q->request);
  }
  q->request[q->n] = (struct plan_request){key, level, rank, q->n};
  hash_insert(&q->hash, key, level, q->n);
  return q->n++;
}

static int32_t get_existing(struct linking *k, uint64_t key, int level) {
  if (linking_owner(k, level, key) != k->rank) return ghosts_get(k, key, level);
  const int32_t slot = linking_find(k, level, key);
  CHECK(slot >= 0, "node of level %d not found: grid not balanced?", level);
  return slot;
}

/* Return the slot of the node that covers (key, level); SLOT_UNKNOWN while its
 * rank has not been asked. */
static int32_t resolve(struct linking *k, struct questions *q, uint64_t key,
                       int level) {
  const uint64_t parent = level > 0 ? key_align(key, level - 1) : key;
  const int owner = linking_owner(k, level, key);
  if (owner == k->rank) {
    const int32_t slot = linking_find(k, level, key);
    return slot >= 0 ? slot : get_existing(k, parent, level - 1);
  }
  int32_t number = hash_find(&q->hash, key, level);
  if (number < 0) number = question_add(q, key, level, owner);
  if (!q->answer) return SLOT_UNKNOWN;
  return q->answer[number] > 0 ? ghosts_get(k, key, level)
                               : get_existing(k, parent, level - 1);
}

static void resolve_links(struct linking *k, struct questions *q) {
  struct hierarchy *h = k->h;
  for (int32_t i = 0; i < h->nactive; i++) {
    uint64_t key;
    if (!k->wanted[i]) continue;
    int offset[DIM];
    for (int f = 0; f < NFACE; f++) {
      if (h->neighbour[f][i] != SLOT_UNKNOWN) continue;
      links_face_offset(f, offset);
      if (linking_place(k, k->key[i], k->level_of[i], offset, &key)) {
        h->wall[i] = (uint8_t)(h->wall[i] | 1 << f);
        h->neighbour[f][i] = i;
      } else {
        h->neighbour[f][i] = resolve(k, q, key, k->level_of[i]);
      }
    }
    for (int e = 0; e < NCORNER; e++) {
      if (h->corner[e][i] != SLOT_UNKNOWN) continue;
      links_corner_offset(e, offset);
      linking_place(k, k->key[i], k->level_of[i], offset, &key);
      h->corner[e][i] =
          key == k->key[i] ? i : resolve(k, q, key, k->level_of[i]);
    }
  }
}

static void ask(struct linking *k, struct questions *q) {
  struct plan plan;
  int64_t nasked;
  plan_begin(&plan, k->h->mesh->comm);
  struct plan_request *asked = plan_ask(&plan, q->n, q->request, &nasked);
  const int64_t n = q->n > nasked ? q->n : nasked;
  /* Answers travel through one array: ours to give behind those we get. */
  double *v = MEM_NEW(double, 2 * n);
  for (int64_t j = 0; j < nasked; j++) {
    plan.send_index[j] = count_index(n + j, "answers");
    v[n + j] = linking_find(k, asked[j].tag, asked[j].key) >= 0;
  }
  plan_run(&plan, 1, &v, 1, false);
  q->answer = v;
  mem_free(asked);
  plan_end(&plan);
}

static void make_plans(struct linking *k, int l) {
  struct hierarchy *h = k->h;
  struct plan *copy = &h->level[l].copy, *add = &h->level[l].add;
  struct plan_request *request = MEM_NEW(struct plan_request, k->nghosts);
  int64_t n = 0, nasked;
  for (int32_t g = 0; g < k->nghosts; g++) {
    if (k->ghost_level[g] != l) continue;
    request[n++] = (struct plan_request){k->ghost_key[g], l,
                                         linking_owner(k, l, k->ghost_key[g]),
                                         h->nowned + g};
  }
  struct plan_request *asked = plan_ask(copy, n, request, &nasked);
  for (int64_t j = 0; j < nasked; j++) {
    copy->send_index[j] = linking_find(k, l, asked[j].key);
    CHECK(copy->send_index[j] >= 0, "asked for an unknown node");
  }
  mem_free(add->send_begin);
  mem_free(add->recv_begin);
  add->send_begin = copy->recv_begin;
  add->send_index = copy->recv_index;
  add->recv_begin = copy->send_begin;
  add->recv_index = copy->send_index;
  mem_free(asked);
  mem_free(request);
}

/* Find links of the wanted slots that could not be followed. */
static void find_links(struct linking *k) {
  struct questions q = {.n = 0};
  hash_begin(&q.hash, 0);
  resolve_links(k, &q);
  ask(k, &q);
  resolve_links(k, &q);
  hash_end(&q.hash);
  mem_free(q.request);
  mem_free(q.answer);
}

/* Give all ghosts a row of links, and want those of coarser leaves next to
 * our nodes, whose slopes are needed. */
static void want_coarse_leaves(struct linking *k) {
  struct hierarchy *h = k->h;
  const int32_t nknown = h->nactive, n = h->nowned + k->nghosts;
  links_grow(k, n);
  memset(k->wanted, 0, (size_t)n);
  for (int32_t i = 0; i < nknown; i++) {
    for (int f = 0; f < NFACE; f++) {
      const int32_t j = h->neighbour[f][i];
      if (j >= nknown && k->level_of[j] < k->level_of[i]) k->wanted[j] = 1;
    }
  }
}

void ghosts_make(struct linking *k) {
  memset(k->wanted, 1, (size_t)k->h->nactive);
  find_links(k);
  want_coarse_leaves(k);
  find_links(k);
  for (int l = 0; l < k->h->nlevels; l++) make_plans(k, l);
}
