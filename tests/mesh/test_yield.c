/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/yield.h"

#include <check.h>
#include <math.h>

#include "ranks.h"
#include "sim.h"
#include "talus/strain.h"
#include "talus/two_phase/yield_faces.h"

Suite *yield_suite(void);

enum { ALONG = 0, UP = DIM - 1 };

static struct rheology exact_closure(const char *name) {
  struct rheology r;
  rheology_init(&r, rheology_find(name));
  rheology_set_regularisation(&r, "exact");
  return r;
}

static double linear(void *context, const double x[3]) {
  (void)context;
  return x[UP];
}

/* Describe a layer of depth 1 in 32 cells on a slope, periodic along it. */
static struct params layer_params(struct rheology grains, double degrees) {
  const double slope = degrees * acos(-1) / 180;
  struct params p = periodic_params(1);
  p.size = 1. / 16;
  p.trees[UP] = 16;
  p.grains.rheology = grains;
  p.boundary[2 * UP].type = BOUNDARY_NO_SLIP;
  p.boundary[2 * UP + 1].type = BOUNDARY_OUTFLOW;
  p.gravity[ALONG] = sin(slope), p.gravity[UP] = -cos(slope);
  p.tolerance_pressure = p.tolerance_viscous = 1e-12;
  p.dt_max = 0.02;
  return p;
}

static double fastest(const struct two_phase *sim, double least) {
  double most = 0;
  for (int32_t i = 0; i < sim->grid.mesh->nleaves; i++) {
    for (int d = 0; d < DIM && sim->c->v[i] > least; d++) {
      most = larger(most, fabs(sim->u[d]->v[i]));
    }
  }
  return mesh_max(sim->grid.mesh, most);
}

static bool run_to(struct two_phase *sim, double time) {
  bool done = true;
  while (done && sim->model.time < time - 1e-9)
    done = step_advance(sim, time - sim->model.time) == EXIT_DONE;
  return done;
}

/* A Coulomb layer that starts with u = y slows down as u = y - k t where it
 * moves, k = g cos(a) (mu_s - tan(a)) = 0.200579, and its top cell stops at
 * t = 4.9077. */
START_TEST(a_layer_stops_when_it_should) {
  const double dt[] = {0.02, 0.01}, late[] = {1.04, 1.025};
  struct rheology grains = exact_closure("coulomb");
  rheology_set(&grains, "mu_s", 0.38);
  struct params p = layer_params(grains, 10);
  p.velocity[ALONG] = (struct function){linear, NULL};
  p.dt_max = dt[_i];
  struct two_phase *sim = sim_start(&p);
  bool done = run_to(sim, 2);
  const double moving = fastest(sim, 0.5);
  while (done && fastest(sim, 0.5) > 1e-9 && sim->model.time < 8)
    done = step_advance(sim, 1) == EXIT_DONE;
  const double stop = sim->model.time;
  done = done && run_to(sim, stop + 1);
  const double rest = fastest(sim, 0.5);
  two_phase_destroy(sim);
  ck_assert(done);
  ck_assert_double_eq_tol(moving, 63. / 64 - 2 * 0.200579, 0.2 * dt[_i]);
  ck_assert_double_gt(stop, 4.9077);
  ck_assert_double_lt(stop, late[_i] * 4.9077);
  ck_assert_double_lt(rest, 1e-15);
}
END_TEST

/* Layers that begin with a flow have their stress before the first step. */
START_TEST(a_flow_begins_at_its_yield_stress) {
  struct rheology grains = exact_closure("coulomb");
  rheology_set(&grains, "mu_s", 0.38);
  struct params p = layer_params(grains, 10);
  p.velocity[ALONG] = (struct function){linear, NULL};
  struct two_phase *sim = sim_start(&p);
  const struct mesh *mesh = sim->grid.mesh;
  double held = 0, wet = 0;
  for (int32_t f = mesh->face_begin[UP]; f < mesh->face_begin[UP + 1]; f++) {
    if (sim->yield.tau_y->v[f] == 0) continue;
    held += !yield_is_reached(&sim->yield, UP, f), wet++;
  }
  held = mesh_sum(mesh, held), wet = mesh_sum(mesh, wet);
  two_phase_destroy(sim);
  ck_assert(wet > 0);
  ck_assert(held == 0);
}
END_TEST

