/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Names that a case may give a tracer, against the fields there are. */
#include <check.h>
#include <string.h>

#include "sim.h"
#include "talus/case.h"
#include "talus/error.h"

static bool all_are_taken(const struct params *params) {
  struct forest_layout layout;
  grid_layout(params, &layout);
  struct two_phase *sim =
      two_phase_new_on(params, forest_new(MPI_COMM_WORLD, &layout, 1));
  bool good = true;
  for (int k = 0; k < sim->grid.fields.n; k++) {
    const char *name = sim->grid.fields.field[k]->name;
    const bool tracer = strcmp(name, params->tracer[0].name) == 0;
    if (case_name_is_taken(name) != tracer) continue;
    fprintf(stderr, "a tracer may%s be called %s\n", tracer ? " not" : "",
            name);
    good = false;
  }
  two_phase_destroy(sim);
  return good;
}

/* With all the fields that options add. */
START_TEST(no_tracer_can_have_the_name_of_a_field) {
  struct params p = box_params(2);
  p.theta = 0.5;
  p.side_walls.mu = 0.1;
  p.side_walls.width = 1;
  p.permeable = true;
  p.ntracers = 1;
  strcpy(p.tracer[0].name, "dyed");
  rheology_init(&p.grains.rheology, rheology_find("lee_huang"));
  ck_assert_ptr_null(rheology_prepare(&p.grains.rheology));
  ck_assert(all_are_taken(&p));
  rheology_release(&p.grains.rheology);
}
END_TEST

Suite *names_suite(void);
Suite *names_suite(void) {
  Suite *suite = suite_create("names");
  TCase *tcase = tcase_create("names");
  tcase_set_tags(tcase, "one_rank");
  tcase_add_test(tcase, no_tracer_can_have_the_name_of_a_field);
  suite_add_tcase(suite, tcase);
  return suite;
}
