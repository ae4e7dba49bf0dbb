/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "talus/remap.h"

#include <check.h>

#include "sim.h"
#include "transport.h"

Suite *remap_suite(void);

static double wavy(int d, const double x[3]) {
  return 0.3 * d + sin(5 * x[0] + d) * cos(4 * x[1] - d) + 0.2 * x[DIM - 1];
}

static double linear(const double x[DIM]) {
  static const double slope[] = {1.3, -0.7, 0.4};
  double v = 0.2;
  for (int d = 0; d < DIM; d++) v += slope[d] * x[d];
  return v;
}

static struct body off_centre = {{0.45, 0.55, 0.5}, 0.3};

/* Make a state of a ball of grains, velocities that vary on the scale of the
 * box, a linear pressure and the vortex on faces. */
static struct two_phase *state_new(const struct params *params, int base,
                                   int level) {
  struct two_phase *sim =
      two_phase_new_on(params, grid_new(MPI_COMM_WORLD, 1, false, base, level));
  fill_shape(sim->grid.mesh, ball, &off_centre, sim->c->v);
  fill_cells(sim->grid.mesh, wavy, sim->u);
  for (int32_t i = 0; i < sim->grid.mesh->nleaves; i++) {
    sim->p->v[i] = linear(sim->grid.mesh->x[i]);
  }
  fill_faces(sim->grid.mesh, vortex, sim->u_f->v);
  clean_face_velocity(sim->grid.clean, sim->grid.mesh, sim->grid.open,
                      sim->u_f->v);
  return sim;
}

/* Divide and merge in patches that move with `round`; whole families are of
 * one mind. The patches lie on one side, so that leaves change ranks. */
static void change_grid(struct two_phase *sim, int round, int level_max) {
  const struct mesh *mesh = sim->grid.mesh;
  int8_t *flag = MEM_NEW(int8_t, mesh->nleaves);
  for (int32_t i = 0; i < mesh->nleaves; i++) {
    const double parent = 2 * mesh->h[i];
    double sum = round;
    for (int d = 0; d < DIM; d++) {
      sum += 3 * (floor(mesh->x[i][d] / parent) + 0.5) * parent;
    }
    flag[i] = (int8_t)(sin(2 * sum) > 0.3) - (int8_t)(sin(2 * sum) < -0.3);
  }
  struct forest_map map;
  if (forest_adapt(sim->grid.forest, flag, 1, level_max, &map)) {
    remap_fields(&sim->grid, &map);
  }
  forest_map_destroy(&map);
  mem_free(flag);
}

/* Divide (1) or merge (-1) everything once. */
static void change_all(struct two_phase *sim, int8_t how) {
  int8_t *flag = MEM_NEW(int8_t, sim->grid.mesh->nleaves);
  struct forest_map map;
  memset(flag, how, (size_t)sim->grid.mesh->nleaves);
  forest_adapt(sim->grid.forest, flag, 0, 8, &map);
  remap_fields(&sim->grid, &map);
  forest_map_destroy(&map);
  mem_free(flag);
}

enum { ROUNDS = 6, FINEST = DIM == 2 ? 6 : 5 };

START_TEST(volume_and_momentum_are_conserved) {
  const struct params params = box_params(5);
  struct two_phase *sim = state_new(&params, 2, FINEST - 1);
  const double volume = integral(sim->grid.mesh, sim->c->v);
  const double mass = sim_momentum(sim, -1);
  double before[DIM], lost = 0, drift = 0, excess = 0;
  int64_t fewest = INT64_MAX, greatest = 0;
  for (int d = 0; d < DIM; d++) before[d] = sim_momentum(sim, d);
  for (int round = 0; round < ROUNDS; round++) {
    change_grid(sim, round, FINEST);
    drift =
        larger(drift, fabs(integral(sim->grid.mesh, sim->c->v) / volume - 1));
    for (int d = 0; d < DIM; d++) {
      lost = larger(lost, fabs(sim_momentum(sim, d) - before[d]) / mass);
    }
    for (int32_t i = 0; i < sim->grid.mesh->nleaves; i++) {
      excess = larger(excess, fmax(-sim->c->v[i], sim->c->v[i] - 1));
    }
    const int64_t n = forest_nleaves_global(sim->grid.forest);
    if (n < fewest) fewest = n;
    if (n > greatest) greatest = n;
  }
  excess = mesh_max(sim->grid.mesh, excess);
  two_phase_destroy(sim);
  ck_assert_int_gt(greatest, fewest); /* the grid did change */
  /* round-off, of random sign over a thousand cells */
  ck_assert_double_le(drift, 1e-14);
  ck_assert_double_le(lost, 1e-14);
  ck_assert_double_le(excess, 1e-14);
}
END_TEST