/* mu_s = 0.38 is the tangent of 20.807 degrees. */
START_TEST(a_layer_rests_up_to_its_angle_of_repose) {
  struct rheology grains = exact_closure("mu_i");
  rheology_set(&grains, "mu_s", 0.38);
  rheology_set(&grains, "d", 0.04);
  rheology_set(&grains, "rho", 1);
  const struct params p = layer_params(grains, _i ? 20.81 : 20.80);
  struct two_phase *sim = sim_start(&p);
  const bool done = run_to(sim, 10);
  const double speed = fastest(sim, 0.5);
  two_phase_destroy(sim);
  ck_assert(done);
  if (_i)
    ck_assert_double_gt(speed, 1e-4);
  else
    ck_assert_double_lt(speed, 1e-12);
}
END_TEST

/* Return the level set of a heap with a slope of *context along x. */
static double heap(void *context, const double x[3]) {
  const double slope = *(const double *)context;
  return 0.3 - slope * x[0] - x[UP];
}

/* Describe a heap at half its angle of repose under gas, on one level or
 * across jumps. */
static struct params heap_params(bool jumps) {
  static double slope = 0.176;
  struct params p = box_params(DIM == 2 ? 5 : 4);
  p.size = 2;
  p.shape = (struct function){heap, &slope};
  p.grains.rheology = exact_closure("mu_i");
  rheology_set(&p.grains.rheology, "mu_s", 0.38);
  rheology_set(&p.grains.rheology, "d", 0.04);
  rheology_set(&p.grains.rheology, "rho", 1);
  p.boundary[1].type = p.boundary[2 * UP].type = BOUNDARY_NO_SLIP;
  p.boundary[2 * UP + 1].type = BOUNDARY_OUTFLOW;
  p.tolerance_pressure = p.tolerance_viscous = 1e-12;
  p.dt_max = 1. / 32;
  if (DIM == 3) params_make_narrow(&p, 2);
  if (jumps) params_follow_surface(&p, p.level_max - 2, 3);
  return p;
}

/* Gas may go on. */
START_TEST(a_heap_rests_under_gas) {
  const struct params p = heap_params(_i);
  struct two_phase *sim = sim_start(&p);
  const bool done = run_to(sim, end_of_run(10, 5));
  const double speed = fastest(sim, 0.01);
  double moved = 0;
  for (int32_t f = 0; f < sim->grid.mesh->nfaces; f++) {
    const int32_t *leaf = sim->grid.mesh->face_leaf[f];
    bool grains = true;
    for (int side = 0; side < 2; side++)
      grains = grains && leaf[side] >= 0 && sim->c->v[leaf[side]] > 0.01;
    if (grains) moved = larger(moved, fabs(sim->u_f->v[f]));
  }
  moved = mesh_max(sim->grid.mesh, moved);
  two_phase_destroy(sim);
  ck_assert(done);
  ck_assert_double_lt(speed, 1e-12); /* the tolerance of the solvers */
  ck_assert_double_lt(moved, 1e-12); /* and so do the faces that carry c */
}
END_TEST

/* Return the level set of a cone. */
static double cone(void *context, const double x[3]) {
  (void)context;
  return 0.3 - 0.176 * hypot(x[0], x[1]) - x[UP];
}

/* The surface of a cone is askew: full leaves beside it have sides wet by 1e-5,
 * which yield. Its grains have 1.3e-10; 2e-8 while such a side freed a leaf. */
START_TEST(a_cone_rests_under_gas) {
  struct params p = heap_params(false);
  p.boundary[3].type = BOUNDARY_NO_SLIP;
  p.size = 2, p.trees[0] = p.trees[DIM - 1] = 1;
  p.level_min = p.level_max = 4;
  p.shape = (struct function){cone, NULL};
  struct two_phase *sim = sim_start(&p);
  const bool done = run_to(sim, 2);
  const double speed = fastest(sim, 0.01);
  two_phase_destroy(sim);
  ck_assert(done);
  ck_assert_msg(speed < 2e-9, "%g", speed);
}
END_TEST

/* Repetitions of a step, whose stress starts from that of the last one, leave a
 * heap at rest. */
