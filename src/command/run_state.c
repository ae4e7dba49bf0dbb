/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/run_state.h"
#include "talus/two_phase/start.h"

#include <float.h>
#include <inttypes.h>
#include <limits.h>
#include <math.h>
#include <mpi.h>
#include <string.h>

#include "talus/checkpoint.h"
#include "talus/error.h"
#include "talus/forest.h"
#include "talus/openings.h"
#include "talus/params.h"
#include "talus/two_phase/state.h"

enum { MAX_SCALARS = 48, NSOLVES = 3 };

/* More steps than a run can make. */
static const double MOST_STEPS = 1e15;

/* Iterations and verdicts of the solves, as the file wants them. */
struct verdicts {
  int64_t iterations[NSOLVES], status[NSOLVES];
};

/* All that the model remembers between steps besides its fields. */
static int list_scalars(struct two_phase *sim, struct run_state *state,
                        struct verdicts *verdicts,
                        struct checkpoint_scalar list[MAX_SCALARS]) {
  struct energy *energy = &sim->energy;
  struct conditions *conditions = &sim->conditions;
  struct solve_stats *p = &sim->pressure, *q = &sim->predictor,
                     *v = &sim->viscous;
  const double any = DBL_MAX, most = INFINITY; /* of a failed solve */
  const struct checkpoint_scalar all[] = {
      {"time", &sim->time, NULL, 0, any},
      {"dt", &sim->dt, NULL, 0, any},
      {"step", NULL, &sim->step, 0, MOST_STEPS},
      {"travel", &sim->travel, NULL, 0, any},
      {"slow_time", &sim->slow_time, NULL, 0, any},
      {"kinetic", &energy->kinetic, NULL, 0, any},
      {"potential", &energy->potential, NULL, -any, any},
      {"dissipated", &energy->dissipated, NULL, -any, any},
      {"initial_energy", &energy->initial, NULL, -any, any},
      {"changed_energy", &energy->changed, NULL, -any, any},
      {"gas_energy", &energy->gas, NULL, -any, any},
      {"gas_dissipated", &energy->gas_dissipated, NULL, -any, any},
      {"conditions_gas", &conditions->gas, NULL, -any, any},
      {"conditions_energy", &conditions->energy, NULL, -any, any},
      {"conditions_force", &conditions->force, NULL, 0, any},
      {"conditions_inflow", &conditions->inflow, NULL, 0, any},
      {"divergence_volume", &sim->divergence_volume, NULL, -any, any},
      {"percolated_volume", &sim->percolation.volume, NULL, 0, any},
      {"percolated_flow", &sim->percolation.flow, NULL, 0, any},
      {"pockets", NULL, &sim->percolation.pockets, 0, MOST_STEPS},
      {"repeat_change", &sim->repeat_change, NULL, 0, most},
      {"wall_seconds", &state->wall_seconds, NULL, 0, any},
      {"snapshots", NULL, &state->snapshots, 0, INT_MAX},
      {"series_rows", NULL, &state->series.rows, 0, MOST_STEPS},
      {"series_checksum", NULL, &state->series.checksum, 0, UINT32_MAX},
      {"profile_rows", NULL, &state->profile.rows, 0, MOST_STEPS},
      {"profile_checksum", NULL, &state->profile.checksum, 0, UINT32_MAX},
      {"pressure_iterations", NULL, &verdicts->iterations[0], 0, INT_MAX},
      {"predictor_iterations", NULL, &verdicts->iterations[1], 0, INT_MAX},
      {"viscous_iterations", NULL, &verdicts->iterations[2], 0, INT_MAX},
      {"pressure_status", NULL, &verdicts->status[0], 0, SOLVE_INCOMPATIBLE},
      {"predictor_status", NULL, &verdicts->status[1], 0, SOLVE_INCOMPATIBLE},
      {"viscous_status", NULL, &verdicts->status[2], 0, SOLVE_INCOMPATIBLE},
      {"pressure_residual_before", &p->residual_before, NULL, 0, most},
      {"pressure_residual_after", &p->residual_after, NULL, 0, most},
      {"predictor_residual_before", &q->residual_before, NULL, 0, most},
      {"predictor_residual_after", &q->residual_after, NULL, 0, most},
      {"viscous_residual_before", &v->residual_before, NULL, 0, most},
      {"viscous_residual_after", &v->residual_after, NULL, 0, most}};
  _Static_assert(sizeof all <= MAX_SCALARS * sizeof all[0], "MAX_SCALARS");
  memcpy(list, all, sizeof all);
  return (int)(sizeof all / sizeof all[0]);
}

