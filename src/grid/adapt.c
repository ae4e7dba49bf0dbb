/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/adapt.h"

#include <math.h>

#include "talus/error.h"
#include "talus/forest.h"
#include "talus/grid.h"
#include "talus/level_raster.h"
#include "talus/log.h"
#include "talus/memory.h"
#include "talus/minmax.h"
#include "talus/openings.h"
#include "talus/remap.h"

/* Cells by which a criterion is widened before a leaf may be merged. */
enum { HYSTERESIS = ADAPT_HYSTERESIS };

static bool is_surface(double c) {
  return c > PARAMS_GAS && c < 1 - PARAMS_GAS;
}

/* Set mark [ncells] to 1 in leaves cut by the surface, or between a full and an
 * empty neighbour. */
static void mark_surface(const struct mesh *mesh, const double *c,
                         double *mark) {
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    bool cut = is_surface(c[i]);
    for (int f = 0; f < NFACE && !cut; f++) {
      const double next = c[mesh->stencil[i][stencil_face(f)]];
      cut = is_surface(next) || (c[i] > 0.5) != (next > 0.5);
    }
    mark[i] = cut;
  }
}

/* Wishes of a criterion for a leaf. */
enum { NOTHING, KEEP, DIVIDE };

struct wanted {
  struct grid *grid;
  const struct followed *followed;
  int8_t *divide; /* [nleaves] finest level asked for */
  int8_t *keep;   /* level above which a leaf may be merged */
  int8_t *may;    /* what the criterion at hand may ask for */
  double *mark;   /* [ncells] scratch */
};

/* Confine a criterion to leaves that hold its phase and to their neighbours; up
 * to HYSTERESIS leaves farther away it may keep leaves. c is filled. */
static void confine(struct wanted *wanted, enum criterion_phase only) {
  const struct mesh *mesh = wanted->grid->mesh;
  double *mark = wanted->mark;
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    const double c = wanted->followed->c->v[i];
    mark[i] = only == CRITERION_BOTH ||
              (only == CRITERION_GRAINS ? c : 1 - c) > PARAMS_GAS;
    wanted->may[i] = mark[i] > 0 ? DIVIDE : NOTHING;
  }
  for (int k = 1; k <= 1 + HYSTERESIS && only != CRITERION_BOTH; k++) {
    mesh_spread(mesh, mark);
    for (int32_t i = 0; i < mesh->nleaves; i++) {
      if (mark[i] > 0 && wanted->may[i] == NOTHING) {
        wanted->may[i] = k > 1 ? KEEP : DIVIDE;
      }
    }
  }
}

static void want(struct wanted *wanted, int32_t i, int divide, int keep) {
  if (wanted->may[i] < DIVIDE) divide = 0;
  if (wanted->may[i] < KEEP) keep = 0;
  if (divide > wanted->divide[i]) wanted->divide[i] = (int8_t)divide;
  if (keep > wanted->keep[i]) wanted->keep[i] = (int8_t)keep;
}

static void want_surface(struct wanted *wanted,
                         const struct criterion *criterion) {
  const struct mesh *mesh = wanted->grid->mesh;
  double *mark = wanted->mark;
  const int width = (int)ceil(criterion->width);
  mark_surface(mesh, wanted->followed->c->v, mark);
  for (int k = 0; k <= width + HYSTERESIS; k++) {
    if (k > 0) mesh_spread(mesh, mark);
    for (int32_t i = 0; i < mesh->nleaves; i++) {
      if (mark[i] > 0) {
        want(wanted, i, k <= width ? criterion->level : 0, criterion->level);
      }
    }
  }
}

static void want_inside(struct wanted *wanted,
                        const struct criterion *criterion) {
  const double *c = wanted->followed->c->v;
  for (int32_t i = 0; i < wanted->grid->mesh->nleaves; i++) {
    if (c[i] > PARAMS_GAS) {
      want(wanted, i, criterion->level, criterion->level);
    }
  }
}

/* Ask for leaves by half the second difference of the velocity, which merging
 * would lose. */
