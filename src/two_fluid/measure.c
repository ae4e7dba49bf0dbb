/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/two_fluid/measure.h"

#include <math.h>
#include <string.h>

#include "talus/error.h"
#include "talus/memory.h"
#include "talus/minmax.h"
#include "talus/two_fluid/properties.h"
#include "talus/two_fluid/state.h"
#include "talus/two_fluid_grains.h"

/* Sums over leaves. */
enum {
  VOLUME,
  FLUID_VOLUME,
  KINETIC,
  FLUID_KINETIC,
  POTENTIAL,
  SPEED2,
  WITHIN, /* grains within the contour, and its area */
  AREA,
  MOMENTUM,
  NSUMS = MOMENTUM + 3
};

double two_fluid_mean_velocity(const struct two_fluid *sim, int32_t i, int d) {
  const double flux = mesh_mean_along(sim->grid.mesh, sim->flux->v, i, d);
  return two_fluid_has_grains(sim, i) ? flux / sim->alpha->v[i] : 0;
}

static double speed_squared(const struct two_fluid *sim, int32_t i) {
  double sum = 0;
  for (int d = 0; d < DIM; d++) {
    const double u = two_fluid_mean_velocity(sim, i, d);
    sum += u * u;
  }
  return sum;
}

double two_fluid_carrying_speed(const struct two_fluid *sim) {
  const struct mesh *mesh = sim->grid.mesh;
  double fastest = 0;
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    if (sim->alpha->v[i] < sim->keys->alpha_surface) continue;
    fastest = max2(fastest, speed_squared(sim, i));
  }
  return sqrt(mesh_max(mesh, fastest));
}

static void add_leaf(const struct two_fluid *sim, int32_t i,
                     double sum[NSUMS]) {
  const struct mesh *mesh = sim->grid.mesh;
  const double rho_s = two_fluid_density(sim, TWO_FLUID_S);
  const double rho_f = two_fluid_density(sim, TWO_FLUID_F);
  const double alpha = sim->alpha->v[i], volume = mesh_volume(mesh, i);
  const double grains = alpha * volume, fluid = (1 - alpha) * volume;
  sum[VOLUME] += grains;
  sum[FLUID_VOLUME] += fluid;
  for (int d = 0; d < DIM; d++) {
    const double u_s = sim->u[TWO_FLUID_S][d]->v[i];
    const double u_f = sim->u[TWO_FLUID_F][d]->v[i];
    sum[KINETIC] += 0.5 * rho_s * grains * u_s * u_s;
    sum[FLUID_KINETIC] += 0.5 * rho_f * fluid * u_f * u_f;
    sum[POTENTIAL] -=
        (rho_s - rho_f) * grains * sim->params->gravity[d] * mesh->x[i][d];
    sum[MOMENTUM + d] += rho_s * grains * u_s + rho_f * fluid * u_f;
  }
  sum[SPEED2] += grains * speed_squared(sim, i);
  if (alpha < sim->keys->alpha_surface) return;
  sum[WITHIN] += grains;
  sum[AREA] += volume;
}

static void sum_leaves(const struct two_fluid *sim, double sum[NSUMS]) {
  const struct mesh *mesh = sim->grid.mesh;
  for (int32_t i = 0; i < mesh->nleaves; i++) add_leaf(sim, i, sum);
  MPI_CHECK(
      MPI_Allreduce(MPI_IN_PLACE, sum, NSUMS, MPI_DOUBLE, MPI_SUM, mesh->comm));
}

double two_fluid_energy(const struct two_fluid *sim) {
  double sum[NSUMS] = {0};
  sum_leaves(sim, sum);
  return sum[KINETIC] + sum[FLUID_KINETIC] + sum[POTENTIAL];
}

/* Return how far the contour lies from the centre of a leaf inside it along
 * axis d, on its upper or lower side, in edges; at most one. */
static double reach(const struct two_fluid *sim, int32_t i, int side) {
  const double at = sim->keys->alpha_surface, here = sim->alpha->v[i];
  const double there =
      sim->alpha->v[sim->grid.mesh->stencil[i][stencil_face(side)]];
  return there < at && here > there ? (here - at) / (here - there) : 0.5;
}

