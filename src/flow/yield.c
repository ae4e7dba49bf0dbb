/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/yield.h"

#include <math.h>
#include <string.h>

#include "talus/error.h"
#include "talus/log.h"
#include "talus/minmax.h"
#include "talus/params.h"
#include "talus/remap.h"
#include "talus/scratch.h"

/* Stress within this part of the yield stress has reached it. */
#define REACHED 1e-6
/* gamma_r in units of the rate of the flow, and the least part of it where
 * grains hardly flow. */
#define STIFF 5e-4
#define HARDLY 0.1
/* yield_least_rate in units of the rate of the flow. */
#define LEAST_RATE 1e-6
/* D*.D^n and |D*| are at least and at most this, in |D^n|^2 and |D^n|. */
#define LEAST 0.2
#define MOST 3
/* D is extrapolated where the cosine between two changes of it is above this:
 * elsewhere it is carried past the face, and its change is noise. A change that
 * is not extrapolated is kept this much smaller, for its direction. */
#define AGREE 0.99
#define FORGOTTEN 1e-3
/* Solves of a step are repeated, MOST_SOLVES in all, until their mismatch is at
 * most FIT. A heap that has lost 10 % of its stress has 0.035 and would move by
 * 1.4e-5 sqrt(g L). Above BAD the user is told. */
#define FIT 0.0005
#define BAD 0.02
enum { MOST_SOLVES = 32 };

static struct field *add(struct fields *fields, const struct mesh *mesh,
                         const char *name, const char *unit,
                         const char *title) {
  struct field *field =
      fields_add(fields, mesh, name, unit, title, FIELD_FACE, &remap_faces);
  field->restart = true;
  return field;
}

void yield_add(struct yield *yield, struct fields *fields,
               struct mesh *const *mesh, bool compressible) {
  static const char *const stress[] = {"stress_0", "stress_1", "stress_2",
                                       "stress_3", "stress_4"};
  static const char *const strain[] = {"strain_0", "strain_1", "strain_2",
                                       "strain_3", "strain_4"};
  static const char *const trend[] = {"strain_trend_0", "strain_trend_1",
                                      "strain_trend_2", "strain_trend_3",
                                      "strain_trend_4"};
  yield->mesh = mesh;
  yield->compressible = compressible;
  yield->nrows = compressible ? STRAIN_ROWS : strain_rows(*mesh);
  for (int k = 0; k < yield->nrows; k++) {
    yield->s[k] = add(fields, *mesh, stress[k], "Pa", "yield stress");
    yield->strain[k] = add(fields, *mesh, strain[k], "1/s", "rate of strain");
    yield->trend[k] = add(fields, *mesh, trend[k], "1/s^2", "its change");
  }
  yield->tau_y =
      add(fields, *mesh, "yield_stress", "Pa", "bound of the yield stress");
}

/* Find the length of the domain. */
static double find_length(const struct params *params) {
  double length = 0;
  for (int d = 0; d < DIM; d++) {
    length = max2(length, params->size * params->trees[d]);
  }
  return length;
}

/* Give the larger of the rates of fall, sqrt(g/H), and of flow; without either
 * that of the run. */
static double larger_rate(const struct params *params, double height,
                          double flow) {
  const double rate = max2(sqrt(params_gravity(params) / height), flow);
  return rate > 0 ? rate : 1 / params->stop;
}

double yield_least_rate(const struct params *params, double speed) {
  const double length = find_length(params);
  return LEAST_RATE * larger_rate(params, length, speed / length);
}

void yield_set_rate(struct yield *yield, const struct params *params,
                    double density, double speed) {
  const struct mesh *mesh = *yield->mesh;
  const double weight = density * params_gravity(params);
  const double length = find_length(params);
  double most = 0;
  for (int32_t f = 0; f < mesh->nfaces; f++) {
    most = max2(most, yield->tau_y->v[f]);
  }
  most = mesh_max(mesh, most);
  const double height = most > 0 && weight > 0 ? most / weight : length;
  yield->gamma_r = STIFF * larger_rate(params, height, speed / length);
}

/* Loops over faces are compiled for the number n of rows in a plane and for
 * that in rings. */
#define KERNEL static inline __attribute__((always_inline))

