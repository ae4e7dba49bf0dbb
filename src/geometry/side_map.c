/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Invariants
 * 1. Nodes [0, number of trees) are the roots; the children of a node lie one
 *    after another, the first axis fastest.
 * 2. Children that are all one boundary are merged: such nodes have no child.
 */
#include "talus/side_map.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "talus/error.h"
#include "talus/memory.h"
#include "talus/minmax.h"

/* Points asked along an edge, at most on a side, and to divide its faces. */
enum { SAMPLES_1 = 16, SAMPLES_2 = 4 };
enum { MOST_POINTS_1 = 1 << 18, MOST_POINTS_2 = 1 << 20 };
enum { MOST_PER_FACE = 1 << 13, MOST_DIVIDING = 1 << 22, MOST_NODES = 1 << 22 };
/* Parts of a face are known to TOLERANCE; less than NOTHING is none. */
static const double kTolerance1 = 1e-7, kTolerance2 = 1e-5;
#define NOTHING 1e-6

struct node {
  int32_t child;   /* first one, -1: none */
  int32_t parts;   /* number in `part`, -1: one boundary */
  int8_t boundary; /* all over */
};

struct side_map {
  struct side_map_layout layout;
  int raster, samples; /* level asked all over; points along an edge there */
  int nchildren, nroots;
  int32_t nnodes, capacity;
  struct node *node;
  int32_t nparts, part_capacity;
  double (*part)[SIDE_MAP_MOST];
  uint32_t seen;
  double covered[SIDE_MAP_MOST];
  int64_t left; /* calls left to divide faces */
};

/* A cell of the side: its level and lower corner in edges of its level. */
struct cell {
  int level;
  int64_t place[2];
};

static double edge_of(const struct side_map *map, int level) {
  return ldexp(map->layout.size, -level);
}

static double corner_of(const struct side_map *map, const struct cell *cell,
                        int axis) {
  return map->layout.origin[axis] +
         (double)cell->place[axis] * edge_of(map, cell->level);
}

static bool is_inside(const struct side_map *map, const double t[2]) {
  for (int e = 0; e < map->layout.naxes; e++) {
    const double low = map->layout.origin[e];
    const double high = low + map->layout.trees[e] * map->layout.size;
    if (t[e] <= low || t[e] >= high) return false;
  }
  return true;
}

static int ask(struct side_map *map, const double t[2]) {
  const int boundary = map->layout.select(map->layout.context, t);
  CHECK(boundary >= 0 && boundary < SIDE_MAP_MOST, "boundary %d", boundary);
  if (is_inside(map, t)) map->seen |= 1u << boundary;
  return boundary;
}

/* Return the one boundary at all points of the cell's raster, or -1. */
static int ask_cell(struct side_map *map, const struct cell *cell) {
  const int n = map->samples + 1;
  const int all = map->layout.naxes == 1 ? n : n * n;
  const double step = edge_of(map, cell->level) / map->samples;
  int common = -1;
  for (int k = 0; k < all; k++) {
    const double t[2] = {
        corner_of(map, cell, 0) + step * (k % n),
        map->layout.naxes > 1 ? corner_of(map, cell, 1) + step * (k / n) : 0};
    const int boundary = ask(map, t);
    if (k > 0 && boundary != common) return -1;
    common = boundary;
  }
  return common;
}

/* A face while its parts are measured. */
struct probe {
  struct side_map *map;
  double low[2], h;
  double t[2];
  int left; /* calls */
};

static void measure(struct probe *probe, int axis, double mean[]);

/* Measure the mean over the axes below `axis`, which is at t. */
static void measure_at(struct probe *probe, int axis, double t, double mean[]) {
  probe->t[axis] = t;
  measure(probe, axis - 1, mean);
}

/* Add the integral from a to b, in edges of the face, by Simpson's rule, in
 * halves until the means at a, b and between lie on a line. */
