/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Whole time steps. */
#include "talus/two_phase/step.h"

#include <check.h>

#include "sim.h"
#include "talus/error.h"
#include "talus/two_phase/fractions.h"
#include "transport.h"

Suite *step_suite(void);

static bool advance(struct two_phase *sim, int steps, double dt) {
  bool good = true;
  for (int k = 0; k < steps && good; k++) {
    good = step_advance(sim, dt) == EXIT_DONE;
  }
  return good;
}

static double height = 0.53; /* cuts leaves */

/* A flat bed: bit 0: coarser away from the surface, 1: open at the top, 2:
 * a wall that holds the grains at the bottom instead of one they slip on. */
START_TEST(a_flat_bed_stays_still) {
  struct params params = box_params(DIM == 2 ? 5 : 4);
  params.shape = (struct function){below, &height};
  params.tolerance_pressure = params.tolerance_viscous = 1e-12;
  if (_i & 1) params_follow_surface(&params, 2, 1);
  if (_i & 2) params.boundary[2 * DIM - 1].type = BOUNDARY_OUTFLOW;
  if (_i & 4) params.boundary[2 * DIM - 2].type = BOUNDARY_NO_SLIP;
  struct two_phase *sim = sim_start(&params);
  const double volume = integral(sim->grid.mesh, sim->c->v);
  const bool done = advance(sim, 15, 0.05);
  const double cells = largest(sim, sim->u);
  const double drift = fabs(integral(sim->grid.mesh, sim->c->v) / volume - 1);
  two_phase_destroy(sim);
  ck_assert(done);
  /* of sqrt(g H) = 0.7; the solvers stop at 1e-12 */
  ck_assert_double_le(cells, 1e-10 * sqrt(height));
  ck_assert_double_le(drift, 1e-14);
}
END_TEST

/* Return the level set of a bed of slope *context, gravity normal to it; a
 * strip of finer leaves. */
static double tilted(void *context, const double x[3]) {
  return 0.53 + *(const double *)context * (x[0] - 0.5) - x[DIM - 1];
}

static double strip(void *context, const double x[3]) {
  const int level = *(const int *)context;
  return x[0] > 0.3 && x[0] < 0.6 ? level : level - 1;
}

/* Across a jump of levels a face must not be heavier than its leaves, nor a
 * heavy leaf take part of its velocity from the gas next to it: what round-off
 * leaves then grew as exp(2.8 t) at a slope of 0.05, exp(4.8 t) at 0.5. */
START_TEST(a_tilted_bed_stays_still_across_levels) {
  double slope = _i ? 0.5 : 0.05;
  const double down = 1 / hypot(1, slope);
  struct params params = box_params(DIM == 2 ? 5 : 4);
  if (DIM == 3) params_make_narrow(&params, 2);
  params.level_min = params.level_max - 1;
  params.shape = (struct function){tilted, &slope};
  params.gas.density = 1e-4;
  params.gravity[0] = slope * down;
  params.gravity[DIM - 1] = -down;
  params.tolerance_pressure = params.tolerance_viscous = 1e-13;
  params.criterion[params.ncriteria++] =
      (struct criterion){.type = CRITERION_FUNCTION,
                         .level = params.level_max,
                         .function = {strip, &params.level_max}};
  struct two_phase *sim = sim_new(&params, MPI_COMM_WORLD);
  int status = EXIT_DONE;
  for (int k = 0; k < 120 && status == EXIT_DONE; k++) {
    status = step_advance(sim, 0.05);
  }
  const double most = largest(sim, sim->u);
  two_phase_destroy(sim);
  ck_assert_int_eq(status, EXIT_DONE);
  ck_assert_double_le(most, 1e-10); /* round-off, not what has grown */
}
END_TEST

/* Return the level set of grains in a block in the middle, [0.25, 0.75]^DIM. */
static double block(void *context, const double x[3]) {
  double outside = 0;
  (void)context;
  for (int d = 0; d < DIM; d++) outside = larger(outside, fabs(x[d] - 0.5));
  return 0.25 - outside;
}

static double block_speed(void *context, const double x[3]) {
  return block(context, x) > 0;
}

/* A block a thousand times as dense as the gas at rest around it moves on as
 * it was: its fastest leaf is at 1.002 (2D), 1.006 (3D) after three steps. With
 * face velocities that are plain means of the cells', not weighted by density,
 * it is at 1.016 and 1.013. */
START_TEST(a_dense_block_moves_on_through_light_gas) {
  struct params params = periodic_params(DIM == 2 ? 6 : 4);
  params.single_phase = false;
  params.pressure_level_given = true;
  params.shape = (struct function){block, NULL};
  params.velocity[0] = (struct function){block_speed, NULL};
  struct two_phase *sim = sim_new(&params, MPI_COMM_WORLD);
  const bool done = advance(sim, 3, 1);
  double fastest = 0;
  for (int32_t i = 0; i < sim->grid.mesh->nleaves; i++) {
    if (sim->c->v[i] > 0.5) fastest = larger(fastest, fabs(sim->u[0]->v[i]));
  }
  fastest = mesh_max(sim->grid.mesh, fastest);
  two_phase_destroy(sim);
  ck_assert(done);
  ck_assert_double_eq_tol(fastest, 1, 0.01);
}
END_TEST

/* Return the level set of a block off the lines of the grid, which moves
 * through gas at rest: a cut leaf starts with the momentum of the grains in it,
 * wherever its centre is. */
