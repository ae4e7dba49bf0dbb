/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Axisymmetric coordinates against exact solutions.
 *
 * Pipe and annulus: a liquid driven by a force G along the axis, periodic
 * there, between walls at rest [Hagen, Poiseuille]: u_z = G/(4 eta) (R^2 -
 * r^2), u_z = G/(4 eta) (R^2 - r^2 - (R^2 - R_i^2) log(R/r)/log(R/R_i)).
 * Viscous and pressure equations by manufactured solutions [roache_2002], with
 *   f_r = eta (2 u_r,rr + 2 u_r,r/r - 2 u_r/r^2 + u_r,zz + u_z,rz)
 *         + 2 eta,r u_r,r + eta,z (u_r,z + u_z,r)
 *   f_z = eta (u_z,rr + u_r,rz + (u_r,z + u_z,r)/r + 2 u_z,zz)
 *         + eta,r (u_r,z + u_z,r) + 2 eta,z u_z,z
 * at cell centres. A ball that u = (r/2, -z) stretches into an ellipsoid. A bed
 * at rest, and a ball of grains that falls on the floor. */
#include "../mesh/transport.h"
#include "report.h"
#include "runs.h"
#include "systems.h"
#include "talus/poisson.h"
#include "talus/viscous.h"
#include "talus/vof.h"

enum { FIRST = 4, N = 4, MOST = 100 };
static const double kQuarter = 1.57079632679489661923; /* of a wave */

/* Make a box of edge 1 from the radius `inner` on. */
static struct forest *rings_make(double inner, enum grid_kind grid, int l) {
  struct forest_layout layout = {.size = 1, .trees = {1, 1}};
  const double centre[3] = {inner + 0.31, 0.42}, axis[3] = {inner, 0.6};
  layout.origin[0] = inner;
  layout.axisymmetric = true;
  struct forest *forest = forest_new(MPI_COMM_WORLD, &layout, l);
  if (grid == GRID_UNIFORM) return forest;
  grid_refine(forest, centre, 0.2, l + 1);
  grid_refine(forest, axis, 0.15, l + (grid == GRID_TWO_JUMPS ? 2 : 1));
  return forest;
}

/* Pipe flow. G/(4 eta) = 1, R = inner + 1. */
static double pipe_velocity(double inner, double r) {
  const double outer = inner + 1, u = outer * outer - r * r;
  if (inner == 0) return u;
  return u -
         (outer * outer - inner * inner) * log(outer / r) / log(outer / inner);
}

/* Ask for finer leaves in two spots, one at the lower radius. */
static double spots(void *context, const double x[3]) {
  const struct params *p = context;
  const double r = x[0] - p->origin[0];
  const bool near =
      hypot(r - 0.31, x[1] - 0.42) < 0.2 || hypot(r, x[1] - 0.6) < 0.15;
  return near ? p->level_max : p->level_min;
}

static struct params ring_params(double inner, int level, bool adapted) {
  struct params p = box_params(level);
  p.coordinates = COORDINATES_AXISYMMETRIC;
  p.origin[0] = inner;
  if (adapted) p.level_min = level - 1;
  return p;
}

static void adapt_to_spots(struct params *p) {
  p->criterion[p->ncriteria++] = (struct criterion){.type = CRITERION_FUNCTION,
                                                    .level = p->level_max,
                                                    .function = {spots, p}};
}

static double pipe_error(double inner, int level, bool adapted) {
  struct params p = ring_params(inner, level, adapted);
  if (adapted) adapt_to_spots(&p);
  p.single_phase = true;
  p.grains = (struct phase){1, newtonian(1)};
  p.gravity[1] = 4;
  p.boundary[0].type = inner > 0 ? BOUNDARY_NO_SLIP : BOUNDARY_SLIP;
  p.boundary[1].type = BOUNDARY_NO_SLIP;
  p.boundary[2].type = p.boundary[3].type = BOUNDARY_PERIODIC;
  struct two_phase *sim = sim_start(&p);
  bool good = run_steady(sim, 1e-7, 20);
  const struct mesh *mesh = sim->grid.mesh;
  double *error = MEM_NEW(double, mesh->nleaves);
  for (int32_t i = 0; i < mesh->nleaves; i++)
    error[i] = sim->u[1]->v[i] - pipe_velocity(inner, mesh->x[i][0]);
  const struct norms norms = norms_of(mesh, error);
  mem_free(error);
  two_phase_destroy(sim);
  return good ? norms.l2 : NAN;
}