static void add_piece(struct probe *probe, int axis, double a, double b,
                      const double at_a[], const double at_b[], double sum[]) {
  double middle[SIDE_MAP_MOST], bend = 0;
  const double t = 0.5 * (a + b), width = (b - a) / probe->h;
  const bool inner = axis == 0 && probe->map->layout.naxes > 1;
  const double tolerance = axis > 0 ? kTolerance2
                           : inner  ? 0.1 * kTolerance2
                                    : kTolerance1;
  measure_at(probe, axis, t, middle);
  for (int k = 0; k < SIDE_MAP_MOST; k++) {
    bend = max2(bend, fabs(middle[k] - 0.5 * (at_a[k] + at_b[k])));
  }
  if (bend * width <= tolerance || probe->left <= 0) {
    for (int k = 0; k < SIDE_MAP_MOST; k++) {
      sum[k] += width * (at_a[k] + 4 * middle[k] + at_b[k]) / 6;
    }
    return;
  }
  add_piece(probe, axis, a, t, at_a, middle, sum);
  add_piece(probe, axis, t, b, middle, at_b, sum);
}

/* Measure the mean presence of each boundary over the axes up to `axis`, the
 * others being at probe->t. */
static void measure(struct probe *probe, int axis, double mean[]) {
  memset(mean, 0, SIDE_MAP_MOST * sizeof *mean);
  if (axis < 0) {
    probe->left--;
    probe->map->left--;
    mean[ask(probe->map, probe->t)] = 1;
    return;
  }
  double at_a[SIDE_MAP_MOST], at_b[SIDE_MAP_MOST];
  const int n = probe->map->samples;
  const double low = probe->low[axis];
  measure_at(probe, axis, low, at_a);
  for (int k = 0; k < n; k++) {
    const double a = low + probe->h * k / n, b = low + probe->h * (k + 1) / n;
    measure_at(probe, axis, b, at_b);
    add_piece(probe, axis, a, b, at_a, at_b, mean);
    memcpy(at_a, at_b, sizeof at_a);
  }
}

/* Measure the parts of a face from points alone. */
static void count_points(struct side_map *map, const double low[2], double h,
                         double part[]) {
  const int n = map->samples, all = map->layout.naxes == 1 ? n : n * n;
  memset(part, 0, SIDE_MAP_MOST * sizeof *part);
  for (int k = 0; k < all; k++) {
    const double t[2] = {low[0] + h * (k % n + 0.5) / n,
                         low[1] + h * (k / n + 0.5) / n};
    part[ask(map, t)] += 1.0 / all;
  }
}

/* Measure the parts of a face, without those that are next to nothing. */
static void measure_face(struct side_map *map, const double low[2], double h,
                         double part[]) {
  struct probe probe = {map, {low[0], low[1]}, h, {0}, MOST_PER_FACE};
  double sum = 0;
  if (map->left >= MOST_PER_FACE) {
    measure(&probe, map->layout.naxes - 1, part);
  } else {
    count_points(map, low, h, part);
  }
  for (int k = 0; k < SIDE_MAP_MOST; k++) {
    if (part[k] < NOTHING) part[k] = 0;
    sum += part[k];
  }
  for (int k = 0; k < SIDE_MAP_MOST; k++) part[k] /= sum;
}

static int sole_part(const double part[]) {
  for (int k = 0; k < SIDE_MAP_MOST; k++) {
    if (part[k] > 0) return part[k] >= 1 ? k : -1;
  }
  return -1;
}

static int32_t add_nodes(struct side_map *map, int n) {
  const int32_t first = map->nnodes;
  if (first + n > map->capacity) {
    map->capacity = 2 * map->capacity + n;
    map->node = mem_resize(map->node, (size_t)map->capacity, sizeof *map->node);
  }
  for (int k = 0; k < n; k++) map->node[first + k] = (struct node){-1, -1, -1};
  map->nnodes += n;
  return first;
}

static void set_parts(struct side_map *map, int32_t i,
                      const struct cell *cell) {
  double part[SIDE_MAP_MOST], low[2] = {0};
  for (int e = 0; e < map->layout.naxes; e++) low[e] = corner_of(map, cell, e);
  measure_face(map, low, edge_of(map, cell->level), part);
  map->node[i].boundary = (int8_t)sole_part(part);
  if (map->node[i].boundary >= 0) return;
  if (map->nparts == map->part_capacity) {
    map->part_capacity = 2 * map->part_capacity + 16;
    map->part =
        mem_resize(map->part, (size_t)map->part_capacity, sizeof *map->part);
  }
  memcpy(map->part[map->nparts], part, sizeof part);
  map->node[i].parts = map->nparts++;
}