static double slanted(void *context, const double x[3]) {
  (void)context;
  double sum = 0.9;
  for (int d = 0; d < DIM; d++) sum -= (1 + 0.3 * d) * fabs(x[d] - 0.47);
  return sum - 0.6;
}
static double slanted_speed(void *context, const double x[3]) {
  return slanted(context, x) > 0;
}

START_TEST(cut_leaves_start_with_the_momentum_of_their_grains) {
  struct params params = periodic_params(DIM == 2 ? 5 : 4);
  double most = 0;
  params.single_phase = false;
  params.pressure_level_given = true;
  params.shape = (struct function){slanted, NULL};
  params.velocity[0] = (struct function){slanted_speed, NULL};
  struct two_phase *sim = sim_start(&params);
  for (int32_t i = 0; i < sim->grid.mesh->nleaves; i++) {
    const double c = sim->c->v[i], rho = params.gas.density;
    const double momentum = (rho + (1 - rho) * c) * sim->u[0]->v[i];
    most = larger(most, fabs(momentum - c));
  }
  most = mesh_max(sim->grid.mesh, most);
  two_phase_destroy(sim);
  /* a lattice of 8 points along an edge */
  ck_assert_double_le(most, 0.1);
}
END_TEST

/* A column falls, the grid follows, the solvers stop early. Bit 0: open at the
 * top, 1: steps too long for the sweeps to be taken whole at all times. */
START_TEST(a_collapse_keeps_its_volume) {
  struct params params = box_params(DIM == 2 ? 6 : 4);
  params.shape = (struct function){column, NULL};
  params.tolerance_pressure = params.tolerance_viscous = 1e-4;
  params_follow_surface(&params, 3, 2);
  if (_i & 1) params.boundary[2 * DIM - 1].type = BOUNDARY_OUTFLOW;
  if (_i & 2) params.cfl = 1;
  struct two_phase *sim = sim_start(&params);
  const double volume = integral(sim->grid.mesh, sim->c->v);
  const double cells = (double)forest_nleaves_global(sim->grid.forest);
  double drift = 0, excess = 0;
  bool done = true, adapted = false;
  for (int k = 0; k < 60 && done; k++) {
    done = step_advance(sim, 1) == EXIT_DONE;
    drift =
        larger(drift, fabs(integral(sim->grid.mesh, sim->c->v) / volume - 1));
    excess = larger(excess, vof_excess(sim->grid.mesh, sim->c->v));
    adapted =
        adapted || (double)forest_nleaves_global(sim->grid.forest) != cells;
  }
  excess = mesh_max(sim->grid.mesh, excess);
  const double speed = largest(sim, sim->u);
  two_phase_destroy(sim);
  ck_assert(done);
  ck_assert(adapted);
  ck_assert_double_gt(speed, 0.1); /* it does fall */
  ck_assert_double_le(drift, 1e-13);
  ck_assert_double_le(excess, 1e-12);
}
END_TEST

/* The flow of Taylor and Green. */
static const double kWave = 6.283185307179586;
static double taylor_green(void *context, const double x[3]) {
  const int d = *(const int *)context;
  return d == 0 ? sin(kWave * x[0]) * cos(kWave * x[1])
                : -cos(kWave * x[0]) * sin(kWave * x[1]);
}
static int kAxis[] = {0, 1};

/* Grains squeezed along one axis and pressed out along another, in a step as
 * long as cfl = 1 allows: the sweeps, taken whole as they are where rate says
 * that it is a shorter one, overfill leaves; in parts they do not. */
static double slanted_bar(void *context, const double x[3]) {
  (void)context;
  return 0.3 - fabs(x[0] - 0.47) - 1.3 * fabs(x[1] - 0.47);
}

START_TEST(sweeps_that_overfill_are_repeated_in_parts) {
  struct params params = periodic_params(3);
  params.single_phase = false;
  params.pressure_level_given = true;
  params.shape = (struct function){slanted_bar, NULL};
  for (int d = 0; d < 2; d++) {
    params.velocity[d] = (struct function){taylor_green, &kAxis[d]};
  }
  struct two_phase *sim = sim_new(&params, MPI_COMM_WORLD);
  const double before = integral(sim->grid.mesh, sim->c->v);
  double rate = 0;
  for (int32_t f = 0; f < sim->grid.mesh->nfaces; f++) {
    rate = larger(rate, fabs(sim->u_f->v[f]) / sim->grid.mesh->face_h[f]);
  }
  fields_save(&sim->grid.fields, sim->grid.mesh);
  rate = mesh_max(sim->grid.mesh, rate);
  fractions_advance(sim, 1 / rate, _i ? rate : VOF_CFL * rate);
  const double after = integral(sim->grid.mesh, sim->c->v);
  const double excess =
      mesh_max(sim->grid.mesh, vof_excess(sim->grid.mesh, sim->c->v));
  two_phase_destroy(sim);
  ck_assert_double_eq_tol(after, before, 1e-14);
  if (_i) {
    ck_assert_double_le(excess, VOF_EMPTY);
  } else {
    ck_assert_double_gt(excess, 1e-3);
  }
}
END_TEST