/* Set `guess` to D* at face f, over dt. */
KERNEL void extrapolate(const struct yield *yield, int n, int32_t f, double dt,
                        double guess[STRAIN_ROWS]) {
  double now[STRAIN_ROWS], product = 0, size = 0, most = 0;
  for (int k = 0; k < n; k++) {
    now[k] = yield->strain[k]->v[f];
    guess[k] = now[k] + dt * yield->trend[k]->v[f];
    product += guess[k] * now[k];
    size += now[k] * now[k];
    most += guess[k] * guess[k];
  }
  const bool turns = product<LEAST * size, leaps = most> MOST * MOST * size;
  for (int k = 0; k < n && (turns || leaps); k++) {
    guess[k] = turns ? LEAST * now[k] : now[k];
  }
}

/* Project q, of n rows, on |q| <= tau_y; returns the factor that does it. */
KERNEL double project(int n, double q[STRAIN_ROWS], int d, double tau_y) {
  double *rows[STRAIN_ROWS];
  for (int k = 0; k < STRAIN_ROWS; k++) rows[k] = &q[k];
  const double size = strain_norm_squared(n, rows, d, 0);
  if (!(size > tau_y * tau_y)) return 1;
  const double m = tau_y / sqrt(size);
  for (int k = 0; k < n; k++) q[k] *= m;
  return m;
}

/* Give the shear rate of u^n at face f of axis d if D* has left out a jolt,
 * else 0. */
KERNEL double find_jolt(const struct yield *yield, int n,
                        double guess[STRAIN_ROWS], int d, int32_t f) {
  double *rows[STRAIN_ROWS];
  for (int k = 0; k < STRAIN_ROWS; k++) rows[k] = &guess[k];
  const double shear = yield->shear->v[f];
  const double excess = shear - yield->gamma_r / STIFF;
  if (!(excess > 0)) return 0;
  const double known = 2 * sqrt(strain_norm_squared(n, rows, d, 0));
  return excess > 2 * known ? shear : 0;
}

static double face_volume(const struct mesh *mesh, int32_t f) {
  const double h = mesh->face_h[f];
  return DIM == 2 ? h * h : h * h * h;
}

/* Set rate [ncells] of leaves and ghosts to the mean |D| of their sides; face:
 * work [nfaces_all]. Returns the mean |D| where grains flow, by the power that
 * the yield stress takes. */
static double find_local_rate(const struct yield *yield, double *face,
                              double *rate) {
  const struct mesh *mesh = *yield->mesh;
  const int n = yield->nrows;
  double *rows[STRAIN_ROWS], power = 0, moment = 0;
  for (int k = 0; k < n; k++) rows[k] = yield->strain[k]->v;
  for (int d = 0; d < DIM; d++) {
    for (int32_t f = mesh->face_begin[d]; f < mesh->face_begin[d + 1]; f++) {
      face[f] = sqrt(strain_norm_squared(n, rows, d, f));
      const double part = face_volume(mesh, f) * yield->tau_y->v[f] * face[f];
      power += part, moment += part * face[f];
    }
  }
  mesh_fill_faces(mesh, 1, &face);
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    rate[i] = mesh_mean(mesh, face, i);
  }
  mesh_fill_ghosts(mesh, 1, &rate);
  power = mesh_sum(mesh, power), moment = mesh_sum(mesh, moment);
  return power > 0 ? moment / power : 0;
}

/* Set r of each face. */
static void set_stiffness(const struct yield *yield, double *r) {
  const struct mesh *mesh = *yield->mesh;
  double *rate = scratch_take_one(yield->scratch, FIELD_CELL, __func__);
  const double flow = STIFF * find_local_rate(yield, r, rate);
  const double most = yield->gamma_r;
  const double gamma_r = max2(HARDLY * most, min2(most, flow));
  for (int32_t f = 0; f < mesh->nfaces; f++) {
    const int32_t *leaf = mesh->face_leaf[f];
    const double lower = rate[leaf[leaf[0] < 0]];
    const double upper = rate[leaf[leaf[1] >= 0]];
    r[f] = yield->tau_y->v[f] / (gamma_r + 0.5 * (lower + upper));
  }
  scratch_give(yield->scratch, __func__);
}

/* Set rows to D, or its deviator, of the velocity u. */
static void find_strain(const struct yield *yield, double *const u[DIM],
                        double *const rows[STRAIN_ROWS]) {
  const struct skin *skin = yield->skin ? *yield->skin : NULL;
  if (yield->compressible)
    strain_find_deviator(*yield->mesh, skin, u, rows);
  else
    strain_find(*yield->mesh, skin, u, rows);
}

