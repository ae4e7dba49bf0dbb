/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/viscous.h"

#include <math.h>
#include <string.h>

#include "levels.h"
#include "talus/error.h"
#include "talus/memory.h"

/* Number of the hoop stress, after those of force e on a face. */
enum { HOOP = DIM };

static int nstresses(const struct mesh *mesh) {
  return mesh_is_axisymmetric(mesh) ? HOOP + 1 : DIM;
}

struct context {
  const struct mesh *mesh;
  struct hierarchy *h;
  const double *rho;
  const struct viscosity *viscosity;
  double theta_dt;
  double *const *rhs;
  const struct bc *const *bc;
};

/* Give the nodes at both ends of the lines along axis e through the nodes of
 * face f of axis d: end[0] and end[1] of the lower one, then of the upper. */
static inline void line_ends(const struct mesh *mesh, int32_t f, int d, int e,
                             int32_t end[4]) {
  const int32_t *stencil = mesh->stencil[mesh->face_owner[f]];
  const int32_t over = stencil_step(d), step = stencil_step(e);
  const int32_t *at =
      stencil + STENCIL_CENTRE -
      (mesh->face_node[f][0] == stencil[STENCIL_CENTRE] ? 0 : over);
  end[0] = at[-step], end[1] = at[step];
  end[2] = at[over - step], end[3] = at[over + step];
}

static inline double difference(const double *v, const int32_t end[4]) {
  return v[end[1]] - v[end[0]] + v[end[3]] - v[end[2]];
}

/* Stress on face f of direction d: component e into tau[e][f]. The normal one
 * has lambda div u, lambda = kappa - 2 eta / 3, but for the hoop; kept: NULL,
 * or where that goes besides. */
static inline __attribute__((always_inline)) void face_stress(
    const struct mesh *mesh, const double *eta_f, const double *kappa_f,
    double *const u[DIM], double *const tau[DIM], double *kept, int32_t f,
    int d) {
  const int32_t *node = mesh->face_node[f];
  const double eta = mesh_slope(mesh, f, eta_f[f]);
  const double across = u[d][node[1]] - u[d][node[0]];
  double divergence = across;
  for (int e = 0; e < DIM; e++) {
    int32_t end[4];
    if (e == d) continue;
    line_ends(mesh, f, d, e, end);
    const double shear =
        u[e][node[1]] - u[e][node[0]] + 0.25 * difference(u[d], end);
    if (kappa_f) divergence += 0.25 * difference(u[e], end);
    tau[e][f] = eta * shear;
  }
  tau[d][f] = 2 * eta * across;
  if (!kappa_f) return;
  const double lambda = kappa_f[f] - 2. / 3 * eta_f[f];
  const double bulk = mesh_slope(mesh, f, lambda * divergence);
  tau[d][f] += bulk;
  if (kept) kept[f] = bulk;
}

/* Beside the surface of the grains. */
static void skin_stress(const struct mesh *mesh, const double *eta_f,
                        const struct skin *skin, double *const u[DIM],
                        double *const tau[DIM]) {
  for (int32_t k = 0; k < skin->n; k++) {
    const struct skin_face *face = &skin->face[k];
    const int32_t f = face->face, *node = mesh->face_node[f];
    const double eta = mesh_slope(mesh, f, eta_f[f]);
    for (int e = 0; e < DIM; e++) {
      if (e == face->axis) continue;
      const double du = u[e][node[1]] - u[e][node[0]];
      const double dv = skin_difference(mesh, face, e, u[face->axis]);
      tau[e][f] = face->part[e] * eta * (du + dv);
    }
  }
}

/* Set the hoop stress around the axis, where tau has lambda times the rest of
 * div u if there is a kappa, and add the hoop's part to the normal stress. */
static void hoop_stress(const struct mesh *mesh,
                        const struct viscosity *viscosity, const double *u_r,
                        double *const tau[]) {
  const double *eta_f = viscosity->eta_f, *kappa_f = viscosity->kappa_f;
  for (int d = 0; d < DIM; d++) {
    for (int32_t f = mesh->face_begin[d]; f < mesh->face_begin[d + 1]; f++) {
      const double rate = mesh_face_hoop(mesh, u_r, f, d);
      const double rest = kappa_f ? tau[HOOP][f] : 0;
      tau[HOOP][f] = 2 * eta_f[f] * rate;
      if (!kappa_f) continue;
      const double hoop = (kappa_f[f] - 2. / 3 * eta_f[f]) * rate;
      tau[d][f] += hoop, tau[HOOP][f] += rest + hoop;
    }
  }
}