static void want_estimate(struct wanted *wanted,
                          const struct criterion *criterion) {
  const struct mesh *mesh = wanted->grid->mesh;
  struct field *const *u = wanted->followed->u;
  field_fill_many(mesh, DIM, u);
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    const int32_t *node = mesh->stencil[i];
    double estimate = 0;
    for (int e = 0; e < DIM; e++) {
      const double *v = u[e]->v;
      for (int d = 0; d < DIM; d++) {
        const double mean = 0.5 * (v[node[stencil_face(2 * d)]] +
                                   v[node[stencil_face(2 * d + 1)]]);
        estimate = max2(estimate, fabs(v[i] - mean));
      }
    }
    const bool fine = estimate > criterion->threshold;
    const bool keep = estimate > 0.25 * criterion->threshold;
    want(wanted, i, fine ? criterion->level : 0, keep ? criterion->level : 0);
  }
}

/* Return the raster of a criterion that is a function of position. */
static const struct level_raster *raster_of(struct grid *grid, int number) {
  struct level_raster **raster = &grid->level_raster[number];
  if (!*raster) {
    *raster = level_raster_new(grid->mesh->comm, forest_layout(grid->forest),
                               &grid->params->criterion[number].function,
                               grid->params->level_max);
  }
  return *raster;
}

static void want_function(struct wanted *wanted,
                          const struct criterion *criterion, int number) {
  const struct mesh *mesh = wanted->grid->mesh;
  const struct level_raster *raster = raster_of(wanted->grid, number);
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    int level = level_raster_most(raster, mesh->x[i], mesh->level[i]);
    if (level > criterion->level) level = criterion->level;
    want(wanted, i, level, level);
  }
}

/* Ask for the coarsest level there may be; without criteria that is the finest.
 */
static void want_everywhere(struct wanted *wanted) {
  const struct params *params = wanted->grid->params;
  const bool uniform = params->ncriteria == 0;
  const int level = uniform ? params->level_max : params->level_min;
  for (int32_t i = 0; i < wanted->grid->mesh->nleaves; i++) {
    want(wanted, i, level, uniform ? level : 0);
  }
}

static void want_openings(struct wanted *wanted) {
  for (int32_t i = 0; i < wanted->grid->mesh->nleaves; i++) {
    const int level = openings_level(wanted->grid, i);
    want(wanted, i, level, level);
  }
}

static void apply_criteria(struct wanted *wanted) {
  const struct params *params = wanted->grid->params;
  confine(wanted, CRITERION_BOTH);
  want_openings(wanted);
  want_everywhere(wanted);
  for (int k = 0; k < params->ncriteria; k++) {
    const struct criterion *criterion = &params->criterion[k];
    confine(wanted, criterion->only);
    switch (criterion->type) {
      case CRITERION_INTERFACE:
        want_surface(wanted, criterion);
        break;
      case CRITERION_INSIDE:
        want_inside(wanted, criterion);
        break;
      case CRITERION_ESTIMATE:
        want_estimate(wanted, criterion);
        break;
      case CRITERION_FUNCTION:
        want_function(wanted, criterion, k);
        break;
    }
  }
}

/* Does a grid of so many leaves keep to the cap of the case, and to memory? */
static bool is_allowed(struct grid *grid, double count) {
  const int64_t cap = grid->params->max_cells, memory = grid->most_leaves;
  if (cap > 0 && count > (double)cap) {
    WARN_ONCE(
        "%.0f cells wanted, max_cells is %lld: the grid stays coarser "
        "than the criteria ask for",
        count, (long long)cap);
    return false;
  }
  if (memory > 0 && count > (double)memory) {
    grid->outgrown = count;
    return false;
  }
  return true;
}

/* Take back all divisions if the grid would exceed a cap. */
static void cap_count(struct grid *grid, int8_t *flag) {
  const struct mesh *mesh = grid->mesh;
  double growth = 0;
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    growth += flag[i] > 0 ? NCHILD - 1 : 0;
  }
  growth = mesh_sum(mesh, growth);
  const double count = (double)forest_nleaves_global(grid->forest) + growth;
  if (growth == 0 || is_allowed(grid, count)) return;
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    if (flag[i] > 0) flag[i] = 0;
  }
}

