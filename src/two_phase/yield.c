/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/two_phase/yield.h"

#include <math.h>
#include <string.h>

#include "talus/error.h"
#include "talus/log.h"
#include "talus/minmax.h"
#include "talus/two_phase/properties.h"
#include "talus/two_phase/state.h"
#include "talus/two_phase/time_step.h"
#include "talus/vof.h"

/* Stress within this part of the yield stress has reached it. */
#define REACHED 1e-6
/* gamma_r in units of the rate of the flow. */
#define STIFF 5e-4
/* Closures that thin are asked for no shear rate below this part of the rate of
 * the flow, as their plastic viscosity has no bound. */
#define LEAST_RATE 1e-6
/* D*.D^n and |D*| are at least and at most this, in |D^n|^2 and |D^n|. */
#define LEAST 0.2
#define MOST 3
/* D is extrapolated where the cosine between two changes of it is above this:
 * elsewhere it is carried past the face, and its change is noise. A change that
 * is not extrapolated is kept this much smaller, for its direction. */
#define AGREE 0.99
#define FORGOTTEN 1e-3
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

/* Set the wet part a [nfaces] of each face. Grains lie on what is beyond a film
 * of gas whose volume in their leaf is below FILM, as gas leaves through them.
 */
static void find_wet(const struct two_phase *sim, double *wet) {
  const struct mesh *mesh = sim->grid.mesh;
  for (int d = 0; d < DIM; d++) {
    for (int32_t f = mesh->face_begin[d]; f < mesh->face_begin[d + 1]; f++) {
      const int32_t *leaf = mesh->face_leaf[f];
      double part = 1;
      for (int side = 0; side < 2; side++) {
        if (leaf[side] < 0) continue;
        const double touches = 1 - (1 - sim->c->v[leaf[side]]) / FILM;
        part = min2(part, max2(touches, wet_side(sim, d, f, side)));
      }
      wet[f] = part;
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
    if (params->boundary[2 * d].type == BOUNDARY_PERIODIC) continue;
    for (int32_t f = mesh->face_begin[d]; f < mesh->face_begin[d + 1]; f++) {
      const int32_t above = mesh->face_leaf[f][g < 0];
      if (above < 0 || !vof_is_cut(sim->c->v[above]) || wet[f] == 0) continue;
      p_f[f] =
          max2(p_f[f], weight * sim->c->v[above] * mesh->h[above] / wet[f]);
    }
  }
}

/* Find the length of the domain. */
static double find_length(const struct params *params) {
  double length = 0;
  for (int d = 0; d < DIM; d++) {
    length = max2(length, params->size * params->trees[d]);
  }
  return length;
}

/* Find the rate U/L of the fastest flow over the domain. */
static double find_flow(const struct two_phase *sim) {
  const struct mesh *mesh = sim->grid.mesh;
  double speed = time_step_boundary_speed(sim, false);
  for (int d = 0; d < DIM; d++) {
    for (int32_t i = 0; i < mesh->nleaves; i++) {
      speed = max2(speed, fabs(sim->u[d]->v[i]));
    }
  }
  return mesh_max(mesh, speed) / find_length(sim->params);
}

/* Give the larger of the rates of fall, sqrt(g/H), and of flow; without either
 * that of the run. */
static double larger_rate(const struct params *params, double height,
                          double flow) {
  double g2 = 0;
  for (int d = 0; d < DIM; d++) g2 += params->gravity[d] * params->gravity[d];
  const double rate = max2(sqrt(sqrt(g2) / height), flow);
  return rate > 0 ? rate : 1 / params->stop;
}

/* Give the height of grains that weighs `stress`; without either the length of
 * the domain. */
static double height_of(const struct params *params, double stress) {
  double g2 = 0;
  for (int d = 0; d < DIM; d++) g2 += params->gravity[d] * params->gravity[d];
  return stress > 0 && g2 > 0 ? stress / (params->grains.density * sqrt(g2))
                              : find_length(params);
}

static double largest_yield_stress(const struct two_phase *sim) {
  double most = 0;
  for (int32_t f = 0; f < sim->grid.mesh->nfaces; f++) {
    most = max2(most, sim->yield.tau_y->v[f]);
  }
  return mesh_max(sim->grid.mesh, most);
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

void yield_update(struct two_phase *sim, double *const u[DIM]) {
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
  const double flow = find_flow(sim);
  const double least =
      LEAST_RATE * larger_rate(params, find_length(params), flow);
  for (int32_t f = 0; f < mesh->nfaces; f++) shear[f] = max2(shear[f], least);
  rheology_parts(&params->grains.rheology, sim->model.time, mesh->nfaces, shear,
                 p_f, eta, tau_y);
  if (!params->single_phase) add_gas(sim, shear, wet, p_f, theta);
  scratch_give(&sim->scratch, __func__);
  mesh_fill_faces(mesh, 1, &eta);
  const double height = height_of(params, largest_yield_stress(sim));
  sim->yield.gamma_r = STIFF * larger_rate(params, height, flow);
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
  const double size = sqrt(strain_norm_squared(n, rows, d, 0));
  const double m = size > tau_y ? tau_y / size : 1;
  for (int k = 0; k < n; k++) q[k] *= m;
  return m;
}

/* Give the shear rate of u^n at face f of axis d if D* has left out a jolt,
 * else 0. */
KERNEL double find_jolt(const struct yield *yield, int n,
                        double guess[STRAIN_ROWS], int d, int32_t f) {
  double *rows[STRAIN_ROWS];
  for (int k = 0; k < STRAIN_ROWS; k++) rows[k] = &guess[k];
  const double known = 2 * sqrt(strain_norm_squared(n, rows, d, 0));
  const double shear = yield->shear->v[f];
  return shear > 2 * known + yield->gamma_r / STIFF ? shear : 0;
}

/* Set rate [ncells] of leaves and ghosts to the mean |D| of their sides; face:
 * work [nfaces_all]. */
static void find_local_rate(const struct two_phase *sim, double *face,
                            double *rate) {
  const struct mesh *mesh = sim->grid.mesh;
  const int n = sim->yield.nrows;
  double *rows[STRAIN_ROWS];
  for (int k = 0; k < n; k++) rows[k] = sim->yield.strain[k]->v;
  for (int d = 0; d < DIM; d++) {
    for (int32_t f = mesh->face_begin[d]; f < mesh->face_begin[d + 1]; f++) {
      face[f] = sqrt(strain_norm_squared(n, rows, d, f));
    }
  }
  mesh_fill_faces(mesh, 1, &face);
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    rate[i] = mesh_mean(mesh, face, i);
  }
  mesh_fill_ghosts(mesh, 1, &rate);
}

/* Set r of each face. */
static void set_stiffness(struct two_phase *sim, double *r) {
  const struct mesh *mesh = sim->grid.mesh;
  double *rate = scratch_take_one(&sim->scratch, FIELD_CELL, __func__);
  find_local_rate(sim, r, rate);
  for (int32_t f = 0; f < mesh->nfaces; f++) {
    const int32_t *leaf = mesh->face_leaf[f];
    const double lower = rate[leaf[leaf[0] < 0]];
    const double upper = rate[leaf[leaf[1] >= 0]];
    r[f] =
        sim->yield.tau_y->v[f] / (sim->yield.gamma_r + 0.5 * (lower + upper));
  }
  scratch_give(&sim->scratch, __func__);
}

/* Set eta and the stress m s^n at face f of axis d. */
KERNEL void linearise_face(const struct two_phase *sim, int n, int d, int32_t f,
                           double dt, const double *r, double *eta,
                           double *const stress[]) {
  const struct yield *yield = &sim->yield;
  double q[STRAIN_ROWS];
  extrapolate(yield, n, f, dt, q);
  const double jolt = find_jolt(yield, n, q, d, f);
  for (int k = 0; k < n; k++) q[k] = yield->s[k]->v[f] + 2 * r[f] * q[k];
  const double tau_y = yield->tau_y->v[f];
  double m = project(n, q, d, tau_y);
  if (jolt > 0 && r[f] > 0) m = min2(m, tau_y / (r[f] * jolt));
  eta[f] = sim->eta_f->v[f] + m * r[f];
  for (int e = 0; e < (DIM == 2 ? n : DIM); e++) {
    stress[e][f] = m * yield->s[e]->v[f];
  }
}

void yield_linearise(struct two_phase *sim, double dt, double *r, double *eta,
                     double *const force[DIM]) {
  const struct mesh *mesh = sim->grid.mesh;
  double *stress[STRAIN_ROWS];
  const int n = mesh_is_axisymmetric(mesh) ? STRAIN_HOOP + 1 : DIM;
  scratch_take(&sim->scratch, FIELD_FACE, __func__, n, stress);
  set_stiffness(sim, r);
  for (int d = 0; d < DIM; d++) {
    for (int32_t f = mesh->face_begin[d]; f < mesh->face_begin[d + 1]; f++) {
      if (sim->yield.nrows == DIM) {
        linearise_face(sim, DIM, d, f, dt, r, eta, stress);
      } else {
        linearise_face(sim, STRAIN_ROWS, d, f, dt, r, eta, stress);
      }
    }
  }
  mesh_fill_faces(mesh, 1, &eta);
  mesh_fill_faces(mesh, n, stress);
  strain_divergence(mesh, stress, force);
  scratch_give(&sim->scratch, __func__);
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
    now[k] = strain[k];
    q[k] = yield->s[k]->v[f] + 2 * r * now[k];
    lack[k] = -m * q[k];
  }
  project(n, q, d, tau_y);
  for (int k = 0; k < n; k++) {
    yield->strain[k]->v[f] = now[k], yield->s[k]->v[f] = q[k];
    q[k] += 2 * r * now[k];
  }
  if (r == 0) return;
  project(n, q, d, tau_y);
  for (int k = 0; k < n; k++) lack[k] += q[k];
  const double size = volume * norm(n, lack, d);
  sum[0] += size;
  sum[1] += volume * tau_y;
  sum[2] += size / (2 * r);
  sum[3] += volume * norm(n, now, d);
}