/* Find the ends of the contour; alpha is filled. */
static void find_contour(const struct two_fluid *sim,
                         struct two_fluid_measures *m) {
  const struct mesh *mesh = sim->grid.mesh;
  const struct params *params = sim->params;
  const int axis = outline_axis(params->gravity);
  const double up = params->gravity[axis] > 0 ? -1 : 1;
  double front = -HUGE_VAL, top = -HUGE_VAL;
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    double distance = 0;
    if (sim->alpha->v[i] < sim->keys->alpha_surface) continue;
    for (int d = 0; d < DIM; d++) {
      const double away = mesh->x[i][d] - params->origin[d];
      const double edge = mesh->h[i] * reach(sim, i, 2 * d + 1);
      if (d != axis) distance += (away + edge) * (away + edge);
    }
    front = max2(front, sqrt(distance));
    const double z = up * mesh->x[i][axis];
    top = max2(top, z + mesh->h[i] * reach(sim, i, 2 * axis + (up > 0)));
  }
  const double side =
      up > 0 ? params->origin[axis]
             : -params->origin[axis] - params->size * params->trees[axis];
  front = mesh_max(mesh, front), top = mesh_max(mesh, top);
  m->front = isfinite(front) ? front : 0;
  if (DIM == 2) m->front += params->origin[1 - axis];
  m->height = isfinite(top) ? top - side : 0;
}

/* Make the outline of solid volume over that of the start. */
static void find_outline(const struct two_fluid *sim,
                         struct two_fluid_measures *m) {
  const struct mesh *mesh = sim->grid.mesh;
  bool *heap = MEM_NEW(bool, (size_t)mesh->nleaves);
  double *c = MEM_NEW(double, (size_t)mesh->nleaves);
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    heap[i] = true;
    c[i] = sim->alpha->v[i] / sim->keys->alpha_start;
  }
  outline_measure(mesh, c, heap, outline_axis(sim->params->gravity),
                  &m->outline);
  m->grain_height = outline_height(&m->outline);
  const double end = sim->params->front_height;
  const double half_grain = 0.5 * sim->closure.param[TWO_FLUID_GRAINS_D];
  m->grain_front = outline_front(&m->outline, end > 0 ? end : half_grain);
  mem_free(heap), mem_free(c);
}

void two_fluid_measure_layers(const struct two_fluid *sim, double **layer) {
  const struct mesh *mesh = sim->grid.mesh;
  const size_t n = (size_t)mesh->nleaves;
  bool *heap = MEM_NEW(bool, n);
  double *c = MEM_NEW(double, n);
  for (int k = 0; k < sim->params->ntracers; k++) {
    struct outline outline;
    for (int32_t i = 0; i < mesh->nleaves; i++) {
      heap[i] = true;
      c[i] = sim->tracer[k]->v[i] * sim->alpha->v[i] / sim->keys->alpha_start;
    }
    outline_measure(mesh, c, heap, outline_axis(sim->params->gravity),
                    &outline);
    layer[k] = outline.height;
  }
  mem_free(heap), mem_free(c);
}

static void find_extremes(const struct two_fluid *sim,
                          struct two_fluid_measures *m) {
  const struct mesh *mesh = sim->grid.mesh;
  double alpha = 0, p_s = 0, low = -HUGE_VAL, high = -HUGE_VAL, flux = 0;
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    alpha = max2(alpha, sim->alpha->v[i]);
    p_s = max2(p_s, sim->p_s->v[i]);
    low = max2(low, -sim->p->v[i]);
    high = max2(high, sim->p->v[i]);
  }
  for (int32_t f = 0; f < mesh->nfaces; f++)
    flux = max2(flux, fabs(sim->flux->v[f]));
  m->max_alpha = mesh_max(mesh, alpha);
  m->max_solid_pressure = mesh_max(mesh, p_s);
  m->least_pressure = -mesh_max(mesh, low);
  m->most_pressure = mesh_max(mesh, high);
  m->max_flux = mesh_max(mesh, flux);
}