static void run_pipes(struct report *report) {
  static const double inner[] = {0, 0.25};
  static const char *const name[] = {"pipe", "pipe adapted", "annulus",
                                     "annulus adapted"};
  for (int k = 0; k < 4; k++) {
    double error[N - 1];
    for (int l = 0; l < N - 1; l++)
      error[l] = pipe_error(inner[k / 2], FIRST + l, k % 2);
    report_errors(report, name[k], "L2 of u", FIRST, N - 1, error, NULL, 1.9);
  }
}

/* Manufactured solutions: odd or even in r, 0 at r = 1, z = 0 and z = 1. */
struct problem {
  struct smooth u[2], log_eta, p;
};

static const struct problem *problem_of(void) {
  static struct problem problem;
  problem = (struct problem){
      .u = {{.n = 2, .mode = {{1, {1, 1}, {0, 0}}, {0.5, {2, 2}, {0, 0}}}},
            {.n = 2,
             .mode = {{1, {0.5, 1}, {kQuarter, 0}},
                      {0.6, {1.5, 2}, {kQuarter, 0}}}}},
      .log_eta = {.n = 1, .mode = {{3, {1, 2}, {kQuarter, 0.5}}}},
      .p = {.n = 2,
            .mode = {{1, {1, 1}, {kQuarter, kQuarter}},
                     {0.4, {2, 3}, {kQuarter, kQuarter}}}}};
  return &problem;
}

/* Return component d of the viscous force at x. */
static double force_at(const struct problem *problem, const double *x, int d) {
  const struct smooth *u = problem->u, *log_eta = &problem->log_eta;
  const double r = x[0];
  const double slant = smooth_slope(&u[0], x, 1) + smooth_slope(&u[1], x, 0);
  double sum = 2 * smooth_second(&u[d], x, d, d) +
               smooth_second(&u[d], x, 1 - d, 1 - d) +
               smooth_second(&u[1 - d], x, 0, 1);
  if (d == 0) {
    sum += 2 * smooth_slope(&u[0], x, 0) / r -
           2 * smooth_value(&u[0], x) / (r * r);
  } else {
    sum += slant / r;
  }
  sum += 2 * smooth_slope(log_eta, x, d) * smooth_slope(&u[d], x, d) +
         smooth_slope(log_eta, x, 1 - d) * slant;
  return sum * exponential(log_eta, x);
}

/* Solve u - div tau = u - f with walls at rest; the axis is a mirror. */
static struct norms solve_viscous(const void *context, enum grid_kind grid,
                                  int level) {
  const struct problem *problem = context;
  struct forest *forest = rings_make(0, grid, level);
  struct mesh *mesh = mesh_new(forest);
  struct hierarchy *hierarchy = hierarchy_new(mesh);
  struct bc side[DIM][MESH_MAX_PATCHES] = {{{0}}};
  const struct bc *bc[DIM] = {side[0], side[1]};
  double *u[DIM], *rhs[DIM], scale = 0;
  double *eta_f = face_values(mesh, exponential, &problem->log_eta, false);
  double *rho = MEM_NEW(double, mesh->nleaves);
  for (int32_t i = 0; i < mesh->nleaves; i++) rho[i] = 1;
  for (int d = 0; d < DIM; d++) {
    u[d] = MEM_NEW(double, mesh->ncells),
    rhs[d] = MEM_NEW(double, mesh->nleaves);
    for (int32_t i = 0; i < mesh->nleaves; i++)
      rhs[d][i] = smooth_value(&problem->u[d], mesh->x[i]) -
                  force_at(problem, mesh->x[i], d);
    for (int k = 0; k < NFACE; k++) side[d][k].type = BC_DIRICHLET;
    scale = larger(scale, largest_size(mesh, rhs[d]));
  }
  side[1][0].type = BC_NEUMANN;
  const struct solve_stats stats =
      viscous_solve(mesh, hierarchy, rho, &(struct viscosity){.eta_f = eta_f},
                    1, rhs, bc, 1e-9 * scale, MOST, u);
  struct norms norms = {0};
  for (int d = 0; d < DIM; d++) {
    for (int32_t i = 0; i < mesh->nleaves; i++)
      rhs[d][i] = u[d][i] - smooth_value(&problem->u[d], mesh->x[i]);
    const struct norms part = norms_of(mesh, rhs[d]);
    norms.l2 = hypot(norms.l2, part.l2);
    norms.most = larger(norms.most, part.most);
    mem_free(u[d]), mem_free(rhs[d]);
  }
  if (stats.status != SOLVE_CONVERGED) norms.l2 = norms.most = NAN;
  mem_free(eta_f), mem_free(rho);
  hierarchy_destroy(hierarchy), mesh_destroy(mesh), forest_destroy(forest);
  return norms;
}

