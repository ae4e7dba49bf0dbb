/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/two_phase/yield_faces.h"

#include <math.h>

#include "talus/minmax.h"
#include "talus/two_phase/properties.h"
#include "talus/two_phase/state.h"
#include "talus/two_phase/time_step.h"
#include "talus/vof.h"

/* Volume of gas in a leaf that keeps grains from touching what is beyond. */
#define FILM 0.1

/* Give the part of a face of axis d that the plane of the leaf on `side` wets.
 */
static double wet_side(const struct two_phase *sim, int d, int32_t f,
                       int side) {
  const struct mesh *mesh = sim->grid.mesh;
  const int32_t leaf = mesh->face_leaf[f][side];
  const int32_t node = mesh->face_node[f][side];
  const double c = sim->c->v[leaf];
  if (!vof_is_cut(c) || c < PARAMS_GAS) return c > 0.5;
  double n[DIM], lo[DIM], hi[DIM], alpha = sim->plane->v[leaf], size = 0;
  const bool coarse = node >= mesh->begin_virtual;
  for (int e = 0; e < DIM; e++) {
    n[e] = sim->normal[e]->v[leaf];
    const bool upper = coarse && (node - mesh->begin_virtual) % NCHILD >> e & 1;
    lo[e] = upper ? 0 : -0.5;
    hi[e] = coarse && !upper ? 0 : 0.5;
  }
  alpha -= n[d] * (side ? -0.5 : 0.5);
  n[d] = 0;
  for (int e = 0; e < DIM; e++) size += fabs(n[e]);
  if (size < 1e-12) return alpha > 0 ? 1 : alpha < 0 ? 0 : 0.5;
  return vof_part(mesh, leaf, n, alpha, lo, hi);
}

/* Does the weight of grains act on faces of axis d? */
static bool weighs_along(const struct params *params, int d) {
  return params->gravity[d] != 0 &&
         params->boundary[2 * d].type != BOUNDARY_PERIODIC;
}

/* Set the wet part a [nfaces] of each face. Grains lie on what is beyond a film
 * of gas whose volume in their leaf is below FILM, as gas leaves through them,
 * and on the grains of the leaf below, though their planes may not meet.
 */
static void find_wet(const struct two_phase *sim, double *wet) {
  const struct mesh *mesh = sim->grid.mesh;
  for (int d = 0; d < DIM; d++) {
    const bool weighs = weighs_along(sim->params, d);
    for (int32_t f = mesh->face_begin[d]; f < mesh->face_begin[d + 1]; f++) {
      const int32_t *leaf = mesh->face_leaf[f];
      double part = 1, both = 1;
      for (int side = 0; side < 2; side++) {
        if (leaf[side] < 0) continue;
        const double c = sim->c->v[leaf[side]];
        const double touches = 1 - (1 - c) / FILM;
        part = min2(part, max2(touches, wet_side(sim, d, f, side)));
        both = min2(both, c < PARAMS_GAS ? 0 : c);
      }
      const bool inside = leaf[0] >= 0 && leaf[1] >= 0;
      wet[f] = weighs && inside ? max2(part, both) : part;
    }
  }
}

/* Let the faces below cut leaves bear the weight of their grains. */
static void bear_weight(const struct two_phase *sim, const double *wet,
                        double *p_f) {
  const struct mesh *mesh = sim->grid.mesh;
  const struct params *params = sim->params;
  for (int d = 0; d < DIM; d++) {
    const double g = params->gravity[d];
    const double weight = params->grains.density * fabs(g);
    if (!weighs_along(params, d)) continue;
    for (int32_t f = mesh->face_begin[d]; f < mesh->face_begin[d + 1]; f++) {
      const int32_t above = mesh->face_leaf[f][g < 0];
      if (above < 0 || !vof_is_cut(sim->c->v[above]) || wet[f] == 0) continue;
      p_f[f] =
          max2(p_f[f], weight * sim->c->v[above] * mesh->h[above] / wet[f]);
    }
  }
}

/* Find the speed of the fastest flow. */
static double find_speed(const struct two_phase *sim) {
  const struct mesh *mesh = sim->grid.mesh;
  double speed = time_step_boundary_speed(sim, false);
  for (int d = 0; d < DIM; d++) {
    for (int32_t i = 0; i < mesh->nleaves; i++) {
      speed = max2(speed, fabs(sim->u[d]->v[i]));
    }
  }
  return mesh_max(mesh, speed);
}

/* Let eta_f and tau_y of the grains be those of grains and gas. On a face that
 * is dry, or wet with gas on its line, both are in series there, grains on a
 * part theta; changes wet and theta. */
static void add_gas(struct two_phase *sim, const double *shear, double *wet,
                    const double *p_f, double *theta) {
  const struct params *params = sim->params;
  const struct rheology *const phase[2] = {&params->grains.rheology,
                                           &params->gas.rheology};
  double *eta = sim->eta_f->v, *tau_y = sim->yield.tau_y->v;
  double *dry = scratch_take_one(&sim->scratch, FIELD_FACE, __func__);
  for (int32_t f = 0; f < sim->grid.mesh->nfaces; f++) {
    if (wet[f] == 1 && theta[f] < 1 - PARAMS_GAS) wet[f] = 0;
    if (wet[f] > 0) theta[f] = 0;
    dry[f] = eta[f];
  }
  properties_mix(sim->grid.mesh, sim->model.time, phase, theta, shear, p_f,
                 dry);
  for (int32_t f = 0; f < sim->grid.mesh->nfaces; f++) {
    eta[f] = wet[f] * eta[f] + (1 - wet[f]) * dry[f];
    tau_y[f] *= wet[f];
  }
  scratch_give(&sim->scratch, __func__);
}

void yield_faces_update(struct two_phase *sim, double *const u[DIM]) {
  const struct mesh *mesh = sim->grid.mesh;
  const struct params *params = sim->params;
  double density[2], *normal[DIM], *work[3], *shear = sim->yield.shear->v;
  scratch_take(&sim->scratch, FIELD_FACE, __func__, 3, work);
  double *wet = work[0], *p_f = work[1], *theta = work[2];
  double *eta = sim->eta_f->v, *tau_y = sim->yield.tau_y->v;
  two_phase_densities(sim, density);
  field_arrays(sim->normal, normal);
  strain_shear_rate(mesh, sim->skin, u, shear);
  properties_pressure(mesh, density, params->gravity, sim->c->v, normal,
                      sim->plane->v, sim->p->v, sim->grid.closed, theta, p_f);
  find_wet(sim, wet);
  bear_weight(sim, wet, p_f);
  const double speed = find_speed(sim);
  const double least = yield_least_rate(params, speed);
  for (int32_t f = 0; f < mesh->nfaces; f++) shear[f] = max2(shear[f], least);
  rheology_parts(&params->grains.rheology, sim->model.time, mesh->nfaces, shear,
                 p_f, eta, tau_y);
  if (!params->single_phase) add_gas(sim, shear, wet, p_f, theta);
  scratch_give(&sim->scratch, __func__);
  mesh_fill_faces(mesh, 1, &eta);
  yield_set_rate(&sim->yield, params, params->grains.density, speed);
}