/* Numbers that tell one state from another, the last with all leaves in it. */
enum { NSUMS = 6 + DIM, NNUMBERS = NSUMS + 2 };
static void numbers(const struct two_phase *sim, double out[NNUMBERS]) {
  const struct mesh *mesh = sim->grid.mesh;
  double sum[NSUMS] = {0};
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    const double v = mesh_volume(mesh, i), c = sim->c->v[i];
    double u2 = 0, phase = 0;
    for (int d = 0; d < DIM; d++) {
      u2 += sim->u[d]->v[i] * sim->u[d]->v[i];
      phase += (17 + 5 * d) * mesh->x[i][d];
      sum[6 + d] += v * c * sim->u[d]->v[i];
    }
    sum[1] += 1;
    sum[2] += v * u2;
    sum[3] += v * fabs(sim->p->v[i]);
    sum[4] += v * c * cos(phase);
    sum[5] += v * sqrt(u2) * cos(phase);
  }
  for (int k = 1; k < NSUMS; k++) out[k] = mesh_sum(mesh, sum[k]);
  out[0] = sim->model.time;
  out[NSUMS] = sim->energy.dissipated;
  out[NSUMS + 1] = sim->divergence_volume;
}

/* Every rank also runs the whole case for itself. */
START_TEST(the_answer_does_not_depend_on_ranks) {
  struct params params = box_params(5);
  params.shape = (struct function){column, NULL};
  params.tolerance_pressure = params.tolerance_viscous = 1e-11;
  params.cfl = 0.4;
  params_follow_surface(&params, 2, 1);
  double out[2][NNUMBERS], most = 0;
  bool done = true;
  for (int k = 0; k < 2; k++) {
    struct two_phase *sim =
        sim_new(&params, k ? MPI_COMM_WORLD : MPI_COMM_SELF);
    done = advance(sim, DIM == 2 ? 15 : 6, 1) && done;
    numbers(sim, out[k]);
    two_phase_destroy(sim);
  }
  for (int k = 0; k < NNUMBERS; k++) {
    most = larger(most, fabs(out[1][k] - out[0][k]));
  }
  most = all_ranks(done) ? most : INFINITY;
  ck_assert(all_ranks(most <= 1e-9));
}
END_TEST

enum look { AS_IT_IS, LOOKED_AT, PLANES_ANEW, FAILED_ONCE, NLOOKS };

/* Take a step, with its repetitions, whose solves may do nothing. */
static void fail_a_step(struct two_phase *sim, struct params *params) {
  const int most = params->max_iterations;
  params->max_iterations = 0;
  ck_assert_int_eq(step_advance(sim, 1), EXIT_NUMERICAL);
  params->max_iterations = most;
}

/* Put a fall that the grid follows into numbers; returns the largest |div u_f|
 * dt that a step leaves. */
static double fall(enum look look, double out[NNUMBERS]) {
  struct params params = box_params(DIM == 2 ? 6 : 4);
  double divergence = 0;
  params.shape = (struct function){column, NULL};
  params.tolerance_pressure = params.tolerance_viscous = 1e-4;
  if (DIM == 3) params_make_narrow(&params, 1);
  params_follow_surface(&params, DIM == 2 ? 3 : 2, 2);
  struct two_phase *sim = sim_start(&params);
  for (int k = 0; k < 40 && divergence < 1; k++) {
    if (look == FAILED_ONCE && k % 8 == 7) fail_a_step(sim, &params);
    const bool done = step_advance(sim, 1) == EXIT_DONE;
    const double left =
        sim->model.dt * clean_divergence(sim->grid.mesh, sim->u_f->v);
    divergence = done ? fmax(divergence, left) : 1;
    if (look == LOOKED_AT) {
      fractions_synchronise(sim);
      fractions_desynchronise(sim);
    }
    if (look == PLANES_ANEW) sim->planes_hold = false;
  }
  numbers(sim, out);
  two_phase_destroy(sim);
  return divergence;
}

/* Not a bit: what a step keeps for the next one is what that would find. */
START_TEST(looks_planes_made_anew_and_failures_change_nothing) {
  double out[NLOOKS][NNUMBERS], divergence = 0;
  for (int k = 0; k < NLOOKS; k++) {
    divergence = larger(divergence, fall((enum look)k, out[k]));
  }
  ck_assert_double_le(divergence, 1e-13);
  for (int k = 1; k < NLOOKS; k++) {
    ck_assert_mem_eq(out[k], out[AS_IT_IS], sizeof out[k]);
  }
}
END_TEST

/* Return a viscosity that is no number the first times that it is asked for. */
static void spoiled_viscosity(void *context, double time, int32_t n,
                              const double *shear_rate, const double *pressure,
                              double *eta) {
  int *times = (int *)context;
  (void)time, (void)shear_rate, (void)pressure;
  for (int32_t i = 0; i < n; i++) eta[i] = *times > 0 ? NAN : 0.01;
  if (*times > 0) (*times)--;
}

/* Every failure divides dt by four. The step that is good in the end is that
 * which a run would have made that knew dt from the first. */
START_TEST(failed_steps_are_repeated_with_a_quarter_of_dt) {
  int times = 0;
  double out[2][NNUMBERS], dt = ldexp(0.01, -2 * _i);
  bool done = true;
  const bool trapped = base_trap_floating_point(false); /* in debug builds */
  struct params params = periodic_params(DIM == 2 ? 3 : 2); /* one block */
  rheology_init(&params.grains.rheology, rheology_find("user"));
  params.grains.rheology.user = spoiled_viscosity;
  params.grains.rheology.context = &times;
  for (int d = 0; d < 2; d++) {
    params.velocity[d] = (struct function){taylor_green, &kAxis[d]};
  }
  for (int k = 0; k < 2; k++) {
    struct two_phase *sim = sim_start(&params);
    times = k == 0 ? _i : 0;
    done = step_advance(sim, k == 0 ? 0.01 : dt) == EXIT_DONE && done;
    numbers(sim, out[k]);
    two_phase_destroy(sim);
  }
  base_trap_floating_point(trapped);
  if (_i > 3) { /* too often */
    ck_assert(!done);
    return;
  }
  ck_assert(done);
  ck_assert_double_eq(out[0][0], dt);
  ck_assert_mem_eq(out[0], out[1], sizeof out[0]);
}
END_TEST