void adapt_flags(struct grid *grid, const struct followed *followed,
                 int8_t *flag) {
  const struct mesh *mesh = grid->mesh;
  struct wanted wanted = {.grid = grid,
                          .followed = followed,
                          .divide = MEM_NEW(int8_t, mesh->nleaves),
                          .keep = MEM_NEW(int8_t, mesh->nleaves),
                          .may = MEM_NEW(int8_t, mesh->nleaves),
                          .mark = MEM_NEW(double, mesh->ncells)};
  apply_criteria(&wanted);
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    flag[i] = 0;
    if (mesh->level[i] < wanted.divide[i]) flag[i] = 1;
    if (mesh->level[i] > wanted.keep[i]) flag[i] = -1;
  }
  cap_count(grid, flag);
  mem_free(wanted.divide);
  mem_free(wanted.keep);
  mem_free(wanted.may);
  mem_free(wanted.mark);
}

static uint32_t add_bytes(uint32_t sum, const void *data, size_t n) {
  const unsigned char *byte = data;
  for (size_t i = 0; i < n; i++) sum = (sum ^ byte[i]) * UINT32_C(16777619);
  return sum;
}

/* Return a checksum of the levels that a function asks for in the leaves. */
static uint32_t sum_of_function(struct grid *grid, int number) {
  const struct mesh *mesh = grid->mesh;
  const struct level_raster *raster = raster_of(grid, number);
  uint32_t sum = 0;
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    const int level = level_raster_most(raster, mesh->x[i], mesh->level[i]);
    const uint32_t place = add_bytes(0, mesh->x[i], sizeof mesh->x[i]);
    sum += add_bytes(place, &level, sizeof level);
  }
  MPI_CHECK(
      MPI_Allreduce(MPI_IN_PLACE, &sum, 1, MPI_UINT32_T, MPI_SUM, mesh->comm));
  return sum;
}

uint32_t adapt_criteria(struct grid *grid) {
  const struct params *params = grid->params;
  const double bounds[] = {params->level_min, params->level_max,
                           params->opening_level, (double)params->max_cells};
  uint32_t sum = add_bytes(0, bounds, sizeof bounds);
  for (int k = 0; k < params->ncriteria; k++) {
    const struct criterion *criterion = &params->criterion[k];
    const double value[] = {criterion->type, criterion->only, criterion->level,
                            criterion->width, criterion->threshold};
    sum = add_bytes(sum, value, sizeof value);
    if (criterion->type != CRITERION_FUNCTION) continue;
    const uint32_t levels = sum_of_function(grid, k);
    sum = add_bytes(sum, &levels, sizeof levels);
  }
  return sum;
}

void adapt_anew(struct grid *grid) {
  grid->rounds = 2 * grid->params->level_max;
}

bool adapt_is_due(const struct grid *grid, int64_t step, double travel) {
  const struct params *params = grid->params;
  if (grid->rounds > 0) return true;
  if (params->ncriteria == 0) return false;
  if (params->adapt_every > 0 && step % params->adapt_every == 0) {
    return true;
  }
  double spare = 4; /* cells the surface may move */
  for (int k = 0; k < params->ncriteria; k++) {
    if (params->criterion[k].type == CRITERION_INTERFACE) {
      spare = min2(spare, max2(params->criterion[k].width - 1, 0));
    }
    if (params->criterion[k].only != CRITERION_BOTH) {
      spare = min2(spare, HYSTERESIS);
    }
  }
  return travel >= spare;
}

bool adapt_grid(struct grid *grid, const struct followed *followed) {
  int8_t *flag = MEM_NEW(int8_t, grid->mesh->nleaves);
  struct forest_map map;
  field_fill(grid->mesh, followed->c);
  adapt_flags(grid, followed, flag);
  const bool changed = forest_adapt(grid->forest, flag, grid->params->level_min,
                                    grid->params->level_max, &map);
  if (changed) remap_fields(grid, &map);
  forest_map_destroy(&map);
  mem_free(flag);
  grid->rounds = changed && grid->rounds > 0 ? grid->rounds - 1 : 0;
  return changed;
}