START_TEST(a_linear_pressure_stays_so) {
  const struct params params = box_params(5);
  struct two_phase *sim = state_new(&params, 2, FINEST - 1);
  double most = 0;
  for (int round = 0; round < ROUNDS; round++) {
    change_grid(sim, round, FINEST);
    for (int32_t i = 0; i < sim->grid.mesh->nleaves; i++) {
      most = larger(most, fabs(sim->p->v[i] - linear(sim->grid.mesh->x[i])));
    }
  }
  most = mesh_max(sim->grid.mesh, most);
  two_phase_destroy(sim);
  ck_assert_double_le(most, 1e-14);
}
END_TEST

/* Children of a divided leaf give the same leaf back, so that a grid that
 * flickers costs no accuracy. */
START_TEST(dividing_and_merging_back_changes_nothing) {
  enum { LEVEL = 4 };
  const struct params params = box_params(LEVEL);
  struct two_phase *sim = state_new(&params, LEVEL, LEVEL);
  struct field *field[DIM + 2] = {sim->c, sim->p};
  double *before[DIM + 2], *after[DIM + 2], most = 0;
  for (int d = 0; d < DIM; d++) field[2 + d] = sim->u[d];
  int32_t size = 1;
  for (int d = 0; d < DIM; d++) size *= 2 << LEVEL;
  for (int k = 0; k < DIM + 2; k++) {
    before[k] = paint(sim->grid.mesh, field[k]->v, LEVEL);
  }
  change_all(sim, 1);
  change_all(sim, -1);
  for (int k = 0; k < DIM + 2; k++) {
    after[k] = paint(sim->grid.mesh, field[k]->v, LEVEL);
    for (int32_t i = 0; i < size; i++) {
      most = larger(most, fabs(after[k][i] - before[k][i]));
    }
    mem_free(before[k]);
    mem_free(after[k]);
  }
  const int64_t n = forest_nleaves_global(sim->grid.forest);
  two_phase_destroy(sim);
  ck_assert_int_eq(n, 1 << DIM * LEVEL);
  ck_assert_double_le(most, 1e-14);
}
END_TEST

/* The children of a cut leaf are cut by its plane: with a flat surface they
 * are what a finer grid would have had from the start. */
START_TEST(children_are_cut_by_the_plane_of_their_parent) {
  double height = 0.53;
  struct params params = box_params(4);
  params.shape = (struct function){below, &height};
  struct two_phase *sim =
      two_phase_new_on(&params, grid_new(MPI_COMM_WORLD, 1, false, 4, 4));
  double most = 0;
  sim_fill(sim);
  change_all(sim, 1);
  for (int32_t i = 0; i < sim->grid.mesh->nleaves; i++) {
    const double h = sim->grid.mesh->h[i];
    const double depth = (height - sim->grid.mesh->x[i][DIM - 1]) / h + 0.5;
    most = larger(most, fabs(sim->c->v[i] - fmin(fmax(depth, 0), 1)));
  }
  most = mesh_max(sim->grid.mesh, most);
  two_phase_destroy(sim);
  ck_assert_double_le(most, 1e-13);
}
END_TEST

/* Between one level and a mixture of two and back, children interpolate
 * between the sides of their parent, and every leaf stays solenoidal. */
START_TEST(face_velocities_stay_solenoidal) {
  enum { LEVEL = 4 };
  const struct params params = box_params(LEVEL);
  struct two_phase *sim = state_new(&params, LEVEL, LEVEL);
  double most = clean_divergence(sim->grid.mesh, sim->u_f->v);
  change_grid(sim, 0, LEVEL + 1);
  most = larger(most, clean_divergence(sim->grid.mesh, sim->u_f->v));
  const bool jumps = forest_nleaves_global(sim->grid.forest) > 1 << DIM * LEVEL;
  change_all(sim, -1);
  most = larger(most, clean_divergence(sim->grid.mesh, sim->u_f->v));
  two_phase_destroy(sim);
  ck_assert(jumps);
  ck_assert_double_le(most, 1e-15 * (2 << LEVEL) * 4); /* of u / h */
}
END_TEST