/* Measure the error against a decay as exp(-2 nu k^2 t) and keeps its shape. */
static double decay_error(int level, double theta, double *shape) {
  struct params params = periodic_params(level);
  const double eta = 0.01, end = 0.4;
  params.grains.rheology = newtonian(eta);
  params.theta = theta;
  for (int d = 0; d < 2; d++) {
    params.velocity[d] = (struct function){taylor_green, &kAxis[d]};
  }
  struct two_phase *sim = sim_start(&params);
  const double dt = 0.4 / (1 << level);
  bool done = true;
  while (done && sim->model.time < end - 1e-12) {
    done = step_advance(sim, fmin(dt, end - sim->model.time)) == EXIT_DONE;
  }
  const double exact = exp(-2 * eta * kWave * kWave * sim->model.time);
  double energy[2] = {0};
  *shape = 0;
  for (int32_t i = 0; i < sim->grid.mesh->nleaves; i++) {
    const double x[3] = {sim->grid.mesh->x[i][0], sim->grid.mesh->x[i][1]};
    for (int d = 0; d < 2; d++) {
      const double start = taylor_green(&kAxis[d], x);
      energy[0] += start * start;
      energy[1] += sim->u[d]->v[i] * sim->u[d]->v[i];
      *shape = larger(*shape, fabs(sim->u[d]->v[i] - exact * start));
    }
  }
  *shape = mesh_max(sim->grid.mesh, *shape);
  const double ratio =
      mesh_sum(sim->grid.mesh, energy[1]) / mesh_sum(sim->grid.mesh, energy[0]);
  two_phase_destroy(sim);
  if (!done) return INFINITY;
  return fabs(ratio / (exact * exact) - 1);
}

START_TEST(a_taylor_green_flow_decays_as_it_should) {
  const int level = DIM == 2 ? 5 : 4;
  double shape[2];
  const double error = decay_error(level, _i ? 0.5 : 1, &shape[0]);
  const double coarse = decay_error(level - 1, _i ? 0.5 : 1, &shape[1]);
  /* measured: 0.8 % (backward Euler), 1.1 % (Crank-Nicolson) at 32 leaves a
   * wave, 7 % at 16 */
  ck_assert_double_le(error, DIM == 2 ? 0.02 : 0.1);
  ck_assert_double_le(shape[0], DIM == 2 ? 0.01 : 0.05);
  ck_assert_double_ge(log2(coarse / error), 1.8);
}
END_TEST

/* Return the velocity of a shear wave that a mean flow carries across itself.
 */
static double shear_wave(void *context, const double x[3]) {
  return *(const int *)context == 0 ? sin(kWave * x[1]) : 1;
}

/* Return the largest error of it at t = 1/4, by dt = 0.4 h, from
 * sin(k (y - t)) exp(-nu k^2 t). */
static double shear_wave_error(int level) {
  struct params params = periodic_params(level);
  const double eta = 0.05, end = 0.25;
  const int steps = 5 << (level - 3);
  params.theta = 0.5;
  params.cfl = 1;
  params.grains.rheology = newtonian(eta);
  for (int d = 0; d < 2; d++) {
    params.velocity[d] = (struct function){shear_wave, &kAxis[d]};
  }
  struct two_phase *sim = sim_new(&params, MPI_COMM_WORLD);
  const bool done = advance(sim, steps, end / steps);
  const double part = exp(-eta * kWave * kWave * sim->model.time);
  double most = 0;
  for (int32_t i = 0; i < sim->grid.mesh->nleaves; i++) {
    const double y = sim->grid.mesh->x[i][1] - sim->model.time;
    most = larger(most, fabs(sim->u[0]->v[i] - part * sin(kWave * y)));
  }
  most = mesh_max(sim->grid.mesh, most);
  two_phase_destroy(sim);
  return done ? most : INFINITY;
}

/* Without viscosity in the predictor the wave would be carried too fast, by as
 * much as it decays in half a step, an error of first order. */
START_TEST(crank_nicolson_is_of_second_order_with_a_mean_flow) {
  const int level = DIM == 2 ? 5 : 4;
  const double coarse = shear_wave_error(level - 1);
  const double fine = shear_wave_error(level);
  ck_assert_double_ge(log2(coarse / fine), 1.8);
}
END_TEST

/* Without advection of momentum a shear wave stays where it is, though a dense
 * square in it moves with the mean flow; with it, the wave rides on. */
START_TEST(a_wave_stays_where_advection_is_off) {
  struct params params = periodic_params(DIM == 2 ? 5 : 4);
  struct body body = {{0.5, 0.3125, 0.5}, 0.1875}; /* uncut */
  params.single_phase = false;
  params.shape = (struct function){cube, &body};
  params.grains.rheology = params.gas.rheology = newtonian(1e-14);
  params.advection = _i ? ADVECTION_OFF : ADVECTION_ON;
  for (int d = 0; d < 2; d++) {
    params.velocity[d] = (struct function){shear_wave, &kAxis[d]};
  }
  struct two_phase *sim = sim_start(&params);
  const struct mesh *mesh = sim->grid.mesh;
  const bool done = advance(sim, 16, 0.005);
  double most = 0, volume = 0, place = 0;
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    const double wave = sin(kWave * mesh->x[i][1]);
    most = larger(most, fabs(sim->u[0]->v[i] - wave));
    volume += sim->c->v[i] * mesh_volume(mesh, i);
    place += sim->c->v[i] * mesh_volume(mesh, i) * mesh->x[i][1];
  }
  most = mesh_max(mesh, most);
  place = mesh_sum(mesh, place) / mesh_sum(mesh, volume);
  two_phase_destroy(sim);
  ck_assert(done);
  if (_i) {
    ck_assert_double_le(most, 1e-8);
  } else {
    ck_assert_double_ge(most, 0.4); /* 2 sin(pi 0.08) = 0.5 */
  }
  /* c is half a step behind, and VOF moves a mean within a tenth of a leaf */
  ck_assert_double_eq_tol(place, 0.3125 + 0.0775, 0.003);
}
END_TEST