static struct cell child_cell(const struct cell *cell, int c) {
  return (struct cell){
      cell->level + 1,
      {2 * cell->place[0] + (c & 1), 2 * cell->place[1] + (c >> 1)}};
}

static void build(struct side_map *map, int32_t i, const struct cell *cell) {
  if (cell->level >= map->raster) {
    const int boundary = ask_cell(map, cell);
    map->node[i].boundary = (int8_t)boundary;
    if (boundary >= 0) return;
  }
  if (cell->level == map->layout.level || map->nnodes > MOST_NODES) {
    set_parts(map, i, cell);
    return;
  }
  const int32_t first = add_nodes(map, map->nchildren);
  bool same = true;
  for (int c = 0; c < map->nchildren; c++) {
    const struct cell child = child_cell(cell, c);
    build(map, first + c, &child);
    same = same && map->node[first + c].boundary >= 0 &&
           map->node[first + c].boundary == map->node[first].boundary;
  }
  if (same) { /* they are the last nodes */
    map->node[i].boundary = map->node[first].boundary;
    map->nnodes = first;
  } else {
    map->node[i].child = first;
  }
}

/* Choose level and density of the raster, as fine as the number of points
 * allows. */
static void choose_raster(struct side_map *map) {
  const struct side_map_layout *layout = &map->layout;
  const int naxes = layout->naxes;
  const double most = naxes == 1 ? MOST_POINTS_1 : MOST_POINTS_2;
  map->raster = layout->level;
  map->samples = naxes == 1 ? SAMPLES_1 : SAMPLES_2;
  while (map->raster > 0) {
    const double n = ldexp(map->samples, map->raster);
    if (map->nroots * (naxes == 1 ? n : n * n) <= most) break;
    if (map->samples > 2) {
      map->samples /= 2;
    } else {
      map->raster--;
    }
  }
}

/* Add the node's parts of its area, times `weight`. */
static void add_parts(const struct side_map *map, int32_t i, double weight,
                      double part[]) {
  const struct node *node = &map->node[i];
  if (node->child >= 0) {
    for (int c = 0; c < map->nchildren; c++) {
      add_parts(map, node->child + c, weight / map->nchildren, part);
    }
  } else if (node->parts >= 0) {
    for (int k = 0; k < SIDE_MAP_MOST; k++) {
      part[k] += weight * map->part[node->parts][k];
    }
  } else {
    part[node->boundary] += weight;
  }
}

static double area_of(const struct side_map *map, int level) {
  return pow(edge_of(map, level), map->layout.naxes);
}

static struct cell root_cell(const struct side_map *map, int r) {
  const int n = map->layout.trees[0];
  return (struct cell){0, {r % n, r / n}};
}

struct side_map *side_map_new(const struct side_map_layout *layout) {
  struct side_map *map = MEM_NEW(struct side_map, 1);
  map->layout = *layout;
  map->nchildren = 1 << layout->naxes;
  if (layout->naxes == 1) map->layout.trees[1] = 1;
  map->nroots = map->layout.trees[0] * map->layout.trees[1];
  map->left = MOST_DIVIDING;
  choose_raster(map);
  add_nodes(map, map->nroots);
  for (int r = 0; r < map->nroots; r++) {
    const struct cell cell = root_cell(map, r);
    build(map, r, &cell);
    add_parts(map, r, area_of(map, 0), map->covered);
  }
  return map;
}

void side_map_destroy(struct side_map *map) {
  if (!map) return;
  mem_free(map->node);
  mem_free(map->part);
  mem_free(map);
}

int side_map_parts(const struct side_map *map, const double t[2], double h,
                   double part[]) {
  const struct side_map_layout *layout = &map->layout;
  const int level = (int)lround(log2(layout->size / h));
  int64_t place[2] = {0}, root[2] = {0};
  for (int e = 0; e < layout->naxes; e++) {
    const double edges = (t[e] - layout->origin[e]) / h;
    const double last = ldexp(layout->trees[e], level) - 1;
    place[e] = (int64_t)min2(max2(floor(edges), 0), last);
    root[e] = place[e] >> level;
  }
  int32_t i = (int32_t)(root[1] * layout->trees[0] + root[0]);
  for (int l = level - 1; l >= 0 && map->node[i].child >= 0; l--) {
    i = map->node[i].child +
        (int32_t)((place[0] >> l & 1) + 2 * (place[1] >> l & 1));
  }
  memset(part, 0, SIDE_MAP_MOST * sizeof *part);
  add_parts(map, i, 1, part);
  return map->node[i].boundary;
}

