/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/grid_size.h"

#include <math.h>
#include <string.h>

#include "talus/adapt.h"
#include "talus/memory.h"
#include "talus/mesh.h"
#include "talus/minmax.h"
#include "talus/openings.h"
#include "talus/params.h"

enum {
  MOST_CELLS = 600,                      /* of a level that are looked at */
  EVALUATIONS = DIM == 2 ? 8000 : 12000, /* of a function on a level, about */
  LEAST_SAMPLES = 4,                     /* along an edge */
  MOST_SAMPLES = 65
};

struct cell {
  double x[DIM]; /* centre, m */
  double weight; /* cells of its level that it stands for */
  double bare;   /* a box that reaches this many cells beyond has no grains */
};

struct walk {
  const struct params *params;
  int level;
  double h;    /* edge of the cells of this level, m */
  int samples; /* along an edge of a box */
  uint64_t random;
  int64_t n;
  struct cell *cell; /* [n], at most MOST_CELLS NCHILD */
};

/* Draw a number between 0 and 1, always from the same sequence. */
static double draw(struct walk *walk) {
  walk->random = walk->random * 6364136223846793005u + 1442695040888963407u;
  return (double)(walk->random >> 11) * 0x1p-53;
}

/* Give the extent of the domain along axis d. */
static void extent(const struct params *params, int d, double *low,
                   double *high) {
  *low = params->origin[d];
  *high = *low + params->size * params->trees[d];
}

/* Place sample k in the box around a cell that reaches `width` cells beyond it,
 * cut to the domain. */
static void sample_point(const struct walk *walk, const struct cell *cell,
                         double width, int k, double x[3]) {
  for (int d = 0; d < DIM; d++, k /= walk->samples) {
    const double beyond = (0.5 + width) * walk->h;
    double low, high;
    extent(walk->params, d, &low, &high);
    const double begin = max2(low, cell->x[d] - beyond);
    const double end = min2(high, cell->x[d] + beyond);
    /* just inside, as the sides of cells are often the sides of things */
    const double at = (k % walk->samples + 1e-6) / (walk->samples - 1 + 2e-6);
    x[d] = begin + (end - begin) * at;
  }
}

static int sample_count(const struct walk *walk) {
  int n = 1;
  for (int d = 0; d < DIM; d++) n *= walk->samples;
  return n;
}

/* Find out whether the shape reaches into the box (*some), and leaves a part of
 * the box (*others). A box within one that was found bare is not searched. */
static void look_for_grains(const struct walk *walk, struct cell *cell,
                            double width, bool *some, bool *others) {
  const struct function *shape = &walk->params->shape;
  const int n = sample_count(walk);
  *some = *others = false;
  if (shape->eval == NULL) *some = true;
  if (width <= cell->bare) *others = true;
  if (*others) return;
  for (int k = 0; k < n && shape->eval != NULL && !(*some && *others); k++) {
    double x[3] = {0};
    sample_point(walk, cell, width, k, x);
    if (shape->eval(shape->context, x) > 0)
      *some = true;
    else
      *others = true;
  }
  if (!*some) cell->bare = width;
}

/* Return the distance from a region of level `finest` up to which cells of the
 * present level are divided, in such cells; on level finest - 1 the distance is
 * `cells` of the finest. 2:1 balance divides the neighbours of divided cells,
 * and so reaches farther by 1/2 to 1 of a cell on every level. */
static double reach(const struct walk *walk, int finest, double cells) {
  double r = 0.5 * cells;
  for (int l = finest - 2; l >= walk->level; l--) r = 0.5 * (r + 0.75);
  return r;
}

static bool wants_position(const struct walk *walk, const struct cell *cell,
                           const struct criterion *criterion) {
  const struct function *level = &criterion->function;
  const int n = sample_count(walk);
  for (int k = 0; k < n; k++) {
    double x[3] = {0};
    sample_point(walk, cell, reach(walk, criterion->level, 0), k, x);
    if (level->eval(level->context, x) + 0.5 >= walk->level + 1) return true;
  }
  return false;
}

/* Is half the second difference of the initial velocity, as adapt.c takes it,
 * above the threshold? */
static bool wants_velocity(const struct walk *walk, const struct cell *cell,
                           const struct criterion *criterion) {
  for (int e = 0; e < DIM; e++) {
    const struct function *u = &walk->params->velocity[e];
    for (int d = 0; d < DIM && u->eval != NULL; d++) {
      double value[3], low, high;
      extent(walk->params, d, &low, &high);
      for (int side = -1; side <= 1; side++) {
        double x[3] = {0};
        memcpy(x, cell->x, sizeof cell->x);
        x[d] = min2(high, max2(low, x[d] + side * walk->h));
        value[side + 1] = u->eval(u->context, x);
      }
      if (fabs(value[1] - 0.5 * (value[0] + value[2])) > criterion->threshold)
        return true;
    }
  }
  return false;
}

/* Is there something in the cell of what the criterion is for? */
static bool is_meant(const struct walk *walk, struct cell *cell,
                     const struct criterion *criterion) {
  bool grains, gas;
  if (criterion->only == CRITERION_BOTH) return true;
  look_for_grains(walk, cell, reach(walk, criterion->level, 0), &grains, &gas);
  return criterion->only == CRITERION_GRAINS ? grains : gas;
}