/* Return the velocity of a periodic box of one fluid with a mean flow, uneven
 * and viscous. */
static double uneven(void *context, const double x[3]) {
  const int d = *(const int *)context;
  return 0.5 + taylor_green(context, x) + 0.3 * sin(kWave * (x[1 - d] + 0.1));
}

START_TEST(momentum_is_conserved_in_a_periodic_box) {
  struct params params = periodic_params(DIM == 2 ? 5 : 4);
  for (int d = 0; d < 2; d++) {
    params.velocity[d] = (struct function){uneven, &kAxis[d]};
  }
  struct two_phase *sim = sim_start(&params);
  double before[DIM], most = 0;
  for (int d = 0; d < DIM; d++) before[d] = sim_momentum(sim, d);
  const bool done = advance(sim, 10, 1);
  for (int d = 0; d < DIM; d++) {
    most = larger(most, fabs(sim_momentum(sim, d) - before[d]));
  }
  const double tolerance = params.tolerance_viscous;
  two_phase_destroy(sim);
  ck_assert(done);
  /* all but the residual of the viscous solve, at most this per step */
  ck_assert_double_le(most, 10 * 1.5 * tolerance);
}
END_TEST

/* Crank-Nicolson sees viscosity in its predictor too, as the last step's solve
 * has left it: in a fluid far too stiff for a term made from u^n itself (which
 * grows where eta dt / (rho h^2) > 7) the uneven flow dies out. */
START_TEST(a_stiff_fluid_comes_to_rest_in_its_mean_flow) {
  struct params params = periodic_params(DIM == 2 ? 5 : 4);
  params.theta = 0.5;
  params.grains.rheology = newtonian(4e3);
  for (int d = 0; d < 2; d++) {
    params.velocity[d] = (struct function){uneven, &kAxis[d]};
  }
  struct two_phase *sim = sim_start(&params);
  const double start = largest(sim, sim->u);
  double most = 0;
  bool done = true;
  for (int k = 0; k < 60 && done; k++) {
    done = advance(sim, 1, 1);
    most = larger(most, largest(sim, sim->u));
  }
  two_phase_destroy(sim);
  ck_assert(done);
  ck_assert_double_le(most, start);
}
END_TEST

/* Return the velocity of a dense square and of the gas around it, without
 * forces: nothing is to change but its place, whatever the ratio of the
 * densities. */
static double drift(void *context, const double x[3]) {
  (void)x;
  return *(const int *)context == 0 ? 1 : 0.5;
}

START_TEST(a_dense_square_drifts_with_its_gas) {
  struct params params = periodic_params(DIM == 2 ? 5 : 4);
  struct body body = {{0.5, 0.5, 0.5}, 0.22};
  const double ratio[] = {1e3, 1e6};
  params.single_phase = false;
  params.shape = (struct function){cube, &body};
  params.gas.density = 1 / ratio[_i];
  for (int d = 0; d < 2; d++) {
    params.velocity[d] = (struct function){drift, &kAxis[d]};
  }
  struct two_phase *sim = sim_start(&params);
  const bool done = advance(sim, 20, 1);
  double most = 0;
  for (int d = 0; d < DIM; d++) {
    const double exact = d == 0 ? 1 : d == 1 ? 0.5 : 0;
    for (int32_t i = 0; i < sim->grid.mesh->nleaves; i++) {
      most = larger(most, fabs(sim->u[d]->v[i] - exact));
    }
  }
  most = mesh_max(sim->grid.mesh, most);
  two_phase_destroy(sim);
  ck_assert(done);
  ck_assert_double_le(most, 1e-10);
}
END_TEST

/* A drop of grains falls through gas a thousand times lighter: speed g t, and
 * the gas that makes way moves no faster than the grains. */
START_TEST(a_drop_falls_freely) {
  struct params params = box_params(DIM == 2 ? 6 : 5);
  struct body body = {{0.5, 0.5, 0.5}, 0.15};
  body.centre[DIM - 1] = 0.7;
  params.shape = (struct function){ball, &body};
  params.gas.rheology = newtonian(1e-6);
  params_follow_surface(&params, 3, 2);
  struct two_phase *sim = sim_start(&params);
  const double mass = integral(sim->grid.mesh, sim->c->v);
  bool done = true;
  double speed = 0, fall = 0;
  while (done && sim->model.time < 0.5 - 1e-12) {
    done = step_advance(sim, 0.5 - sim->model.time) == EXIT_DONE;
  }
  for (int32_t i = 0; i < sim->grid.mesh->nleaves; i++) {
    const double part = sim->c->v[i] * mesh_volume(sim->grid.mesh, i) / mass;
    speed -= part * sim->u[DIM - 1]->v[i];
    fall += part * (body.centre[DIM - 1] - sim->grid.mesh->x[i][DIM - 1]);
  }
  speed = mesh_sum(sim->grid.mesh, speed);
  fall = mesh_sum(sim->grid.mesh, fall);
  const double most = largest(sim, sim->u), time = sim->model.time;
  const double exact =
      0.5 * pow(time - 0.5 * sim->model.dt, 2); /* c lives there */
  two_phase_destroy(sim);
  ck_assert(done);
  /* buoyancy and added mass take 0.3 %, the grid 0.2 % in two dimensions and
   * 1.4 % in three, where the drop is ten leaves wide */
  ck_assert_double_le(fabs(speed / time - 1), DIM == 2 ? 0.01 : 0.03);
  ck_assert_double_le(fabs(fall / exact - 1), DIM == 2 ? 0.01 : 0.03);
  ck_assert_double_le(most, 1.2 * time);
}
END_TEST

