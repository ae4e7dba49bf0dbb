/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Kolmogorov flow at 45 degrees to the grid [meshalkin_sinai_1961] in a
 * doubly periodic unit box, with a viscosity that varies by 1e3 along the
 * wave: with s = x - y and k = 2 pi
 *   u = v = sin(k s),   eta = exp(b sin(k s + 0.7)),   b = log(1000) / 2,
 *   force on each component = -2 (eta u')' = -2 eta (k b cos(k s + 0.7) u' +
 *   u''),   ' = d/ds
 * (grad u + grad u^T has the normal components 2u' and -2u' alone). Steady:
 * rho h^2 / (eta dt) = 1e-8 for the smallest eta; only the mean velocity is
 * kept by the mass, so what the forces on the leaves do not balance, of the
 * order of h^2, is taken off. Second order also: what a projection must take
 * off the mean velocity of faces to make it solenoidal; on a uniform grid
 * that is nothing, as x and -y are alike. */
#include "report.h"
#include "systems.h"
#include "talus/projection.h"
#include "talus/viscous.h"

enum { FIRST = 4, N = 5, MOST = 100 };

static const double kWave = 6.28318530717958647693;
static const double kLag = 0.7, kLogEta = 3.45387763949106995; /* b */

static const double kTolerance = 1e-8; /* of solves, relative */
static const char *const kChange = "L2 of what a projection changes";

static double wave_eta(const void *context, const double *x) {
  (void)context;
  return exp(kLogEta * sin(kWave * (x[0] - x[1]) + kLag));
}

static double exact(const double *x) { return sin(kWave * (x[0] - x[1])); }

static double force(const double *x) {
  const double s = kWave * (x[0] - x[1]), k2 = kWave * kWave;
  return -2 * wave_eta(NULL, x) * k2 *
         (kLogEta * cos(s + kLag) * cos(s) - sin(s));
}

struct flow {
  struct bench *bench;
  struct hierarchy *hierarchy;
  struct field *u[DIM];
  double *eta_f, *rho, *rhs[DIM];
};

static void flow_start(struct flow *s, enum grid_kind grid, int level) {
  static const char *const names[] = {"u_x", "u_y", "u_z"};
  s->bench = bench_on(grid_make(grid, true, level));
  const struct mesh *mesh = s->bench->mesh;
  s->hierarchy = hierarchy_new(mesh);
  s->eta_f = face_values(mesh, wave_eta, NULL, false);
  s->rho = MEM_NEW(double, mesh->ncells);
  bench_vector(s->bench, names, s->u);
  for (int32_t i = 0; i < mesh->ncells; i++) s->rho[i] = 1;
  for (int d = 0; d < DIM; d++) s->rhs[d] = MEM_NEW(double, mesh->nleaves);
}

static void flow_end(struct flow *s) {
  for (int d = 0; d < DIM; d++) mem_free(s->rhs[d]);
  mem_free(s->eta_f), mem_free(s->rho);
  hierarchy_destroy(s->hierarchy);
  bench_destroy(s->bench);
}

/* Find u from the balance of forces over a step so long that only the mean
 * feels inertia. False if the solve does not converge. */
static bool balance_forces(struct flow *s) {
  const struct mesh *mesh = s->bench->mesh;
  const double h = ldexp(1, -mesh->level_finest);
  const double dt = h * h / (1e-8 * exp(-kLogEta));
  const struct bc *bc[DIM];
  double *u[DIM], most = 0;
  for (int d = 0; d < DIM; d++) {
    bc[d] = s->u[d]->bc;
    for (int32_t i = 0; i < mesh->nleaves; i++) {
      s->rhs[d][i] = dt * force(mesh->x[i]);
    }
    remove_mean(mesh, s->rhs[d]);
    most = larger(most, largest_size(mesh, s->rhs[d]));
  }
  field_arrays(s->u, u);
  return viscous_solve(mesh, s->hierarchy, s->rho,
                       &(struct viscosity){.eta_f = s->eta_f}, dt, s->rhs, bc,
                       kTolerance * most, MOST, u)
             .status == SOLVE_CONVERGED;
}

/* Return the root of the mean square of what a projection changes at faces. */
static double compression(struct flow *s) {
  struct bench *b = s->bench;
  const struct mesh *mesh = b->mesh;
  struct field *u_f = bench_face(b, "u_f"), *alpha_f = bench_face(b, "alpha_f");
  struct field *gravity_f = bench_face(b, "gravity_f");
  struct field *flux = bench_face(b, "flux"), *p = bench_cell(b, "p");
  double *u[DIM], sum = 0, area = 0;
  for (int32_t f = 0; f < mesh->nfaces_all; f++) alpha_f->v[f] = 1;
  const struct projection projection = {.mesh = mesh,
                                        .hierarchy = s->hierarchy,
                                        .rho = s->rho,
                                        .alpha_f = alpha_f->v,
                                        .gravity_f = gravity_f->v,
                                        .bc = p->bc,
                                        .tolerance = kTolerance,
                                        .max_iterations = MOST,
                                        .rhs = s->rhs[0],
                                        .flux = flux->v};
  field_arrays(s->u, u);
  projection_face_velocity(&projection, 1, u, u_f->v);
  const struct solve_stats stats =
      projection_project(&projection, 1, u_f->v, p->v);
  for (int32_t f = 0; f < mesh->nfaces; f++) {
    sum += mesh->face_h[f] * mesh->face_h[f] * flux->v[f] * flux->v[f];
    area += mesh->face_h[f] * mesh->face_h[f];
  }
  return stats.status == SOLVE_CONVERGED ? sqrt(sum / area) : NAN;
}

static void solve(enum grid_kind grid, int level, double value[3]) {
  struct flow s;
  struct norms norms[DIM];
  flow_start(&s, grid, level);
  const struct mesh *mesh = s.bench->mesh;
  const bool good = balance_forces(&s);
  for (int d = 0; d < DIM; d++) {
    double *error = s.rhs[d]; /* done with */
    for (int32_t i = 0; i < mesh->nleaves; i++) {
      error[i] = s.u[d]->v[i] - exact(mesh->x[i]);
    }
    remove_mean(mesh, error); /* of the exact values at centres */
    norms[d] = norms_of(mesh, error);
  }
  value[0] = good ? hypot(norms[0].l2, norms[1].l2) : NAN;
  value[1] = good ? larger(norms[0].most, norms[1].most) : NAN;
  value[2] = compression(&s);
  flow_end(&s);
}

static void run(struct report *report) {
  for (int grid = 0; grid < NGRIDS; grid++) {
    double error[3][N];
    for (int l = 0; l < N; l++) {
      double value[3];
      solve(grid, FIRST + l, value);
      for (int k = 0; k < 3; k++) error[k][l] = value[k];
    }
    report_errors(report, grid_name[grid], "L2 of u", FIRST, N, error[0], NULL,
                  1.9);
    report_errors(report, grid_name[grid], "max of u", FIRST, N, error[1], NULL,
                  0);
    for (int l = 0; l < N && grid == GRID_UNIFORM; l++) {
      report_at_most(report, grid_name[grid], kChange, FIRST + l, error[2][l],
                     kTolerance);
    }
    if (grid == GRID_UNIFORM) continue;
    report_errors(report, grid_name[grid], kChange, FIRST, N, error[2], NULL,
                  1.9);
  }
}

const struct convergence_case kolmogorov_case = {
    "kolmogorov", "Kolmogorov flow at 45 degrees, eta over 1e3", 2, true, run};
