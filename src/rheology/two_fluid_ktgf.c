/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/two_fluid_ktgf.h"

#include <math.h>

#include "two_fluid_sets.h"

static const double PI = 3.14159265358979323846;

/* Distance from the poles at which functions go on linearly. */
static const double MARGIN = 1e-3;

/* Return (phi/phi_max)^(1/3). */
static double crowding(const struct two_fluid_closure *c, double phi) {
  return cbrt(phi / c->param[TWO_FLUID_KT_PHI_MAX]);
}

/* Return A_p; phi g_0' = g_0^2 x/3 with x = (phi/phi_max)^(1/3). */
static struct two_fluid_slope kinetic_pressure(
    const struct two_fluid_closure *c, double phi, double unused) {
  const double rho = c->param[TWO_FLUID_GRAINS_DENSITY];
  const double more = 2 * (1 + c->param[TWO_FLUID_KT_E]);
  const double x = crowding(c, phi), g_0 = 1 / (1 - x);
  (void)unused;
  return (struct two_fluid_slope){
      phi * rho * (1 + more * phi * g_0),
      rho * (1 + more * phi * (2 * g_0 + g_0 * g_0 * x / 3))};
}

/* Return p_f of Johnson & Jackson, eq. 35. */
static struct two_fluid_slope johnson_jackson(const struct two_fluid_closure *c,
                                              double phi, double unused) {
  const double x = phi - c->param[TWO_FLUID_KT_PHI_FR];
  const double room = c->param[TWO_FLUID_KT_PHI_MAX] - phi;
  (void)unused;
  if (x <= 0) return (struct two_fluid_slope){0, 0};
  const double p =
      c->param[TWO_FLUID_KT_STIFFNESS] * x * x / two_fluid_fifth(room);
  return (struct two_fluid_slope){p, p * (2 / x + 5 / room)};
}

/* Return p_f of MFiX, after Syamlal. */
static struct two_fluid_slope syamlal(const struct two_fluid_closure *c,
                                      double phi) {
  const double x = phi - c->param[TWO_FLUID_KT_PHI_STAR];
  if (x <= 0) return (struct two_fluid_slope){0, 0};
  const double slope = 10 * c->param[TWO_FLUID_KT_SYAMLAL] * pow(x, 9);
  return (struct two_fluid_slope){slope * x / 10, slope};
}

static struct two_fluid_slope frictional(const struct two_fluid_closure *c,
                                         double phi) {
  if (c->frictional_pressure == TWO_FLUID_SYAMLAL) return syamlal(c, phi);
  return two_fluid_beyond(johnson_jackson, c, phi, 0,
                          c->param[TWO_FLUID_KT_PHI_MAX] - MARGIN);
}

static struct two_fluid_slope collisions(const struct two_fluid_closure *c,
                                         double phi) {
  return two_fluid_beyond(kinetic_pressure, c, phi, 0,
                          c->param[TWO_FLUID_KT_PHI_MAX] - MARGIN);
}

struct two_fluid_slope two_fluid_ktgf_pressure(
    const struct two_fluid_closure *c, double phi,
    const struct two_fluid_frozen *with) {
  struct two_fluid_slope p = frictional(c, phi);
  if (with->Theta > 0) {
    const struct two_fluid_slope A_p = collisions(c, phi);
    p.value += A_p.value * with->Theta;
    p.slope += A_p.slope * with->Theta;
  }
  return p;
}

struct two_fluid_kinetic two_fluid_kinetic(const struct two_fluid_closure *c,
                                           double phi) {
  const double *v = c->param, e = v[TWO_FLUID_KT_E];
  const double d = v[TWO_FLUID_GRAINS_D], rho = v[TWO_FLUID_GRAINS_DENSITY];
  struct two_fluid_kinetic A = {.p = collisions(c, phi).value};
  phi = fmin(phi, v[TWO_FLUID_KT_PHI_MAX] - MARGIN);
  const double g_0 = 1 / (1 - crowding(c, phi)); /* eq. 37 */
  const double contact = 0.8 * phi * (1 + e) * g_0;
  const double eta_c = phi * contact * rho * d / sqrt(PI); /* eq. 32 */
  const double few = 10 * rho * d * sqrt(PI) / (96 * (1 + e) * g_0);
  A.eta = eta_c + few * (1 + contact) * (1 + contact); /* eq. 33 */
  A.kappa = 5. / 3 * eta_c;                            /* eq. 34 */
  A.loss = 12 * (1 - e * e) * g_0 * rho * phi * phi / (d * sqrt(PI));
  return A;
}

/* Return tau_y/p_s above phi_fr. */
static double friction(const struct two_fluid_closure *c, double phi) {
  const double angle = c->param[TWO_FLUID_KT_ANGLE] * PI / 180;
  if (phi <= c->param[TWO_FLUID_KT_PHI_FR]) return 0;
  return c->friction == TWO_FLUID_SIN ? sin(angle) : tan(angle);
}

struct two_fluid_stress two_fluid_ktgf_stress(const struct two_fluid_closure *c,
                                              double phi, double p_s,
                                              double Theta) {
  const struct two_fluid_kinetic A = two_fluid_kinetic(c, phi);
  const double s = sqrt(Theta);
  return (struct two_fluid_stress){A.eta * s, p_s * friction(c, phi),
                                   A.kappa * s};
}

/* Return the largest root s >= 0 of a s^2 + b s = B, with a, B >= 0; INFINITY
 * where nothing holds it. */
static double quadratic(double a, double b, double B) {
  const double root = sqrt(b * b + 4 * a * B);
  if (!(B > 0) && b >= 0) return 0;
  if (b >= 0) return b + root > 0 ? 2 * B / (b + root) : INFINITY;
  return a > 0 ? (root - b) / (2 * a) : INFINITY;
}

/* Return the one root s > 0 of a s^3 + b s^2 - B s = C, with a, C > 0 and B >=
 * 0. The start is above it, where the left side is convex, so that Newton's
 * method falls to it. */
static double cubic(double a, double b, double B, double C) {
  enum { MOST = 200 };
  double beyond = cbrt(C / a);
  if (b > 0) beyond = fmin(beyond, sqrt(C / b));
  double s = quadratic(a, b, B) + beyond;
  for (int k = 0; k < MOST; k++) {
    const double miss = ((a * s + b) * s - B) * s - C;
    const double next = s - miss / ((3 * a * s + 2 * b) * s - B);
    if (!(next < s)) break;
    s = next;
  }
  return s;
}

double two_fluid_temperature(const struct two_fluid_closure *c, double phi,
                             double DD, double div, double K, double du2) {
  if (c->set != TWO_FLUID_KTGF) return 0;
  const struct two_fluid_kinetic A = two_fluid_kinetic(c, phi);
  const double B =
      fmax(2 * A.eta * DD + (A.kappa - 2. / 3 * A.eta) * div * div, 0);
  double b = A.p * div + 3 * K, C = 0;
  if (c->production == TWO_FLUID_TOTAL) {
    const double rub = friction(c, phi) * sqrt(2 * DD);
    b -= A.p * rub;
    C = frictional(c, phi).value * (rub - div);
  }
  const double root = C > 0 ? cubic(A.loss, b, B, C) : quadratic(A.loss, b, B);
  const double s = fmin(root, sqrt(du2 / 3));
  return s * s;
}
