/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/two_phase/properties.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "talus/minmax.h"
#include "talus/params.h"
#include "talus/plane.h"
#include "talus/vof.h"

/* A line this close to a surface, in leaf edges, from end to end lies half in
 * the grains: round-off must not choose. */
#define ALONG 1e-9

/* Weight that the place of the surface has in a full leaf, more than in a film
 * beside it, and in an empty one, which counts where the face has no other. */
#define FULL 0.01
#define EMPTY 1e-30

static inline double unit_range(double c) { return min2(max2(c, 0), 1); }

/* Return the mean fraction of the leaves, not the nodes, of a face: see
 * properties.h. */
static inline double face_fraction(const struct mesh *mesh, const double *c,
                                   int32_t f) {
  const int32_t *of =
      mesh->face_patch[f] < 0 ? mesh->face_leaf[f] : mesh->face_node[f];
  return 0.5 * (unit_range(c[of[0]]) + unit_range(c[of[1]]));
}

void properties_density(const struct mesh *mesh, const double density[2],
                        const double *c, const bool *closed, double *rho,
                        double *alpha_f) {
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    rho[i] = density[1] + unit_range(c[i]) * (density[0] - density[1]);
  }
  mesh_touch(mesh, rho);
  for (int32_t f = 0; f < mesh->nfaces; f++) {
    const int patch = mesh->face_patch[f];
    const double c_f = face_fraction(mesh, c, f);
    alpha_f[f] = patch >= 0 && closed[patch]
                     ? 0
                     : 1 / (density[1] + c_f * (density[0] - density[1]));
  }
  mesh_fill_faces(mesh, 1, &alpha_f);
}

/* Find the potential g.(x_S - Z) of the surface in or at leaf i, from its plane
 * or from the faces where a full leaf meets an empty one. Returns false if
 * there is none. */
static bool surface_potential(const struct mesh *mesh,
                              const double gravity[DIM],
                              const double origin[DIM], const double *c,
                              double *const normal[DIM], const double *plane,
                              int32_t i, double *potential) {
  double at[DIM] = {0}, n[DIM];
  int count = 0;
  if (vof_is_cut(c[i])) {
    for (int d = 0; d < DIM; d++) n[d] = normal[d][i];
    plane_foot(n, plane[i], at);
    count = 1;
  } else {
    for (int f = 0; f < NFACE; f++) {
      const double next = c[mesh->stencil[i][stencil_face(f)]];
      if ((next > 0.5) == (c[i] > 0.5) || vof_is_cut(next)) continue;
      at[f >> 1] += f & 1 ? 0.5 : -0.5;
      count++;
    }
  }
  *potential = 0;
  if (count == 0) return false;
  for (int d = 0; d < DIM; d++) {
    *potential +=
        gravity[d] * (mesh->x[i][d] - origin[d] + mesh->h[i] * at[d] / count);
  }
  return true;
}

/* Give the potential of a leaf with a surface to its neighbours: c interpolated
 * in them, on the coarse side of a jump of level, feels that surface. */
static void spread_potential(const struct mesh *mesh,
                             const struct gravity *gravity, const double *c) {
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    double potential = gravity->surface[i], count = gravity->count[i], near = 0;
    for (int f = 0; f < NFACE; f++) { /* > 0 in children of a leaf with 1 */
      near = max2(near, gravity->count[mesh->stencil[i][stencil_face(f)]]);
    }
    const bool search = near > 0 && count == 0;
    for (int f = 0; f < NFACE && search; f++) {
      int32_t node = mesh->stencil[i][stencil_face(f)];
      if (node >= mesh->begin_boundary) continue;
      if (node >= mesh->begin_virtual) {
        node = mesh->virtual_leaf[(node - mesh->begin_virtual) / NCHILD];
      }
      if (gravity->count[node] == 0) continue;
      potential += gravity->surface[node];
      count += gravity->count[node];
    }
    gravity->near_surface[i] = count > 0 ? potential / count : 0;
    gravity->near_weight[i] =
        count > 0 ? max2(c[i] * (1 + FULL - c[i]), EMPTY) : 0;
  }
}

/* Set W and, where the potential was, c, filled as p is; and the potential next
 * to surfaces. */
static void set_surface(const struct mesh *mesh, const double density[2],
                        const struct gravity *gravity, const double *c,
                        double *const normal[DIM], const double *plane) {
  static const struct bc neumann[MESH_MAX_PATCHES];
  const struct bc *bc[] = {neumann, neumann, neumann};
  double *cells[] = {gravity->surface, gravity->count};
  double *potentials[] = {gravity->weight, gravity->surface};
  double *ghosts[] = {gravity->near_surface, gravity->near_weight};
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    double weight = 0;
    for (int d = 0; d < DIM; d++) {
      weight += gravity->bounded[d] * (mesh->x[i][d] - gravity->origin[d]);
    }
    gravity->weight[i] =
        weight * (density[1] + c[i] * (density[0] - density[1]));
    gravity->count[i] =
        surface_potential(mesh, gravity->bounded, gravity->origin, c, normal,
                          plane, i, &gravity->surface[i]);
  }
  mesh_fill(mesh, 2, cells, bc, true);
  spread_potential(mesh, gravity, c);
  mesh_fill_ghosts(mesh, 2, ghosts);
  memcpy(gravity->surface, c, (size_t)mesh->nleaves * sizeof *c);
  mesh_fill_potential(mesh, gravity->rho, 2, potentials, bc, true);
}

