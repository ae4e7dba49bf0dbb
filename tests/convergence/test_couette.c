/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Two layers sheared along their interface, viscosities 1000 : 1.
 *
 * Couette flow, the whole time step: the stiff layer below y = Y on a wall at
 * rest, the soft one above under a wall that moves with 1; the interface at
 * 0.1 to 0.9 of a cell of level 4. The stress is the same everywhere, so
 *   u = S y / eta_1 below, 1 - S (1 - y) / eta_2 above,
 *   S = 1 / (Y / eta_1 + (1 - Y) / eta_2),
 * piecewise linear: outside the cut cells exact to round-off, as the face
 * viscosity is that of the layers in series [properties.h]. In the cut cells
 * the bar is none; the value at their centres is reported. Densities 1 : 1 and
 * 1000 : 1. In a cut cell with little of the dense layer but most of its mass
 * in it the velocity is that of the mass, at the interface, not at the centre:
 * first order, up to 4 % here. With the centre a heap would rest on a cushion
 * of gas and never stop (a_heap_less_steep_than_friction_rests, test_step.c).
 * "exact": with a yield stress of 1e-12 of the moving wall's, so that the
 * layers are mixed as an exact yield does it (two_phase/yield_faces.h).
 *
 * Stripes at 45 degrees in a doubly periodic box, the viscous solver alone:
 * stiff for |s - s_0| < W/2, s = x - y of period 1, driven along (1, 1) by
 * forces per volume f_1 in them and f_2 around that add up to 0. With d the
 * distance in s from the middle of a stripe,
 *   -2 (eta u')' = f:   u = -f d^2 / (4 eta) + constant in each,
 * continuous, and so is the stress; mean velocity 0. The force on a leaf is
 * the mean over it. The interface lies off the diagonals of cells; as its
 * place among them changes from level to level, an error is the largest of
 * five places. Errors are relative to max u - min u. On the adapted grid the
 * interface crosses a jump of level. */
#include "report.h"
#include "systems.h"
#include "talus/two_phase/properties.h"
#include "talus/viscous.h"
#include "talus/vof.h"

enum { LEVEL = 4, FIRST = 5, N = 4, MOST = 100 };

static const double kStiff = 1000, kSoft = 1;

/* Return the velocity of Couette flow with the interface at height `interface`.
 */
static double couette(double interface, double y) {
  const double stress = 1 / (interface / kStiff + (1 - interface) / kSoft);
  return y < interface ? stress * y / kStiff : 1 - stress * (1 - y) / kSoft;
}

static struct params layers(double *interface, double density_soft,
                            bool exact) {
  struct params params = box_params(LEVEL);
  params.gravity[DIM - 1] = 0;
  params.grains = (struct phase){1, newtonian(kStiff)};
  params.gas = (struct phase){density_soft, newtonian(kSoft)};
  if (exact) {
    rheology_set(&params.grains.rheology, "cohesion", 1e-12);
    rheology_set_regularisation(&params.grains.rheology, "exact");
  }
  params.shape = (struct function){below, interface};
  params.boundary[0].type = params.boundary[1].type = BOUNDARY_PERIODIC;
  params.boundary[2].type = params.boundary[3].type = BOUNDARY_NO_SLIP;
  params.boundary[3].velocity[0] = 1;
  params.tolerance_viscous = 1e-12;
  params.tolerance_pressure = 1e-12;
  params.stop = 5;
  return params;
}

/* Measure the largest error of the velocity in all leaves but those that the
 * interface cuts, and in those. NAN if a step fails or it is not steady by the
 * end. */
static void couette_errors(double part, double density_soft, bool exact,
                           double error[2]) {
  double interface = (7 + part) / (1 << LEVEL);
  const struct params params = layers(&interface, density_soft, exact);
  struct two_phase *sim = sim_start(&params);
  const bool good = run_steady(sim, 1e-11, params.stop);
  error[0] = error[1] = good ? 0 : NAN;
  for (int32_t i = 0; i < sim->grid.mesh->nleaves && good; i++) {
    const double y = sim->grid.mesh->x[i][1];
    const bool cut = fabs(y - interface) < 0.5 * sim->grid.mesh->h[i];
    const double off = fabs(sim->u[0]->v[i] - couette(interface, y));
    error[cut] = larger(error[cut], larger(off, fabs(sim->u[1]->v[i])));
  }
  two_phase_destroy(sim);
}

static void report_couette(struct report *report, const char *densities,
                           double density_soft, bool exact) {
  for (int tenth = 1; tenth <= 9; tenth++) {
    char name[64];
    double error[2];
    snprintf(name, sizeof name, "%s cut at 0.%d", densities, tenth);
    couette_errors(0.1 * tenth, density_soft, exact, error);
    if (density_soft == 1 || tenth >= 5) {
      report_at_most(report, name, "max of u outside cut cells", LEVEL,
                     error[0], 1e-8);
    } else {
      report_value(report, name, "max of u outside cut cells", LEVEL, error[0]);
    }
    report_value(report, name, "max of u in cut cells", LEVEL, error[1]);
  }
}

/* Stripes: width and middle of the stiff ones in s. */
enum { PLACES = 5 };
static const double kWidth = 0.437;
static const double kPlace[PLACES] = {0.2718, 0.0414, 0.5236, 0.7071, 0.9577};

/* Return the distance in s from the middle of a stiff stripe: -1/2 to 1/2. */
static double from_stripe(double middle, const double *x) {
  const double s = x[0] - x[1] - middle;
  return s - floor(s + 0.5);
}

static double stripe(void *context, const double x[3]) {
  return 0.5 * kWidth - fabs(from_stripe(*(const double *)context, x));
}

/* Return the force of the stiff stripes such that that of the soft ones is -1.
 */
static double stiff_force(void) { return (1 - kWidth) / kWidth; }

/* Return the velocity up to a constant; 0 at the interface. */
static double stripe_velocity(double middle, const double *x) {
  const double d = fabs(from_stripe(middle, x)), half = 0.5 * kWidth;
  if (d < half) return stiff_force() * (half * half - d * d) / (4 * kStiff);
  return ((0.5 - d) * (0.5 - d) - (0.5 - half) * (0.5 - half)) / (4 * kSoft);
}

/* Set the face viscosity as in a step, from the fractions of the leaves. */
static void stripe_viscosity(struct bench *b, double middle, struct field *c,
                             double *eta_f) {
  static const char *const names[] = {"normal_x", "normal_y", "normal_z"};
  const struct phase stiff = {1, newtonian(kStiff)};
  const struct phase soft = {1, newtonian(kSoft)};
  const double gravity[DIM] = {0};
  struct field *plane = bench_cell(b, "plane"), *p = bench_cell(b, "p");
  struct field *normal[DIM], *shear_f = bench_face(b, "shear_f");
  double *work[2] = {bench_face(b, "work")->v, bench_face(b, "more")->v};
  double *n[DIM];
  bench_vector(b, names, normal);
  field_arrays(normal, n);
  fill_shape(b->mesh, stripe, &middle, c->v);
  field_fill(b->mesh, c);
  vof_reconstruct(b->mesh, c->v, n, plane->v);
  properties_viscosity(b->mesh, 0, &stiff, &soft, gravity, c->v, n, plane->v,
                       p->v, b->closed, shear_f->v, work, eta_f);
}

/* Apply forces on the leaves over dt and find the velocity they drive; returns
 * false if the solve does not converge. */
static bool drive_stripes(struct bench *b, const double *c, const double *eta_f,
                          double dt, struct field *const u[DIM]) {
  const struct mesh *mesh = b->mesh;
  struct hierarchy *hierarchy = hierarchy_new(mesh);
  double *rho = MEM_NEW(double, mesh->nleaves), *rhs[DIM], *v[DIM];
  const struct bc *bc[DIM];
  for (int d = 0; d < DIM; d++) {
    rhs[d] = MEM_NEW(double, mesh->nleaves);
    bc[d] = u[d]->bc;
    for (int32_t i = 0; i < mesh->nleaves; i++) {
      rho[i] = 1;
      rhs[d][i] = dt * (c[i] * (stiff_force() + 1) - 1);
    }
    remove_mean(mesh, rhs[d]); /* round-off, against 1e8 times the inertia */
  }
  field_arrays(u, v);
  const struct solve_stats stats =
      viscous_solve(mesh, hierarchy, rho, &(struct viscosity){.eta_f = eta_f},
                    dt, rhs, bc, 1e-8 * largest_size(mesh, rhs[0]), MOST, v);
  for (int d = 0; d < DIM; d++) mem_free(rhs[d]);
  mem_free(rho);
  hierarchy_destroy(hierarchy);
  return stats.status == SOLVE_CONVERGED;
}

static struct norms stripe_errors(enum grid_kind grid, int level,
                                  double middle) {
  static const char *const names[] = {"u_x", "u_y", "u_z"};
  struct bench *b = bench_on(grid_make(grid, true, level));
  struct field *c = bench_cell(b, "c"), *eta_f = bench_face(b, "eta_f");
  struct field *u[DIM], *error = bench_cell(b, "error");
  bench_vector(b, names, u);
  stripe_viscosity(b, middle, c, eta_f->v);
  /* rho h^2 / (eta dt) = 1e-8 */
  const double dt = ldexp(1e8 / kSoft, -2 * b->mesh->level_finest);
  const bool good = drive_stripes(b, c->v, eta_f->v, dt, u);
  const double range = stiff_force() * kWidth * kWidth / (16 * kStiff) +
                       (1 - kWidth) * (1 - kWidth) / (16 * kSoft);
  struct norms norms = {0};
  for (int d = 0; d < DIM; d++) {
    for (int32_t i = 0; i < b->mesh->nleaves; i++) {
      error->v[i] =
          (u[d]->v[i] - stripe_velocity(middle, b->mesh->x[i])) / range;
    }
    remove_mean(b->mesh, error->v);
    const struct norms part = norms_of(b->mesh, error->v);
    norms.l2 = hypot(norms.l2, part.l2);
    norms.most = larger(norms.most, part.most);
  }
  if (!good) norms.l2 = norms.most = NAN;
  bench_destroy(b);
  return norms;
}

/* Return the larger one; NAN if one is. */
static double worse(double a, double b) { return isnan(a) || a >= b ? a : b; }

static void report_stripes(struct report *report, const char *name,
                           enum grid_kind grid) {
  double l2[N], most[N];
  for (int l = 0; l < N; l++) {
    l2[l] = most[l] = 0;
    for (int k = 0; k < PLACES; k++) {
      const struct norms norms = stripe_errors(grid, FIRST + l, kPlace[k]);
      l2[l] = worse(l2[l], norms.l2), most[l] = worse(most[l], norms.most);
    }
  }
  report_errors(report, name, "L2 of u", FIRST, N, l2, NULL, 1);
  report_errors(report, name, "max of u", FIRST, N, most, NULL, 1);
}

static void run(struct report *report) {
  report_couette(report, "same density", 1, false);
  report_couette(report, "same density exact", 1, true);
  report_couette(report, "density 1000 : 1", 1e-3, false);
  report_couette(report, "density 1000 : 1 exact", 1e-3, true);
  report_stripes(report, "45 degrees uniform", GRID_UNIFORM);
  report_stripes(report, "45 degrees adapted", GRID_BALL);
}

const struct convergence_case couette_case = {
    "couette", "layers of viscosity 1000 : 1 in shear", 2, true, run};
