/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/two_fluid/jumps.h"

#include <string.h>

#include "talus/outline.h"
#include "talus/two_fluid/properties.h"
#include "talus/two_fluid/state.h"

/* Return P of side s of leaf i, of the velocities v over dt that its face has
 * got. */
static double pressure_at(const struct two_fluid *sim, double dt, int32_t i,
                          int s, const double v[]) {
  const int d = s / 2;
  const bool level = d != outline_axis(sim->params->gravity);
  const double rho_s = two_fluid_density(sim, TWO_FLUID_S);
  const double rho_f = two_fluid_density(sim, TWO_FLUID_F);
  const double alpha = sim->alpha->v[i], upper = sim->upper[d]->v[i];
  const double part = alpha * (s & 1 ? upper : 1 - upper);
  const double weight = part * (rho_s - rho_f) * sim->params->gravity[d];
  const double thrust = part * rho_s * v[TWO_FLUID_S] / dt +
                        0.5 * (1 - alpha) * rho_f * v[TWO_FLUID_F] / dt -
                        weight;
  const double p =
      sim->p->v[i] + sim->p_s->v[i] - (level ? sim->lack->v[i] : 0);
  return p + (s & 1 ? -1 : 1) * sim->grid.mesh->h[i] * thrust;
}

/* Set P of faces of axis d between levels, as their finer leaf finds it. */
static void find_pressures(const struct two_fluid *sim, double dt, int d,
                           const double *const v[], double *P) {
  const struct mesh *mesh = sim->grid.mesh;
  memset(P, 0, (size_t)mesh->nfaces_all * sizeof *P);
  for (int32_t f = mesh->face_begin[d]; f < mesh->face_begin[d + 1]; f++) {
    const int32_t *leaf = mesh->face_leaf[f];
    if (leaf[0] < 0 || leaf[1] < 0) continue;
    const int finer = mesh->level[leaf[1]] > mesh->level[leaf[0]];
    if (mesh->level[leaf[0]] == mesh->level[leaf[1]]) continue;
    const double both[] = {v[0][f], v[1][f]};
    P[f] = pressure_at(sim, dt, leaf[finer], 2 * d + !finer, both);
  }
  mesh_fill_faces(mesh, 1, &P);
}

void two_fluid_jumps(struct two_fluid *sim, double dt, int d,
                     const double *const v[], double *more) {
  const struct mesh *mesh = sim->grid.mesh;
  double *P = scratch_take_one(&sim->scratch, FIELD_FACE, __func__);
  find_pressures(sim, dt, d, v, P);
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    const double alpha = sim->alpha->v[i];
    const double mass = alpha * two_fluid_density(sim, TWO_FLUID_S) +
                        (1 - alpha) * two_fluid_density(sim, TWO_FLUID_F);
    more[i] = 0;
    for (int s = 2 * d; s < 2 * d + 2; s++) {
      const int32_t f = mesh->cell_face[i][s];
      if (f < mesh->begin_face_average) continue;
      const double both[] = {v[0][f], v[1][f]};
      const double lack = P[f] - pressure_at(sim, dt, i, s, both);
      more[i] += (s & 1 ? -1 : 1) * dt * lack / (mesh->h[i] * mass);
    }
    more[i] *= 1 - two_fluid_stillness(sim, i);
  }
  scratch_give(&sim->scratch, __func__);
}
