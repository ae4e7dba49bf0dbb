/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Times one part of the scheme alone, for tools/bench.py.
 *
 *   bench NAME LEVEL CALLS    prints `leaves,iterations,seconds`: of the box,
 *                             of one solve, of one call (mean)
 *
 * vof          all sweeps of a step, a ball in a vortex, uniform grid
 * poisson      a solve from zero to 1e-4, jump of 1e3 across a ball
 * viscous      a solve from zero to 1e-4, jump of 1e4 across a ball
 * adaptation   dividing and merging around a ball that moves by half a leaf,
 *              fields, mesh and hierarchy made anew
 * The last three on grids with two levels more around the ball. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "../mesh/sim.h"
#include "../mesh/transport.h"
#include "talus/hierarchy.h"
#include "talus/poisson.h"
#include "talus/program.h"
#include "talus/viscous.h"

struct result {
  int64_t leaves;
  int iterations;
  double seconds; /* of one call */
};

static const double kMiddle[] = {0.5, 0.5, 0.5};

static struct result time_vof(int level, int calls) {
  struct bench *b = bench_new(1, false, level, level);
  struct transport t = transport_new(b);
  struct body body = {{0.5, 0.72, 0.5}, 0.17};
  fill_shape(b->mesh, ball, &body, t.c->v);
  fill_faces(b->mesh, vortex, t.u_f->v);
  clean_face_velocity(b->clean, b->mesh, b->open, t.u_f->v);
  const double dt = courant_dt(b->mesh, t.u_f->v, 0.5);
  const double begin = MPI_Wtime();
  for (int k = 0; k < calls; k++) transport_step(b, &t, k, dt);
  struct result result = {forest_nleaves_global(b->forest), 0,
                          (MPI_Wtime() - begin) / calls};
  bench_destroy(b);
  return result;
}

/* A grid around a ball with the arrays of a solve of DIM components. */
struct system {
  struct forest *forest;
  struct mesh *mesh;
  struct hierarchy *hierarchy;
  struct bc bc[MESH_MAX_PATCHES];
  double *coefficient; /* [nfaces_all] */
  double *rho;         /* [nleaves] */
  double *rhs[DIM], *x[DIM];
};

static struct system system_new(int level, double inside, double outside) {
  struct system s = {
      .forest = grid_new(MPI_COMM_WORLD, 1, false, level - 2, level - 2)};
  grid_refine(s.forest, kMiddle, 0.3, level);
  s.mesh = mesh_new(s.forest);
  s.hierarchy = hierarchy_new(s.mesh);
  for (int k = 0; k < NFACE; k++) s.bc[k].type = BC_DIRICHLET;
  s.coefficient = MEM_NEW(double, s.mesh->nfaces_all);
  s.rho = MEM_NEW(double, s.mesh->nleaves);
  for (int d = 0; d < DIM; d++) {
    s.rhs[d] = MEM_NEW(double, s.mesh->nleaves);
    s.x[d] = MEM_NEW(double, s.mesh->ncells);
    for (int32_t f = s.mesh->face_begin[d]; f < s.mesh->face_begin[d + 1];
         f++) {
      double x[3];
      face_centre(s.mesh, d, f, x);
      s.coefficient[f] =
          level_set_ball(kMiddle, 0.25, x) > 0 ? inside : outside;
    }
    for (int32_t i = 0; i < s.mesh->nleaves; i++) {
      s.rho[i] = 1;
      s.rhs[d][i] = sin(3 * s.mesh->x[i][0] + d) * cos(5 * s.mesh->x[i][1]);
    }
  }
  mesh_fill_faces(s.mesh, 1, &s.coefficient);
  return s;
}

static void system_destroy(struct system *s) {
  for (int d = 0; d < DIM; d++) mem_free(s->rhs[d]), mem_free(s->x[d]);
  mem_free(s->rho);
  mem_free(s->coefficient);
  hierarchy_destroy(s->hierarchy);
  mesh_destroy(s->mesh);
  forest_destroy(s->forest);
}

static void system_reset(struct system *s) {
  for (int d = 0; d < DIM; d++) {
    memset(s->x[d], 0, (size_t)s->mesh->ncells * sizeof(double));
  }
}

static struct result time_poisson(int level, int calls) {
  struct system s = system_new(level, 1, 1e3);
  struct result result = {.leaves = forest_nleaves_global(s.forest)};
  const double begin = MPI_Wtime();
  for (int k = 0; k < calls; k++) {
    system_reset(&s);
    result.iterations = poisson_solve(s.mesh, s.hierarchy, s.coefficient, NULL,
                                      NULL, s.rhs[0], s.bc, 1e-4, 100, s.x[0])
                            .iterations;
  }
  result.seconds = (MPI_Wtime() - begin) / calls;
  system_destroy(&s);
  return result;
}

static struct result time_viscous(int level, int calls) {
  struct system s = system_new(level, 1, 1e-4);
  struct result result = {.leaves = forest_nleaves_global(s.forest)};
  const struct bc *bc[DIM];
  for (int d = 0; d < DIM; d++) bc[d] = s.bc;
  const double begin = MPI_Wtime();
  for (int k = 0; k < calls; k++) {
    system_reset(&s);
    result.iterations =
        viscous_solve(s.mesh, s.hierarchy, s.rho,
                      &(struct viscosity){.eta_f = s.coefficient}, 0.01, s.rhs,
                      bc, 1e-4, 100, s.x)
            .iterations;
  }
  result.seconds = (MPI_Wtime() - begin) / calls;
  system_destroy(&s);
  return result;
}

static struct result time_adaptation(int level, int calls) {
  struct params params = box_params(level);
  struct body body = {{0.4, 0.5, 0.5}, 0.25};
  params.shape = (struct function){ball, &body};
  params_follow_surface(&params, level - 3, 3);
  struct two_phase *sim = sim_start(&params);
  struct result result = {.leaves = forest_nleaves_global(sim->grid.forest)};
  for (int k = 0; k < calls; k++) {
    body.centre[0] += 0.5 / (1 << level);
    fill_shape(sim->grid.mesh, ball, &body, sim->c->v);
    const double begin = MPI_Wtime();
    two_phase_adapt(sim);
    result.seconds += (MPI_Wtime() - begin) / calls;
  }
  two_phase_destroy(sim);
  return result;
}

int main(int argc, char **argv) {
  static const struct {
    const char *name;
    struct result (*run)(int level, int calls);
  } jobs[] = {{"vof", time_vof},
              {"poisson", time_poisson},
              {"viscous", time_viscous},
              {"adaptation", time_adaptation}};
  int status = EXIT_USER;
  base_begin(&argc, &argv);
  for (size_t k = 0; k < sizeof jobs / sizeof *jobs && argc == 4; k++) {
    if (strcmp(argv[1], jobs[k].name) != 0) continue;
    const struct result result = jobs[k].run(atoi(argv[2]), atoi(argv[3]));
    if (base_rank() == 0) {
      printf("%lld,%d,%.9g\n", (long long)result.leaves, result.iterations,
             result.seconds);
    }
    status = EXIT_DONE;
  }
  base_end();
  return status;
}
