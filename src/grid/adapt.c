/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/adapt.h"

#include <math.h>

#include "talus/error.h"
#include "talus/forest.h"
#include "talus/level_raster.h"
#include "talus/log.h"
#include "talus/memory.h"
#include "talus/minmax.h"
#include "talus/openings.h"
#include "talus/remap.h"
#include "talus/two_phase/properties.h"
#include "talus/two_phase/state.h"

/* Cells by which a criterion is widened before a leaf may be merged. */
enum { HYSTERESIS = ADAPT_HYSTERESIS };

static bool is_surface(double c) {
  return c > PROPERTIES_GAS && c < 1 - PROPERTIES_GAS;
}

/* mark [ncells] = 1 in leaves cut by the surface, or between a full and an
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
  int8_t *divide; /* [nleaves] finest level asked for */
  int8_t *keep;   /* level above which a leaf may be merged */
  int8_t *may;    /* what the criterion at hand may ask for */
};

/* Confine a criterion to the leaves that hold its phase and to those beside
 * them; leaves up to HYSTERESIS farther away it may keep. c is filled. */
static void confine(struct two_phase *sim, enum criterion_phase only,
                    struct wanted *wanted) {
  const struct mesh *mesh = sim->mesh;
  double *mark = sim->cell[1]->v;
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    const double c = sim->c->v[i];
    mark[i] = only == CRITERION_BOTH ||
              (only == CRITERION_GRAINS ? c : 1 - c) > PROPERTIES_GAS;
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

static void want_surface(struct two_phase *sim,
                         const struct criterion *criterion,
                         struct wanted *wanted) {
  const struct mesh *mesh = sim->mesh;
  double *mark = sim->cell[0]->v;
  const int width = (int)ceil(criterion->width);
  mark_surface(mesh, sim->c->v, mark);
  for (int k = 0; k <= width + HYSTERESIS; k++) {
    if (k > 0) mesh_spread(mesh, mark);
    for (int32_t i = 0; i < mesh->nleaves; i++) {
      if (mark[i] > 0) {
        want(wanted, i, k <= width ? criterion->level : 0, criterion->level);
      }
    }
  }
}

static void want_inside(const struct two_phase *sim,
                        const struct criterion *criterion,
                        struct wanted *wanted) {
  for (int32_t i = 0; i < sim->mesh->nleaves; i++) {
    if (sim->c->v[i] > PROPERTIES_GAS) {
      want(wanted, i, criterion->level, criterion->level);
    }
  }
}

/* Half the second difference of the velocity: what merging would lose. */
static void want_estimate(struct two_phase *sim,
                          const struct criterion *criterion,
                          struct wanted *wanted) {
  const struct mesh *mesh = sim->mesh;
  field_fill_many(mesh, DIM, sim->u);
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    const int32_t *node = mesh->stencil[i];
    double estimate = 0;
    for (int e = 0; e < DIM; e++) {
      const double *v = sim->u[e]->v;
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

static void want_function(struct two_phase *sim,
                          const struct criterion *criterion, int number,
                          struct wanted *wanted) {
  struct level_raster **raster = &sim->level_raster[number];
  if (!*raster) {
    *raster = level_raster_new(sim->mesh->comm, forest_layout(sim->forest),
                               &criterion->function, sim->params->level_max);
  }
  for (int32_t i = 0; i < sim->mesh->nleaves; i++) {
    int level =
        level_raster_most(*raster, sim->mesh->x[i], sim->mesh->level[i]);
    if (level > criterion->level) level = criterion->level;
    want(wanted, i, level, level);
  }
}

static void want_openings(const struct two_phase *sim, struct wanted *wanted) {
  for (int32_t i = 0; i < sim->mesh->nleaves; i++) {
    const int level = openings_level(sim, i);
    want(wanted, i, level, level);
  }
}

static void apply_criteria(struct two_phase *sim, struct wanted *wanted) {
  const struct params *params = sim->params;
  confine(sim, CRITERION_BOTH, wanted);
  want_openings(sim, wanted);
  for (int k = 0; k < params->ncriteria; k++) {
    const struct criterion *criterion = &params->criterion[k];
    confine(sim, criterion->only, wanted);
    switch (criterion->type) {
      case CRITERION_INTERFACE:
        want_surface(sim, criterion, wanted);
        break;
      case CRITERION_INSIDE:
        want_inside(sim, criterion, wanted);
        break;
      case CRITERION_ESTIMATE:
        want_estimate(sim, criterion, wanted);
        break;
      case CRITERION_FUNCTION:
        want_function(sim, criterion, k, wanted);
        break;
    }
  }
}

/* Does a grid of so many leaves keep to the cap of the case, and to memory? */
static bool is_allowed(struct two_phase *sim, double count) {
  const int64_t cap = sim->params->max_cells, memory = sim->most_leaves;
  if (cap > 0 && count > (double)cap) {
    WARN_ONCE(
        "%.0f cells wanted, max_cells is %lld: the grid stays coarser "
        "than the criteria ask for",
        count, (long long)cap);
    return false;
  }
  if (memory > 0 && count > (double)memory) {
    sim->outgrown = count;
    return false;
  }
  return true;
}

/* Above the caps nothing is divided any more. */
static void cap_count(struct two_phase *sim, int8_t *flag) {
  const struct mesh *mesh = sim->mesh;
  double growth = 0;
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    growth += flag[i] > 0 ? NCHILD - 1 : 0;
  }
  growth = mesh_sum(mesh, growth);
  const double count = (double)forest_nleaves_global(sim->forest) + growth;
  if (growth == 0 || is_allowed(sim, count)) return;
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    if (flag[i] > 0) flag[i] = 0;
  }
}

void adapt_flags(struct two_phase *sim, int8_t *flag) {
  const struct mesh *mesh = sim->mesh;
  struct wanted wanted = {MEM_NEW(int8_t, mesh->nleaves),
                          MEM_NEW(int8_t, mesh->nleaves),
                          MEM_NEW(int8_t, mesh->nleaves)};
  apply_criteria(sim, &wanted);
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    flag[i] = 0;
    if (mesh->level[i] < wanted.divide[i]) flag[i] = 1;
    if (mesh->level[i] > wanted.keep[i]) flag[i] = -1;
  }
  cap_count(sim, flag);
  mem_free(wanted.divide);
  mem_free(wanted.keep);
  mem_free(wanted.may);
}

bool adapt_is_due(const struct two_phase *sim) {
  const struct params *params = sim->params;
  if (params->ncriteria == 0) return false;
  if (params->adapt_every > 0 && sim->step % params->adapt_every == 0) {
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
  return sim->travel >= spare;
}

bool adapt_grid(struct two_phase *sim) {
  int8_t *flag = MEM_NEW(int8_t, sim->mesh->nleaves);
  struct forest_map map;
  field_fill(sim->mesh, sim->c);
  adapt_flags(sim, flag);
  const bool changed = forest_adapt(sim->forest, flag, sim->params->level_min,
                                    sim->params->level_max, &map);
  if (changed) remap_fields(sim, &map);
  forest_map_destroy(&map);
  mem_free(flag);
  sim->travel = 0;
  return changed;
}