void two_fluid_measure(struct two_fluid *sim, struct two_fluid_measures *m) {
  double sum[NSUMS] = {0};
  memset(m, 0, sizeof *m);
  two_fluid_properties(sim);
  sum_leaves(sim, sum);
  m->volume = sum[VOLUME];
  m->fluid_volume = sum[FLUID_VOLUME];
  m->kinetic = sum[KINETIC];
  m->fluid_kinetic = sum[FLUID_KINETIC];
  m->potential = sum[POTENTIAL];
  for (int d = 0; d < DIM; d++) m->momentum[d] = sum[MOMENTUM + d];
  if (sum[VOLUME] > 0) {
    m->grain_speed = sqrt(sum[SPEED2] / sum[VOLUME]);
    m->suspended = 1 - sum[WITHIN] / sum[VOLUME];
  }
  if (sum[AREA] > 0) m->mean_alpha = sum[WITHIN] / sum[AREA];
  m->max_speed = two_fluid_carrying_speed(sim);
  find_extremes(sim, m);
  find_contour(sim, m);
  find_outline(sim, m);
}

/* Return the shear rate of leaf i, the mean over its faces. */
static double shear_rate(const struct two_fluid *sim, int32_t i) {
  const int32_t *face = sim->grid.mesh->cell_face[i];
  double sum = 0;
  for (int s = 0; s < NFACE; s++) sum += sim->shear_f[TWO_FLUID_S]->v[face[s]];
  return sum / NFACE;
}

/* Return what viscosity gives leaf i of stress, and friction unless it yields
 * exactly: then what friction grows by with the shear rate. */
static double viscous_stress(const struct two_fluid *sim, int32_t i) {
  const struct two_fluid_closure *c = &sim->closure;
  const double gamma = shear_rate(sim, i), p_s = max2(sim->p_s->v[i], 0);
  const double phi = sim->phi->v[i], eta = sim->eta->v[i];
  const double Theta = sim->Theta->v[i];
  const struct two_fluid_stress s =
      two_fluid_stress(c, phi, p_s, gamma, eta, Theta);
  if (!sim->exact)
    return two_fluid_capped(&s, gamma, sim->keys->gamma_r, sim->eta_max) *
           gamma;
  const double held = two_fluid_stress(c, phi, p_s, 0, eta, Theta).tau_y;
  return s.eta * gamma + max2(s.tau_y - held, 0);
}

/* Set `stress` [nfaces_all] to the yield stress that faces hold, Pa. */
static void find_held(const struct two_fluid *sim, double *stress) {
  const struct mesh *mesh = sim->grid.mesh;
  const struct yield *yield = &sim->yield;
  double *rows[STRAIN_ROWS];
  for (int k = 0; k < yield->nrows; k++) rows[k] = yield->s[k]->v;
  for (int d = 0; d < DIM; d++)
    for (int32_t f = mesh->face_begin[d]; f < mesh->face_begin[d + 1]; f++)
      stress[f] = yield->tau_y->v[f] > 0
                      ? sqrt(strain_norm_squared(yield->nrows, rows, d, f))
                      : 0;
  mesh_fill_faces(mesh, 1, &stress);
}

/* Return the mean of a stress over the faces of leaf i that have one. */
static double mean_held(const struct mesh *mesh, const double *stress,
                        int32_t i) {
  double sum = 0;
  int n = 0;
  for (int s = 0; s < NFACE; s++) {
    const double here = stress[mesh->cell_face[i][s]];
    sum += here, n += here > 0;
  }
  return n > 0 ? sum / n : 0;
}

void two_fluid_find_stress(const struct two_fluid *sim, double *stress) {
  const struct mesh *mesh = sim->grid.mesh;
  double *held = MEM_NEW(double, mesh->nfaces_all);
  if (sim->exact) find_held(sim, held);
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    stress[i] = 0;
    if (!two_fluid_has_grains(sim, i)) continue;
    stress[i] = viscous_stress(sim, i);
    if (sim->exact) stress[i] += mean_held(mesh, held, i);
  }
  mem_free(held);
}
