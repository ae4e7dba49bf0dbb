/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Filling: averages, messages, interpolation, messages, boundaries.
 * The depth is fixed: an average adds up leaves and finer averages, a slope
 * reads leaves, ghosts and averages only, a boundary node may mirror any of
 * the others. */
#include "exchange.h"
#include "talus/error.h"
#include "talus/mesh.h"
#include "talus/minmax.h"
#include "talus/poison.h"

static void fill_averages(const struct mesh *mesh, double *v) {
  const int32_t n = mesh->begin_virtual - mesh->begin_average;
  for (int32_t k = 0; k < n; k++) {
    const int32_t *child = mesh->average_child[k];
    double sum = 0;
    for (int c = 0; c < NCHILD; c++) {
      if (child[c] >= 0) sum += v[child[c]];
    }
    v[mesh->begin_average + k] = sum / NCHILD;
  }
}

/* Return v[node[1]] - v[node[0]] of the two neighbours of a leaf (or the leaf
 * itself for a missing one), as if rho were the leaf's throughout: across each
 * face dv/rho_f is kept, rho_f the mean of both sides. */
static double weighted_difference(const double *rho, const double *v,
                                  int32_t leaf, const int32_t node[2]) {
  const double here = 2 * rho[leaf];
  return here / (rho[leaf] + rho[node[1]]) * (v[node[1]] - v[leaf]) +
         here / (rho[leaf] + rho[node[0]]) * (v[leaf] - v[node[0]]);
}

static void fill_virtuals(const struct mesh *mesh, const double *rho,
                          double *v) {
  for (int32_t k = 0; k < mesh->nvirtual_local; k++) {
    const int32_t leaf = mesh->virtual_leaf[k];
    double *child = v + mesh->begin_virtual + NCHILD * k;
    double step[DIM];
    for (int d = 0; d < DIM; d++) {
      const int32_t *node = mesh->virtual_slope[k][d];
      const double weight = mesh->virtual_weight[k][d];
      step[d] = rho ? weight * weighted_difference(rho, v, leaf, node)
                    : weight * (v[node[1]] - v[node[0]]);
    }
    for (int c = 0; c < NCHILD; c++) {
      double value = v[leaf];
      for (int d = 0; d < DIM; d++) value += c >> d & 1 ? step[d] : -step[d];
      child[c] = value;
    }
  }
}

static void fill_boundaries(const struct mesh *mesh, double *v,
                            const struct bc *bc, bool homogeneous) {
  const int32_t n = mesh->ncells - mesh->begin_boundary;
  for (int32_t k = 0; k < n; k++) {
    double value = v[mesh->boundary_source[k]];
    for (int d = 0; d < DIM; d++) {
      const int patch = mesh->boundary_patch[k][d];
      if (patch < 0) continue;
      double a, b;
      bc_ghost(&bc[patch], mesh->boundary_h[k], &a, &b);
      value = a * value + (homogeneous ? 0 : b);
    }
    v[mesh->begin_boundary + k] = value;
  }
}

/* Return the value of a condition that is the mean over patches, or that of
 * `patch`, whose type of condition holds, if the face is not shared. */
static double shared_value(const struct patch_shares *shares,
                           const struct bc *bc, int patch) {
  const enum bc_type type = bc[patch].type;
  double sum = 0;
  if (shares->n == 0 || type == BC_NEUMANN) return bc[patch].value;
  for (int k = 0; k < shares->n; k++) {
    const struct bc *of = &bc[shares->patch[k]];
    if (of->type == BC_NEUMANN) continue;
    sum += (type == BC_CARRIED ? shares->flux : shares->part)[k] * of->value;
  }
  return sum;
}