int side_map_owner(const struct side_map *map, const double t[2], double h,
                   uint32_t weighted) {
  double part[SIDE_MAP_MOST], most = 0;
  int owner = side_map_parts(map, t, h, part);
  if (owner >= 0) return owner;
  for (int k = 0; k < SIDE_MAP_MOST; k++) {
    if (!(weighted >> k & 1) || part[k] <= most) continue;
    most = part[k];
    owner = k;
  }
  return owner >= 0 ? owner : map->layout.select(map->layout.context, t);
}

static uint32_t list_within(const struct side_map *map, int32_t i,
                            const struct cell *cell, const double lo[2],
                            const double hi[2]) {
  const double edge = edge_of(map, cell->level);
  const double slip = 1e-6 * edge_of(map, map->layout.level);
  const struct node *node = &map->node[i];
  uint32_t found = 0;
  for (int e = 0; e < map->layout.naxes; e++) {
    const double low = corner_of(map, cell, e);
    if (low > hi[e] - slip || low + edge < lo[e] + slip) return 0;
  }
  if (node->boundary >= 0) return 1u << node->boundary;
  if (node->parts >= 0) {
    for (int k = 0; k < SIDE_MAP_MOST; k++) {
      if (map->part[node->parts][k] > 0) found |= 1u << k;
    }
    return found;
  }
  for (int c = 0; c < map->nchildren; c++) {
    const struct cell child = child_cell(cell, c);
    found |= list_within(map, node->child + c, &child, lo, hi);
  }
  return found;
}

/* Return the tree along an axis that holds the coordinate t, or the nearest
 * one. */
static int tree_at(const struct side_map *map, int axis, double t) {
  const double tree = floor((t - map->layout.origin[axis]) / map->layout.size);
  return (int)min2(max2(tree, 0), map->layout.trees[axis] - 1);
}

uint32_t side_map_within(const struct side_map *map, const double lo[2],
                         const double hi[2]) {
  int first[2] = {0}, last[2] = {0};
  uint32_t found = 0;
  for (int e = 0; e < map->layout.naxes; e++) {
    first[e] = tree_at(map, e, lo[e]);
    last[e] = tree_at(map, e, hi[e]);
  }
  for (int j = first[1]; j <= last[1]; j++) {
    for (int i = first[0]; i <= last[0]; i++) {
      const struct cell cell = {0, {i, j}};
      found |= list_within(map, j * map->layout.trees[0] + i, &cell, lo, hi);
    }
  }
  return found;
}

uint32_t side_map_seen(const struct side_map *map) { return map->seen; }

const double *side_map_covered(const struct side_map *map) {
  return map->covered;
}

/* Add the faces of the finest level below a node to those who take them. */
static void add_taken(const struct side_map *map, int32_t i,
                      const struct cell *cell, uint32_t weighted,
                      double taken[]) {
  const struct node *node = &map->node[i];
  if (node->child >= 0) {
    for (int c = 0; c < map->nchildren; c++) {
      const struct cell child = child_cell(cell, c);
      add_taken(map, node->child + c, &child, weighted, taken);
    }
    return;
  }
  int owner = node->boundary;
  const double h = edge_of(map, cell->level);
  if (owner < 0) {
    double t[2] = {0};
    for (int e = 0; e < map->layout.naxes; e++) {
      t[e] = corner_of(map, cell, e) + 0.5 * h;
    }
    owner = side_map_owner(map, t, h, weighted);
  }
  taken[owner] += area_of(map, cell->level);
}

void side_map_taken(const struct side_map *map, uint32_t weighted,
                    double taken[]) {
  memset(taken, 0, SIDE_MAP_MOST * sizeof *taken);
  for (int r = 0; r < map->nroots; r++) {
    const struct cell cell = root_cell(map, r);
    add_taken(map, r, &cell, weighted, taken);
  }
}