/* Do it at faces of axis d; eta: of the solve. */
KERNEL void advance_faces(const struct two_phase *sim, int n, int d, double dt,
                          const double *r, const double *eta,
                          double *const rows[STRAIN_ROWS], bool again,
                          double sum[4]) {
  const struct mesh *mesh = sim->grid.mesh;
  for (int32_t f = mesh->face_begin[d]; f < mesh->face_begin[d + 1]; f++) {
    const double h = mesh->face_h[f], volume = DIM == 2 ? h * h : h * h * h;
    const double m = r[f] > 0 ? (eta[f] - sim->eta_f->v[f]) / r[f] : 0;
    double strain[STRAIN_ROWS];
    for (int k = 0; k < n; k++) strain[k] = rows[k][f];
    if (!again) renew_trend(&sim->yield, n, f, dt, strain);
    advance_face(&sim->yield, n, d, f, volume, r[f], m, strain, sum);
  }
}

double yield_advance(struct two_phase *sim, double dt, const double *r,
                     const double *eta, double *const u[DIM], bool again) {
  const struct mesh *mesh = sim->grid.mesh;
  const int n = sim->yield.nrows;
  double *rows[STRAIN_ROWS], sum[4] = {0};
  scratch_take(&sim->scratch, FIELD_FACE, __func__, n, rows);
  strain_find(mesh, sim->skin, u, rows);
  for (int d = 0; d < DIM; d++) {
    if (n == DIM) {
      advance_faces(sim, DIM, d, dt, r, eta, rows, again, sum);
    } else {
      advance_faces(sim, STRAIN_ROWS, d, dt, r, eta, rows, again, sum);
    }
  }
  scratch_give(&sim->scratch, __func__);
  for (int k = 0; k < 4; k++) sum[k] = mesh_sum(mesh, sum[k]);
  const double most = sum[1] * sum[3];
  return most > 0 ? sum[0] * sum[2] / most : 0;
}