START_TEST(a_heap_rests_in_repeated_steps) {
  struct params p = heap_params(false);
  p.picard = 1;
  struct two_phase *sim = sim_start(&p);
  const bool done = run_to(sim, 2);
  const double speed = fastest(sim, 0.01);
  two_phase_destroy(sim);
  ck_assert(done);
  ck_assert_msg(speed < 1e-9, "%g", speed);
}
END_TEST

/* Return the level set of a cliff with its foot at x = 0.5 and of height
 * *context. */
static double cliff(void *context, const double x[3]) {
  return fmin(0.5 - x[0], *(const double *)context - x[UP]);
}

/* A cliff with a cohesion k has the stress -rho g depth e_y e_y without
 * yielding as long as rho g H/2 <= mu rho g H/2 + k: H = 2 k/(rho g (1 - mu)) =
 * 0.323 stands. A wedge at 45 degrees + asin(mu)/2 slides at twice that. Gas
 * weighs 1e-6 or 1e-3; grains have 2.1e-8 and 1.3e-7 at most. */
START_TEST(a_cliff_with_cohesion_stands) {
  const double gas[] = {1e-6, 1e-3, 1e-3}, most[] = {4e-8, 1e-6, 1};
  double height = _i < 2 ? 0.25 : 0.75;
  struct params p = heap_params(false);
  p.shape = (struct function){cliff, &height};
  p.gas.density = gas[_i];
  p.gas.rheology = newtonian(0.01 * gas[_i]);
  p.grains.rheology = exact_closure("coulomb");
  rheology_set(&p.grains.rheology, "mu_s", 0.38);
  rheology_set(&p.grains.rheology, "cohesion", 0.1);
  struct two_phase *sim = sim_start(&p);
  bool done = run_to(sim, 1);
  double speed = fastest(sim, 0.01);
  while (done && _i < 2 && sim->model.time < (DIM == 2 ? 5 : 2)) {
    done = step_advance(sim, 1) == EXIT_DONE;
    speed = larger(speed, fastest(sim, 0.01));
  }
  two_phase_destroy(sim);
  ck_assert(done);
  ck_assert_msg(speed < most[_i], "%g", speed);
  ck_assert_msg(_i < 2 || speed > 1e-2, "%g", speed);
}
END_TEST

/* Misfits are told to the user where they are bad, and counted. */
START_TEST(a_bad_misfit_is_told_once) {
  struct params p = heap_params(false);
  struct two_phase *sim = sim_new(&p, MPI_COMM_WORLD);
  yield_fits(&sim->yield, 0, 32, 0.01);
  const int fair = sim->yield.misfits;
  yield_fits(&sim->yield, 0, 32, 0.03);
  const int bad = sim->yield.misfits;
  two_phase_destroy(sim);
  ck_assert_int_eq(fair, 0);
  ck_assert_int_eq(bad, 1);
}
END_TEST

/* A heap at 0.95 of its slope of repose is at its yield stress below the crest,
 * which sank at 2e-5 while grains felt what the projection alone does. Then it
 * falls on, with the currents of the gas. */
START_TEST(a_crest_near_repose_does_not_sink) {
  double slope = 0.95 * 0.38;
  struct params p = heap_params(false);
  p.level_min = p.level_max = 6;
  p.shape = (struct function){heap, &slope};
  p.tolerance_pressure = p.tolerance_viscous = 1e-10;
  p.dt_max = 1. / 64;
  struct two_phase *sim = sim_start(&p);
  const bool done = run_to(sim, 4);
  const double speed = fastest(sim, 0.01);
  two_phase_destroy(sim);
  ck_assert(done);
  ck_assert_double_lt(speed, 1e-8);
}
END_TEST

/* Scale the stress of a heap at rest, or tilt it to 15 degrees, of 20.8 that it
 * bears: it moves as far as its springs give way, and rests again. */
START_TEST(a_heap_mends_its_stress) {
  static const double factor[] = {0, 0.9, 1};
  struct params p = heap_params(false);
  struct two_phase *sim = sim_start(&p);
  bool done = run_to(sim, 10);
  for (int k = 0; k < sim->yield.nrows; k++) {
    for (int32_t f = 0; f < sim->grid.mesh->nfaces_all; f++)
      sim->yield.s[k]->v[f] *= factor[_i];
  }
  if (_i == 2) p.gravity[ALONG] = 0.0875 * -p.gravity[UP]; /* tan 5 degrees */
  done = done && step_advance(sim, 1) == EXIT_DONE;
  const double first = fastest(sim, 0.01);
  for (int k = 0; k < 10 && done; k++) done = step_advance(sim, 1) == EXIT_DONE;
  const double tenth = fastest(sim, 0.01);
  two_phase_destroy(sim);
  ck_assert(done);
  /* one solve gives 1.4e-4, 1.4e-5 and 7.5e-5 */
  ck_assert_msg(first <= 1e-5, "%g", first);
  /* p, which tilting changes, takes longer */
  ck_assert_msg(_i == 2 || tenth <= 0.01 * first, "%g, %g", first, tenth);
}
END_TEST

