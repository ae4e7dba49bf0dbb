/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A field that is no longer finite ends the run, wherever it is. Debug builds
 * would stop where it is read first, so that their traps are off here. */
#include <check.h>
#include <math.h>
#include <string.h>

#include "sim.h"
#include "talus/error.h"

/* Describe grains and a tracer in a corner of the box. */
static struct params state_params(void) {
  struct params p = box_params(3);
  p.shape = (struct function){.eval = column};
  p.ntracers = 1;
  strcpy(p.tracer[0].name, "dyed");
  p.tracer[0].shape = (struct function){.eval = column};
  p.dt_max = 1e-3;
  return p;
}

static bool is_seen(struct field *field, struct two_phase *sim, double value) {
  const bool cells = field->location == FIELD_CELL;
  const int32_t n = cells ? sim->grid.mesh->nleaves : sim->grid.mesh->nfaces;
  const double before = field->v[n / 2];
  if (base_rank() == base_size() - 1) field->v[n / 2] = value;
  const char *name = fields_not_finite(&sim->grid.fields, sim->grid.mesh);
  const bool seen = name != NULL && strcmp(name, field->name) == 0;
  field->v[n / 2] = before;
  return seen && fields_not_finite(&sim->grid.fields, sim->grid.mesh) == NULL;
}

START_TEST(every_field_of_the_state_is_looked_at) {
  static const double WILD[] = {NAN, INFINITY, -INFINITY};
  struct params p = state_params();
  struct two_phase *sim = sim_start(&p);
  bool good = step_advance(sim, 1) == EXIT_DONE;
  const bool trapped = base_trap_floating_point(false);
  int n = 0;
  for (int k = 0; k < sim->grid.fields.n; k++) {
    struct field *field = sim->grid.fields.field[k];
    if (!field->rule) continue;
    good = good && is_seen(field, sim, WILD[n++ % 3]);
  }
  base_trap_floating_point(trapped);
  two_phase_destroy(sim);
  ck_assert(all_ranks(good));
  /* c, tracer, p, eta, u_f and three vectors */
  ck_assert_int_eq(n, 5 + 3 * DIM);
}
END_TEST

/* In a leaf in the midst of grains, where no surface passes. */
START_TEST(a_nan_in_a_tracer_ends_the_run) {
  struct params p = state_params();
  struct two_phase *sim = sim_start(&p);
  int status = step_advance(sim, 1);
  ck_assert_int_eq(status, EXIT_DONE);
  const bool trapped = base_trap_floating_point(false);
  if (base_rank() == 0) sim->tracer[0]->v[0] = NAN;
  status = step_advance(sim, 1);
  base_trap_floating_point(trapped);
  two_phase_destroy(sim);
  ck_assert_int_eq(status, EXIT_NUMERICAL);
}
END_TEST

Suite *finite_suite(void);
Suite *finite_suite(void) {
  Suite *suite = suite_create("finite");
  TCase *tcase = tcase_create("finite");
  tcase_add_test(tcase, every_field_of_the_state_is_looked_at);
  tcase_add_test(tcase, a_nan_in_a_tracer_ends_the_run);
  suite_add_tcase(suite, tcase);
  return suite;
}
