/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/two_phase/still.h"

#include <math.h>
#include <string.h>

#include "talus/minmax.h"
#include "talus/poisson.h"
#include "talus/projection.h"
#include "talus/two_phase/state.h"

/* Still grains are slower than this part of what gravity gives in a step. */
#define SLOW 0.1
/* Sides with less than this part of the yield stress of a leaf do not decide
 * whether it is held: a film touches what is beside it by 1e-5 of a side. */
#define WEAK 0.01
/* Leaves with more grains than this are asked for their speed. */
#define HOLDS_GRAINS 0.01
/* Return that part, or under a light gas that in which grains weigh as much as
 * the gas: a leaf with fewer than HOLDS_GRAINS fell on a toe for ever. */
static double least_grains(const struct two_phase *sim) {
  const struct params *params = sim->params;
  if (params->single_phase) return HOLDS_GRAINS;
  return min2(HOLDS_GRAINS, params->gas.density / params->grains.density);
}

void still_find(struct two_phase *sim, double dt) {
  double *w = sim->yield.still->v;
  const struct mesh *mesh = sim->grid.mesh;
  const double least = least_grains(sim);
  const double slow = max2(SLOW * dt * params_gravity(sim->params), 1e-300);
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    double u2 = 0;
    w[i] = 0;
    if (!(sim->c->v[i] > least)) continue;
    for (int e = 0; e < DIM; e++) {
      u2 += sim->u_old[e]->v[i] * sim->u_old[e]->v[i];
    }
    w[i] = max2(0, 1 - sqrt(u2) / slow);
  }
  mesh_fill_ghosts(mesh, 1, &w);
}

/* Return w of a face: the least of the leaves with more than `few` grains, 0
 * without. A leaf with less than HOLDS_GRAINS of the grains of the other has
 * the less to say the fewer it has: its gas may carry them along. */
static double face_weight(const struct two_phase *sim, double few, int32_t f) {
  const int32_t *leaf = sim->grid.mesh->face_leaf[f];
  double least = 1;
  bool grains = false;
  if (leaf[0] < 0 || leaf[1] < 0) return 0;
  for (int side = 0; side < 2; side++) {
    const double c = sim->c->v[leaf[side]];
    const double counted = HOLDS_GRAINS * sim->c->v[leaf[!side]];
    if (!(c > few)) continue;
    const double w = sim->yield.still->v[leaf[side]];
    least = min2(least, c < counted ? max2(w, 1 - c / counted) : w);
    grains = true;
  }
  return grains ? least : 0;
}

/* Set mean [nfaces_all] to m_c of u*. */
static void find_mean(struct two_phase *sim,
                      const struct projection *projection, const double *rho,
                      double dt, double *mean) {
  const struct mesh *mesh = sim->grid.mesh;
  const struct bc *bc[DIM];
  double *u[DIM];
  scratch_take(&sim->scratch, FIELD_CELL, __func__, DIM, u);
  for (int e = 0; e < DIM; e++) {
    bc[e] = sim->u[e]->bc;
    for (int32_t i = 0; i < mesh->nleaves; i++) {
      u[e][i] = sim->u[e]->v[i] + dt * sim->g[e]->v[i];
    }
  }
  mesh_fill(mesh, DIM, u, bc, false);
  struct projection by_grains = *projection;
  by_grains.rho = rho;
  projection_face_velocity(&by_grains, 0, u, mean);
  scratch_give(&sim->scratch, __func__);
}

/* Set held [nfaces_all] to tau_y on faces that do not yield, else to 0, and
 * tau [nfaces_all] to tau_y. */
static void find_held(const struct two_phase *sim, double *tau, double *held) {
  const struct mesh *mesh = sim->grid.mesh;
  const struct yield *yield = &sim->yield;
  double *face[] = {tau, held};
  for (int d = 0; d < DIM; d++) {
    for (int32_t f = mesh->face_begin[d]; f < mesh->face_begin[d + 1]; f++) {
      tau[f] = yield->tau_y->v[f];
      held[f] = yield_is_reached(yield, d, f) ? 0 : tau[f];
    }
  }
  mesh_fill_faces(mesh, 2, face);
}

void still_remember(struct two_phase *sim, double *g[DIM]) {
  const size_t bytes = (size_t)sim->grid.mesh->nleaves * sizeof(double);
  scratch_take(&sim->scratch, FIELD_CELL, "remembered", DIM, g);
  for (int e = 0; e < DIM; e++) memcpy(g[e], sim->g[e]->v, bytes);
}

void still_keep(struct two_phase *sim, double dt, double *const g[DIM]) {
  const struct mesh *mesh = sim->grid.mesh;
  double *face[2];
  scratch_take(&sim->scratch, FIELD_FACE, __func__, 2, face);
  find_held(sim, face[0], face[1]);
  /* a single phase has not renewed g for the load of this step */
  const bool renewed = !sim->params->single_phase;
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    const double tau = mesh_mean(mesh, face[0], i);
    const double held = mesh_mean(mesh, face[1], i);
    if (!renewed || tau == 0 || held < (1 - WEAK) * tau) continue;
    for (int e = 0; e < DIM; e++) {
      sim->u[e]->v[i] +=
          sim->yield.still->v[i] * dt * (g[e][i] - sim->g[e]->v[i]);
    }
  }
  for (int e = 0; e < DIM; e++) mesh_touch(mesh, sim->u[e]->v);
  scratch_give(&sim->scratch, __func__);
  scratch_give(&sim->scratch, "remembered");
}

void still_blend(const struct two_phase *sim, const double *slowly,
                 double *u_f) {
  const struct mesh *mesh = sim->grid.mesh;
  const double few = least_grains(sim);
  for (int32_t f = 0; f < mesh->nfaces; f++) {
    u_f[f] += face_weight(sim, few, f) * (slowly[f] - u_f[f]);
  }
  mesh_fill_faces(mesh, 1, &u_f);
}

void still_face_velocity(struct two_phase *sim,
                         const struct projection *projection, const double *rho,
                         double dt, double *u_f) {
  const struct mesh *mesh = sim->grid.mesh;
  double *mean = scratch_take_one(&sim->scratch, FIELD_FACE, __func__);
  find_mean(sim, projection, rho, dt, mean);
  poisson_flux(mesh, projection->alpha_f, sim->p->v, projection->flux);
  for (int32_t f = 0; f < mesh->nfaces; f++) {
    mean[f] += dt * projection->flux[f];
  }
  still_blend(sim, mean, u_f);
  scratch_give(&sim->scratch, __func__);
}
