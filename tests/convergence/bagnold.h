/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Bagnold's profile with mu(I), mu_s = 0.38, delta_mu = 0.26, I0 = 0.3,
 * d = 0.04, in a layer of thickness 1 on a slope, rho = g = 1: friction
 * balances weight, so I is the same at all depths,
 *   mu(I) = tan(slope),  du/dy = I/d sqrt(p/rho),  p = (1 - y) cos(slope),
 *   u = 2/3 I/d sqrt(cos(slope)) (1 - (1 - y)^(3/2))
 * [lagree_staron_popinet_2011, eqs. 2.24-2.26; the prefactor of 2.26 is
 * misprinted, eq. 2.25 gives this one]. On 0.43 rad u(1) = 2.06631. */
#ifndef TALUS_TESTS_BAGNOLD_H
#define TALUS_TESTS_BAGNOLD_H

#include "report.h"
#include "runs.h"

/* max |du/dt| of a flow that counts as steady (at the start it is 0.4), and of
 * one whose distance from the steady one no longer shows. */
static const double kBagnoldSteady = 1e-6, kBagnoldSettled = 1e-8;

static inline double bagnold_inertial(double slope) {
  const double t = tan(slope);
  return 0.3 * (t - 0.38) / (0.38 + 0.26 - t);
}

/* Return the shear rate, or the speed. */
static inline double bagnold_rate(double slope, double y) {
  return bagnold_inertial(slope) / 0.04 * sqrt(cos(slope) * fmax(1 - y, 0));
}
static inline double bagnold_exact(double slope, double y) {
  return 2. / 3 * bagnold_rate(slope, 0) * (1 - pow(1 - y, 1.5));
}

/* Return the error of u in every leaf, [nleaves], for the caller to free. */
static inline double *bagnold_errors(const struct two_phase *sim,
                                     double slope) {
  const struct mesh *mesh = sim->grid.mesh;
  double *error = MEM_NEW(double, mesh->nleaves);
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    error[i] = sim->u[0]->v[i] - bagnold_exact(slope, mesh->x[i][1]);
  }
  return error;
}

static inline struct norms bagnold_norms(const struct two_phase *sim,
                                         double slope) {
  double *error = bagnold_errors(sim, slope);
  const struct norms norms = norms_of(sim->grid.mesh, error);
  mem_free(error);
  return norms;
}

/* Return a leaf next to the surface. */
static inline int32_t bagnold_top(const struct mesh *mesh) {
  int32_t top = 0;
  for (int32_t i = 1; i < mesh->nleaves; i++) {
    if (mesh->x[i][1] > mesh->x[top][1]) top = i;
  }
  return top;
}

/* Return the relative error of u there. */
static inline double bagnold_top_error(const struct two_phase *sim,
                                       double slope) {
  const int32_t i = bagnold_top(sim->grid.mesh);
  const double exact = bagnold_exact(slope, sim->grid.mesh->x[i][1]);
  return fabs(sim->u[0]->v[i] - exact) / exact;
}

#endif
