/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/two_phase/still.h"

#include <math.h>
#include <string.h>

#include "talus/two_phase/state.h"
#include "talus/two_phase/yield.h"

/* Still grains are slower than this part of what gravity gives in a step. */
#define SLOW 0.1
/* Part of the last change of g that is expected again. */
#define EXPECTED 0.9

/* Set wet and held [nfaces_all] to 1 on faces that can yield, and on those of
 * them that do not, else to 0. */
static void find_held(const struct two_phase *sim, double *wet, double *held) {
  const struct mesh *mesh = sim->grid.mesh;
  const struct yield *yield = &sim->yield;
  double *face[] = {wet, held};
  for (int d = 0; d < DIM; d++) {
    for (int32_t f = mesh->face_begin[d]; f < mesh->face_begin[d + 1]; f++) {
      wet[f] = yield->tau_y->v[f] > 0;
      held[f] = wet[f] > 0 && !yield_is_reached(yield, d, f);
    }
  }
  mesh_fill_faces(mesh, 2, face);
}

void still_find(struct two_phase *sim, double dt) {
  const struct mesh *mesh = sim->grid.mesh;
  double *face[2], g2 = 0;
  scratch_take(&sim->scratch, FIELD_FACE, __func__, 2, face);
  find_held(sim, face[0], face[1]);
  for (int d = 0; d < DIM; d++) {
    g2 += sim->params->gravity[d] * sim->params->gravity[d];
  }
  const double slow2 = SLOW * SLOW * dt * dt * g2;
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    const double wet = mesh_mean(mesh, face[0], i);
    const double held = mesh_mean(mesh, face[1], i);
    double u2 = 0;
    for (int e = 0; e < DIM; e++) u2 += sim->u[e]->v[i] * sim->u[e]->v[i];
    sim->yield.still->v[i] = wet > 0 && held == wet && u2 < slow2;
  }
  scratch_give(&sim->scratch, __func__);
}

void still_forget(struct two_phase *sim) {
  for (int e = 0; e < DIM; e++) {
    double *change = sim->yield.g_change[e]->v;
    memset(change, 0, (size_t)sim->grid.mesh->nleaves * sizeof *change);
  }
}

void still_guess(struct two_phase *sim) {
  for (int e = 0; e < DIM; e++) {
    double *g = sim->g[e]->v, *change = sim->yield.g_change[e]->v;
    for (int32_t i = 0; i < sim->grid.mesh->nleaves; i++) {
      change[i] *= EXPECTED * sim->yield.still->v[i];
      g[i] += change[i];
    }
    mesh_touch(sim->grid.mesh, g);
  }
}

/* Take g from, or add it to, its change, and dt g to u of leaves that are still
 * or not. */
static void count(struct two_phase *sim, double dt, double sign, bool still) {
  for (int e = 0; e < DIM; e++) {
    const double *g = sim->g[e]->v;
    double *u = sim->u[e]->v, *change = sim->yield.g_change[e]->v;
    for (int32_t i = 0; i < sim->grid.mesh->nleaves; i++) {
      change[i] += sign * g[i];
      if ((sim->yield.still->v[i] > 0) == still) u[i] += dt * g[i];
    }
    mesh_touch(sim->grid.mesh, u);
  }
}

void still_before(struct two_phase *sim, double dt) {
  count(sim, dt, -1, true);
}

void still_after(struct two_phase *sim, double dt) { count(sim, dt, 1, false); }