/* Set the nodes beyond faces that patches share. */
static void fill_shared(const struct mesh *mesh, double *v,
                        const struct bc *bc) {
  for (int32_t i = 0; i < mesh->nshared; i++) {
    const struct shared_node *shared = &mesh->shared[i];
    const int32_t k = shared->node;
    double value = v[mesh->boundary_source[k]];
    for (int d = 0; d < DIM; d++) {
      const int patch = mesh->boundary_patch[k][d];
      if (patch < 0) continue;
      struct bc one = bc[patch];
      double a, b;
      one.value = shared_value(&shared->across[d], bc, patch);
      bc_ghost(&one, mesh->boundary_h[k], &a, &b);
      value = a * value + b;
    }
    v[mesh->begin_boundary + k] = value;
  }
}

void mesh_fill_ghosts(const struct mesh *mesh, int n, double *const v[]) {
  plan_run(&mesh->exchange->ghost, n, v, 1, false);
}

static void fill(const struct mesh *mesh, const double *rho, int n,
                 double *const v[], const struct bc *const bc[],
                 bool homogeneous) {
  enum { MOST = 64 };
  double *group[MOST];
  CHECK(n <= MOST, "%d fields filled at once, at most %d", n, MOST);
  for (int k = 0; k < n; k++) {
    fill_averages(mesh, v[k]);
    group[k] = v[k] + mesh->begin_virtual;
  }
  plan_run(&mesh->exchange->ghost, n, v, 1, false);
  plan_run(&mesh->exchange->average, n, v, 1, true);
  for (int k = 0; k < n; k++) fill_virtuals(mesh, rho, v[k]);
  plan_run(&mesh->exchange->virtual_node, n, group, NCHILD, false);
  for (int k = 0; k < n; k++) {
    fill_boundaries(mesh, v[k], bc[k], homogeneous);
    if (!homogeneous) fill_shared(mesh, v[k], bc[k]);
  }
}

void mesh_fill(const struct mesh *mesh, int n, double *const v[],
               const struct bc *const bc[], bool homogeneous) {
  fill(mesh, NULL, n, v, bc, homogeneous);
}

void mesh_fill_potential(const struct mesh *mesh, const double *rho, int n,
                         double *const v[], const struct bc *const bc[],
                         bool homogeneous) {
  fill(mesh, rho, n, v, bc, homogeneous);
}

/* Return the average of the finer faces of a side, by their areas, the second
 * of two weighing 1 + slant; poison if nobody has set one of them, as in a
 * sweep along another axis. */
static double mean_of_faces(const double *v, const int32_t face[NCHILD / 2],
                            double slant) {
  double sum = 0;
  for (int c = 0; c < NCHILD / 2; c++) {
    if (POISON_ON && is_poison(&v[face[c]])) return v[face[c]];
    sum += v[face[c]];
  }
  if (slant != 0) sum += slant * (v[face[1]] - v[face[0]]);
  return sum / (NCHILD / 2);
}

void mesh_fill_faces(const struct mesh *mesh, int n, double *const v[]) {
  plan_run(&mesh->exchange->face, n, v, 1, false);
  const int32_t ncoarse = mesh->nfaces_all - mesh->begin_face_average;
  for (int k = 0; k < n; k++) {
    for (int32_t i = 0; i < ncoarse; i++) {
      v[k][mesh->begin_face_average + i] =
          mean_of_faces(v[k], mesh->average_face[i],
                        mesh->average_slant ? mesh->average_slant[i] : 0);
    }
  }
}

void mesh_spread(const struct mesh *mesh, double *mark) {
  static const struct bc none[MESH_MAX_PATCHES];
  const struct bc *bc[] = {none};
  mesh_fill(mesh, 1, &mark, bc, true);
  for (int32_t k = mesh->begin_virtual; k < mesh->begin_boundary; k++) {
    mark[k] = mark[mesh->virtual_leaf[(k - mesh->begin_virtual) / NCHILD]];
  }
  for (int32_t k = mesh->begin_boundary; k < mesh->ncells; k++) mark[k] = 0;
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    double most = 0;
    for (int s = 0; s < NSTENCIL; s++) {
      most = max2(most, mark[mesh->stencil[i][s]]);
    }
    if (mark[i] == 0 && most > 0) mark[i] = -1; /* new: spreads no further */
  }
  for (int32_t i = 0; i < mesh->nleaves; i++) mark[i] = mark[i] != 0;
}