/* Return div(alpha grad p). */
static double pressure_source(const struct problem *problem, const double *x) {
  const struct smooth *p = &problem->p;
  double sum = smooth_second(p, x, 0, 0) + smooth_second(p, x, 1, 1) +
               smooth_slope(p, x, 0) / x[0];
  for (int d = 0; d < DIM; d++)
    sum += smooth_slope(&problem->log_eta, x, d) * smooth_slope(p, x, d);
  return sum * exponential(&problem->log_eta, x);
}

static struct norms solve_pressure(const void *context, enum grid_kind grid,
                                   int level) {
  const struct problem *problem = context;
  struct forest *forest = rings_make(0, grid, level);
  struct mesh *mesh = mesh_new(forest);
  struct hierarchy *hierarchy = hierarchy_new(mesh);
  struct bc side[MESH_MAX_PATCHES] = {{0}};
  double *alpha = face_values(mesh, exponential, &problem->log_eta, true);
  double *p = MEM_NEW(double, mesh->ncells);
  double *rhs = MEM_NEW(double, mesh->nleaves);
  for (int32_t i = 0; i < mesh->nleaves; i++)
    rhs[i] = pressure_source(problem, mesh->x[i]);
  const double scale = largest_size(mesh, rhs);
  remove_mean(mesh, rhs);
  const struct solve_stats stats = poisson_solve(
      mesh, hierarchy, alpha, NULL, NULL, rhs, side, 1e-9 * scale, MOST, p);
  for (int32_t i = 0; i < mesh->nleaves; i++)
    rhs[i] = p[i] - smooth_value(&problem->p, mesh->x[i]);
  remove_mean(mesh, rhs);
  struct norms norms = norms_of(mesh, rhs);
  if (stats.status != SOLVE_CONVERGED) norms.l2 = norms.most = NAN;
  mem_free(alpha), mem_free(p), mem_free(rhs);
  hierarchy_destroy(hierarchy), mesh_destroy(mesh), forest_destroy(forest);
  return norms;
}

/* An ellipsoid around the axis with the half axes a and b. */
struct ellipsoid {
  double a, b;
};
static double ellipsoid(void *context, const double x[3]) {
  const struct ellipsoid *e = context;
  const double s = hypot(x[0] / e->a, (x[1] - 0.5) / e->b);
  return 1 - s;
}

static double strain_flow(int d, const double x[3]) {
  return d ? 0.5 - x[1] : 0.5 * x[0];
}

/* Return the part of a ball of radius 0.3 that is in the wrong place after a
 * strain of log(2) along the axis. */
static double stretched(enum grid_kind grid, int level) {
  struct bench *b = bench_on(rings_make(0, grid, level));
  struct transport t = transport_new(b);
  const struct ellipsoid ball = {0.3, 0.3}, end = {0.3 * sqrt(2), 0.15};
  fill_faces(b->mesh, strain_flow, t.u_f->v);
  for (int32_t i = 0; i < b->mesh->nleaves; i++)
    t.c->v[i] = shape_ring_fraction(ellipsoid, (void *)&ball, b->mesh->x[i],
                                    b->mesh->h[i], 4);
  const int steps = (3 << level) / 4 * (grid == GRID_TWO_JUMPS ? 4 : 2);
  for (int k = 0; k < steps; k++) transport_step(b, &t, k, log(2) / steps);
  double wrong = 0, all = 0;
  for (int32_t i = 0; i < b->mesh->nleaves; i++) {
    const double want = shape_ring_fraction(ellipsoid, (void *)&end,
                                            b->mesh->x[i], b->mesh->h[i], 4);
    wrong += mesh_volume(b->mesh, i) * fabs(t.c->v[i] - want);
    all += mesh_volume(b->mesh, i) * want;
  }
  bench_destroy(b);
  return wrong / all;
}