/* A closed box says nothing of the pressure but its gradient: the case gives
 * the mean. */
START_TEST(the_mean_pressure_is_that_of_the_case) {
  struct params params = box_params(4);
  params.shape = (struct function){below, &height};
  params.pressure_level_given = true;
  params.pressure_level = 3.5;
  struct two_phase *sim = sim_start(&params);
  const double start = integral(sim->grid.mesh, sim->p->v);
  const bool done = advance(sim, 3, 0.01);
  const double end = integral(sim->grid.mesh, sim->p->v);
  two_phase_destroy(sim);
  ck_assert(done);
  ck_assert_double_eq_tol(start, 3.5, 1e-12);
  ck_assert_double_eq_tol(end, 3.5, 1e-12);
}
END_TEST

static double one(void *context, const double x[3]) {
  (void)context, (void)x;
  return 1;
}

/* At the start and after a step. */
START_TEST(viscosity_of_leaves_is_that_of_the_fluid) {
  struct params params = periodic_params(DIM == 2 ? 4 : 3);
  double most = 0;
  params.grains.rheology = newtonian(0.03);
  struct two_phase *sim = sim_start(&params);
  for (int k = 0; k < 2; k++) {
    for (int32_t i = 0; i < sim->grid.mesh->nleaves; i++) {
      most = larger(most, fabs(sim->eta->v[i] - 0.03));
      sim->eta->v[i] = 0;
    }
    if (k == 0) most = larger(most, advance(sim, 1, 0.1) ? 0 : INFINITY);
  }
  most = mesh_max(sim->grid.mesh, most);
  two_phase_destroy(sim);
  ck_assert_double_le(most, 1e-16);
}
END_TEST

/* A channel filled from the left: what is inside is fraction U t, but for the
 * half step by which c lags; nothing else comes in. */
START_TEST(an_inflow_brings_its_fraction) {
  struct params params = box_params(4);
  double empty = -1;
  params.gravity[DIM - 1] = 0;
  params.grains.density = params.gas.density = 1;
  params.shape = (struct function){below, &empty};
  params.velocity[0] = (struct function){one, NULL};
  params.boundary[0] = (struct boundary){
      .type = BOUNDARY_INFLOW, .velocity = {1, 0, 0}, .fraction = 0.3};
  params.boundary[1] = (struct boundary){.type = BOUNDARY_OUTFLOW};
  struct two_phase *sim = sim_new(&params, MPI_COMM_WORLD);
  const bool done = advance(sim, 6, 0.01);
  const double carried = 0.3 * (sim->model.time - 0.5 * sim->model.dt);
  const double volume = integral(sim->grid.mesh, sim->c->v);
  two_phase_destroy(sim);
  ck_assert(done);
  ck_assert_double_eq_tol(volume, carried, 1e-12);
}
END_TEST

/* A lid starts to drag a fluid at rest: the speed of the lid, not that of the
 * fluid, sets the first step and the tolerance of its solve. */
START_TEST(a_moving_wall_is_felt_from_rest) {
  struct params params = box_params(5);
  params.single_phase = true;
  params.gravity[DIM - 1] = 0;
  params.pressure_level_given = true;
  params.tolerance_viscous = 1e-4;
  params.boundary[2 * DIM - 1] =
      (struct boundary){.type = BOUNDARY_NO_SLIP, .velocity = {2, 0, 0}};
  struct two_phase *sim = sim_start(&params);
  const bool done = advance(sim, 1, 1);
  const double dt = sim->model.dt;
  const int iterations = sim->viscous.iterations;
  two_phase_destroy(sim);
  ck_assert(done);
  ck_assert_double_le(dt, 0.5 / 32 / 2 + 1e-15); /* cfl h / U */
  ck_assert_int_le(iterations, 5);
}
END_TEST

/* Grains that touch an opening move away from it: what follows is gas, as
 * below the outlet of a silo. */
START_TEST(an_opening_lets_no_grains_in) {
  struct params params = box_params(4);
  params.gravity[DIM - 1] = 0;
  params.shape = (struct function){column, NULL};
  params.velocity[DIM - 1] = (struct function){one, NULL};
  params.boundary[2 * DIM - 2] = params.boundary[2 * DIM - 1] =
      (struct boundary){.type = BOUNDARY_OUTFLOW};
  struct two_phase *sim = sim_new(&params, MPI_COMM_WORLD);
  const double before = integral(sim->grid.mesh, sim->c->v);
  const bool done = advance(sim, 10, 0.02);
  const double after = integral(sim->grid.mesh, sim->c->v);
  const double speed = largest(sim, sim->u);
  two_phase_destroy(sim);
  ck_assert(done);
  ck_assert_double_gt(speed, 0.5); /* it has moved */
  ck_assert_double_eq_tol(after / before, 1, 1e-12);
}
END_TEST