static bool wants(const struct walk *walk, struct cell *cell,
                  const struct criterion *criterion) {
  bool some, others;
  const int finest = criterion->level;
  if (walk->level >= finest || !is_meant(walk, cell, criterion)) return false;
  switch (criterion->type) {
    case CRITERION_INTERFACE:
      look_for_grains(
          walk, cell,
          reach(walk, finest, ceil(criterion->width) + ADAPT_HYSTERESIS), &some,
          &others);
      return some && others;
    case CRITERION_INSIDE:
      look_for_grains(walk, cell, reach(walk, finest, 0), &some, &others);
      return some;
    case CRITERION_ESTIMATE:
      return wants_velocity(walk, cell, criterion);
    case CRITERION_FUNCTION:
      return wants_position(walk, cell, criterion);
  }
  return false;
}

static bool is_divided(const struct walk *walk, struct cell *cell) {
  const struct params *params = walk->params;
  if (walk->level >= params->level_max) return false;
  if (walk->level < params->level_min || params->ncriteria == 0) return true;
  if (openings_level_at(params, cell->x, walk->level) > walk->level)
    return true;
  for (int k = 0; k < params->ncriteria; k++)
    if (wants(walk, cell, &params->criterion[k])) return true;
  return false;
}

/* Keep one cell of each stretch, if there are too many. */
static void thin(struct walk *walk) {
  if (walk->n <= MOST_CELLS) return;
  const double stretch = (double)walk->n / MOST_CELLS;
  for (int k = 0; k < MOST_CELLS; k++) {
    const int64_t i = (int64_t)(stretch * (k + draw(walk)));
    walk->cell[k] = walk->cell[i < walk->n ? i : walk->n - 1];
    walk->cell[k].weight *= stretch;
  }
  walk->n = MOST_CELLS;
}

/* Replace cells by their children where they are divided; returns how many
 * leaves the others stand for. */
static double descend(struct walk *walk) {
  struct cell *next = mem_alloc((size_t)walk->n * NCHILD, sizeof(struct cell));
  double leaves = 0;
  int64_t n = 0;
  const double least = pow(EVALUATIONS / (double)walk->n, 1. / DIM);
  walk->samples = (int)min2(MOST_SAMPLES, max2(LEAST_SAMPLES, least));
  for (int64_t i = 0; i < walk->n; i++) {
    walk->cell[i].bare = -1;
    if (!is_divided(walk, &walk->cell[i])) {
      leaves += walk->cell[i].weight;
      continue;
    }
    for (int c = 0; c < NCHILD; c++, n++) {
      next[n] = walk->cell[i];
      for (int d = 0; d < DIM; d++)
        next[n].x[d] += walk->h * (c >> d & 1 ? 0.25 : -0.25);
    }
  }
  mem_free(walk->cell);
  walk->cell = next;
  walk->n = n;
  walk->level++;
  walk->h *= 0.5;
  return leaves;
}

/* Begin with the trees, one cell each. */
static void begin(struct walk *walk) {
  const struct params *params = walk->params;
  walk->n = 1;
  for (int d = 0; d < DIM; d++) walk->n *= params->trees[d];
  walk->cell = mem_alloc((size_t)walk->n, sizeof(struct cell));
  for (int64_t i = 0; i < walk->n; i++) {
    int64_t k = i;
    for (int d = 0; d < DIM; d++, k /= params->trees[d - 1])
      walk->cell[i].x[d] =
          params->origin[d] +
          params->size * ((double)(k % params->trees[d]) + 0.5);
    walk->cell[i].weight = 1;
  }
}

/* Return the number of cells of a uniform grid. */
static double uniform(const struct params *params, int level) {
  double n = ldexp(1, DIM * level);
  for (int d = 0; d < DIM; d++) n *= params->trees[d];
  return n;
}

double grid_size_leaves(const struct params *params) {
  struct walk walk = {.params = params, .h = params->size};
  const double coarsest = uniform(params, params->level_min);
  double leaves = 0;
  if (params->ncriteria == 0) return uniform(params, params->level_max);
  begin(&walk);
  while (walk.n > 0) {
    thin(&walk);
    leaves += descend(&walk);
  }
  mem_free(walk.cell);
  /* the cap binds what criteria add to the coarsest grid */
  if (params->max_cells > 0) leaves = min2(leaves, (double)params->max_cells);
  return max2(leaves, coarsest);
}

double grid_size_bytes(const struct params *params) {
  /* --timing of columns on uniform and adapted grids of 3e4 to 6e5 leaves, on 1
   * and 2 ranks: 920 to 1170 in 2D, 1350 to 1500 in 3D, 15 more for a tracer,
   * 20 in 2D and 70 in 3D for theta < 1, 220 and 890 for an exact yield */
  const struct rheology *grains = &params->grains.rheology;
  const bool exact = grains->model && grains->regularisation == RHEOLOGY_EXACT;
  double bytes = (DIM == 2 ? 1100 : 1600) + 16 * params->ntracers;
  if (params->theta < 1) bytes += DIM == 2 ? 24 : 72;
  if (exact) bytes += DIM == 2 ? 250 : 950;
  return bytes;
}
