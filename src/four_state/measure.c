/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/four_state/measure.h"

#include <math.h>
#include <string.h>

#include "talus/error.h"
#include "talus/four_state/properties.h"
#include "talus/four_state/state.h"
#include "talus/four_state/temperature.h"
#include "talus/memory.h"
#include "talus/minmax.h"

/* Grains slower than this times sqrt(g d) count as slow. */
static const double SLOW = 0.1;

/* Sums over leaves. */
enum {
  VOLUME,
  KINETIC,
  POTENTIAL,
  ELASTIC,
  SLOW_VOLUME,
  SPEED2,
  PART, /* and three more */
  AREA = PART + 4,
  MOMENTUM,
  NSUMS = MOMENTUM + 3
};

static double speed_squared(const struct four_state *sim, int32_t i) {
  double sum = 0;
  for (int d = 0; d < DIM; d++) sum += sim->u[d]->v[i] * sim->u[d]->v[i];
  return sum;
}

/* Return the square of the speed below which grains are slow, m^2/s^2. */
static double slow_squared(const struct four_state *sim) {
  return SLOW * SLOW * params_gravity(sim->params) *
         sim->closure.param[LEE_HUANG_D];
}

static void add_leaf(const struct four_state *sim, int32_t i, double slow2,
                     double sum[NSUMS]) {
  const struct mesh *mesh = sim->grid.mesh;
  const double rho = sim->closure.param[LEE_HUANG_RHO_D];
  const double nu = sim->nu->v[i], grains = nu * mesh_volume(mesh, i);
  const double u2 = speed_squared(sim, i);
  sum[VOLUME] += grains;
  sum[KINETIC] += 0.5 * rho * grains * u2;
  for (int d = 0; d < DIM; d++) {
    sum[POTENTIAL] -= rho * grains * sim->params->gravity[d] * mesh->x[i][d];
    sum[MOMENTUM + d] += rho * grains * sim->u[d]->v[i];
  }
  sum[ELASTIC] += grains * four_state_elastic(&sim->closure, nu);
  sum[SPEED2] += grains * u2;
  if (u2 < slow2) sum[SLOW_VOLUME] += grains;
}

static void sum_leaves(const struct four_state *sim, double sum[NSUMS]) {
  const struct mesh *mesh = sim->grid.mesh;
  const double slow2 = slow_squared(sim);
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    if (sim->nu->v[i] > 0) add_leaf(sim, i, slow2, sum);
  }
  MPI_CHECK(
      MPI_Allreduce(MPI_IN_PLACE, sum, NSUMS, MPI_DOUBLE, MPI_SUM, mesh->comm));
}

double four_state_energy(const struct four_state *sim) {
  double sum[NSUMS] = {0};
  sum_leaves(sim, sum);
  return sum[KINETIC] + sum[POTENTIAL] + sum[ELASTIC] +
         four_state_fluctuating(sim);
}

struct four_state_store four_state_store(const struct four_state *sim) {
  double sum[NSUMS] = {0};
  sum_leaves(sim, sum);
  return (struct four_state_store){
      .mass = sim->closure.param[LEE_HUANG_RHO_D] * sum[VOLUME],
      .kinetic = sum[KINETIC],
      .other = sum[ELASTIC] + four_state_fluctuating(sim)};
}

/* Return how far the contour lies from the centre of a leaf inside it along
 * axis d, on its upper or lower side, in edges; at most one. */
static double reach(const struct four_state *sim, int32_t i, int side) {
  const double at = sim->keys->nu_surface, here = sim->nu->v[i];
  const double there =
      sim->nu->v[sim->grid.mesh->stencil[i][stencil_face(side)]];
  return there < at && here > there ? (here - at) / (here - there) : 0.5;
}