void yield_start(const struct yield *yield, double *const u[DIM]) {
  const struct mesh *mesh = *yield->mesh;
  const int n = yield->nrows;
  double *strain[STRAIN_ROWS], q[STRAIN_ROWS];
  double *r = scratch_take_one(yield->scratch, FIELD_FACE, __func__);
  for (int k = 0; k < n; k++) strain[k] = yield->strain[k]->v;
  find_strain(yield, u, strain);
  set_stiffness(yield, r);
  for (int d = 0; d < DIM; d++) {
    for (int32_t f = mesh->face_begin[d]; f < mesh->face_begin[d + 1]; f++) {
      for (int k = 0; k < n; k++) q[k] = 2 * r[f] * strain[k][f];
      project(n, q, d, yield->tau_y->v[f]);
      for (int k = 0; k < n; k++) yield->s[k]->v[f] = q[k];
    }
  }
  scratch_give(yield->scratch, __func__);
}

/* Set eta and the stress m s^n at face f of axis d. */
KERNEL void linearise_face(const struct yield *yield, int n, int d, int32_t f,
                           double dt, const double *r, double *eta,
                           double *const stress[]) {
  const int nrows = DIM == 2 ? n : DIM;
  const double tau_y = yield->tau_y->v[f];
  double q[STRAIN_ROWS];
  eta[f] = yield->eta->v[f];
  for (int e = 0; e < nrows; e++) stress[e][f] = 0;
  if (r[f] == 0) return;
  extrapolate(yield, n, f, dt, q);
  const double jolt = find_jolt(yield, n, q, d, f);
  for (int k = 0; k < n; k++) q[k] = yield->s[k]->v[f] + 2 * r[f] * q[k];
  double m = project(n, q, d, tau_y);
  if (jolt > 0) m = min2(m, tau_y / (r[f] * jolt));
  eta[f] += m * r[f];
  for (int e = 0; e < nrows; e++) stress[e][f] = m * yield->s[e]->v[f];
}

void yield_linearise(const struct yield *yield, double dt, double *r,
                     double *eta, double *const force[DIM]) {
  const struct mesh *mesh = *yield->mesh;
  double *stress[STRAIN_ROWS];
  const int n = DIM == 2 ? yield->nrows : DIM;
  scratch_take(yield->scratch, FIELD_FACE, __func__, n, stress);
  set_stiffness(yield, r);
  for (int d = 0; d < DIM; d++) {
    for (int32_t f = mesh->face_begin[d]; f < mesh->face_begin[d + 1]; f++) {
      if (yield->nrows == DIM) {
        linearise_face(yield, DIM, d, f, dt, r, eta, stress);
      } else {
        linearise_face(yield, STRAIN_ROWS, d, f, dt, r, eta, stress);
      }
    }
  }
  mesh_fill_faces(mesh, 1, &eta);
  mesh_fill_faces(mesh, n, stress);
  strain_divergence(mesh, stress, force);
  scratch_give(yield->scratch, __func__);
}

/* Renew the trend of D at face f, which is now `strain` after dt. */
KERNEL void renew_trend(const struct yield *yield, int n, int32_t f, double dt,
                        const double strain[STRAIN_ROWS]) {
  double change[STRAIN_ROWS], product = 0, size = 0, last = 0;
  for (int k = 0; k < n; k++) {
    const double before = yield->trend[k]->v[f];
    change[k] = (strain[k] - yield->strain[k]->v[f]) / dt;
    product += change[k] * before;
    size += change[k] * change[k], last += before * before;
  }
  const bool agree = product > AGREE * sqrt(size * last);
  for (int k = 0; k < n; k++) {
    yield->trend[k]->v[f] = change[k] * (agree ? 1 : FORGOTTEN);
  }
}

/* Give |T| of one tensor, of n rows. */
KERNEL double norm(int n, double tensor[STRAIN_ROWS], int d) {
  double *rows[STRAIN_ROWS];
  for (int k = 0; k < n; k++) rows[k] = &tensor[k];
  return sqrt(strain_norm_squared(n, rows, d, 0));
}

/* Take D and the stress at face f of axis d from a solve with m, and add to sum
 * what the mismatch (yield.h) has sums of. */