static struct rheology mu_i(double eta_max) {
  struct rheology r;
  rheology_init(&r, rheology_find("mu_i"));
  rheology_set(&r, "mu_s", 0.32);
  rheology_set(&r, "delta_mu", 0.28);
  rheology_set(&r, "I0", 0.4);
  rheology_set(&r, "d", 0.02);
  rheology_set(&r, "rho", 1);
  rheology_set(&r, "eta_min", 1e-3);
  rheology_set(&r, "eta_max", eta_max);
  return r;
}

/* Return the level set of a heap; its surface crosses the grid, so that some
 * leaves are nearly empty. */
static double gentle_heap(void *context, const double x[3]) {
  (void)context;
  return 0.6 - 0.25 * x[0] - x[DIM - 1];
}

/* Less steep than friction holds, a heap stays, up to its last grain. With
 * half of such a line from the centre of a cut leaf in the gas it crept at
 * 0.012 (2D), 0.022 (3D); now at 4e-4 and 1.4e-3. */
START_TEST(a_heap_less_steep_than_friction_rests) {
  struct params params = box_params(DIM == 2 ? 5 : 4);
  params.grains.rheology = mu_i(100);
  params.shape = (struct function){gentle_heap, NULL};
  params.boundary[2 * DIM - 2].type = BOUNDARY_NO_SLIP;
  params.boundary[2 * DIM - 1].type = BOUNDARY_OUTFLOW;
  params.tolerance_pressure = params.tolerance_viscous = 1e-6;
  struct two_phase *sim = sim_start(&params);
  bool done = true;
  double fastest = 0;
  while (done && sim->model.time < 1)
    done = step_advance(sim, 0.02) == EXIT_DONE;
  for (int32_t i = 0; i < sim->grid.mesh->nleaves; i++) {
    for (int d = 0; d < DIM && sim->c->v[i] > 0.5; d++) {
      fastest = larger(fastest, fabs(sim->u[d]->v[i]));
    }
  }
  fastest = mesh_max(sim->grid.mesh, fastest);
  two_phase_destroy(sim);
  ck_assert(done);
  ck_assert_double_le(fastest, 2e-3); /* of sqrt(g H) */
}
END_TEST

/* Repetitions of viscosity and projection in a step: each changes the velocity
 * by less than the one before, and all iterations of both solves count. */
START_TEST(repetitions_close_in_on_a_velocity) {
  struct params params = box_params(5);
  double change[3];
  int iterations[3], pressure[3];
  bool done = true;
  params.grains.rheology = mu_i(10);
  params.shape = (struct function){column, NULL};
  if (DIM == 3) params_make_narrow(&params, 2);
  for (int k = 0; k < 3; k++) {
    params.picard = 1 << k;
    struct two_phase *sim = sim_start(&params);
    done = advance(sim, 5, 0.01) && done;
    change[k] = sim->repeat_change;
    iterations[k] = sim->viscous.iterations;
    pressure[k] = sim->pressure.iterations;
    two_phase_destroy(sim);
  }
  ck_assert(done);
  ck_assert_double_gt(change[2], 0);
  ck_assert_double_lt(change[1], 0.8 * change[0]);
  ck_assert_double_lt(change[2], 0.8 * change[1]);
  for (int k = 0; k < 2; k++) {
    ck_assert_int_gt(iterations[k + 1], iterations[k]);
    ck_assert_int_gt(pressure[k + 1], pressure[k]);
  }
}
END_TEST

/* Return a speed of a column that begins with one. */
static double downward(void *context, const double x[3]) {
  (void)context, (void)x;
  return -0.01;
}

/* Return how much the grains of two runs differ in velocity, over that of the
 * first, in the mean of the squares. */
static double relative_change(struct two_phase *const sim[2]) {
  const struct mesh *mesh = sim[0]->grid.mesh;
  double sum[2] = {0};
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    const double grains = sim[0]->c->v[i] * mesh_volume(mesh, i);
    for (int d = 0; d < DIM; d++) {
      const double u = sim[0]->u[d]->v[i];
      sum[0] += grains * pow(sim[1]->u[d]->v[i] - u, 2);
      sum[1] += grains * u * u;
    }
  }
  return sqrt(mesh_sum(mesh, sum[0]) / mesh_sum(mesh, sum[1]));
}

/* Grains set free yield under the pressure of grains that yield, which a run
 * begins without. Four repetitions of its first step more change its speed by
 * 0.007 (clipped at 10), 0.014 (exact; 0.005 in 3D), and by 0.65, 0.07 (0.04)
 * where there are none before. Bit 0: exact, 1: it has a speed at first, and is
 * not repeated. */
START_TEST(a_first_step_from_rest_is_repeated) {
  struct params params = box_params(5);
  params.grains.rheology = mu_i(10);
  if (_i & 1) rheology_set_regularisation(&params.grains.rheology, "exact");
  if (_i & 2) params.velocity[DIM - 1] = (struct function){downward, NULL};
  params.shape = (struct function){column, NULL};
  if (DIM == 3) params_make_narrow(&params, 2);
  double change[2];
  bool done = true;
  struct two_phase *sim[2];
  for (int k = 0; k < 2; k++) {
    params.picard = 12 * k;
    sim[k] = sim_start(&params);
    done = advance(sim[k], 1, 0.01) && done;
    change[k] = sim[k]->repeat_change;
  }
  const double part = relative_change(sim);
  for (int k = 0; k < 2; k++) two_phase_destroy(sim[k]);
  ck_assert(done);
  ck_assert_double_gt(change[1], 0);
  if (_i & 2) {
    ck_assert_double_eq(change[0], 0);
  } else {
    ck_assert_double_le(part, 0.02);
  }
}
END_TEST