void properties_gravity(const struct mesh *mesh, const double density[2],
                        const struct gravity *gravity, const double *c,
                        double *const normal[DIM], const double *plane,
                        const double *alpha_f, double *gravity_f) {
  const double *fraction = gravity->surface;
  set_surface(mesh, density, gravity, c, normal, plane);
  for (int d = 0; d < DIM; d++) {
    const double along = gravity->periodic[d];
    for (int32_t f = mesh->face_begin[d]; f < mesh->face_begin[d + 1]; f++) {
      const int32_t *node = mesh->face_node[f], *leaf = mesh->face_leaf[f];
      if (mesh->face_patch[f] >= 0) {
        gravity_f[f] = alpha_f[f] > 0 ? gravity->bounded[d] + along : 0;
        continue;
      }
      const double jump =
          (density[0] - density[1]) * (fraction[node[1]] - fraction[node[0]]);
      double potential = 0, count = 0;
      for (int side = 0; side < 2 && jump != 0; side++) {
        const double weight = gravity->near_weight[leaf[side]];
        potential += weight * gravity->near_surface[leaf[side]];
        count += weight;
      }
      const double weight = gravity->weight[node[1]] -
                            gravity->weight[node[0]] -
                            (count > 0 ? jump * potential / count : 0);
      gravity_f[f] = along + mesh_slope(mesh, f, alpha_f[f] * weight);
    }
  }
  mesh_fill_faces(mesh, 1, &gravity_f);
}

/* Where the grains are. */
struct grains {
  const double *density; /* of grains and gas */
  const double *c;
  double *const *normal; /* planes of cut leaves */
  const double *plane;
};

/* Return the part in the grains of the line from the node on `side` of a face
 * to the face, by the plane of the leaf there; the node is the leaf itself or
 * one of its children. The line begins in the phase with most of the mass of
 * the leaf, whose velocity the leaf has: at the surface if the node is on the
 * other side. */
static double line_fraction(const struct mesh *mesh, int d, int32_t f, int side,
                            const struct grains *grains) {
  const int32_t leaf = mesh->face_leaf[f][side];
  const int32_t node = mesh->face_node[f][side];
  const double c = grains->c[leaf];
  if (!vof_is_cut(c)) return unit_range(c);
  const bool coarse = node >= mesh->begin_virtual;
  const bool heavy = c * grains->density[0] > (1 - c) * grains->density[1];
  double at_node = -grains->plane[leaf];
  for (int e = 0; e < DIM && coarse; e++) {
    const int upper = (node - mesh->begin_virtual) % NCHILD >> e & 1;
    at_node += grains->normal[e][leaf] * (upper ? 0.25 : -0.25);
  }
  const double reach = (side ? -0.5 : 0.5) * (coarse ? 0.5 : 1);
  const double at_face = at_node + reach * grains->normal[d][leaf];
  if (max2(fabs(at_node), fabs(at_face)) < ALONG) return 0.5;
  at_node = heavy ? min2(at_node, 0) : max2(at_node, 0);
  if (at_node <= 0 && at_face <= 0) return 1;
  if (at_node > 0 && at_face > 0) return 0;
  return (at_node <= 0 ? -at_node : -at_face) / fabs(at_node - at_face);
}

/* Give both halves of the line of a face; one across a boundary mirrors the
 * other. */
static void line_halves(const struct mesh *mesh, int d, int32_t f,
                        const struct grains *grains, double half[2]) {
  const int32_t *leaf = mesh->face_leaf[f];
  for (int side = 0; side < 2; side++) {
    if (leaf[side] >= 0) {
      half[side] = line_fraction(mesh, d, f, side, grains);
    }
  }
  if (leaf[0] < 0) half[0] = half[1];
  if (leaf[1] < 0) half[1] = half[0];
}

void properties_pressure(const struct mesh *mesh, const double density[2],
                         const double gravity[DIM], const double *c,
                         double *const normal[DIM], const double *plane,
                         const double *p, const bool *closed, double *theta_f,
                         double *p_f) {
  const struct grains grains = {density, c, normal, plane};
  for (int d = 0; d < DIM; d++) {
    for (int32_t f = mesh->face_begin[d]; f < mesh->face_begin[d + 1]; f++) {
      const int32_t *node = mesh->face_node[f];
      const int patch = mesh->face_patch[f];
      double half[2] = {0}, rho[2];
      line_halves(mesh, d, f, &grains, half);
      for (int side = 0; side < 2; side++) {
        rho[side] = density[1] + half[side] * (density[0] - density[1]);
      }
      theta_f[f] = 0.5 * (half[0] + half[1]);
      p_f[f] = (rho[1] * p[node[0]] + rho[0] * p[node[1]]) / (rho[0] + rho[1]);
      if (patch >= 0 && closed[patch]) {
        const int32_t i = mesh->face_owner[f];
        const double out = node[0] == i ? 0.5 : -0.5;
        p_f[f] = p[i] + out * mesh->h[i] * rho[0] * gravity[d];
      }
    }
  }
}

