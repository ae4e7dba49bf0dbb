/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Rates of strain D = (grad u + grad u^T)/2 at faces: normal derivatives from
 * the two nodes of a face, tangential ones the mean of central differences at
 * both, one-sided beside the surface of the grains (skin.h). The stress of
 * viscous.h is made of the same differences.
 * In rings around an axis D_tt = u_r/r is the mean over both nodes.
 */
#ifndef TALUS_STRAIN_H
#define TALUS_STRAIN_H

#include "talus/mesh.h"
#include "talus/skin.h"

/* Rows of a symmetric tensor without trace, T, at a face of axis d:
 *   T[d] T_dd, T[e] T_de for the other axes e; in 3D, t and w being the axes
 *   after d in a circle, T[3] (T_tt - T_ww)/2 and T[4] T_tw, so that both are
 *   treated alike, T_tt, T_ww = -T_dd/2 +- T[3]; and in rings T[STRAIN_HOOP]
 *   T_tt, t around the axis.
 */
enum { STRAIN_ROWS = DIM == 2 ? 3 : 5, STRAIN_HOOP = 2 };

/* Return how many rows a tensor has on a mesh. */
static inline int strain_rows(const struct mesh *mesh) {
  return DIM == 2 && !mesh_is_axisymmetric(mesh) ? DIM : STRAIN_ROWS;
}

/* Give T:T/2 of n rows at face f of axis d. */
static inline double strain_norm_squared(int n, double *const rows[STRAIN_ROWS],
                                         int d, int32_t f) {
  double sum = 0;
  for (int e = 0; e < DIM; e++) sum += rows[e][f] * rows[e][f];
  if (n == DIM) return sum;
  const double a = rows[d][f];
  if (DIM == 2) {
    const double t = rows[STRAIN_HOOP][f];
    return sum + t * t + a * t;
  }
  const double t = rows[STRAIN_ROWS - 2][f], tw = rows[STRAIN_ROWS - 1][f];
  return sum - 0.25 * a * a + t * t + tw * tw;
}

/* shear_f [nfaces] = sqrt(2 D:D) on our own faces; skin: of the mesh, or NULL;
 * u[e] filled. */
void strain_shear_rate(const struct mesh *mesh, const struct skin *skin,
                       double *const u[DIM], double *shear_f);
/* slide_f [nfaces] = sqrt(2 (D:D - (tr D)^2)), in rings with the hoop in both,
 * 0 where that is negative: the shear rate of a flow that keeps its volume, and
 * 0 of one that is squeezed along one axis alone. */
void strain_sliding_rate(const struct mesh *mesh, double *const u[DIM],
                         double *slide_f);
/* rows [strain_rows][nfaces_all]: D, 1/s. Collective. */
void strain_find(const struct mesh *mesh, const struct skin *skin,
                 double *const u[DIM], double *const rows[STRAIN_ROWS]);
/* rows [STRAIN_ROWS][nfaces_all]: D - (tr D)/3 I, 1/s, of a flow that changes
 * its volume; in a plane flow the row of the hoop is that across the plane.
 * Collective. */
void strain_find_deviator(const struct mesh *mesh, const struct skin *skin,
                          double *const u[DIM],
                          double *const rows[STRAIN_ROWS]);
/* force[e] [nleaves] = (div s)_e, N/m^3, of a stress s [nfaces_all], Pa, whose
 * first DIM rows, and in rings the hoop, are filled. */
void strain_divergence(const struct mesh *mesh, double *const s[],
                       double *const force[DIM]);

#endif