/* With a viscosity that does not change, a repetition mends what the viscous
 * solve has not seen of the new pressure gradient. In the grains of a moving
 * column that is what the interface has changed of their density: by how much
 * of their mean speed it moves them, in the mean of the squares, in steps all
 * alike: 2.1e-3 (2D), 1.8e-3 (3D, narrow), and 6.2e-3 and 3.5e-3 where g has
 * that of the last step. */
START_TEST(the_viscous_solve_sees_the_density_of_its_step) {
  struct params params = box_params(DIM == 2 ? 6 : 5);
  bool done = true;
  params.dt_max = 0.015;
  params.grains.rheology = newtonian(0.1);
  params.shape = (struct function){column, NULL};
  if (DIM == 3) params_make_narrow(&params, 3);
  struct two_phase *sim[2];
  for (int k = 0; k < 2; k++) {
    params.picard = 0;
    sim[k] = sim_start(&params);
    done = advance(sim[k], 30, 1) && done;
    params.picard = k;
    done = advance(sim[k], 1, 1) && done;
  }
  const double part = relative_change(sim);
  for (int k = 0; k < 2; k++) two_phase_destroy(sim[k]);
  ck_assert(done);
  ck_assert_double_le(part, 2.6e-3);
}
END_TEST

/* One iteration is not enough for a column that falls; it is then where it
 * was. */
START_TEST(a_solve_that_fails_is_told) {
  struct params params = box_params(5);
  params.shape = (struct function){column, NULL};
  params.tolerance_pressure = 1e-14;
  params.max_iterations = 1;
  struct two_phase *sim = sim_start(&params);
  const double start = 0.01;
  double moved = 0;
  for (int32_t i = 0; i < sim->grid.mesh->nleaves; i++) {
    for (int d = 0; d < DIM; d++) sim->u[d]->v[i] = start * i;
  }
  const int status = step_advance(sim, 0.01);
  const enum solve_status solve = sim->pressure.status;
  for (int32_t i = 0; i < sim->grid.mesh->nleaves; i++) {
    for (int d = 0; d < DIM; d++) {
      moved = larger(moved, fabs(sim->u[d]->v[i] - start * i));
    }
  }
  moved = mesh_max(sim->grid.mesh, moved);
  two_phase_destroy(sim);
  ck_assert_double_eq(moved, 0);
  ck_assert_int_eq(solve, SOLVE_STALLED);
  ck_assert_int_eq(status, EXIT_NUMERICAL);
}
END_TEST

Suite *step_suite(void) {
  Suite *suite = suite_create("step");
  TCase *tc = tcase_create("step"), *alone = tcase_create("many steps");
  tcase_set_tags(alone, "one_rank");
  tcase_add_loop_test(alone, a_flat_bed_stays_still, 0, 7);
  tcase_add_loop_test(tc, a_flat_bed_stays_still, 7, 8);
  tcase_add_loop_test(alone, a_tilted_bed_stays_still_across_levels, 0, 2);
  tcase_add_test(tc, a_dense_block_moves_on_through_light_gas);
  tcase_add_test(tc, cut_leaves_start_with_the_momentum_of_their_grains);
  tcase_add_loop_test(alone, a_collapse_keeps_its_volume, 0, 3);
  tcase_add_loop_test(tc, a_collapse_keeps_its_volume, 3, 4);
  tcase_add_loop_test(tc, sweeps_that_overfill_are_repeated_in_parts, 0, 2);
  tcase_add_test(tc, the_answer_does_not_depend_on_ranks);
  tcase_add_test(alone, looks_planes_made_anew_and_failures_change_nothing);
  tcase_add_loop_test(tc, failed_steps_are_repeated_with_a_quarter_of_dt, 0, 5);
  tcase_add_loop_test(tc, a_taylor_green_flow_decays_as_it_should, 0, 2);
  tcase_add_test(tc, crank_nicolson_is_of_second_order_with_a_mean_flow);
  tcase_add_loop_test(tc, a_wave_stays_where_advection_is_off, 0, 2);
  tcase_add_test(tc, momentum_is_conserved_in_a_periodic_box);
  tcase_add_test(alone, a_stiff_fluid_comes_to_rest_in_its_mean_flow);
  tcase_add_loop_test(tc, a_dense_square_drifts_with_its_gas, 0, 2);
  tcase_add_test(tc, a_drop_falls_freely);
  tcase_add_test(tc, the_mean_pressure_is_that_of_the_case);
  tcase_add_test(tc, viscosity_of_leaves_is_that_of_the_fluid);
  tcase_add_test(tc, an_inflow_brings_its_fraction);
  tcase_add_test(tc, a_moving_wall_is_felt_from_rest);
  tcase_add_test(tc, an_opening_lets_no_grains_in);
  tcase_add_test(alone, a_heap_less_steep_than_friction_rests);
  tcase_add_test(alone, repetitions_close_in_on_a_velocity);
  tcase_add_loop_test(alone, a_first_step_from_rest_is_repeated, 0, 1);
  tcase_add_loop_test(tc, a_first_step_from_rest_is_repeated, 1, 2);
  tcase_add_loop_test(alone, a_first_step_from_rest_is_repeated, 2, 4);
  tcase_add_test(tc, the_viscous_solve_sees_the_density_of_its_step);
  tcase_add_test(tc, a_solve_that_fails_is_told);
  tcase_set_timeout(tc, 60);
  suite_add_tcase(suite, tc);
  suite_add_tcase(suite, alone);
  return suite;
}
