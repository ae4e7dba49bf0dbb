/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Each rank joins its own leaves to pieces. A piece is known by the global
 * number of its first leaf. Then all ranks gather all pieces with their
 * volumes, and the links between pieces of two ranks, and join the pieces in
 * the same way, each for itself. */
#include "talus/droplets.h"

#include <mpi.h>
#include <stdlib.h>

#include "talus/count.h"
#include "talus/error.h"
#include "talus/forest.h"
#include "talus/memory.h"
#include "talus/mesh.h"

struct piece {
  double label; /* global number of the first leaf */
  double volume;
};

struct link { /* of two pieces, by label */
  double a, b;
};

/* Find the root of a set, the smallest index in it (union-find). */
static int32_t find_root(int32_t *parent, int32_t i) {
  while (parent[i] != i) i = parent[i] = parent[parent[i]];
  return i;
}

static void join(int32_t *parent, int32_t i, int32_t j) {
  if (parent[i] == parent[j]) return;
  i = find_root(parent, i);
  j = find_root(parent, j);
  if (i < j)
    parent[j] = i;
  else
    parent[i] = j;
}

/* Set parent [nleaves] to an earlier leaf of the piece, the first one its own;
 * -1 where there are no grains. */
static int32_t *join_leaves(const struct mesh *mesh, const double *c,
                            double threshold) {
  int32_t *parent = MEM_NEW(int32_t, (size_t)mesh->nleaves);
  for (int32_t i = 0; i < mesh->nleaves; i++)
    parent[i] = c[i] > threshold ? i : -1;
  for (int32_t f = 0; f < mesh->nfaces; f++) {
    int32_t i = mesh->face_leaf[f][0], j = mesh->face_leaf[f][1];
    if (i < 0 || j < 0 || i >= mesh->nleaves || j >= mesh->nleaves) continue;
    if (parent[i] >= 0 && parent[j] >= 0) join(parent, i, j);
  }
  return parent;
}

/* Number the pieces of this rank in order of their labels; returns how many.
 * The parent of a leaf becomes the number of its piece. */
static int number_pieces(const struct mesh *mesh, const double *c,
                         int32_t *parent, struct piece **pieces) {
  double first = (double)forest_first_leaf(mesh->forest);
  int n = 0;
  for (int32_t i = 0; i < mesh->nleaves; i++) n += parent[i] == i;
  *pieces = MEM_NEW(struct piece, (size_t)n);
  n = 0;
  double volume = 0; /* of piece `last` up to here */
  int32_t last = -1;
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    if (parent[i] < 0) continue;
    if (parent[i] == i) {
      (*pieces)[n].label = first + (double)i;
      parent[i] = n++;
    } else {
      parent[i] = parent[parent[i]]; /* an earlier leaf, numbered already */
    }
    if (parent[i] != last) {
      if (last >= 0) (*pieces)[last].volume = volume;
      last = parent[i];
      volume = (*pieces)[last].volume;
    }
    volume += c[i] * mesh_volume(mesh, i);
  }
  if (last >= 0) (*pieces)[last].volume = volume;
  return n;
}

static int compare_links(const void *p, const void *q) {
  const struct link *x = p, *y = q;
  if (x->a != y->a) return x->a < y->a ? -1 : 1;
  return x->b < y->b ? -1 : x->b > y->b;
}

/* Label leaves and ghosts, < 0: no grains. */
static double *label_leaves(const struct mesh *mesh, const int32_t *number,
                            const struct piece *pieces) {
  double *label = MEM_NEW(double, (size_t)(mesh->nleaves + mesh->nghosts));
  for (int32_t i = 0; i < mesh->nleaves; i++)
    label[i] = number[i] < 0 ? -1 : pieces[number[i]].label;
  mesh_fill_ghosts(mesh, 1, &label);
  return label;
}

/* List links across faces between this rank and others, each once. Every such
 * face is listed on one of its two ranks. number [nleaves] of pieces. */
static int list_links(const struct mesh *mesh, const int32_t *number,
                      const struct piece *pieces, struct link **links) {
  int n = 0, room = 0;
  *links = NULL;
  if (mesh->nranks == 1) return 0;
  double *label = label_leaves(mesh, number, pieces);
  for (int32_t f = 0; f < mesh->nfaces; f++) {
    int32_t i = mesh->face_leaf[f][0], j = mesh->face_leaf[f][1];
    if (i < 0 || j < 0 || (i < mesh->nleaves && j < mesh->nleaves)) continue;
    if (label[i] < 0 || label[j] < 0) continue;
    if (n == room) {
      room = 2 * room + 16;
      *links = mem_resize(*links, (size_t)room, sizeof **links);
    }
    (*links)[n++] = (struct link){label[i], label[j]};
  }
  mem_free(label);
  if (n == 0) return 0;
  qsort(*links, (size_t)n, sizeof **links, compare_links);
  int kept = 1;
  for (int k = 1; k < n; k++)
    if (compare_links(&(*links)[k], &(*links)[kept - 1]) != 0)
      (*links)[kept++] = (*links)[k];
  return kept;
}

/* Gather the pairs of doubles of all ranks in rank order, instead of this
 * rank's, which are freed; returns how many. */
