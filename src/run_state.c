/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/run_state.h"

#include <mpi.h>
#include <string.h>

#include "talus/checkpoint.h"
#include "talus/forest.h"
#include "talus/params.h"
#include "talus/simulation.h"

enum { MAX_SCALARS = 32, NSOLVES = 3 };

/* Iterations and verdicts of the solves, as the file wants them. */
struct verdicts {
  int64_t iterations[NSOLVES], status[NSOLVES];
};

/* All that the model remembers between steps besides its fields. */
static int list_scalars(struct simulation *sim, struct run_state *state,
                        struct verdicts *verdicts,
                        struct checkpoint_scalar list[MAX_SCALARS]) {
  struct energy *energy = &sim->energy;
  struct solve_stats *p = &sim->pressure, *q = &sim->predictor,
                     *v = &sim->viscous;
  const struct checkpoint_scalar all[] = {
      {"time", &sim->time, NULL},
      {"dt", &sim->dt, NULL},
      {"step", NULL, &sim->step},
      {"travel", &sim->travel, NULL},
      {"kinetic", &energy->kinetic, NULL},
      {"potential", &energy->potential, NULL},
      {"dissipated", &energy->dissipated, NULL},
      {"initial_energy", &energy->initial, NULL},
      {"divergence_volume", &sim->divergence_volume, NULL},
      {"repeat_change", &sim->repeat_change, NULL},
      {"wall_seconds", &state->wall_seconds, NULL},
      {"snapshots", NULL, &state->snapshots},
      {"pressure_iterations", NULL, &verdicts->iterations[0]},
      {"predictor_iterations", NULL, &verdicts->iterations[1]},
      {"viscous_iterations", NULL, &verdicts->iterations[2]},
      {"pressure_status", NULL, &verdicts->status[0]},
      {"predictor_status", NULL, &verdicts->status[1]},
      {"viscous_status", NULL, &verdicts->status[2]},
      {"pressure_residual_before", &p->residual_before, NULL},
      {"pressure_residual_after", &p->residual_after, NULL},
      {"predictor_residual_before", &q->residual_before, NULL},
      {"predictor_residual_after", &q->residual_after, NULL},
      {"viscous_residual_before", &v->residual_before, NULL},
      {"viscous_residual_after", &v->residual_after, NULL}};
  _Static_assert(sizeof all <= MAX_SCALARS * sizeof all[0], "MAX_SCALARS");
  memcpy(list, all, sizeof all);
  return (int)(sizeof all / sizeof all[0]);
}

static void list_solves(struct simulation *sim,
                        struct solve_stats *solve[NSOLVES]) {
  solve[0] = &sim->pressure;
  solve[1] = &sim->predictor;
  solve[2] = &sim->viscous;
}

void run_state_write(const char *path, struct simulation *sim,
                     struct run_state *state, const char *parameters) {
  struct solve_stats *solve[NSOLVES];
  struct verdicts verdicts;
  list_solves(sim, solve);
  for (int k = 0; k < NSOLVES; k++) {
    verdicts.iterations[k] = solve[k]->iterations;
    verdicts.status[k] = solve[k]->status;
  }
  struct checkpoint_scalar list[MAX_SCALARS];
  int n = list_scalars(sim, state, &verdicts, list);
  checkpoint_write(path, sim->mesh, &sim->fields, n, list, parameters);
}

struct simulation *run_state_read(const char *path, const struct params *params,
                                  struct run_state *state) {
  struct forest_layout layout;
  simulation_layout(params, &layout);
  struct checkpoint *checkpoint =
      checkpoint_open(MPI_COMM_WORLD, path, &layout);
  struct forest *forest = checkpoint_forest(checkpoint, &layout);
  struct simulation *sim = simulation_new_on(params, forest);
  checkpoint_read_fields(checkpoint, sim->mesh, &sim->fields);

  struct solve_stats *solve[NSOLVES];
  struct verdicts verdicts;
  struct checkpoint_scalar list[MAX_SCALARS];
  int n = list_scalars(sim, state, &verdicts, list);
  checkpoint_read_scalars(checkpoint, n, list);
  checkpoint_close(checkpoint);
  list_solves(sim, solve);
  for (int k = 0; k < NSOLVES; k++) {
    solve[k]->iterations = (int)verdicts.iterations[k];
    solve[k]->status = (enum solve_status)verdicts.status[k];
  }
  for (int k = 0; k < sim->fields.n; k++)
    if (sim->fields.field[k]->restart &&
        sim->fields.field[k]->location == FIELD_CELL)
      field_fill(sim->mesh, sim->fields.field[k]);
  return sim;
}