/* Closures that thin have no bound on their plastic viscosity at rest, and the
 * largest yield stress there is must not overflow. */
START_TEST(closures_that_thin_start_from_rest) {
  struct rheology grains = exact_closure("herschel_bulkley");
  rheology_set(&grains, "tau_y", 1e3);
  rheology_set(&grains, "K", 1);
  rheology_set(&grains, "n", 0.3);
  const struct params p = layer_params(grains, 10);
  struct two_phase *sim = sim_start(&p);
  const bool done = run_to(sim, 0.2);
  const double speed = fastest(sim, 0.5);
  two_phase_destroy(sim);
  ck_assert(done);
  ck_assert_double_lt(speed, 1e-3);
}
END_TEST

/* Gravity that hardly acts sets no scale of its own: a stress-free box turns as
 * if there was none. */
START_TEST(the_stiffness_follows_the_faster_of_fall_and_flow) {
  struct rheology grains = exact_closure("bingham");
  rheology_set(&grains, "tau_y", 0.1);
  rheology_set(&grains, "eta_0", 0.1);
  struct params p = layer_params(grains, 10);
  p.velocity[ALONG] = (struct function){linear, NULL};
  double gamma_r[2];
  for (int k = 0; k < 2; k++) {
    for (int d = 0; d < DIM; d++) p.gravity[d] *= k == 0 ? 0 : 1e-9;
    if (k == 1) p.gravity[UP] = -1e-9;
    struct two_phase *sim = sim_start(&p);
    step_advance(sim, 0.01);
    gamma_r[k] = sim->yield.gamma_r;
    two_phase_destroy(sim);
  }
  ck_assert_double_eq_tol(gamma_r[1], gamma_r[0], 1e-9 * gamma_r[0]);
}
END_TEST

/* Return the level set of grains above (*context > 0) or below the height
 * |*context|. */
static double level_grains(void *context, const double x[3]) {
  const double height = *(const double *)context;
  return height > 0 ? x[UP] - height : -height - x[UP];
}

/* Make grains with a flat surface, finer near a corner of the box. */
static struct two_phase *flat_grains(const struct params *p) {
  const double corner[DIM] = {0};
  struct forest_layout layout;
  grid_layout(p, &layout);
  struct forest *forest = forest_new(MPI_COMM_WORLD, &layout, p->level_min);
  grid_refine(forest, corner, 0.6, p->level_max);
  struct two_phase *sim = two_phase_new_on(p, forest);
  sim_fill(sim);
  step_density(sim);
  field_fill_many(sim->grid.mesh, DIM, sim->u);
  mesh_fill_potential(sim->grid.mesh, NULL, 1, &sim->p->v,
                      (const struct bc *[]){sim->p->bc}, false);
  double *u[DIM];
  field_arrays(sim->u, u);
  yield_faces_update(sim, u);
  return sim;
}

/* Grains at faces along the surface touch the part of them that lies in the
 * grains, on fine faces of coarse leaves too. */
START_TEST(faces_are_wet_as_far_as_grains_reach) {
  double height = _i ? 0.5375 : -0.5375, worst = 0; /* 0.3 of a coarse leaf */
  struct params p = box_params(3);
  p.level_max = 4;
  p.shape = (struct function){level_grains, &height};
  p.grains.rheology = exact_closure("bingham");
  rheology_set(&p.grains.rheology, "tau_y", 1);
  rheology_set(&p.grains.rheology, "eta_0", 1);
  struct two_phase *sim = flat_grains(&p);
  const struct mesh *mesh = sim->grid.mesh;
  for (int32_t f = 0; f < mesh->face_begin[1]; f++) {
    const int32_t i = mesh->face_owner[f];
    const double reach =
        (fabs(height) - mesh->x[i][UP]) / mesh->face_h[f] + 0.5;
    const double below = fmin(fmax(reach, 0), 1);
    const double want = _i ? 1 - below : below;
    worst = larger(worst, fabs(sim->yield.tau_y->v[f] - want));
  }
  worst = mesh_max(mesh, worst);
  two_phase_destroy(sim);
  ck_assert_double_lt(worst, 1e-10);
}
END_TEST