/* Grids whose fine parts the surface enters and leaves have no smooth order:
 * they are to be as good as a uniform grid as fine as their coarse parts. */
static void run_ball(struct report *report) {
  double error[NGRIDS][N];
  for (int grid = 0; grid < NGRIDS; grid++) {
    char name[64];
    snprintf(name, sizeof name, "stretched ball %s", grid_name[grid]);
    for (int l = 0; l < N; l++)
      error[grid][l] = stretched((enum grid_kind)grid, FIRST + 1 + l);
    report_errors(report, name, "L1 of c", FIRST + 1, N, error[grid],
                  grid > 0 ? error[0] : NULL, grid > 0 ? 0 : 1.9);
  }
}

static double bed(void *context, const double x[3]) {
  (void)context;
  return 0.53 - x[1];
}

/* Return the largest speed of a bed over 300 steps, in sqrt(g H). */
static double rest(double inner, int level, bool adapted) {
  struct params p = ring_params(inner, level, adapted);
  if (adapted) adapt_to_spots(&p);
  p.shape = (struct function){bed, NULL};
  p.tolerance_pressure = p.tolerance_viscous = 1e-12;
  struct two_phase *sim = sim_start(&p);
  bool good = true;
  double most = 0;
  for (int k = 0; k < 300 && good; k++) {
    good = step_advance(sim, 0.05) == EXIT_DONE;
    most = larger(most, largest(sim, sim->u) / sqrt(0.53));
  }
  two_phase_destroy(sim);
  return good ? most : NAN;
}

static void run_rest(struct report *report) {
  for (int level = FIRST; level < FIRST + 3; level++) {
    report_at_most(report, "bed at rest", "max |u|", level,
                   rest(0, level, false), 1e-10);
    report_at_most(report, "bed at rest in a ring", "max |u|", level,
                   rest(0.4, level, false), 1e-10);
    report_at_most(report, "bed at rest adapted", "max |u|", level,
                   rest(0, level, true), 1e-10);
  }
}

static double falling(void *context, const double x[3]) {
  (void)context;
  return 0.25 - hypot(x[0], x[1] - 0.6);
}

static void run_fall(struct report *report) {
  for (int exact = 0; exact < 2; exact++) {
    struct params p = ring_params(0, 6, true);
    struct rheology *r = &p.grains.rheology;
    rheology_init(r, rheology_find("mu_i"));
    rheology_set(r, "mu_s", 0.38), rheology_set(r, "delta_mu", 0.28);
    rheology_set(r, "I0", 0.279), rheology_set(r, "d", 0.01);
    rheology_set(r, "eta_min", 1e-3), rheology_set(r, "eta_max", 10);
    rheology_set(r, "rho", 1);
    if (exact) r->regularisation = RHEOLOGY_EXACT;
    params_follow_surface(&p, 4, 3);
    p.permeable = true;
    p.boundary[2].type = BOUNDARY_NO_SLIP;
    p.boundary[3].type = BOUNDARY_OUTFLOW;
    p.tolerance_pressure = p.tolerance_viscous = 1e-4;
    p.shape = (struct function){falling, NULL};
    struct two_phase *sim = sim_start(&p);
    const double volume = integral(sim->grid.mesh, sim->c->v);
    const bool good = run_to(sim, 2);
    const double after = integral(sim->grid.mesh, sim->c->v);
    two_phase_destroy(sim);
    const char *name = exact ? "falling ball exact" : "falling ball";
    const double solid = 4.18879020478639 * pow(0.25, 3);
    report_at_most(report, name, "its volume", 6, fabs(volume / solid - 1),
                   1e-5); /* of shapes.h */
    report_at_most(report, name, "volume lost", 6,
                   good ? fabs(after / volume - 1) : NAN, 1e-13);
  }
}

static void run(struct report *report) {
  const struct problem *problem = problem_of();
  run_pipes(report);
  report_grids(report, "viscous", "u", solve_viscous, problem, 1.9, 0);
  report_grids(report, "pressure", "p", solve_pressure, problem, 1.9, 0);
  run_ball(report);
  run_rest(report);
  run_fall(report);
}

const struct convergence_case axisymmetric_case = {
    "axisymmetric", "pipe, annulus, balls and beds around an axis", 2, true,
    run};
