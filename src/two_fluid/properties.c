/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/two_fluid/properties.h"

#include <math.h>

#include "talus/minmax.h"
#include "talus/skin.h"
#include "talus/strain.h"
#include "talus/two_fluid/state.h"
#include "talus/two_fluid/surface.h"
#include "talus/two_fluid_drag.h"
#include "talus/two_fluid_ktgf.h"

/* Weights of leaves in tangential differences where grains do not touch and
 * where there are none. */
#define LOOSE 1e-3
#define NO_GRAINS 1e-6
/* Still grains and the fluid past them are slower than this part of what
 * gravity gives in a step. */
#define SLOW 0.1

/* Interpolated solid fractions stay within those that a leaf may have. */
static void clamp_helpers(const struct two_fluid *sim, double *v, double low,
                          double high) {
  const struct mesh *mesh = sim->grid.mesh;
  for (int32_t i = mesh->begin_virtual; i < mesh->ncells; i++)
    v[i] = min2(max2(v[i], low), high);
}

static void fill_alpha(struct two_fluid *sim) {
  field_fill(sim->grid.mesh, sim->alpha);
  clamp_helpers(sim, sim->alpha->v, 0, two_fluid_densest(&sim->closure));
}

void two_fluid_calm(struct two_fluid *sim) {
  const struct mesh *mesh = sim->grid.mesh;
  const double *alpha = sim->alpha->v;
  for (int e = 0; e < DIM; e++) {
    double *u = sim->u[TWO_FLUID_S][e]->v;
    const double *u_f = sim->u[TWO_FLUID_F][e]->v;
    field_fill(mesh, sim->u[TWO_FLUID_S][e]);
    for (int32_t i = 0; i < mesh->nleaves; i++) {
      double mass = 0, sum = 0;
      if (two_fluid_has_grains(sim, i)) continue;
      for (int s = 0; s < NSTENCIL; s++) {
        const int32_t node = mesh->stencil[i][s];
        if (alpha[node] < TWO_FLUID_NONE) continue;
        mass += alpha[node];
        sum += alpha[node] * u[node];
      }
      u[i] = mass > 0 ? sum / mass : u_f[i];
    }
    mesh_touch(mesh, u);
    field_fill(mesh, sim->u[TWO_FLUID_S][e]);
  }
}

/* Set the shear rates of both phases at faces, filled. */
static void find_shear(struct two_fluid *sim) {
  const struct mesh *mesh = sim->grid.mesh;
  for (int k = 0; k < TWO_FLUID_NPHASES; k++) {
    double *u[DIM];
    field_arrays(sim->u[k], u);
    const struct skin *skin = k == TWO_FLUID_S ? sim->skin : NULL;
    strain_shear_rate(mesh, skin, u, sim->shear_f[k]->v);
    field_fill_faces(mesh, sim->shear_f[k]);
  }
}

/* Set the rates at which grains slide past each other at faces, filled. */
static void find_sliding(struct two_fluid *sim) {
  const struct mesh *mesh = sim->grid.mesh;
  double *u[DIM];
  field_arrays(sim->u[TWO_FLUID_S], u);
  strain_sliding_rate(mesh, u, sim->force_f->v);
  field_fill_faces(mesh, sim->force_f);
}

/* Return the shear rate of a leaf: the mean over its faces, which is exact
 * where it grows linearly. */
static double leaf_shear(const struct mesh *mesh, const double *shear_f,
                         int32_t i) {
  double sum = 0;
  for (int s = 0; s < NFACE; s++) {
    sum += shear_f[mesh->cell_face[i][s]];
  }
  return sum / NFACE;
}

/* Return div u_s of a leaf within the grains; 0 beside leaves without. */
static double leaf_divergence(const struct two_fluid *sim, int32_t i) {
  const struct mesh *mesh = sim->grid.mesh;
  const int32_t *node = mesh->stencil[i];
  double sum = 0;
  for (int d = 0; d < DIM; d++) {
    const double *u = sim->u[TWO_FLUID_S][d]->v;
    const int32_t lo = node[stencil_face(2 * d)];
    const int32_t hi = node[stencil_face(2 * d + 1)];
    if (min2(sim->alpha->v[lo], sim->alpha->v[hi]) < TWO_FLUID_NONE) return 0;
    sum += 0.5 * (u[hi] - u[lo]);
  }
  return mesh_leaf_slope(mesh, i, sum) +
         mesh_hoop(mesh, sim->u[TWO_FLUID_S][0]->v, i);
}