/* Without any pressure the face below a cut leaf bears c rho g h of it, and no
 * other face has friction. */
START_TEST(a_cut_leaf_weighs_on_the_face_below) {
  double height = -0.5375, worst = 0;
  struct params p = box_params(3);
  p.level_max = 4;
  p.shape = (struct function){level_grains, &height};
  p.grains.rheology = exact_closure("coulomb");
  rheology_set(&p.grains.rheology, "mu_s", 0.5);
  struct two_phase *sim = flat_grains(&p);
  const struct mesh *mesh = sim->grid.mesh;
  for (int d = 0; d < DIM; d++) {
    for (int32_t f = mesh->face_begin[d]; f < mesh->face_begin[d + 1]; f++) {
      const int32_t above = mesh->face_leaf[f][1];
      const double c = above < 0 ? 0 : sim->c->v[above];
      const bool bears = d == UP && c > 1e-9 && c < 1 - 1e-9;
      const double want = bears ? 0.5 * c * mesh->h[above] : 0;
      if (mesh->face_patch[f] >= 0) continue; /* walls see dp/dn */
      worst = larger(worst, fabs(sim->yield.tau_y->v[f] - want));
    }
  }
  worst = mesh_max(mesh, worst);
  two_phase_destroy(sim);
  ck_assert_double_lt(worst, 1e-10);
}
END_TEST

/* Without any pressure a few grains in a leaf weigh on those of the cut leaf
 * below, whose plane does not reach them. */
START_TEST(grains_lie_on_those_of_the_leaf_below) {
  const double few = 0.003;
  double height = -0.5375, worst = 0;
  struct params p = box_params(3);
  p.shape = (struct function){level_grains, &height};
  p.grains.rheology = exact_closure("coulomb");
  rheology_set(&p.grains.rheology, "mu_s", 0.5);
  struct two_phase *sim = sim_new(&p, MPI_COMM_WORLD);
  const struct mesh *mesh = sim->grid.mesh;
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    if (mesh->x[i][UP] > 0.625 && mesh->x[i][UP] < 0.75) sim->c->v[i] = few;
    sim->p->v[i] = 0;
  }
  sim->planes_hold = false;
  step_density(sim);
  field_fill_many(mesh, DIM, sim->u);
  mesh_fill_potential(mesh, NULL, 1, &sim->p->v,
                      (const struct bc *[]){sim->p->bc}, false);
  double *u[DIM];
  field_arrays(sim->u, u);
  yield_faces_update(sim, u);
  for (int32_t f = mesh->face_begin[UP]; f < mesh->face_begin[DIM]; f++) {
    const int32_t above = mesh->face_leaf[f][1];
    if (above < 0 || sim->c->v[above] != few) continue;
    const double want = 0.5 * few * mesh->h[above];
    worst = larger(worst, fabs(sim->yield.tau_y->v[f] / want - 1));
  }
  worst = mesh_max(mesh, worst);
  two_phase_destroy(sim);
  ck_assert_double_lt(worst, 1e-10);
}
END_TEST

/* Grains touch the floor by 1 - 10 c' where a film of gas takes c' of the
 * lowest leaves. */
START_TEST(grains_touch_what_a_film_keeps_them_from) {
  const double film[] = {1e-6, 0.02, 0.3}, h = 1. / 8;
  double height = film[_i] * h, worst = 0;
  struct params p = box_params(3);
  p.shape = (struct function){level_grains, &height};
  p.grains.rheology = exact_closure("bingham");
  rheology_set(&p.grains.rheology, "tau_y", 1);
  rheology_set(&p.grains.rheology, "eta_0", 1);
  struct two_phase *sim = flat_grains(&p);
  const struct mesh *mesh = sim->grid.mesh;
  for (int32_t f = mesh->face_begin[UP]; f < mesh->face_begin[UP + 1]; f++) {
    if (mesh->face_patch[f] != 2 * UP) continue;
    const double want = fmax(1 - 10 * film[_i], 0);
    worst = larger(worst, fabs(sim->yield.tau_y->v[f] - want));
  }
  worst = mesh_max(mesh, worst);
  two_phase_destroy(sim);
  ck_assert_double_lt(worst, 1e-10);
}
END_TEST

