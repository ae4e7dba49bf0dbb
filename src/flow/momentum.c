/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/momentum.h"

#include <math.h>

#include "talus/minmax.h"
#include "talus/vof.h"

void momentum_mark_band(const struct mesh *mesh, const double *c, int rings,
                        double *band) {
  static const struct bc neumann[MESH_MAX_PATCHES];
  const struct bc *bc[] = {neumann};
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    double low = 1, high = 0;
    for (int s = 0; s < NSTENCIL; s++) {
      low = min2(low, c[mesh->stencil[i][s]]);
      high = max2(high, c[mesh->stencil[i][s]]);
    }
    band[i] = high > VOF_EMPTY && low < 1 - VOF_EMPTY;
  }
  for (int k = 1; k < rings; k++) mesh_spread(mesh, band);
  mesh_fill(mesh, 1, &band, bc, true);
}

/* Set limited differences of u_e along d, per leaf edge, of leaves that have a
 * face in the band; none in cut leaves. */
static void limited_slopes(const struct mesh *mesh, int d, const double *c,
                           const double *band, double *const u[DIM],
                           double *const slope[DIM]) {
  const int lower = stencil_face(2 * d), upper = stencil_face(2 * d + 1);
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    const int32_t *node = mesh->stencil[i];
    const double near = max2(band[node[lower]], band[node[upper]]);
    if (band[i] <= 0 && near <= 0) continue;
    const bool cut = vof_is_cut(c[i]);
    for (int e = 0; e < DIM; e++) {
      const double left = u[e][i] - u[e][node[lower]];
      const double right = u[e][node[upper]] - u[e][i];
      slope[e][i] = cut ? 0 : minmod(left, right);
    }
  }
  mesh_fill_ghosts(mesh, DIM, slope);
}

void momentum_flux(const struct mesh *mesh, int d, double dt,
                   const double density[2], const double *u_f, const double *c,
                   const double *flux, const double *band, double *const u[DIM],
                   struct momentum_flux *out) {
  limited_slopes(mesh, d, c, band, u, out->slope);
  for (int32_t f = mesh->face_begin[d]; f < mesh->face_begin[d + 1]; f++) {
    out->mass[f] = 0;
    for (int e = 0; e < DIM; e++) out->carried[e][f] = 0;
    if (!momentum_face_in_band(mesh, band, f)) continue;
    const double mass = density[0] * flux[f] + density[1] * (u_f[f] - flux[f]);
    const int upwind = u_f[f] > 0 ? 0 : 1;
    const int32_t node = mesh->face_node[f][upwind];
    const int32_t leaf = mesh->face_leaf[f][upwind];
    out->mass[f] = mass;
    for (int e = 0; e < DIM; e++) {
      double value = u[e][node];
      if (leaf < 0) { /* at the boundary itself */
        value = 0.5 * (value + u[e][mesh->face_node[f][1 - upwind]]);
      } else {
        const double reach = 1 - mesh_face_edges(mesh, f, fabs(u_f[f]) * dt);
        const double half =
            0.5 * mesh_edges(mesh, leaf, mesh->face_h[f]) * reach;
        value += (upwind ? -half : half) * out->slope[e][leaf];
      }
      out->carried[e][f] = mass * value;
    }
  }
  double *v[DIM + 1] = {out->mass};
  for (int e = 0; e < DIM; e++) v[e + 1] = out->carried[e];
  mesh_fill_faces(mesh, DIM + 1, v);
}

/* Return mesh_side in rings, along r, or the plain value. */
static inline double side_of(const struct mesh *mesh, bool rings,
                             const double *v, int32_t i, int s) {
  return rings ? mesh_side(mesh, v, i, s) : v[mesh->cell_face[i][s]];
}

static inline __attribute__((always_inline)) void update_leaves(
    const struct mesh *mesh, bool rings, int d, double dt,
    const double density[2], const double *u_f, const double *c_old,
    const double *cc, const double *band, double *const u_start[DIM],
    const struct momentum_flux *flux, double *const u[DIM]) {
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    const double mass[2] = {side_of(mesh, rings, flux->mass, i, 2 * d),
                            side_of(mesh, rings, flux->mass, i, 2 * d + 1)};
    if (band[i] == 0 && mass[0] == 0 && mass[1] == 0) continue;
    const double k = dt / mesh_width(mesh, i);
    double rho = density[1] + c_old[i] * (density[0] - density[1]);
    double dilation = 0;
    if (band[i] > 0) {
      dilation = (cc[i] > 0 ? density[0] : density[1]) *
                 mesh_net_along(mesh, u_f, i, d);
      rho += k * (dilation - (mass[1] - mass[0]));
    }
    for (int e = 0; e < DIM; e++) {
      const double *carried = flux->carried[e];
      u[e][i] -=
          k / rho *
          ((side_of(mesh, rings, carried, i, 2 * d + 1) - mass[1] * u[e][i]) -
           (side_of(mesh, rings, carried, i, 2 * d) - mass[0] * u[e][i]) -
           dilation * (u_start[e][i] - u[e][i]));
    }
  }
}

void momentum_update(const struct mesh *mesh, int d, double dt,
                     const double density[2], const double *u_f,
                     const double *c_old, const double *cc, const double *band,
                     double *const u_start[DIM],
                     const struct momentum_flux *flux, double *const u[DIM]) {
  if (d == 0 && mesh_is_axisymmetric(mesh)) {
    update_leaves(mesh, true, d, dt, density, u_f, c_old, cc, band, u_start,
                  flux, u);
  } else {
    update_leaves(mesh, false, d, dt, density, u_f, c_old, cc, band, u_start,
                  flux, u);
  }
  for (int e = 0; e < DIM; e++) mesh_touch(mesh, u[e]);
}