/* Return |u_s - u_f| of nodes a and b, the means by mass. */
static double slip_between(const struct two_fluid *sim, int32_t a, int32_t b) {
  const double *alpha = sim->alpha->v;
  double sum = 0;
  for (int e = 0; e < DIM; e++) {
    double mean[TWO_FLUID_NPHASES];
    for (int k = 0; k < TWO_FLUID_NPHASES; k++) {
      const double *u = sim->u[k][e]->v;
      const double m[2] = {two_fluid_part(k, alpha[a]),
                           two_fluid_part(k, alpha[b])};
      const double M = m[0] + m[1];
      mean[k] = M > TWO_FLUID_NONE ? (m[0] * u[a] + m[1] * u[b]) / M : u[a];
    }
    sum += (mean[0] - mean[1]) * (mean[0] - mean[1]);
  }
  return sqrt(sum);
}

/* Return the shear rate of leaf i less that at which grains below their yield
 * stress creep, as their viscosity is capped: only what yields dilates. */
static double yielding_rate(const struct two_fluid *sim, int32_t i,
                            double phi) {
  const double gamma = sim->shear->v[i];
  if (sim->exact) return gamma; /* two_fluid_shear_leaves has left it out */
  const struct two_fluid_stress stress =
      two_fluid_stress(&sim->closure, phi, max2(sim->load->v[i], 0), gamma,
                       sim->eta->v[i], sim->Theta->v[i]);
  return max2(gamma - stress.tau_y / sim->eta_max, 0);
}

double two_fluid_next_packing(const struct two_fluid *sim, int32_t i,
                              double alpha, double dt) {
  const double phi = max2(alpha, sim->phi->v[i]);
  const double rate =
      two_fluid_plastic_rate(&sim->closure, phi, sim->load->v[i],
                             yielding_rate(sim, i, phi), sim->eta->v[i]);
  return two_fluid_plastic(&sim->closure, sim->phi_p->v[i], rate, dt);
}

/* Return P of leaf i without a surface. */
static double law(const struct two_fluid *sim, int32_t i, double alpha,
                  double dt, double *slope) {
  static const double STEP = 1e-7; /* of alpha, for the slope by phi_p */
  const bool plastic = dt > 0 && sim->closure.set == TWO_FLUID_CRITICAL_STATE;
  struct two_fluid_frozen with = {
      .phi_p = sim->phi_p->v[i], .X = sim->X->v[i], .Theta = sim->Theta->v[i]};
  if (!plastic) return two_fluid_pressure(&sim->closure, alpha, &with, slope);
  with.phi_p = two_fluid_next_packing(sim, i, alpha, dt);
  const double p = two_fluid_pressure(&sim->closure, alpha, &with, slope);
  if (slope == NULL) return p;
  with.phi_p = two_fluid_next_packing(sim, i, alpha + STEP, dt);
  *slope +=
      max2(two_fluid_pressure(&sim->closure, alpha, &with, NULL) - p, 0) / STEP;
  return p;
}

double two_fluid_law(const struct two_fluid *sim, int32_t i, double alpha,
                     double dt, double *slope) {
  const double m = sim->borne->v[i];
  const double p = law(sim, i, alpha, dt, slope), s = m * sim->rest->v[i];
  const double at_rest = s * alpha + m * sim->burden->v[i];
  if (p >= at_rest) return p;
  if (slope != NULL) *slope = s;
  return at_rest;
}

/* Return what shear by 1 would add to the pressure p_s of leaf i, Pa: dense
 * grains dilate, and what holds them together presses until they can. */
static double hardening_of(const struct two_fluid *sim, int32_t i, double p_s) {
  static const double STEP = 1e-6; /* of phi_p */
  const struct two_fluid_closure *c = &sim->closure;
  const double alpha = sim->phi->v[i], phi_p = sim->phi_p->v[i];
  const double gamma = max2(sim->shear->v[i], 1e-12);
  if (c->set != TWO_FLUID_CRITICAL_STATE) return 0;
  const double rate =
      two_fluid_plastic_rate(c, alpha, p_s, gamma, sim->eta->v[i]);
  struct two_fluid_frozen with = {.phi_p = phi_p, .X = sim->X->v[i]};
  const double before = two_fluid_pressure(c, alpha, &with, NULL);
  with.phi_p -= STEP;
  const double rise = two_fluid_pressure(c, alpha, &with, NULL) - before;
  return max2(-rate / gamma * phi_p * rise / STEP, 0);
}