/* A leaf that is not changed keeps its sides, whatever happens beyond: the
 * new leaves there know less of them than it does. */
START_TEST(leaves_that_stay_keep_their_sides) {
  enum { LEVEL = DIM == 2 ? 5 : 4 };
  const struct params params = box_params(LEVEL);
  struct two_phase *sim = state_new(&params, LEVEL - 2, LEVEL);
  double *side[2][NFACE + 1], most = 0, count = 0;
  int32_t size = 1;
  for (int d = 0; d < DIM; d++) size *= 2 << LEVEL;
  for (int k = 0; k < 2; k++) {
    const struct mesh *mesh = sim->grid.mesh;
    double *v = MEM_NEW(double, mesh->nleaves);
    for (int f = 0; f <= NFACE; f++) {
      for (int32_t i = 0; i < mesh->nleaves; i++) {
        v[i] = f < NFACE ? sim->u_f->v[mesh->cell_face[i][f]]
                         : mesh->level[i] == LEVEL;
      }
      side[k][f] = paint(mesh, v, LEVEL);
    }
    mem_free(v);
    if (k > 0) break;
    int8_t *flag = MEM_NEW(int8_t, mesh->nleaves);
    struct forest_map map;
    memset(flag, 1, (size_t)mesh->nleaves); /* all that are not yet finest */
    forest_adapt(sim->grid.forest, flag, 0, LEVEL, &map);
    remap_fields(&sim->grid, &map);
    forest_map_destroy(&map);
    mem_free(flag);
  }
  for (int32_t i = 0; i < size; i++) {
    if (side[0][NFACE][i] == 0) continue;
    count++;
    for (int f = 0; f < NFACE; f++) {
      most = larger(most, fabs(side[1][f][i] - side[0][f][i]));
    }
  }
  for (int f = 0; f <= NFACE; f++) {
    mem_free(side[0][f]);
    mem_free(side[1][f]);
  }
  two_phase_destroy(sim);
  ck_assert_double_gt(count, 0);
  ck_assert(most == 0);
}
END_TEST

/* Halves of a side take its value: first order along the side, and no worse
 * where levels meet. */
START_TEST(face_velocities_stay_accurate) {
  double error[2];
  for (int k = 0; k < 2; k++) {
    const int level = 4 + k;
    const struct params params = box_params(level + 1);
    struct two_phase *sim = state_new(&params, level - 1, level);
    const struct mesh *mesh;
    change_all(sim, 1);
    mesh = sim->grid.mesh;
    error[k] = 0;
    for (int d = 0; d < DIM; d++) {
      for (int32_t f = mesh->face_begin[d]; f < mesh->face_begin[d + 1]; f++) {
        double x[3];
        face_centre(mesh, d, f, x);
        error[k] +=
            fabs(sim->u_f->v[f] - vortex(d, x)) * pow(mesh->face_h[f], DIM);
      }
    }
    error[k] = mesh_sum(mesh, error[k]);
    two_phase_destroy(sim);
  }
  ck_assert_double_ge(log2(error[0] / error[1]), 0.9);
}
END_TEST

Suite *remap_suite(void) {
  Suite *suite = suite_create("remap");
  TCase *tc = tcase_create("remap");
  tcase_add_test(tc, volume_and_momentum_are_conserved);
  tcase_add_test(tc, a_linear_pressure_stays_so);
  tcase_add_test(tc, dividing_and_merging_back_changes_nothing);
  tcase_add_test(tc, children_are_cut_by_the_plane_of_their_parent);
  tcase_add_test(tc, face_velocities_stay_solenoidal);
  tcase_add_test(tc, leaves_that_stay_keep_their_sides);
  tcase_add_test(tc, face_velocities_stay_accurate);
  tcase_set_timeout(tc, 60);
  suite_add_tcase(suite, tc);
  return suite;
}