/* Linearise a step of 0.1 with gamma_r = 1e-3; the caller frees r and eta
 * [nfaces_all]. */
static void linearise(struct two_phase *sim, double **r, double **eta) {
  const struct mesh *mesh = sim->grid.mesh;
  double *force[DIM];
  *r = MEM_NEW(double, mesh->nfaces_all);
  *eta = MEM_NEW(double, mesh->nfaces_all);
  for (int d = 0; d < DIM; d++) force[d] = MEM_NEW(double, mesh->ncells);
  sim->yield.gamma_r = 1e-3;
  yield_linearise(&sim->yield, 0.1, *r, *eta, force);
  for (int d = 0; d < DIM; d++) mem_free(force[d]);
}

/* D = 0 of before the projection leaves out a shear rate of 1e3 that it has
 * brought: the solve then takes the viscosity of that, tau_y/1e3. */
START_TEST(a_jolt_lets_grains_yield) {
  struct params p = periodic_params(2);
  double worst = 0;
  p.grains.rheology = exact_closure("bingham");
  rheology_set(&p.grains.rheology, "tau_y", 1);
  rheology_set(&p.grains.rheology, "eta_0", 1);
  struct two_phase *sim = sim_new(&p, MPI_COMM_WORLD);
  const struct mesh *mesh = sim->grid.mesh;
  double *r, *eta;
  for (int32_t f = 0; f < mesh->nfaces; f++) {
    sim->eta_f->v[f] = 1;
    sim->yield.tau_y->v[f] = 1;
    sim->yield.shear->v[f] = _i ? 1e3 : 1;
  }
  linearise(sim, &r, &eta);
  for (int32_t f = 0; f < mesh->nfaces; f++) {
    const double want = 1 + (_i ? 1e-3 : r[f]);
    worst = larger(worst, fabs(eta[f] / want - 1));
  }
  worst = mesh_max(mesh, worst);
  mem_free(r), mem_free(eta);
  two_phase_destroy(sim);
  ck_assert_double_lt(worst, 1e-12);
}
END_TEST

/* Where |D| is the same on all faces r = tau_y/(gamma_r + |D|), in which
 * gamma_r follows |D| between a tenth of what it is in a flow and all of it. */
START_TEST(springs_stiffen_as_a_flow_dies) {
  const double rate[] = {0, 0.4, 20}, gamma_r[] = {1e-4, 2e-4, 1e-3};
  struct params p = periodic_params(2);
  double worst = 0;
  p.grains.rheology = exact_closure("bingham");
  rheology_set(&p.grains.rheology, "tau_y", 3);
  rheology_set(&p.grains.rheology, "eta_0", 1);
  struct two_phase *sim = sim_new(&p, MPI_COMM_WORLD);
  const struct mesh *mesh = sim->grid.mesh;
  double *r, *eta;
  for (int d = 0; d < DIM; d++) {
    for (int32_t f = mesh->face_begin[d]; f < mesh->face_begin[d + 1]; f++) {
      sim->yield.tau_y->v[f] = 3;
      sim->yield.strain[(d + 1) % DIM]->v[f] = rate[_i];
    }
  }
  linearise(sim, &r, &eta);
  for (int32_t f = 0; f < mesh->nfaces; f++) {
    const double want = 3 / (gamma_r[_i] + rate[_i]);
    worst = larger(worst, fabs(r[f] / want - 1));
  }
  worst = mesh_max(mesh, worst);
  mem_free(r), mem_free(eta);
  two_phase_destroy(sim);
  ck_assert_double_lt(worst, 1e-12);
}
END_TEST

/* Where D is 2 on all faces but one, on which it vanishes, r is tau_y/(gamma_r
 * + 2), or a little more beside that one. */