/* Set what leaf i has of its own. */
static void set_leaf(struct two_fluid *sim, int32_t i) {
  const struct mesh *mesh = sim->grid.mesh;
  const struct two_fluid_closure *c = &sim->closure;
  const double alpha = max2(sim->alpha->v[i], 0);
  const double gamma = leaf_shear(mesh, sim->shear_f[TWO_FLUID_S]->v, i);
  const double eta =
      two_fluid_viscosity(c, leaf_shear(mesh, sim->shear_f[TWO_FLUID_F]->v, i));
  const double beta =
      two_fluid_drag_per_phi(c, sim->phi->v[i], slip_between(sim, i, i), eta);
  sim->drag->v[i] = beta;
  sim->shear->v[i] = leaf_shear(mesh, sim->force_f->v, i);
  sim->eta->v[i] = eta;
  sim->Theta->v[i] = sim->p_s->v[i] = sim->hardening->v[i] = 0;
  if (!two_fluid_has_grains(sim, i)) return;
  const double du = gamma * mesh->h[i];
  sim->Theta->v[i] =
      two_fluid_temperature(c, alpha, 0.5 * gamma * gamma,
                            leaf_divergence(sim, i), alpha * beta, du * du);
  sim->p_s->v[i] = two_fluid_law(sim, i, alpha, 0, NULL);
  sim->hardening->v[i] = hardening_of(sim, i, sim->p_s->v[i]);
}

static void set_face_drag(struct two_fluid *sim) {
  const struct mesh *mesh = sim->grid.mesh;
  const struct two_fluid_closure *c = &sim->closure;
  const double *alpha = sim->alpha->v;
  for (int32_t f = 0; f < mesh->nfaces; f++) {
    const int32_t *node = mesh->face_node[f];
    const double eta = two_fluid_viscosity(c, sim->shear_f[TWO_FLUID_F]->v[f]);
    sim->drag_f->v[f] =
        two_fluid_drag_per_phi(c, 0.5 * (alpha[node[0]] + alpha[node[1]]),
                               slip_between(sim, node[0], node[1]), eta);
  }
}

/* Fill what faces take of leaves: p_s, Theta, hardening, phi_p and X. p_s is
 * interpolated by weight, since beside the surface leaves that are nearly empty
 * would get the pressure of those below. */
static void fill_pressure(struct two_fluid *sim) {
  const struct mesh *mesh = sim->grid.mesh;
  const struct bc *bc = sim->p_s->bc;
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    const double c = sim->rest->v[i] > 0 ? sim->c->v[i] : 1;
    sim->weight->v[i] = max2(sim->alpha->v[i], TWO_FLUID_NONE);
    sim->lack->v[i] = (1 - c) * sim->p_s->v[i];
  }
  mesh_touch(mesh, sim->lack->v);
  field_fill(mesh, sim->lack);
  field_fill(mesh, sim->weight);
  clamp_helpers(sim, sim->weight->v, TWO_FLUID_NONE, 1);
  field_fill(mesh, sim->Theta);
  clamp_helpers(sim, sim->Theta->v, 0, HUGE_VAL);
  field_fill(mesh, sim->hardening);
  clamp_helpers(sim, sim->hardening->v, 0, HUGE_VAL);
  field_fill(mesh, sim->phi_p);
  field_fill(mesh, sim->X);
  clamp_helpers(sim, sim->X->v, 0, HUGE_VAL);
  mesh_fill_potential(mesh, sim->weight->v, 1, &sim->p_s->v, &bc, false);
}

/* Find the faces beside leaves in which grains do not touch: what moves there
 * is not continued by the grains of a bed. */
static void find_skin(struct two_fluid *sim) {
  const struct mesh *mesh = sim->grid.mesh;
  double *m = sim->touches->v;
  const double weight =
      params_gravity(sim->params) * (two_fluid_density(sim, TWO_FLUID_S) -
                                     two_fluid_density(sim, TWO_FLUID_F));
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    const double half = 0.5 * weight * mesh->h[i] * sim->alpha->v[i];
    const double c = sim->rest->v[i] > 0 ? sim->c->v[i] : 1;
    m[i] = NO_GRAINS;
    if (!two_fluid_has_grains(sim, i)) continue;
    m[i] = half > 0 ? c * min2(max2(sim->p_s->v[i], 0) / half, 1) : c;
    m[i] = max2(m[i], LOOSE);
  }
  mesh_touch(mesh, m);
  field_fill(mesh, sim->touches);
  clamp_helpers(sim, m, NO_GRAINS, 1);
  sim->skin->grains_only = true;
  skin_find(mesh, m, 1, sim->skin);
}

