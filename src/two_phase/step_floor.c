/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/two_phase/step_floor.h"

#include <float.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>

#include "talus/error.h"
#include "talus/log.h"
#include "talus/minmax.h"
#include "talus/params.h"
#include "talus/two_phase/state.h"
#include "talus/two_phase/time_step.h"

static const double SHORT = 1e-9; /* of the times of the case */
/* A step that is longer by this factor than the last one recovers. */
static const double GROWS = 1.1;

static double speed_of_case(const struct two_phase *sim) {
  const struct mesh *mesh = sim->grid.mesh;
  const struct function *u = sim->params->velocity;
  double fastest = time_step_boundary_speed(sim, false);
  for (int d = 0; d < DIM; d++) {
    for (int32_t i = 0; i < mesh->nleaves && u[d].eval != NULL; i++) {
      double x[3] = {0};
      for (int e = 0; e < DIM; e++) x[e] = mesh->x[i][e];
      fastest = max2(fastest, fabs(u[d].eval(u[d].context, x)));
    }
  }
  return mesh_max(mesh, fastest);
}

double step_floor(const struct two_phase *sim) {
  const struct params *params = sim->params;
  const double speed = speed_of_case(sim);
  const double g = params_gravity(params);
  double time = params->stop;
  if (g > 0) time = min2(time, sqrt(params->size / g));
  if (speed > 0) time = min2(time, params->size / speed);
  return max2(SHORT * time, 0.5 * DBL_EPSILON * params->stop);
}

/* The leaf that binds dt most, over all ranks. */
struct worst {
  double rate; /* 1/s: how much of it passes in a second */
  double x[3], h, value;
};

/* Take the one of the rank whose rate is largest. */
static void share_worst(const struct mesh *mesh, struct worst *worst) {
  struct {
    double rate;
    int rank;
  } most = {worst->rate, mesh->rank};
  MPI_CHECK(MPI_Allreduce(MPI_IN_PLACE, &most, 1, MPI_DOUBLE_INT, MPI_MAXLOC,
                          mesh->comm));
  MPI_CHECK(MPI_Bcast(worst, sizeof *worst / sizeof(double), MPI_DOUBLE,
                      most.rank, mesh->comm));
}

static void take_worst(const struct mesh *mesh, int32_t i, double rate,
                       double value, struct worst *worst) {
  if (!(rate > worst->rate)) return;
  worst->rate = rate, worst->value = value, worst->h = mesh->h[i];
  for (int d = 0; d < DIM; d++) worst->x[d] = mesh->x[i][d];
}

/* Find the leaves behind the bounds of time_step.h: the fastest, and the grains
 * with the largest acceleration. */
static void find_worst(const struct two_phase *sim, struct worst *flow,
                       struct worst *forces) {
  const struct mesh *mesh = sim->grid.mesh;
  const double *u_f = sim->u_f->v;
  *flow = *forces = (struct worst){.rate = 0};
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    double fastest = 0, g2 = 0;
    const double start = time_step_of_start(sim, i);
    for (int f = 0; f < NFACE; f++) {
      fastest = max2(fastest, fabs(u_f[mesh->cell_face[i][f]]));
    }
    for (int d = 0; d < DIM; d++) g2 += sim->g[d]->v[i] * sim->g[d]->v[i];
    take_worst(mesh, i, mesh_turnover(mesh, u_f, i), fastest, flow);
    if (start < HUGE_VAL) take_worst(mesh, i, 1 / start, sqrt(g2), forces);
  }
  share_worst(mesh, flow);
  share_worst(mesh, forces);
}

static void place_text(const struct worst *worst, size_t size, char *text) {
  if (DIM == 2)
    snprintf(text, size, "in the cell of %.3g at (%.5g, %.5g)", worst->h,
             worst->x[0], worst->x[1]);
  else
    snprintf(text, size, "in the cell of %.3g at (%.5g, %.5g, %.5g)", worst->h,
             worst->x[0], worst->x[1], worst->x[2]);
}

/* Name the cause of dt, the bound that comes nearest: the state is that after
 * the step, which has bounds of its own. */
static void cause_text(const struct two_phase *sim, const struct worst *flow,
                       const struct worst *forces, size_t size, char *text) {
  const double dt = sim->model.dt;
  const double by_flow = log(max2(flow->rate * dt / sim->params->cfl, DBL_MIN));
  const double by_forces = log(max2(forces->rate * dt, DBL_MIN));
  char place[160];
  place_text(forces, sizeof place, place);
  if (by_flow < -2 && by_forces < -2)
    snprintf(text, size,
             "it was repeated ever shorter, as a solve failed (run.log says "
             "which)");
  else if (fabs(by_flow) <= fabs(by_forces))
    snprintf(text, size, "what binds it is the advection (solver.cfl)");
  else
    snprintf(text, size,
             "what binds it are the forces on grains that set off, whose "
             "acceleration is %.3g %s",
             forces->value, place);
}

static void explain(const struct two_phase *sim, double floor) {
  struct worst flow, forces;
  char place[160], cause[320], line[1024];
  find_worst(sim, &flow, &forces);
  if (base_rank() != 0) return;
  place_text(&flow, sizeof place, place);
  cause_text(sim, &flow, &forces, sizeof cause, cause);
  snprintf(line, sizeof line,
           "the run gave up after step %" PRId64
           ", time %.6g: its dt = %.3g is below %.3g, with which it would "
           "never end; %s; the largest speed is %.3g %s. Are the speeds and "
           "forces of the case what they should be?",
           sim->model.step, sim->model.time, sim->model.dt, floor, cause,
           flow.value, place);
  fprintf(stderr, "talus: error: %s\n", line);
  log_info("error: %s", line);
}

bool step_is_too_short(const struct two_phase *sim, double floor,
                       const struct step_taken *taken) {
  const double dt = sim->model.dt,
               most = min2(taken->dt_max, sim->params->dt_max);
  const bool stands = sim->model.time == taken->time;
  const bool bound_by_flow = dt < most * (1 - 1e-9);
  const bool grows = taken->last_dt > 0 && dt >= GROWS * taken->last_dt;
  if (!stands && !(dt < floor && bound_by_flow && !grows)) return false;
  explain(sim, stands ? max2(floor, DBL_EPSILON * sim->model.time) : floor);
  return true;
}