START_TEST(a_still_face_in_a_flow_is_as_soft_as_the_others) {
  double height = -0.5375, stiffest = 0, softest = 1e300;
  struct params p = box_params(3);
  p.level_max = 4;
  p.shape = (struct function){level_grains, &height};
  p.grains.rheology = exact_closure("bingham");
  rheology_set(&p.grains.rheology, "tau_y", 1);
  rheology_set(&p.grains.rheology, "eta_0", 1);
  struct two_phase *sim = flat_grains(&p);
  const struct mesh *mesh = sim->grid.mesh;
  double *r, *eta;
  for (int d = 0; d < DIM; d++) {
    const int other = (d + 1) % DIM;
    for (int32_t f = mesh->face_begin[d]; f < mesh->face_begin[d + 1]; f++)
      sim->yield.strain[other]->v[f] = f == 0 ? 0 : 2;
  }
  linearise(sim, &r, &eta);
  for (int32_t f = 0; f < mesh->nfaces; f++) {
    const double scaled = r[f] / sim->yield.tau_y->v[f];
    if (sim->yield.tau_y->v[f] == 0) continue;
    stiffest = larger(stiffest, scaled);
    softest = fmin(softest, scaled);
  }
  stiffest = mesh_max(mesh, stiffest);
  softest = -mesh_max(mesh, -softest);
  mem_free(r), mem_free(eta);
  two_phase_destroy(sim);
  ck_assert_double_eq_tol(softest, 1 / 2.001, 1e-12);
  /* D = 0 at one of at least four sides, of one leaf where that is a wall */
  ck_assert_double_le(stiffest, 1 / 1.5);
}
END_TEST

/* u_e = sum_t (e + 2 t + 1) x_t. */
static double plane_flow(int e, const double x[3]) {
  double u = 0;
  for (int t = 0; t < DIM; t++) u += (e + 2 * t + 1) * x[t];
  return u;
}

/* A flow that yields and goes on as it did has no mismatch; one that sets in
 * at once has one. */
START_TEST(a_flow_that_goes_on_has_no_mismatch) {
  double height = -0.5375;
  struct params p = box_params(3);
  p.level_max = 4;
  p.shape = (struct function){level_grains, &height};
  p.grains.rheology = exact_closure("bingham");
  rheology_set(&p.grains.rheology, "tau_y", 1);
  rheology_set(&p.grains.rheology, "eta_0", 1);
  struct two_phase *sim = flat_grains(&p);
  const struct mesh *mesh = sim->grid.mesh;
  double *r = MEM_NEW(double, mesh->nfaces_all), *u[DIM], *force[DIM];
  double *eta = MEM_NEW(double, mesh->nfaces_all), first = 0, last = 0;
  for (int e = 0; e < DIM; e++) {
    u[e] = sim->u[e]->v;
    force[e] = MEM_NEW(double, mesh->ncells);
    for (int32_t i = 0; i < mesh->nleaves; i++) {
      double x[3] = {0};
      for (int d = 0; d < DIM; d++) x[d] = mesh->x[i][d];
      u[e][i] = plane_flow(e, x);
    }
  }
  field_fill_many(mesh, DIM, sim->u);
  for (int k = 0; k < 20; k++) {
    yield_linearise(&sim->yield, 0, r, eta, force);
    last = yield_advance(&sim->yield, 0.1, r, eta, u, k > 0);
    if (k == 0) first = last;
  }
  for (int e = 0; e < DIM; e++) mem_free(force[e]);
  mem_free(r), mem_free(eta);
  two_phase_destroy(sim);
  ck_assert_double_gt(first, 1);
  ck_assert_double_lt(last, 1e-12); /* round-off */
}
END_TEST

START_TEST(strain_of_a_linear_flow_is_exact) {
  struct params p = box_params(3);
  struct two_phase *sim = sim_new(&p, MPI_COMM_WORLD);
  const struct mesh *mesh = sim->grid.mesh;
  double *u[DIM], *rows[STRAIN_ROWS], worst = 0;
  for (int e = 0; e < DIM; e++) u[e] = sim->u[e]->v;
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    double x[3] = {0};
    for (int d = 0; d < DIM; d++) x[d] = mesh->x[i][d];
    for (int e = 0; e < DIM; e++) u[e][i] = plane_flow(e, x);
  }
  field_fill_many(mesh, DIM, sim->u);
  for (int k = 0; k < STRAIN_ROWS; k++)
    rows[k] = MEM_NEW(double, mesh->nfaces_all);
  strain_find(mesh, NULL, u, rows);
  for (int d = 0; d < DIM; d++) {
    for (int32_t f = mesh->face_begin[d]; f < mesh->face_begin[d + 1]; f++) {
      bool inner = mesh->face_patch[f] < 0;
      for (int k = 0; k < NSTENCIL; k++) {
        const int32_t node = mesh->stencil[mesh->face_owner[f]][k];
        inner = inner && node < mesh->begin_boundary;
      }
      for (int e = 0; e < DIM && inner; e++) {
        const double want = 0.5 * ((e + 2 * d + 1) + (d + 2 * e + 1));
        worst = larger(worst, fabs(rows[e][f] - want));
      }
    }
  }
  worst = mesh_max(mesh, worst);
  for (int k = 0; k < STRAIN_ROWS; k++) mem_free(rows[k]);
  two_phase_destroy(sim);
  ck_assert_double_lt(worst, 1e-11);
}
END_TEST