static int gather_pairs(const struct mesh *mesh, int n, void **pairs) {
  int *count = MEM_NEW(int, (size_t)mesh->nranks);
  int *begin = MEM_NEW(int, (size_t)mesh->nranks);
  int mine = count_index(2 * (int64_t)n, "pairs"), all = 0;
  MPI_CHECK(MPI_Allgather(&mine, 1, MPI_INT, count, 1, MPI_INT, mesh->comm));
  for (int r = 0; r < mesh->nranks; r++) {
    begin[r] = all;
    all = count_index((int64_t)all + count[r], "pairs");
  }
  double *gathered = MEM_NEW(double, (size_t)all);
  MPI_CHECK(MPI_Allgatherv(*pairs, mine, MPI_DOUBLE, gathered, count, begin,
                           MPI_DOUBLE, mesh->comm));
  mem_free(*pairs);
  mem_free(count);
  mem_free(begin);
  *pairs = gathered;
  return all / 2;
}

static int compare_labels(const void *p, const void *q) {
  const struct piece *x = p, *y = q;
  return x->label < y->label ? -1 : x->label > y->label;
}

static int32_t find_piece(int n, const struct piece *pieces, double label) {
  struct piece key = {label, 0};
  const struct piece *piece =
      bsearch(&key, pieces, (size_t)n, sizeof key, compare_labels);
  CHECK(piece != NULL, "piece %.0f is linked but not listed", label);
  return (int32_t)(piece - pieces);
}

/* Find the roots [npieces] of the sets of all pieces. */
static int32_t *join_pieces(int npieces, const struct piece *pieces, int nlinks,
                            const struct link *links) {
  int32_t *root = MEM_NEW(int32_t, (size_t)npieces);
  for (int k = 0; k < npieces; k++) root[k] = k;
  for (int k = 0; k < nlinks; k++)
    join(root, find_piece(npieces, pieces, links[k].a),
         find_piece(npieces, pieces, links[k].b));
  for (int k = 0; k < npieces; k++) root[k] = find_root(root, k);
  return root;
}

/* Find the set of the largest volume and count the others. -1 if there is none.
 */
static int32_t find_heap(int n, const struct piece *pieces, const int32_t *root,
                         struct droplets *droplets) {
  double *volume = MEM_NEW(double, (size_t)n), all = 0;
  int32_t heap = n > 0 ? 0 : -1;
  for (int k = 0; k < n; k++) volume[root[k]] += pieces[k].volume;
  *droplets = (struct droplets){0};
  for (int k = 0; k < n; k++) {
    if (root[k] != k) continue;
    if (volume[k] > volume[heap]) heap = k;
    droplets->n++;
  }
  if (n > 0) droplets->n--;
  for (int k = 0; k < n; k++)
    if (root[k] == k && k != heap) all += volume[k];
  droplets->volume = all;
  mem_free(volume);
  return heap;
}

/* Sets of leaves over all ranks. */
struct sets {
  int npieces;
  struct piece *pieces; /* [npieces] of all ranks */
  int32_t *root;        /* [npieces] the piece that stands for the set */
  int32_t *number;      /* [nleaves] piece of a leaf, -1: none */
};

static void join_sets(const struct mesh *mesh, const double *c,
                      double threshold, struct sets *sets) {
  struct link *links;
  int32_t *number = join_leaves(mesh, c, threshold);
  int nmine = number_pieces(mesh, c, number, &sets->pieces);
  double label = nmine > 0 ? sets->pieces[0].label : 0;
  int nlinks = list_links(mesh, number, sets->pieces, &links);
  sets->npieces = gather_pairs(mesh, nmine, (void **)&sets->pieces);
  nlinks = gather_pairs(mesh, nlinks, (void **)&links);
  sets->root = join_pieces(sets->npieces, sets->pieces, nlinks, links);
  /* ours stand one after the other among those of all ranks */
  const int32_t first =
      nmine > 0 ? find_piece(sets->npieces, sets->pieces, label) : 0;
  for (int32_t i = 0; i < mesh->nleaves; i++)
    if (number[i] >= 0) number[i] += first;
  sets->number = number;
  mem_free(links);
}

static void free_sets(struct sets *sets) {
  mem_free(sets->root);
  mem_free(sets->pieces);
  mem_free(sets->number);
}

int droplets_number(const struct mesh *mesh, const double *v, double threshold,
                    int32_t *set) {
  struct sets sets;
  join_sets(mesh, v, threshold, &sets);
  for (int32_t i = 0; i < mesh->nleaves; i++)
    set[i] = sets.number[i] < 0 ? -1 : sets.root[sets.number[i]];
  free_sets(&sets);
  return sets.npieces;
}

void droplets_find(const struct mesh *mesh, const double *c, bool *heap,
                   struct droplets *droplets) {
  struct sets sets;
  join_sets(mesh, c, DROPLETS_THRESHOLD, &sets);
  int32_t largest = find_heap(sets.npieces, sets.pieces, sets.root, droplets);
  for (int32_t i = 0; i < mesh->nleaves; i++)
    heap[i] = sets.number[i] >= 0 && sets.root[sets.number[i]] == largest;
  free_sets(&sets);
}
