/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/two_fluid_pair.h"

void two_fluid_pair_solve(const struct two_fluid_pair *pair, double u[2]) {
  const double rho_s = pair->rho_s, rho_f = pair->rho_f, a_s = u[0], a_f = u[1];
  const double c_s = pair->drag, c_f = c_s * pair->phi / (1 - pair->phi);
  const double determinant = rho_s * rho_f + c_s * rho_f + c_f * rho_s;
  if (!(determinant > 0)) { /* the fluid has no density: nothing moves it */
    if (rho_s + c_s > 0) u[0] = (rho_s * a_s + c_s * a_f) / (rho_s + c_s);
    return;
  }
  u[0] = ((rho_f + c_f) * rho_s * a_s + c_s * rho_f * a_f) / determinant;
  u[1] = ((rho_s + c_s) * rho_f * a_f + c_f * rho_s * a_s) / determinant;
}

double two_fluid_pair_mobility(const struct two_fluid_pair *pair) {
  const double phi = pair->phi, rho_s = pair->rho_s, rho_f = pair->rho_f;
  const double c = pair->drag / (1 - phi); /* k/(phi (1 - phi)) */
  const double rho_m = phi * rho_s + (1 - phi) * rho_f;
  return (phi * rho_f + (1 - phi) * rho_s + c) / (rho_s * rho_f + c * rho_m);
}

double two_fluid_pair_inertia(const struct two_fluid_pair *pair) {
  const double a = 1 - pair->phi;
  return pair->rho_s + pair->rho_f * pair->phi / a + pair->drag / (a * a);
}