void yield_say_misfit(struct two_phase *sim, int solves, double mismatch,
                      double want, double bad) {
  log_info(
      "step %lld: %d solves leave a mismatch of stress and load of %.3g, "
      "wanted is %g",
      (long long)sim->model.step, solves, mismatch, want);
  if (!(mismatch > bad) || sim->yield.misfits++ > 0) return;
  WARN(
      "step %lld: %d solves leave a mismatch of stress and load of %.3g; above "
      "%g grains that the yield stress holds may move, and others lag: take a "
      "smaller solver.dt_max (said once; run.log has all)",
      (long long)sim->model.step, solves, mismatch, bad);
}

bool yield_is_reached(const struct yield *yield, int d, int32_t f) {
  double *rows[STRAIN_ROWS];
  const double least = (1 - REACHED) * yield->tau_y->v[f];
  for (int k = 0; k < yield->nrows; k++) rows[k] = yield->s[k]->v;
  return least > 0 &&
         strain_norm_squared(yield->nrows, rows, d, f) >= least * least;
}

void yield_find_state(struct two_phase *sim, double *state) {
  const struct mesh *mesh = sim->grid.mesh;
  const struct yield *yield = &sim->yield;
  double *flows = scratch_take_one(&sim->scratch, FIELD_FACE, __func__);
  for (int d = 0; d < DIM; d++) {
    for (int32_t f = mesh->face_begin[d]; f < mesh->face_begin[d + 1]; f++) {
      flows[f] = yield_is_reached(yield, d, f);
    }
  }
  mesh_fill_faces(mesh, 1, &flows);
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    state[i] = sim->c->v[i] < 0.5 ? 0 : mesh_mean(mesh, flows, i);
  }
  scratch_give(&sim->scratch, __func__);
}