static void list_solves(struct two_phase *sim,
                        struct solve_stats *solve[NSOLVES]) {
  solve[0] = &sim->pressure;
  solve[1] = &sim->predictor;
  solve[2] = &sim->viscous;
}

/* A residual of a solve that failed may be no number; a checkpoint holds none
 * that it would refuse. */
static void make_writable(struct solve_stats *solve) {
  if (isnan(solve->residual_before)) solve->residual_before = INFINITY;
  if (isnan(solve->residual_after)) solve->residual_after = INFINITY;
}

void run_state_write(const char *path, struct two_phase *sim,
                     struct run_state *state, const char *parameters) {
  struct solve_stats *solve[NSOLVES];
  struct verdicts verdicts;
  list_solves(sim, solve);
  for (int k = 0; k < NSOLVES; k++) {
    verdicts.iterations[k] = solve[k]->iterations;
    verdicts.status[k] = solve[k]->status;
    make_writable(solve[k]);
  }
  if (isnan(sim->repeat_change)) sim->repeat_change = INFINITY;
  conditions_measure(sim, &sim->conditions);
  struct checkpoint_scalar list[MAX_SCALARS];
  int n = list_scalars(sim, state, &verdicts, list);
  checkpoint_write(path, sim->grid.mesh, &sim->grid.fields, n, list,
                   parameters);
}

/* Each step, and the start, writes one snapshot at most. */
static void check_snapshots(const char *path, int64_t snapshots, int64_t step) {
  if (snapshots <= step + 1) return;
  USER_ERROR("'%s' is damaged or was edited: snapshots = %" PRId64
             ", after step %" PRId64 " a number from 0 to %" PRId64
             " is needed; take another copy of it, or start afresh without "
             "--restart",
             path, snapshots, step, step + 1);
}

struct two_phase *run_state_read(const char *path, const struct params *params,
                                 struct run_state *state) {
  struct forest_layout layout;
  grid_layout(params, &layout);
  struct checkpoint *checkpoint =
      checkpoint_open(MPI_COMM_WORLD, path, &layout);
  struct forest *forest = checkpoint_forest(checkpoint, &layout);
  struct two_phase *sim = two_phase_new_on(params, forest);
  checkpoint_read_fields(checkpoint, sim->grid.mesh, &sim->grid.fields);

  struct solve_stats *solve[NSOLVES];
  struct verdicts verdicts;
  struct checkpoint_scalar list[MAX_SCALARS];
  int n = list_scalars(sim, state, &verdicts, list);
  checkpoint_read_scalars(checkpoint, n, list);
  check_snapshots(path, state->snapshots, sim->step);
  checkpoint_close(checkpoint);
  list_solves(sim, solve);
  for (int k = 0; k < NSOLVES; k++) {
    solve[k]->iterations = (int)verdicts.iterations[k];
    solve[k]->status = (enum solve_status)verdicts.status[k];
  }
  for (int k = 0; k < sim->grid.fields.n; k++)
    if (sim->grid.fields.field[k]->restart &&
        sim->grid.fields.field[k]->location == FIELD_CELL)
      field_fill(sim->grid.mesh, sim->grid.fields.field[k]);
  two_phase_refine_openings(sim);
  return sim;
}