/* Faces whose line lies in both phases, a block of them. */
enum { BLOCK = 512 };
struct mixed {
  int32_t n, face[BLOCK];
  double theta[BLOCK], p[BLOCK];
  double shear[2][BLOCK], eta[2][BLOCK]; /* of grains and gas */
};

/* Find eta of two phases in series, which share the stress, not the shear rate:
 *   gamma = theta gamma_1 + (1 - theta) gamma_2,
 *   eta_1 gamma_1 = eta_2 gamma_2,
 *   eta = 1 / (theta/eta_1 + (1 - theta)/eta_2).
 * Stresses grow with their rates, so gamma_1 is found by halving its range.
 * Grains that took the rate of the whole line, most of which is the gas's,
 * would give way too easily under a dense gas. */
static void share_stress(double time, const struct rheology *const phase[2],
                         const double *shear_f, struct mixed *m,
                         double *eta_f) {
  enum { HALVINGS = 24 };
  double low[BLOCK] = {0}, high[BLOCK];
  for (int32_t i = 0; i < m->n; i++) {
    high[i] = shear_f[m->face[i]] / m->theta[i];
  }
  for (int j = 0; j <= HALVINGS; j++) {
    for (int32_t i = 0; i < m->n; i++) {
      const double theta = m->theta[i], gamma = 0.5 * (low[i] + high[i]);
      m->shear[0][i] = gamma;
      m->shear[1][i] = (shear_f[m->face[i]] - theta * gamma) / (1 - theta);
    }
    for (int k = 0; k < 2; k++) {
      rheology_eval(phase[k], time, m->n, m->shear[k], m->p, m->eta[k]);
    }
    for (int32_t i = 0; i < m->n; i++) {
      const double excess =
          m->eta[0][i] * m->shear[0][i] - m->eta[1][i] * m->shear[1][i];
      *(excess > 0 ? &high[i] : &low[i]) = m->shear[0][i];
    }
  }
  for (int32_t i = 0; i < m->n; i++) {
    const double theta = m->theta[i];
    const double eta[2] = {max2(m->eta[0][i], DBL_MIN),
                           max2(m->eta[1][i], DBL_MIN)};
    eta_f[m->face[i]] = 1 / (theta / eta[0] + (1 - theta) / eta[1]);
  }
  m->n = 0;
}

void properties_mix(const struct mesh *mesh, double time,
                    const struct rheology *const phase[2],
                    const double *theta_f, const double *shear_f,
                    const double *p_f, double *eta_f) {
  double eta_gas[BLOCK];
  struct mixed m;
  m.n = 0; /* the rest, which is large, need not be cleared */
  for (int32_t begin = 0; begin < mesh->nfaces; begin += BLOCK) {
    const int32_t n =
        begin + BLOCK < mesh->nfaces ? BLOCK : mesh->nfaces - begin;
    rheology_eval(phase[1], time, n, shear_f + begin, p_f + begin, eta_gas);
    for (int32_t k = 0; k < n; k++) {
      const int32_t f = begin + k;
      if (theta_f[f] < PARAMS_GAS) {
        eta_f[f] = eta_gas[k];
      } else if (theta_f[f] < 1 - PARAMS_GAS) {
        m.face[m.n] = f, m.theta[m.n] = theta_f[f], m.p[m.n] = p_f[f];
        if (++m.n == BLOCK) share_stress(time, phase, shear_f, &m, eta_f);
      }
    }
  }
  share_stress(time, phase, shear_f, &m, eta_f);
}

void properties_viscosity(const struct mesh *mesh, double time,
                          const struct phase *grains, const struct phase *gas,
                          const double gravity[DIM], const double *c,
                          double *const normal[DIM], const double *plane,
                          const double *p, const bool *closed,
                          const double *shear_f, double *const work[2],
                          double *eta_f) {
  double *theta_f = work[0], *p_f = work[1];
  const double density[2] = {grains->density,
                             gas ? gas->density : grains->density};
  properties_pressure(mesh, density, gravity, c, normal, plane, p, closed,
                      theta_f, p_f);
  rheology_eval(&grains->rheology, time, mesh->nfaces, shear_f, p_f, eta_f);
  if (gas) {
    const struct rheology *const phase[2] = {&grains->rheology, &gas->rheology};
    properties_mix(mesh, time, phase, theta_f, shear_f, p_f, eta_f);
  }
  mesh_fill_faces(mesh, 1, &eta_f);
}