/* Set the stress on faces, filled; tau [nstresses]. */
static void stress(const struct mesh *mesh, const struct viscosity *viscosity,
                   double *const u[DIM], double *const tau[]) {
  const double *eta_f = viscosity->eta_f, *kappa_f = viscosity->kappa_f;
  const struct skin *skin = viscosity->skin;
  const bool rings = mesh_is_axisymmetric(mesh);
  struct mesh_piece piece = mesh_no_piece(mesh);
  while (mesh_next_piece(mesh, &piece)) {
#pragma GCC unroll 3 /* so that d is known in the loops over faces */
    for (int d = 0; d < DIM; d++) {
      const int32_t begin = piece.begin[d], end = piece.end[d];
      for (int32_t f = begin; f < end && !kappa_f; f++)
        face_stress(mesh, eta_f, NULL, u, tau, NULL, f, d);
      for (int32_t f = begin; f < end && kappa_f; f++)
        face_stress(mesh, eta_f, kappa_f, u, tau, rings ? tau[HOOP] : NULL, f,
                    d);
    }
  }
  if (skin) skin_stress(mesh, eta_f, skin, u, tau);
  if (rings) hoop_stress(mesh, viscosity, u[0], tau);
  mesh_fill_faces(mesh, nstresses(mesh), tau);
}

void viscous_force(const struct mesh *mesh, const struct viscosity *viscosity,
                   double *const u[DIM], double *const force[DIM]) {
  double *tau[HOOP + 1];
  const int n = nstresses(mesh);
  for (int e = 0; e < n; e++) tau[e] = MEM_NEW(double, mesh->nfaces_all);
  stress(mesh, viscosity, u, tau);
  for (int e = 0; e < DIM; e++) {
    for (int32_t i = 0; i < mesh->nleaves; i++) {
      force[e][i] = mesh_divergence(mesh, tau[e], i);
    }
  }
  for (int32_t i = 0; i < mesh->nleaves && n > DIM; i++) {
    force[0][i] += mesh_hoop_force(mesh, tau[HOOP], i);
  }
  for (int e = 0; e < n; e++) mem_free(tau[e]);
}

/* q = rho u - theta dt div(stress), but for the hoop's. */
static inline __attribute__((always_inline)) void add_forces(
    const struct context *k, bool rings, double *const tau[],
    double *const u[DIM], double *const q[DIM]) {
  const struct mesh *mesh = k->mesh;
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    const double ratio = k->theta_dt / mesh_width(mesh, i);
    for (int e = 0; e < DIM; e++) {
      q[e][i] =
          k->rho[i] * u[e][i] - ratio * mesh_net_of(mesh, rings, tau[e], i);
    }
  }
}

/* q = rho u - theta dt div(stress), u filled; q may be u. */
static void operate(const struct context *k, double *const u[DIM],
                    double *const q[DIM]) {
  const struct mesh *mesh = k->mesh;
  double *tau[HOOP + 1];
  const int n = nstresses(mesh);
  for (int e = 0; e < n; e++) {
    tau[e] = k->h->work_faces + (int64_t)e * mesh->nfaces_all;
  }
  stress(mesh, k->viscosity, u, tau);
  if (n > DIM) {
    add_forces(k, true, tau, u, q);
  } else {
    add_forces(k, false, tau, u, q);
  }
  for (int32_t i = 0; i < mesh->nleaves && n > DIM; i++) {
    q[0][i] -= k->theta_dt * mesh_hoop_force(mesh, tau[HOOP], i);
  }
}

static void apply(void *context, const double *z, double *q[]) {
  const struct context *k = context;
  const struct mesh *mesh = k->mesh;
  for (int e = 0; e < DIM; e++) {
    q[e] = k->h->work_cells + (int64_t)e * mesh->ncells;
    memcpy(q[e], z + (int64_t)e * mesh->nleaves,
           (size_t)mesh->nleaves * sizeof *z);
  }
  mesh_fill(mesh, DIM, q, k->bc, true);
  operate(k, q, q);
}

static void residual(const struct context *k, double *const u[], double *r) {
  const int32_t n = k->mesh->nleaves;
  double *part[DIM];
  for (int e = 0; e < DIM; e++) part[e] = r + (int64_t)e * n;
  mesh_fill(k->mesh, DIM, u, k->bc, false);
  operate(k, u, part);
  for (int e = 0; e < DIM; e++) {
    for (int32_t i = 0; i < n; i++) part[e][i] = k->rhs[e][i] - part[e][i];
  }
}

static void precondition(void *context, const double *r, double size,
                         double *z) {
  const struct context *k = context;
  rough_watch(k->h, size);
  cycle_run(k->h, 1, r, z);
}

static void prepare(void *context) {
  const struct context *k = context;
  const struct viscosity *viscosity = k->viscosity;
  bulk_set(k->h, viscosity->eta_f, viscosity->kappa_f, k->theta_dt);
  coefficients_set(k->h, DIM, viscosity->eta_f, k->theta_dt, k->rho, k->bc);
  skin_nodes_set(k->h, viscosity->skin);
}

struct solve_stats viscous_solve(const struct mesh *mesh, struct hierarchy *h,
                                 const double *rho,
                                 const struct viscosity *viscosity,
                                 double theta_dt, double *const rhs[DIM],
                                 const struct bc *const bc[DIM],
                                 double tolerance, int max_iterations,
                                 double *const u[DIM]) {
  CHECK(h->revision == mesh->revision, "hierarchy of an older mesh");
  struct context context = {mesh, h, rho, viscosity, theta_dt, rhs, bc};
  residual(&context, u, h->residual);
  const struct krylov_system system = {.comm = mesh->comm,
                                       .n = mesh->nleaves,
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
