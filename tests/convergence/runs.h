/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Whole runs for convergence cases: an example with some of its parameters
 * changed, or params made here, carried to a time or to a steady state. */
#ifndef TALUS_TESTS_RUNS_H
#define TALUS_TESTS_RUNS_H

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "../mesh/sim.h"
#include "talus/case.h"

/* An example of the manual under way. */
struct example {
  struct case_file *file;
  struct two_phase *sim;
};

/* Start examples/NAME.lua with overrides: printf of "name=value ..." divided
 * by blanks. */
static inline struct example example_new(const char *name, const char *format,
                                         ...) {
  enum { MOST = 32 };
  char path[256], words[1024], *override[MOST];
  int n = 0;
  va_list args;
  va_start(args, format);
  vsnprintf(words, sizeof words, format, args);
  va_end(args);
  for (char *word = strtok(words, " "); word && n < MOST;
       word = strtok(NULL, " ")) {
    override[n++] = word;
  }
  snprintf(path, sizeof path, "examples/%s.lua", name);
  char *text = case_read_text(path);
  CHECK(text, "cannot read %s: start this from the root of the checkout", path);
  struct example example = {.file = case_load_text(path, text, n, override)};
  mem_free(text);
  example.sim = sim_start(case_params(example.file));
  return example;
}

static inline void example_destroy(struct example *example) {
  two_phase_destroy(example->sim);
  case_destroy(example->file);
}

/* Advance to `time`; false if a step fails. */
static inline bool run_to(struct two_phase *sim, double time) {
  bool good = true;
  while (good && sim->model.time < time * (1 - 1e-12)) {
    good = step_advance(sim, time - sim->model.time) == EXIT_DONE;
  }
  return good;
}

/* Return the largest change of a velocity component over the last step, per
 * time. The mesh must be the one before it. */
static inline double run_rate(const struct two_phase *sim) {
  double most = 0;
  for (int d = 0; d < DIM; d++) {
    for (int32_t i = 0; i < sim->grid.mesh->nleaves; i++) {
      most = larger(most, fabs(sim->u[d]->v[i] - sim->u_old[d]->v[i]));
    }
  }
  return mesh_max(sim->grid.mesh, most) / sim->model.dt;
}

/* Advance until max |du/dt| < rate; false if that is not so at `time`. */
static inline bool run_steady(struct two_phase *sim, double rate, double time) {
  while (sim->model.time < time) {
    if (step_advance(sim, time - sim->model.time) != EXIT_DONE) return false;
    if (run_rate(sim) < rate) return true;
  }
  return false;
}

/* Norms of an error [nleaves] over the box: root of its mean square, mean
 * and largest size. */
struct norms {
  double l2, l1, most;
};
static inline struct norms norms_of(const struct mesh *mesh,
                                    const double *error) {
  double volume = 0, sum[2] = {0}, most = 0;
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    volume += mesh_volume(mesh, i);
    sum[0] += mesh_volume(mesh, i) * error[i] * error[i];
    sum[1] += mesh_volume(mesh, i) * fabs(error[i]);
    most = larger(most, fabs(error[i]));
  }
  volume = mesh_sum(mesh, volume);
  return (struct norms){sqrt(mesh_sum(mesh, sum[0]) / volume),
                        mesh_sum(mesh, sum[1]) / volume, mesh_max(mesh, most)};
}

#endif