KERNEL void advance_face(const struct yield *yield, int n, int d, int32_t f,
                         double volume, double r, double m,
                         const double strain[STRAIN_ROWS], double sum[4]) {
  const double tau_y = yield->tau_y->v[f];
  double now[STRAIN_ROWS], q[STRAIN_ROWS], lack[STRAIN_ROWS];
  for (int k = 0; k < n; k++) {
    yield->strain[k]->v[f] = now[k] = strain[k];
    q[k] = yield->s[k]->v[f] + 2 * r * now[k];
    lack[k] = -m * q[k];
  }
  project(n, q, d, tau_y);
  for (int k = 0; k < n; k++) yield->s[k]->v[f] = q[k];
  if (r == 0) return;
  for (int k = 0; k < n; k++) q[k] += 2 * r * now[k];
  project(n, q, d, tau_y);
  for (int k = 0; k < n; k++) lack[k] += q[k];
  const double size = volume * norm(n, lack, d);
  sum[0] += size;
  sum[1] += volume * tau_y;
  sum[2] += size / (2 * r);
  sum[3] += volume * norm(n, now, d);
}

/* Do it at faces of axis d; eta: of the solve. */
KERNEL void advance_faces(const struct yield *yield, int n, int d, double dt,
                          const double *r, const double *eta,
                          double *const rows[STRAIN_ROWS], bool again,
                          double sum[4]) {
  const struct mesh *mesh = *yield->mesh;
  for (int32_t f = mesh->face_begin[d]; f < mesh->face_begin[d + 1]; f++) {
    const double volume = face_volume(mesh, f);
    const double m = r[f] > 0 ? (eta[f] - yield->eta->v[f]) / r[f] : 0;
    double strain[STRAIN_ROWS];
    for (int k = 0; k < n; k++) strain[k] = rows[k][f];
    if (!again) renew_trend(yield, n, f, dt, strain);
    advance_face(yield, n, d, f, volume, r[f], m, strain, sum);
  }
}

double yield_advance(const struct yield *yield, double dt, const double *r,
                     const double *eta, double *const u[DIM], bool again) {
  const struct mesh *mesh = *yield->mesh;
  const int n = yield->nrows;
  double *rows[STRAIN_ROWS], sum[4] = {0};
  scratch_take(yield->scratch, FIELD_FACE, __func__, n, rows);
  find_strain(yield, u, rows);
  for (int d = 0; d < DIM; d++) {
    if (n == DIM) {
      advance_faces(yield, DIM, d, dt, r, eta, rows, again, sum);
    } else {
      advance_faces(yield, STRAIN_ROWS, d, dt, r, eta, rows, again, sum);
    }
  }
  scratch_give(yield->scratch, __func__);
  for (int k = 0; k < 4; k++) sum[k] = mesh_sum(mesh, sum[k]);
  const double part = sum[0] / max2(sum[1], 1e-300);
  return sum[2] < sum[3] ? part * sum[2] / sum[3] : part;
}

bool yield_fits(struct yield *yield, long long step, int solves,
                double mismatch) {
  if (mismatch <= FIT) return true;
  if (solves < MOST_SOLVES) return false;
  log_info(
      "step %lld: %d solves leave a mismatch of stress and load of %.3g, "
      "wanted is %g",
      step, solves, mismatch, FIT);
  if (!(mismatch > BAD) || yield->misfits++ > 0) return true;
  WARN(
      "step %lld: %d solves leave a mismatch of stress and load of %.3g; above "
      "%g grains that the yield stress holds may move, and others lag: take a "
      "smaller solver.dt_max (said once; run.log has all)",
      step, solves, mismatch, BAD);
  return true;
}

bool yield_is_reached(const struct yield *yield, int d, int32_t f) {
  double *rows[STRAIN_ROWS];
  const double least = (1 - REACHED) * yield->tau_y->v[f];
  for (int k = 0; k < yield->nrows; k++) rows[k] = yield->s[k]->v;
  return least > 0 &&
         strain_norm_squared(yield->nrows, rows, d, f) >= least * least;
}

void yield_find_state(const struct yield *yield, const double *part,
                      double *state) {
  const struct mesh *mesh = *yield->mesh;
  double *flows = scratch_take_one(yield->scratch, FIELD_FACE, __func__);
  for (int d = 0; d < DIM; d++) {
    for (int32_t f = mesh->face_begin[d]; f < mesh->face_begin[d + 1]; f++) {
      flows[f] = yield_is_reached(yield, d, f);
    }
  }
  mesh_fill_faces(mesh, 1, &flows);
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    state[i] = part[i] < 0.5 ? 0 : mesh_mean(mesh, flows, i);
  }
  scratch_give(yield->scratch, __func__);
}
