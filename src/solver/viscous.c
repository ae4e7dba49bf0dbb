/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/viscous.h"

#include <math.h>
#include <string.h>

#include "levels.h"
#include "talus/error.h"
#include "talus/memory.h"

struct context {
  const struct mesh *mesh;
  struct hierarchy *h;
  const double *rho, *eta_f;
  double theta_dt;
  const struct bc *const *bc;
};

/* Stress on face f of direction d: component e into tau[e][f]. */
static inline void face_stress(const struct mesh *mesh, const double *eta_f,
                               double *const u[DIM], double *const tau[DIM],
                               int32_t f, int d) {
  const int32_t *node = mesh->face_node[f];
  const int32_t *stencil = mesh->stencil[mesh->face_owner[f]];
  const double eta = eta_f[f] / mesh->face_h[f];
  const double *ud = u[d];
  const int low = node[0] == stencil[STENCIL_CENTRE]
                      ? STENCIL_CENTRE
                      : STENCIL_CENTRE - stencil_step(d);
  for (int e = 0; e < DIM; e++) {
    const double du = u[e][node[1]] - u[e][node[0]];
    if (e == d) {
      tau[e][f] = 2 * eta * du;
      continue;
    }
    const int32_t *at = stencil + low, step = stencil_step(e);
    const int32_t over = stencil_step(d);
    const double dv = ud[at[step]] - ud[at[-step]] + ud[at[over + step]] -
                      ud[at[over - step]];
    tau[e][f] = eta * (du + 0.25 * dv);
  }
}

static void stress(const struct mesh *mesh, const double *eta_f,
                   double *const u[DIM], double *const tau[DIM]) {
  for (int d = 0; d < DIM; d++) {
    for (int32_t f = mesh->face_begin[d]; f < mesh->face_begin[d + 1]; f++) {
      face_stress(mesh, eta_f, u, tau, f, d);
    }
  }
  mesh_fill_faces(mesh, DIM, tau);
}

/* Divergence of the stress at leaf i, times h. */
static inline double divergence(const struct mesh *mesh, const double *tau,
                                int32_t i) {
  const int32_t *face = mesh->cell_face[i];
  double sum = 0;
  for (int d = 0; d < DIM; d++) sum += tau[face[2 * d + 1]] - tau[face[2 * d]];
  return sum;
}

void viscous_force(const struct mesh *mesh, const double *eta_f,
                   double *const u[DIM], double *const force[DIM]) {
  double *tau[DIM];
  for (int e = 0; e < DIM; e++) tau[e] = MEM_NEW(double, mesh->nfaces_all);
  stress(mesh, eta_f, u, tau);
  for (int e = 0; e < DIM; e++) {
    for (int32_t i = 0; i < mesh->nleaves; i++) {
      force[e][i] = divergence(mesh, tau[e], i) / mesh->h[i];
    }
    mem_free(tau[e]);
  }
}

void viscous_dissipation(const struct mesh *mesh, const double *eta_f,
                         double *const u[DIM], double *dissipation) {
  double *tau[DIM];
  for (int e = 0; e < DIM; e++) tau[e] = MEM_NEW(double, mesh->nfaces_all);
  stress(mesh, eta_f, u, tau);
  double *power = tau[0];
  for (int32_t f = 0; f < mesh->nfaces; f++) {
    const int32_t *node = mesh->face_node[f];
    double sum = 0;
    for (int e = 0; e < DIM; e++) {
      sum += tau[e][f] * (u[e][node[1]] - u[e][node[0]]);
    }
    power[f] = sum / mesh->face_h[f];
  }
  mesh_fill_faces(mesh, 1, &power);
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    double sum = 0;
    for (int f = 0; f < NFACE; f++) sum += power[mesh->cell_face[i][f]];
    dissipation[i] = 0.5 * sum;
  }
  for (int e = 0; e < DIM; e++) mem_free(tau[e]);
}

/* q = rho u - theta dt div(2 eta D(u)), u filled. */
static void operate(const struct context *k, double *const u[DIM], double *q) {
  const struct mesh *mesh = k->mesh;
  const int64_t n = mesh->nleaves;
  double *tau[DIM];
  for (int e = 0; e < DIM; e++) {
    tau[e] = k->h->work_faces + (int64_t)e * mesh->nfaces_all;
  }
  stress(mesh, k->eta_f, u, tau);
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    const double ratio = k->theta_dt / mesh->h[i];
    for (int e = 0; e < DIM; e++) {
      q[e * n + i] = k->rho[i] * u[e][i] - ratio * divergence(mesh, tau[e], i);
    }
  }
}

static void apply(void *context, const double *z, double *q) {
  const struct context *k = context;
  const struct mesh *mesh = k->mesh;
  double *u[DIM];
  for (int e = 0; e < DIM; e++) {
    u[e] = k->h->work_cells + (int64_t)e * mesh->ncells;
    memcpy(u[e], z + (int64_t)e * mesh->nleaves,
           (size_t)mesh->nleaves * sizeof **u);
  }
  mesh_fill(mesh, DIM, u, k->bc, true);
  operate(k, u, q);
}

static void precondition(void *context, const double *r, double *z) {
  const struct context *k = context;
  rough_watch(k->h, k->rho, r);
  cycle_run(k->h, 1, r, z);
}

static void prepare(void *context) {
  const struct context *k = context;
  coefficients_set(k->h, DIM, k->eta_f, k->theta_dt, k->rho, k->bc);
}

struct solve_stats viscous_solve(const struct mesh *mesh, struct hierarchy *h,
                                 const double *rho, const double *eta_f,
                                 double theta_dt, double *const rhs[DIM],
                                 const struct bc *const bc[DIM],
                                 double tolerance, int max_iterations,
                                 double *const u[DIM]) {
  CHECK(h->revision == mesh->revision, "hierarchy of an older mesh");
  const int32_t n = mesh->nleaves;
  struct context context = {mesh, h, rho, eta_f, theta_dt, bc};
  mesh_fill(mesh, DIM, u, bc, false);
  operate(&context, u, h->residual);
  for (int e = 0; e < DIM; e++) {
    double *r = h->residual + (int64_t)e * n;
    for (int32_t i = 0; i < n; i++) r[i] = rhs[e][i] - r[i];
  }
  const struct krylov_system system = {.comm = mesh->comm,
                                       .n = n,
                                       .nparts = DIM,
                                       .context = &context,
                                       .prepare = prepare,
                                       .precondition = precondition,
                                       .apply = apply,
                                       .weight = h->weight,
                                       .density = rho};
  struct solve_stats stats = krylov_solve(&system, h->krylov, tolerance,
                                          max_iterations, h->residual, u);
  mesh_fill(mesh, DIM, u, bc, false);
  return stats;
}