void two_fluid_properties(struct two_fluid *sim) {
  const struct mesh *mesh = sim->grid.mesh;
  fill_alpha(sim);
  field_fill_many(mesh, DIM, sim->u[TWO_FLUID_F]);
  two_fluid_calm(sim);
  two_fluid_find_surface(sim);
  if (sim->exact) sim->skin->n = 0; /* it may be that of an earlier mesh */
  find_shear(sim);
  find_sliding(sim);
  for (int32_t i = 0; i < mesh->nleaves; i++) set_leaf(sim, i);
  set_face_drag(sim);
  fill_pressure(sim);
  if (sim->exact) find_skin(sim);
  two_fluid_find_contact(sim);
}

/* Return the pressure of the grains on a wall: that of the leaf, and the weight
 * of half the leaf that lies on the wall. */
static double wall_pressure(const struct two_fluid *sim, int d, int32_t f) {
  const struct mesh *mesh = sim->grid.mesh;
  const int32_t i = mesh->face_owner[f];
  const bool low = mesh->face_node[f][1] == i; /* the wall is below */
  const double g = sim->params->gravity[d] * (low ? -1 : 1);
  const double difference =
      two_fluid_density(sim, TWO_FLUID_S) - two_fluid_density(sim, TWO_FLUID_F);
  if (!(sim->p_s->v[i] > 0)) return 0;
  return sim->p_s->v[i] +
         0.5 * sim->alpha->v[i] * difference * max2(g, 0) * mesh->h[i];
}

/* Return what the shear rate gamma of face f adds to its pressure p by X, Pa,
 * which has the part of X that p_s of its leaves has, of the last step. Without
 * it stress would not depend on the shear rate that a solve is after, and all
 * shear would gather where p_s is least
 * (tests/convergence/test_two_fluid_shear.c). */
static double sheared(const struct two_fluid *sim, int32_t f, double alpha,
                      double p, double gamma, double eta_fluid) {
  const struct mesh *mesh = sim->grid.mesh;
  const struct two_fluid_closure *c = &sim->closure;
  const bool side = mesh->face_patch[f] >= 0;
  const int32_t a = side ? mesh->face_owner[f] : mesh->face_node[f][0];
  const int32_t b = side ? mesh->face_owner[f] : mesh->face_node[f][1];
  const double p_s = sim->p_s->v[a] + sim->p_s->v[b];
  struct two_fluid_frozen with = {
      .phi_p = 0.5 * (sim->phi_p->v[a] + sim->phi_p->v[b]),
      .X = p_s > 0 ? (sim->X->v[a] + sim->X->v[b]) * p / p_s : 0};
  const double X =
      two_fluid_relaxed_shear(c, with.X, gamma, eta_fluid, alpha, sim->dt);
  if (X == with.X) return 0;
  const double before = two_fluid_pressure(c, alpha, &with, NULL);
  with.X = X;
  return two_fluid_pressure(c, alpha, &with, NULL) - before;
}

/* Set the viscosities of the grains at face f of axis d. */
static void set_solid(struct two_fluid *sim, int d, int32_t f, double alpha,
                      double eta_fluid) {
  const struct mesh *mesh = sim->grid.mesh;
  const int32_t *node = mesh->face_node[f];
  double *eta = &sim->eta_f[TWO_FLUID_S]->v[f];
  double *kappa = &sim->kappa_f[TWO_FLUID_S]->v[f];
  *eta = *kappa = 0;
  if (sim->exact) sim->yield.tau_y->v[f] = 0;
  if (sim->alpha->v[node[0]] < TWO_FLUID_NONE ||
      sim->alpha->v[node[1]] < TWO_FLUID_NONE)
    return;
  const double *p_s = sim->p_s->v, *Theta = sim->Theta->v;
  const double p = mesh->face_patch[f] >= 0
                       ? wall_pressure(sim, d, f)
                       : 0.5 * (p_s[node[0]] + p_s[node[1]]);
  const double gamma = sim->shear_f[TWO_FLUID_S]->v[f];
  const double *C = sim->hardening->v;
  const double more = 0.5 * (C[node[0]] + C[node[1]]) * (gamma * sim->dt) +
                      sheared(sim, f, alpha, p, gamma, eta_fluid);
  const double T = 0.5 * (Theta[node[0]] + Theta[node[1]]);
  const struct two_fluid_stress stress = two_fluid_stress(
      &sim->closure, alpha, max2(p + more, 0), gamma, eta_fluid, T);
  *kappa = stress.kappa;
  if (!sim->exact) {
    *eta = two_fluid_capped(&stress, gamma, sim->keys->gamma_r, sim->eta_max);
    return;
  }
  const double held = p + sheared(sim, f, alpha, p, 0, eta_fluid);
  const double tau_y =
      two_fluid_stress(&sim->closure, alpha, max2(held, 0), 0, eta_fluid, T)
          .tau_y;
  const double beyond = max2(stress.tau_y - tau_y, 0);
  sim->yield.tau_y->v[f] = tau_y;
  *eta = stress.eta + (gamma > 0 ? beyond / gamma : 0);
}