/* T:T/2 of T = [[1, 3, 4], [3, 2, 5], [4, 5, -3]] and of [[1, 3], [3, -1]]. */
START_TEST(the_norm_counts_all_of_the_tensor) {
  double value[5] = {1, 3, 4, 2.5, 5}, *rows[STRAIN_ROWS];
  for (int k = 0; k < STRAIN_ROWS; k++) rows[k] = &value[k];
  const double want = DIM == 2 ? 1 + 9 : 0.5 * (1 + 4 + 9) + 9 + 16 + 25;
  ck_assert_double_eq_tol(strain_norm_squared(DIM == 2 ? 2 : 5, rows, 0, 0),
                          want, 1e-14);
}
END_TEST

Suite *yield_suite(void) {
  Suite *suite = suite_create("yield");
  TCase *tcase = tcase_create("rest");
  if (DIM == 2) tcase_add_loop_test(tcase, a_layer_stops_when_it_should, 0, 1);
  tcase_add_test(tcase, a_flow_begins_at_its_yield_stress);
  tcase_add_loop_test(tcase, a_heap_rests_under_gas, 1, 2);
  tcase_add_test(tcase, a_heap_rests_in_repeated_steps);
  tcase_add_test(tcase, a_bad_misfit_is_told_once);
  tcase_add_test(tcase, closures_that_thin_start_from_rest);
  tcase_add_test(tcase, the_stiffness_follows_the_faster_of_fall_and_flow);
  suite_add_tcase(suite, tcase);
  tcase = tcase_create("long rest");
  tcase_set_tags(tcase, "one_rank");
  tcase_add_loop_test(tcase, a_layer_stops_when_it_should, DIM == 2, 2);
  tcase_add_loop_test(tcase, a_layer_rests_up_to_its_angle_of_repose, 0, 2);
  tcase_add_loop_test(tcase, a_heap_rests_under_gas, 0, 1);
  tcase_add_loop_test(tcase, a_heap_mends_its_stress, 0, DIM == 2 ? 3 : 1);
  if (DIM == 2) tcase_add_test(tcase, a_crest_near_repose_does_not_sink);
  if (DIM == 3) tcase_add_test(tcase, a_cone_rests_under_gas);
  tcase_add_loop_test(tcase, a_cliff_with_cohesion_stands, 0, 3);
  suite_add_tcase(suite, tcase);
  tcase = tcase_create("surface");
  tcase_add_loop_test(tcase, faces_are_wet_as_far_as_grains_reach, 0, 2);
  tcase_add_loop_test(tcase, grains_touch_what_a_film_keeps_them_from, 0, 3);
  tcase_add_loop_test(tcase, a_jolt_lets_grains_yield, 0, 2);
  tcase_add_test(tcase, a_cut_leaf_weighs_on_the_face_below);
  tcase_add_test(tcase, grains_lie_on_those_of_the_leaf_below);
  tcase_add_loop_test(tcase, springs_stiffen_as_a_flow_dies, 0, 3);
  tcase_add_test(tcase, a_still_face_in_a_flow_is_as_soft_as_the_others);
  suite_add_tcase(suite, tcase);
  tcase = tcase_create("strain");
  tcase_add_test(tcase, a_flow_that_goes_on_has_no_mismatch);
  tcase_add_test(tcase, strain_of_a_linear_flow_is_exact);
  tcase_add_test(tcase, the_norm_counts_all_of_the_tensor);
  suite_add_tcase(suite, tcase);
  return suite;
}