/* Find the ends of the contour; nu is filled. */
static void find_contour(const struct four_state *sim,
                         struct four_state_measures *m) {
  const struct mesh *mesh = sim->grid.mesh;
  const int axis = outline_axis(sim->params->gravity);
  const double up = sim->params->gravity[axis] > 0 ? -1 : 1;
  double front = -HUGE_VAL, top = -HUGE_VAL, fastest = 0;
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    double distance = 0;
    if (sim->nu->v[i] < sim->keys->nu_surface) continue;
    for (int d = 0; d < DIM; d++) {
      const double away = mesh->x[i][d] - sim->params->origin[d];
      const double edge = mesh->h[i] * reach(sim, i, 2 * d + 1);
      if (d != axis) distance += (away + edge) * (away + edge);
    }
    front = max2(front, sqrt(distance));
    const double z = up * mesh->x[i][axis];
    top = max2(top, z + mesh->h[i] * reach(sim, i, 2 * axis + (up > 0)));
    fastest = max2(fastest, speed_squared(sim, i));
  }
  const double side = up > 0 ? sim->params->origin[axis]
                             : -sim->params->origin[axis] -
                                   sim->params->size * sim->params->trees[axis];
  front = mesh_max(mesh, front), top = mesh_max(mesh, top);
  m->front = isfinite(front) ? front : 0;
  if (DIM == 2) m->front += sim->params->origin[1 - axis];
  m->height = isfinite(top) ? top - side : 0;
  m->max_speed = sqrt(mesh_max(mesh, fastest));
}

/* Make the outline of solid volume over that of the start. */
static void find_outline(const struct four_state *sim,
                         struct four_state_measures *m) {
  const struct mesh *mesh = sim->grid.mesh;
  bool *heap = MEM_NEW(bool, (size_t)mesh->nleaves);
  double *c = MEM_NEW(double, (size_t)mesh->nleaves);
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    heap[i] = true;
    c[i] = sim->nu->v[i] / sim->keys->nu_start;
  }
  outline_measure(mesh, c, heap, outline_axis(sim->params->gravity),
                  &m->outline);
  m->grain_height = outline_height(&m->outline);
  const double end = sim->params->front_height;
  const double half_grain = 0.5 * sim->closure.param[LEE_HUANG_D];
  m->grain_front = outline_front(&m->outline, end > 0 ? end : half_grain);
  mem_free(heap), mem_free(c);
}

void four_state_find_states(struct four_state *sim, double *contact,
                            double *name) {
  const struct mesh *mesh = sim->grid.mesh;
  double *u[DIM];
  field_arrays(sim->u, u);
  field_fill_many(mesh, DIM, sim->u);
  four_state_contacts(sim);
  four_state_shear(sim, u);
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    const double p = sim->p->v[i];
    const double part = p > 0 ? sim->p_E->v[i] / p : 0;
    double gamma = 0;
    for (int s = 0; s < NFACE; s++)
      gamma = max2(gamma, mesh_side(mesh, sim->shear_f->v, i, s));
    if (contact) contact[i] = part;
    if (name) name[i] = four_state_name(&sim->closure, part, gamma);
  }
}

/* Add the areas of the states. */
static void add_states(struct four_state *sim, double sum[NSUMS]) {
  const struct mesh *mesh = sim->grid.mesh;
  double *name = MEM_NEW(double, (size_t)mesh->nleaves);
  four_state_find_states(sim, NULL, name);
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    if (sim->nu->v[i] < sim->keys->nu_surface) continue;
    sum[PART + (int)name[i]] += mesh_volume(mesh, i);
    sum[AREA] += mesh_volume(mesh, i);
  }
  mem_free(name);
}

void four_state_measure(struct four_state *sim, struct four_state_measures *m) {
  const struct mesh *mesh = sim->grid.mesh;
  double sum[NSUMS] = {0}, nu = 0, p = 0;
  memset(m, 0, sizeof *m);
  add_states(sim, sum);
  sum_leaves(sim, sum);
  m->volume = sum[VOLUME];
  m->kinetic = sum[KINETIC];
  m->potential = sum[POTENTIAL];
  m->elastic = sum[ELASTIC];
  m->fluctuating = four_state_fluctuating(sim);
  for (int d = 0; d < DIM; d++) m->momentum[d] = sum[MOMENTUM + d];
  if (sum[VOLUME] > 0) {
    m->slow = sum[SLOW_VOLUME] / sum[VOLUME];
    m->grain_speed = sqrt(sum[SPEED2] / sum[VOLUME]);
  }
  for (int k = 0; k < 4 && sum[AREA] > 0; k++)
    m->part[k] = sum[PART + k] / sum[AREA];
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    nu = max2(nu, sim->nu->v[i]);
    p = max2(p, sim->p->v[i]);
  }
  m->max_nu = mesh_max(mesh, nu);
  m->max_pressure = mesh_max(mesh, p);
  field_fill(mesh, sim->nu);
  find_contour(sim, m);
  find_outline(sim, m);
}