/* Let faces whose stress is below the yield stress not slide. */
static void hold_faces(struct two_fluid *sim) {
  const struct mesh *mesh = sim->grid.mesh;
  const double *tau_y = sim->yield.tau_y->v;
  for (int d = 0; d < DIM; d++) {
    for (int32_t f = mesh->face_begin[d]; f < mesh->face_begin[d + 1]; f++) {
      if (tau_y[f] > 0 && !yield_is_reached(&sim->yield, d, f))
        sim->force_f->v[f] = 0;
    }
  }
  field_fill_faces(mesh, sim->force_f);
}

/* Ask closures for no smaller shear rates than they can tell from none. */
static void least_shear(struct two_fluid *sim) {
  const double least = yield_least_rate(sim->params, sim->scale);
  double *shear = sim->shear_f[TWO_FLUID_S]->v;
  for (int32_t f = 0; f < sim->grid.mesh->nfaces; f++)
    shear[f] = max2(shear[f], least);
}

void two_fluid_shear_leaves(struct two_fluid *sim) {
  find_sliding(sim);
  if (sim->exact) hold_faces(sim);
  for (int32_t i = 0; i < sim->grid.mesh->nleaves; i++)
    sim->shear->v[i] = leaf_shear(sim->grid.mesh, sim->force_f->v, i);
}

void two_fluid_viscosities(struct two_fluid *sim) {
  const struct mesh *mesh = sim->grid.mesh;
  const double *alpha = sim->alpha->v;
  find_shear(sim);
  if (sim->exact) least_shear(sim);
  for (int d = 0; d < DIM; d++) {
    for (int32_t f = mesh->face_begin[d]; f < mesh->face_begin[d + 1]; f++) {
      const int32_t *node = mesh->face_node[f];
      const double mean = 0.5 * (alpha[node[0]] + alpha[node[1]]);
      const double eta =
          two_fluid_viscosity(&sim->closure, sim->shear_f[TWO_FLUID_F]->v[f]);
      sim->eta_f[TWO_FLUID_F]->v[f] =
          (1 - mean) * two_fluid_pore_viscosity(&sim->closure, mean, eta);
      sim->kappa_f[TWO_FLUID_F]->v[f] = 0;
      set_solid(sim, d, f, 0.5 * (sim->phi->v[node[0]] + sim->phi->v[node[1]]),
                eta);
    }
  }
  for (int k = 0; k < TWO_FLUID_NPHASES; k++) {
    field_fill_faces(mesh, sim->eta_f[k]);
    field_fill_faces(mesh, sim->kappa_f[k]);
  }
}

double two_fluid_slowness(const struct two_fluid *sim, int32_t i) {
  const double g = params_gravity(sim->params);
  const double slow = max2(SLOW * sim->dt * g, 1e-300);
  double u2 = 0, slip2 = 0;
  for (int e = 0; e < DIM; e++) {
    const double u = sim->u[TWO_FLUID_S][e]->saved[i];
    const double slip = sim->u[TWO_FLUID_F][e]->saved[i] - u;
    u2 += u * u, slip2 += slip * slip;
  }
  return max2(0, 1 - sqrt(u2) / slow) * max2(0, 1 - slip2 / (slow * slow));
}

double two_fluid_stillness(const struct two_fluid *sim, int32_t i) {
  const double difference =
      two_fluid_density(sim, TWO_FLUID_S) - two_fluid_density(sim, TWO_FLUID_F);
  const double half = 0.5 * difference * params_gravity(sim->params) *
                      sim->grid.mesh->h[i] * max2(sim->alpha->v[i], 0);
  if (!(half > 0)) return 0;
  return min2(max2(sim->p_s->v[i], 0) / half, 1) * two_fluid_slowness(sim, i);
}
